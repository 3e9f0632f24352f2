//! Nodes with too few ranges to be placed with the law of all: where they may be by the law of the others.

use nalgebra::Matrix3;
use sextant_kernel::NodeId;

use super::groups::RangeGroup;
use super::modes::{middle, modes};
use super::places::{Place, estimate, longest_m, shared_out, within};
use super::problem::{HeightPrior, Problem, Shared};
use crate::posterior::{Concern, Estimate};

/// A node with its estimate, and the places that its ranges may mean.
pub(super) type FewRanges = (NodeId, Estimate, Vec<Place>);

/// Where the nodes of `problem` may be by the law that all ranges share, the likeliest place first. One range leaves a ring round its
/// stop, whose middle stands for it.
pub(super) fn estimates(problem: &Problem<'_>, shared: &Shared) -> Vec<FewRanges> {
    let of_node = |(number, &node): (usize, &NodeId)| {
        let groups = problem.groups.of_node(number);
        let found = if groups.len() == 1 { Vec::new() } else { modes(problem, number, shared) };
        let mut places: Vec<Place> = Vec::new();
        for place in found.iter().map(Place::of) {
            if places.iter().all(|other| place.is_apart(other)) {
                places.push(place);
            }
        }
        shared_out(&mut places);
        if places.is_empty() {
            places.push(ring(groups, problem.heights));
        }
        let Place { place, covariance, .. } = places[0];
        let covariance = within(covariance, longest_m(groups, shared, problem.node_bias_m));
        let estimate = estimate(place, covariance, &places[1..], problem.heights, |_| Some(Concern::TooFew));
        (node, estimate, places)
    };
    problem.groups.nodes.iter().enumerate().map(of_node).collect()
}

/// A ring, as wide as the ranges are long.
fn ring(groups: &[RangeGroup], heights: HeightPrior) -> Place {
    let ([x, y], usual_m) = middle(groups);
    let variance = 0.5 * usual_m * usual_m;
    let of_height = heights.deviation_m.powi(2);
    Place {
        place: [x, y, heights.mean_m].into(),
        covariance: Matrix3::from_diagonal(&[variance, variance, of_height].into()),
        share: 1.0,
    }
}
