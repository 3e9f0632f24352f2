//! Cuts of an area into one part for each robot.

use sextant_channel::{Bounds, Position};

use super::area::{Axis, FreeArea};
use super::config::{BalanceConfig, CutConfig, PartitionConfig};
use crate::route::number;

/// Rounds in which the shares of the robots are corrected by the time that they would take.
const ROUNDS: usize = 24;
/// Exponent of a correction: lower than 1, because the time of a part changes in steps of a lane.
const CORRECTION: f64 = 0.7;
/// Times that differ by less than this share are equal.
const EQUAL: f64 = 1e-3;

/// The part of an area of one robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobotPart {
    /// Its box without what it shares with neighbours.
    pub own: Bounds,
    /// The box that the robot surveys: all that is free in its own and in the strips that it shares.
    pub surveyed: Bounds,
}

/// Divides `area` among `robots`. Neighbouring parts share strips of `overlap_m` along the cuts. `cost` is the time that
/// robot `number` would take for a part; `None` if it cannot survey that.
///
/// Recursive bisection (Berger and Bokhari 1987): all parts of the area are in a part. To balance times the shares of robots
/// are corrected by their times, and the partition whose slowest robot is fastest is taken.
pub fn partition(
    area: &FreeArea,
    robots: usize,
    config: PartitionConfig,
    overlap_m: f64,
    cost: impl Fn(usize, &RobotPart) -> Option<f64>,
) -> Vec<RobotPart> {
    let cut = |shares: &[f64]| {
        let mut parts = Vec::with_capacity(robots);
        match config.cut {
            CutConfig::Bisection => bisect(area, area.bounds(), shares, &mut parts),
            CutConfig::Strips => strips(area, shares, &mut parts),
        }
        let share = |own: Bounds| RobotPart { own, surveyed: area.tight(&grown(&own, overlap_m, area)) };
        parts.into_iter().map(share).collect::<Vec<RobotPart>>()
    };
    let mut shares = vec![1.0 / number(robots); robots];
    let mut best = cut(&shares);
    if config.balance == BalanceConfig::Area || robots < 2 {
        return best;
    }
    let costs_of = |parts: &[RobotPart]| -> Option<Vec<f64>> {
        parts.iter().enumerate().map(|(robot, part)| cost(robot, part)).collect()
    };
    let longest = |costs: &[f64]| costs.iter().copied().fold(0.0, f64::max);
    let Some(mut costs) = costs_of(&best) else { return best };
    let mut least = longest(&costs);
    for _ in 0..ROUNDS {
        let mean = costs.iter().sum::<f64>() / number(robots);
        if longest(&costs) <= (1.0 + EQUAL) * mean {
            break;
        }
        for (share, cost) in shares.iter_mut().zip(&costs) {
            *share *= libm::pow(mean / cost.max(1e-3 * mean), CORRECTION);
        }
        let total: f64 = shares.iter().sum();
        shares.iter_mut().for_each(|share| *share /= total);
        let parts = cut(&shares);
        let Some(next) = costs_of(&parts) else { break };
        costs = next;
        if longest(&costs) < least {
            (least, best) = (longest(&costs), parts);
        }
    }
    best
}

/// Cuts a box across its longer side until there is a part for each of the `shares`.
fn bisect(area: &FreeArea, whole: Bounds, shares: &[f64], parts: &mut Vec<Bounds>) {
    if shares.len() < 2 {
        parts.push(whole);
        return;
    }
    let (first, second) = shares.split_at(shares.len() / 2);
    let axis = Axis::longer(&area.tight(&whole));
    let share = first.iter().sum::<f64>() / shares.iter().sum::<f64>();
    let at_m = area.cut_m(&whole, axis, share);
    bisect(area, axis.below(&whole, at_m), first, parts);
    bisect(area, axis.above(&whole, at_m), second, parts);
}

/// Cuts the area into strips along y.
fn strips(area: &FreeArea, shares: &[f64], parts: &mut Vec<Bounds>) {
    let mut rest = area.bounds();
    for (at, share) in shares.iter().enumerate() {
        let left: f64 = shares[at..].iter().sum();
        let cut_m = if at + 1 < shares.len() { area.cut_m(&rest, Axis::X, share / left) } else { rest.max.x_m };
        parts.push(Axis::X.below(&rest, cut_m));
        rest = Axis::X.above(&rest, cut_m);
    }
}

/// A part with half the strips that it shares, within the area.
fn grown(part: &Bounds, overlap_m: f64, area: &FreeArea) -> Bounds {
    let margin = Position::new(0.5 * overlap_m, 0.5 * overlap_m, 0.0);
    let (min, max) = (part.min - margin, part.max + margin);
    let whole = area.bounds();
    Bounds {
        min: Position { x_m: min.x_m.max(whole.min.x_m), y_m: min.y_m.max(whole.min.y_m), ..min },
        max: Position { x_m: max.x_m.min(whole.max.x_m), y_m: max.y_m.min(whole.max.y_m), ..max },
    }
}
