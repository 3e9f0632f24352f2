//! Whether places explain ranges at all: better than a constant range of each node.

use super::error_law;
use super::problem::{Point, Problem, Residual};
use crate::numerics::median;

/// What places gain over constant ranges.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Explained {
    /// Logarithm of how much more probable a group is by places than by constants, on average, less one for each coordinate.
    pub(super) mean_gain: f64,
    /// The same of each node with all its groups, by the law of all ranges and by its own of constants.
    pub(super) of_nodes: Vec<f64>,
    /// The usual error that is left, as a share of the usual range.
    pub(super) share_left: f64,
}

/// Places that gain less for each group explain nothing (nats), if errors are at least so large a share of the ranges.
const LEAST_GAIN: f64 = 0.2;
const LARGE: f64 = 0.25;
/// A place of one node is no place if a constant is more probable by so much (nats).
const CLEAR: f64 = 5.0;

impl Explained {
    pub(super) fn of(problem: &Problem<'_>, point: &Point) -> Self {
        let law = point.errors().prepared();
        let (mut constants, mut lefts, mut by_places, mut of_nodes) = (Vec::new(), Vec::new(), 0.0, Vec::new());
        for (number, node) in point.nodes.iter().enumerate() {
            let groups = problem.groups.of_node(number);
            let left: Vec<f64> =
                groups.iter().map(|group| Residual::of(group, node, &point.shared).error_m).collect();
            let usual_m = median(&mut groups.iter().map(|group| group.range_m).collect::<Vec<_>>());
            let constant: Vec<f64> = groups.iter().map(|group| group.range_m - usual_m).collect();
            let likelihood = law.log_likelihood(left.iter().copied());
            of_nodes.push(problem.worth * (likelihood - best(&constant)));
            by_places += likelihood;
            lefts.extend(left.iter().map(|error_m| error_m.abs()));
            constants.extend(constant);
        }
        let axes = if problem.heights.is_given() { 2.0 } else { 3.0 };
        let gain = problem.worth * (by_places - best(&constants)) - axes * point.nodes.len() as f64;
        Self {
            mean_gain: gain / problem.groups.len() as f64,
            of_nodes,
            share_left: 1.4826 * median(&mut lefts) / problem.groups.usual_m().max(f64::MIN_POSITIVE),
        }
    }

    /// Whether no place of the log explains its ranges better than a constant.
    pub(super) fn is_nothing(&self) -> bool {
        self.mean_gain < LEAST_GAIN && self.share_left > LARGE
    }

    /// Whether places explain the ranges better than a constant, however small the errors are.
    pub(super) fn is_any(&self) -> bool {
        self.mean_gain >= LEAST_GAIN
    }

    /// Whether a constant explains the ranges of a node clearly better than its place.
    pub(super) fn is_no_place(&self, number: usize) -> bool {
        self.of_nodes[number] < -CLEAR
    }
}

/// Logarithm of the likelihood of these errors (m) by the law that suits them best.
fn best(errors_m: &[f64]) -> f64 {
    error_law::of_errors(errors_m).prepared().log_likelihood(errors_m.iter().copied())
}
