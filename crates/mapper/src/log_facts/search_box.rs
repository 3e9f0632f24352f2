//! The box in which a node of a log without a known channel is searched for, from the stops that heard it.
//!
//! A log determines the place of a node only within the reach of its stops. If all stops hear all nodes equally well,
//! a node far away explains the log as well as a node among the stops. So a node is searched for in a box round the
//! stops that heard it, and a node that is as likely at the border of its box is reported.

use sextant_channel::{Position, ReceptionLog};

use crate::log_facts::heights::{HeightReason, SoughtHeights};
use crate::log_facts::reach::HeardNode;

/// A node may be this many times the reach away from a stop that heard it.
const REACHES: f64 = 1.25;
/// If the stops that heard a node are farther apart than that, the node may be outside them by this share of the
/// reach, or of the diagonal of the box of all stops if that is smaller.
const BEYOND: [f64; 2] = [0.5, 0.1];

/// The corners of the box in which a node is searched for (m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SearchBox {
    pub(crate) low: [f64; 3],
    pub(crate) high: [f64; 3],
    /// Whether the bounds along an axis follow from the stops that heard the node, and not from the settings.
    pub(crate) is_guessed: [bool; 3],
}

impl SearchBox {
    /// Whether the box is a rectangle at one height.
    pub(crate) fn is_level(&self) -> bool {
        self.low[2] >= self.high[2]
    }

    /// The box with ends that are guessed so much farther out (m).
    pub(crate) fn widened(mut self, by_m: f64) -> Self {
        for axis in (0..3).filter(|&axis| self.is_guessed[axis]) {
            self.low[axis] -= by_m;
            self.high[axis] += by_m;
        }
        self
    }

    /// The middle of the box.
    pub(crate) fn middle(&self) -> Position {
        [0, 1, 2].map(|axis| 0.5 * (self.low[axis] + self.high[axis])).into()
    }

    /// Whether the box holds `place`.
    pub(crate) fn contains(&self, place: Position) -> bool {
        let place: [f64; 3] = place.into();
        // A plane is found within rounding errors.
        (0..3).all(|axis| place[axis] >= self.low[axis] - 1e-9 && place[axis] <= self.high[axis] + 1e-9)
    }

    /// Whether `place` is less than `step_m` from an end of the box that is guessed.
    pub(crate) fn is_at_edge(&self, place: Position, step_m: f64) -> bool {
        self.is_in_outer_cells(place, [step_m; 3])
    }

    /// Whether `place` is nearer to an end of the box that is guessed than these steps along the axes (m).
    pub(crate) fn is_in_outer_cells(&self, place: Position, steps_m: [f64; 3]) -> bool {
        let place: [f64; 3] = place.into();
        let is_near = |axis: usize| {
            place[axis] < self.low[axis] + steps_m[axis] || place[axis] > self.high[axis] - steps_m[axis]
        };
        (0..3).any(|axis| self.is_guessed[axis] && self.low[axis] < self.high[axis] && is_near(axis))
    }

    /// The place in the box that is nearest to `place`.
    pub(crate) fn nearest(&self, place: Position) -> Position {
        let place: [f64; 3] = place.into();
        [0, 1, 2].map(|axis| place[axis].clamp(self.low[axis], self.high[axis])).into()
    }
}

/// How far from stops nodes may be.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    from_stop_m: f64,
    beyond_m: f64,
    heights: SoughtHeights,
}

impl Limits {
    /// Limits for a log whose nodes are heard over `reach_m` and searched for at `heights`.
    pub(crate) fn new(log: &ReceptionLog, reach_m: f64, heights: SoughtHeights) -> Self {
        let mut corners = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for stop in log.stops() {
            for (axis, value) in <[f64; 3]>::from(stop.position).into_iter().enumerate() {
                corners[0][axis] = corners[0][axis].min(value);
                corners[1][axis] = corners[1][axis].max(value);
            }
        }
        let diagonal_m = (0..3).map(|axis| (corners[1][axis] - corners[0][axis]).powi(2)).sum::<f64>().sqrt();
        Self { from_stop_m: REACHES * reach_m, beyond_m: (BEYOND[0] * reach_m).min(BEYOND[1] * diagonal_m), heights }
    }

    /// The box for a node.
    pub(crate) fn of(&self, heard: &HeardNode) -> SearchBox {
        let [first, last] = heard.corners;
        let reach_m = |axis: usize| self.from_stop_m.max(last[axis] - first[axis] + self.beyond_m);
        let mut low = [0, 1, 2].map(|axis| last[axis] - reach_m(axis));
        let mut high = [0, 1, 2].map(|axis| first[axis] + reach_m(axis));
        let mut is_guessed = [true; 3];
        let SoughtHeights { low_m, high_m, reason } = self.heights;
        if reason == HeightReason::Reach {
            (low[2], high[2]) = (low[2].max(low_m), high[2].min(high_m));
        } else {
            (low[2], high[2], is_guessed[2]) = (low_m, high_m, false);
        }
        SearchBox { low, high, is_guessed }
    }
}
