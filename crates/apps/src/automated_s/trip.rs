//! Trips of the automated S path: to the other side, and to what the lanes passed by.

use sextant_channel::Position;
use sextant_sim::{RobotCommand, Situation};

use super::settings::Settings;
use super::survey::{AutomatedS, COVERED, Move, Task};

/// New ways looked for on one trip, at most.
const MAX_REPLANS: u32 = 32;
/// How often the robot comes back for one node, in packets wanted.
const RETURNS_PER_PACKET: u32 = 2;
/// Share of the lane spacing within which a stop covers a place, on a closer look.
const CLOSELY_COVERED: f64 = 0.375;

/// A trip past known obstacles.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Trip {
    pub(super) goal: Position,
    /// The way that is left, the next place last.
    pub(super) way: Vec<Position>,
    pub(super) replans: u32,
    pub(super) then: Goal,
}

/// Why the robot travels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Goal {
    /// To sweep the other side of the start.
    OtherSide,
    /// To listen at a place passed by, or again.
    Check,
    /// To climb from there to another layer, at this height [m].
    Climb { to_z_m: f64 },
}

impl AutomatedS {
    /// Goes where packets of missing nodes may be had: places passed by if some were never heard, then those where
    /// they were heard best. A robot with an area does not know which nodes are its own: it visits gaps.
    pub(super) fn check(&mut self, situation: &Situation<'_>) {
        let here = situation.position;
        loop {
            let goal = if self.area.is_some() {
                self.knowledge.nearest_gap(here, COVERED * self.spacing_m())
            } else {
                self.place_to_check(here)
            };
            let Some(goal) = goal else { break };
            if self.set_out(situation, goal, Goal::Check) {
                return;
            }
            self.knowledge.give_up_opening(goal);
        }
        self.task = Task::Finish(self.ending_with_misses());
    }

    /// A place passed by if nodes were never heard, else one at which nodes were heard best.
    fn place_to_check(&mut self, here: Position) -> Option<Position> {
        let shares = [COVERED, CLOSELY_COVERED].into_iter().filter(|_| self.misses_nodes());
        let opening = { shares }.find_map(|share| self.knowledge.nearest_opening(here, share * self.spacing_m()));
        opening.or_else(|| self.knowledge.place_to_listen_again(here, self.settings.packets_per_node, self.returns()))
    }

    /// The distance between lanes, or between layers if that is more [m].
    fn spacing_m(&self) -> f64 {
        let Settings { lane_spacing_m, layers, .. } = self.settings;
        layers.map_or(lane_spacing_m, |layers| layers.spacing_m.max(lane_spacing_m))
    }

    /// How often the robot comes back for one node.
    fn returns(&self) -> u32 {
        self.settings.packets_per_node.saturating_mul(RETURNS_PER_PACKET)
    }

    /// Whether there are nodes that no place known is good for.
    pub(super) fn misses_nodes(&self) -> bool {
        self.knowledge.misses_nodes(self.settings.packets_per_node, self.returns())
    }

    /// Sets out for `goal`; `false` and no change if no way is known.
    pub(super) fn set_out(&mut self, situation: &Situation<'_>, goal: Position, then: Goal) -> bool {
        let Some(way) = self.way(situation, goal) else { return false };
        self.task = Task::Travel(Trip { goal, way, replans: 0, then });
        true
    }

    /// A way to `goal`, the next place last.
    fn way(&self, situation: &Situation<'_>, goal: Position) -> Option<Vec<Position>> {
        let Settings { step_m, lane_spacing_m, .. } = self.settings;
        let mut way = self.knowledge.way(situation, goal, 0.5 * step_m, 2.0 * lane_spacing_m)?;
        way.reverse();
        Some(way)
    }

    pub(super) fn travel(
        &mut self,
        situation: &Situation<'_>,
        mut trip: Trip,
        last_move: Move,
    ) -> Option<RobotCommand> {
        if last_move == Move::Blocked {
            trip.replans += 1;
            let way = if trip.replans > MAX_REPLANS { None } else { self.way(situation, trip.goal) };
            trip.way = way.unwrap_or_default();
        }
        if let Some(place) = trip.way.pop() {
            self.task = Task::Travel(trip);
            return Some(RobotCommand::Drive(place));
        }
        match trip.then {
            Goal::OtherSide if self.settings.layers.is_some() => self.begin_other_side_of_layer(situation.position),
            Goal::OtherSide => self.begin_sweep(situation.position),
            Goal::Climb { to_z_m } => self.task = Task::Climb { to_z_m },
            Goal::Check => {
                self.knowledge.give_up_opening(trip.goal);
                self.check(situation);
            }
        }
        None
    }
}
