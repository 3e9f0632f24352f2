//! The change of frame with which most of the shared nodes agree.

use sextant_channel::{Bounds, Position};
use sextant_kernel::Seed;

use super::frame_change::{FrameChange, Handedness, Lengths, WeightedPair};
use super::shared::SharedNode;
use super::tukey;
use crate::purpose;

/// All pairs of nodes are tried up to this many, otherwise as many random ones.
const MOST_TRIALS: usize = 1_500;
/// A trial is judged by at most this many nodes.
const MOST_JUDGES: usize = 400;
/// The nodes of a trial are apart by at least this share of the extent of all.
const LEAST_APART: f64 = 0.15;
/// Rounds of reweighting.
const ROUNDS: usize = 50;
/// Standard deviations below this share of the extent are rounding.
const ROUNDING: f64 = 1e-9;

/// A change of frame with which most of the shared nodes agree.
#[derive(Clone, Debug)]
pub(super) struct Consensus {
    pub(super) change: FrameChange,
    /// Standard deviation of a residual along an axis, relative to that expected from the variance of the node.
    pub(super) deviation: f64,
}

/// The change of frame with this handedness whose median residual is least among those of many pairs of nodes (Rousseeuw
/// 1984), refined by reweighting with Tukey's biweight; `None` if the places coincide.
pub(super) fn consensus(
    nodes: &[SharedNode],
    handedness: Handedness,
    lengths: Lengths,
    seed: Seed,
) -> Option<Consensus> {
    let extent = extent_m(nodes);
    if extent <= 0.0 {
        return None;
    }
    let step = nodes.len().div_ceil(MOST_JUDGES);
    let judges: Vec<SharedNode> = nodes.iter().step_by(step).copied().collect();
    let mut best: Option<(f64, FrameChange)> = None;
    for [a, b] in trials(nodes.len(), seed) {
        let pair = [nodes[a], nodes[b]];
        if level_m(pair[0].from - pair[1].from) < LEAST_APART * extent {
            continue;
        }
        let pair = pair.map(|node| WeightedPair { from: node.from, onto: node.onto, weight: 1.0 });
        let Some(change) = FrameChange::fit(&pair, handedness, lengths) else { continue };
        let mut residuals: Vec<f64> = judges.iter().map(|node| residual(node, &change)).collect();
        let middle = residuals.len() / 2;
        let median = *residuals.select_nth_unstable_by(middle, f64::total_cmp).1;
        if best.is_none_or(|(least, _)| median < least) {
            best = Some((median, change));
        }
    }
    let (_, change) = best?;
    refined(nodes, change, lengths, extent)
}

/// The fit near `change`, with outliers left out.
fn refined(nodes: &[SharedNode], change: FrameChange, lengths: Lengths, extent: f64) -> Option<Consensus> {
    let usual = nodes.iter().map(|node| node.variance).fold(f64::INFINITY, f64::min).sqrt();
    let least = ROUNDING * extent / usual;
    let deviation_of = |change: &FrameChange| {
        let residuals = nodes.iter().map(|node| residual(node, change)).collect();
        tukey::standard_deviation(residuals, 2).max(least)
    };
    let mut change = change;
    let deviation = deviation_of(&change);
    for _ in 0..ROUNDS {
        let weighted = nodes.iter().map(|node| WeightedPair {
            from: node.from,
            onto: node.onto,
            weight: tukey::weight(residual(node, &change) / deviation) / node.variance,
        });
        let weighted: Vec<WeightedPair> = weighted.filter(|pair| pair.weight > 0.0).collect();
        let next = FrameChange::fit(&weighted, change.handedness, lengths)?;
        let moved = nodes.iter().map(|node| next.apply(node.from).distance_m(change.apply(node.from)));
        let is_last = moved.fold(0.0, f64::max) <= 1e-12 * extent;
        change = next;
        if is_last {
            break;
        }
    }
    let deviation = deviation_of(&change).min(deviation);
    Some(Consensus { change, deviation })
}

/// How far a node is from where `change` brings it, seen from above, in standard deviations that its variance gives.
pub(super) fn residual(node: &SharedNode, change: &FrameChange) -> f64 {
    level_m(change.apply(node.from) - node.onto) / node.variance.sqrt()
}

/// The length of a step seen from above (m).
pub(super) fn level_m(step: Position) -> f64 {
    libm::hypot(step.x_m, step.y_m)
}

/// The diagonal of the box of the nodes on the first map (m).
fn extent_m(nodes: &[SharedNode]) -> f64 {
    let bounds = Bounds::of(nodes.iter().map(|node| node.from));
    bounds.map_or(0.0, |bounds| level_m(bounds.max - bounds.min))
}

/// Pairs of different numbers below `count`: all of them, or random ones.
fn trials(count: usize, seed: Seed) -> Vec<[usize; 2]> {
    if count * count.saturating_sub(1) / 2 <= MOST_TRIALS {
        return (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b])).collect();
    }
    let draw = |trial: usize, which: u64| {
        let bits = seed.bits(purpose::STITCHING, [trial as u64, which, 0]);
        usize::try_from(bits % count as u64).expect("less than the number of nodes")
    };
    (0..MOST_TRIALS).map(|trial| [draw(trial, 0), draw(trial, 1)]).filter(|[a, b]| a != b).collect()
}
