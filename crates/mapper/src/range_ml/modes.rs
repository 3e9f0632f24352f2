//! The places of a node that its ranges may mean: on a straight way there are two, mirror images of each other.

use std::f64::consts::FRAC_PI_4;

use nalgebra::Matrix2;

use super::groups::RangeGroup;
use super::problem::{Effort, HeightPrior, NodeMode, NodeState, Problem, Residual, Sample, Shared};
use crate::comparators::lateration::{Range, refine};
use crate::numerics::median;

/// Two places that are closer than this share of the usual range are one.
const SAME: f64 = 0.02;
/// A mode that is seen from afar is left out if it is less probable than the best by this and this for each group (nats).
const HOPELESS: [f64; 2] = [20.0, 0.25];
/// Above and below the height that is most likely, the search begins this far off (m).
const ABOVE_M: f64 = 0.3;

/// The modes of the node with this number, the most probable first. They are sought from places all around its stops.
pub(super) fn modes(problem: &Problem<'_>, number: usize, shared: &Shared) -> Vec<NodeMode> {
    let groups = problem.groups.of_node(number);
    let (middle, usual_m) = middle(groups);
    let height = problem.heights.mean_m;
    let lift = if problem.heights.is_given() { 0.0 } else { ABOVE_M };
    let ranges = to_stops(Sample::few(groups.len()).of(groups));
    let mut starts: Vec<NodeState> = Vec::new();
    for [x, y] in round(middle, usual_m) {
        let place = refine([x, y, height].into(), &ranges, 2);
        starts.extend([[x, y], [place.x_m, place.y_m]].map(|[x, y]| NodeState::new(x, y, height + lift, 0.0)));
    }
    let mut found = Vec::new();
    settle(problem, number, shared, &starts, &mut found);
    // Mirror images of those that were found.
    let axis = axis_of(groups, middle);
    let mirrored: Vec<NodeState> = found
        .iter()
        .flat_map(|mode: &NodeMode| {
            let mut across = mode.state;
            let along = (across[0] - middle[0]) * axis[0] + (across[1] - middle[1]) * axis[1];
            for at in 0..2 {
                across[at] = 2.0 * (middle[at] + along * axis[at]) - across[at];
            }
            let mut below = mode.state;
            below[2] = 2.0 * height - below[2];
            if problem.heights.is_given() { vec![across] } else { vec![across, below] }
        })
        .collect();
    settle(problem, number, shared, &mirrored, &mut found);
    found
}

fn to_stops<'a>(groups: impl IntoIterator<Item = &'a RangeGroup>) -> Vec<Range> {
    groups.into_iter().map(|group| Range::new(group.position.into(), group.range_m)).collect()
}

/// Places all around, as far off as ranges usually are.
fn round(middle: [f64; 2], usual_m: f64) -> impl Iterator<Item = [f64; 2]> {
    (0..8).map(move |eighth| {
        let angle = f64::from(eighth) * FRAC_PI_4 + 0.1;
        [middle[0] + usual_m * libm::cos(angle), middle[1] + usual_m * libm::sin(angle)]
    })
}

/// The place of a node by plain least squares from places all around, and the sum of the squares of its errors (m²).
pub(super) fn least_squares(groups: &[RangeGroup], heights: HeightPrior) -> (NodeState, f64) {
    let (middle, usual_m) = middle(groups);
    let (some, all) = (to_stops(Sample::few(groups.len()).of(groups)), to_stops(groups));
    let of = |[x, y]: [f64; 2]| {
        let mut place = refine([x, y, heights.mean_m].into(), &some, 2);
        if some.len() < all.len() {
            place = refine(place, &all, 2);
        }
        let state = NodeState::new(place.x_m, place.y_m, place.z_m, 0.0);
        let square = |group: &RangeGroup| Residual::of(group, &state, &Shared::zeros()).error_m.powi(2);
        (state, groups.iter().map(square).sum::<f64>())
    };
    let best = round(middle, usual_m).map(of).min_by(|a, b| a.1.total_cmp(&b.1));
    best.expect("there are eight places around")
}

/// The middle of the places of some groups, and how long their ranges usually are (m).
pub(super) fn middle(groups: &[RangeGroup]) -> ([f64; 2], f64) {
    let mean = |axis: usize| groups.iter().map(|group| group.position[axis]).sum::<f64>() / groups.len() as f64;
    let mut ranges: Vec<f64> = groups.iter().map(|group| group.range_m.abs()).collect();
    ([mean(0), mean(1)], median(&mut ranges))
}

/// The modes near `starts` of the node with this number, the most probable first.
pub(super) fn settled(problem: &Problem<'_>, number: usize, shared: &Shared, starts: &[NodeState]) -> Vec<NodeMode> {
    let mut found = Vec::new();
    settle(problem, number, shared, starts, &mut found);
    found
}

/// Adds the modes near `starts` to `found`, each once, and sorts them.
fn settle(problem: &Problem<'_>, number: usize, shared: &Shared, starts: &[NodeState], found: &mut Vec<NodeMode>) {
    let groups = problem.groups.of_node(number);
    let (_, usual_m) = middle(groups);
    let is_told =
        |mode: &NodeMode| mode.state.iter().all(|value| value.is_finite()) && problem.heights.allows(mode.state[2]);
    let add = |found: &mut Vec<NodeMode>, mode: NodeMode| {
        let is_same =
            |other: &NodeMode| (other.state - mode.state).fixed_rows::<3>(0).norm() <= SAME * (usual_m + 1.0);
        match found.iter_mut().find(|other| is_same(other)) {
            Some(other) if other.log_evidence < mode.log_evidence => *other = mode,
            Some(_) => {}
            None => found.push(mode),
        }
    };
    // Most starts lead to the same few modes.
    let mut seen = Vec::new();
    for &start in starts {
        if let Some(mode) = problem.settle_node(number, start, shared, Effort::Look).filter(is_told) {
            add(&mut seen, mode);
        }
    }
    let best = seen.iter().map(|mode| mode.log_evidence).fold(f64::NEG_INFINITY, f64::max);
    let least = best - HOPELESS[0] - HOPELESS[1] * problem.worth * groups.len() as f64;
    for mode in seen.into_iter().filter(|mode| mode.log_evidence >= least) {
        if let Some(mode) = problem.settle_node(number, mode.state, shared, Effort::Settle).filter(is_told) {
            add(found, mode);
        }
    }
    found.sort_by(|a, b| b.log_evidence.total_cmp(&a.log_evidence));
}

/// The direction in which the places of some ranges spread most: a unit vector.
fn axis_of(groups: &[RangeGroup], middle: [f64; 2]) -> [f64; 2] {
    let mut spread = Matrix2::zeros();
    for group in groups {
        let apart = nalgebra::Vector2::new(group.position[0] - middle[0], group.position[1] - middle[1]);
        spread += apart * apart.transpose();
    }
    let angle = 0.5 * libm::atan2(2.0 * spread[(0, 1)], spread[(0, 0)] - spread[(1, 1)]);
    [libm::cos(angle), libm::sin(angle)]
}

impl HeightPrior {
    /// Whether a node may be at this height.
    fn allows(self, height_m: f64) -> bool {
        self.range_m.is_none_or(|[low, high]| (low - 1e-6..=high + 1e-6).contains(&height_m))
    }
}
