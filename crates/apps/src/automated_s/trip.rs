//! A trip round known obstacles, to a place off the lanes.

use sextant_channel::Position;

use super::settings::Settings;
use super::view::{Move, View};

/// Maximum number of times that one trip is planned again.
const MAX_REPLANS: u32 = 32;

/// A trip round known obstacles.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Trip {
    pub(super) goal: Position,
    /// What begins at the goal.
    pub(super) then: Goal,
    /// The rest of the way, in reverse order: the next place is the last entry.
    way: Vec<Position>,
    replans: u32,
}

/// The purpose of a trip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Goal {
    /// To sweep the other side of the start.
    OtherSide,
    /// To listen at a place that was passed, or to listen again.
    Check,
    /// To climb from there to another layer, at this height (m).
    Climb { to_z_m: f64 },
}

impl Trip {
    /// A trip to `goal`; `None` if no way is known.
    pub(super) fn plan(view: &View<'_>, goal: Position, then: Goal) -> Option<Self> {
        Some(Self { goal, then, way: way(view, goal)?, replans: 0 })
    }

    /// Whether places on the way are still ahead.
    pub(super) fn is_under_way(&self) -> bool {
        !self.way.is_empty()
    }

    /// The next place. `None` at the end of the trip: the goal is reached, or no way to it is known.
    pub(super) fn next(&mut self, view: &View<'_>) -> Option<Position> {
        if view.last_move == Move::Blocked {
            self.replans += 1;
            let way = if self.replans > MAX_REPLANS { None } else { way(view, self.goal) };
            self.way = way.unwrap_or_default();
        }
        self.way.pop()
    }
}

/// A way to `goal`, in reverse order: the next place is the last entry.
fn way(view: &View<'_>, goal: Position) -> Option<Vec<Position>> {
    let Settings { step_m, lane_spacing_m, .. } = view.rules.settings;
    let mut way = view.knowledge.way(view.situation, goal, 0.5 * step_m, 2.0 * lane_spacing_m)?;
    way.reverse();
    Some(way)
}
