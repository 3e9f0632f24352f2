//! From one lane to the next.

use sextant_channel::Position;
use sextant_sim::{RobotCommand, Situation};

use super::survey::{AutomatedS, Move, Task};

impl AutomatedS {
    /// Over to the next lane; where there is no way, back along this one in search of one.
    pub(super) fn shift(
        &mut self,
        situation: &Situation<'_>,
        from: Position,
        last_move: Move,
    ) -> Option<RobotCommand> {
        let here = situation.position;
        let step_m = self.settings.step_m;
        let done_m = (here.x_m - from.x_m).abs();
        let left_m = self.settings.lane_spacing_m - done_m;
        let is_done = left_m <= 0.01 * step_m;
        let stride_m = self.sweep * self.stride(left_m);
        let is_at_border = !is_done && !self.allows(here + Position::new(stride_m, 0.0, 0.0));
        let least_m = if is_at_border { 0.5 * self.settings.lane_spacing_m } else { 0.99 * step_m };
        if is_done || (last_move == Move::Blocked || is_at_border) && done_m >= least_m {
            self.lane.heading = -self.lane.heading;
            self.begin_lane(here);
            return None;
        }
        if done_m < 0.01 * step_m && !self.has_room_over(here) {
            if self.has_way_over() {
                self.task = Task::Retreat;
            } else {
                self.end_sweep(situation);
            }
            return None;
        }
        if last_move == Move::Blocked || is_at_border {
            self.task = Task::Retreat;
            return None;
        }
        Self::drive(here, stride_m, 0.0)
    }

    /// Whether the area goes on beside this place for half the way to the next lane.
    fn has_room_over(&self, here: Position) -> bool {
        let half_m = self.sweep * 0.5 * self.settings.lane_spacing_m;
        self.allows(here + Position::new(half_m, 0.0, 0.0))
    }

    /// Whether it goes on all the way beside any stop of this lane.
    fn has_way_over(&self) -> bool {
        let over = Position::new(self.sweep * self.settings.lane_spacing_m, 0.0, 0.0);
        self.knowledge.visits[self.lane.first_stop..].iter().any(|visit| self.allows(visit.place + over))
    }

    /// Back along the lane to where there is a way over; at its end the sweep is at its end.
    pub(super) fn retreat(&mut self, situation: &Situation<'_>, last_move: Move) -> Option<RobotCommand> {
        let here = situation.position;
        let lane_m = self.settings.lane_spacing_m;
        let over = Position::new(self.sweep * lane_m, 0.0, 0.0);
        if self.allows(here + over) && situation.clearance_m(over, lane_m) >= lane_m {
            self.task = Task::Shift { from: here };
            return None;
        }
        if last_move == Move::Blocked
            || self.lane.left_of_network_m(here.y_m, -self.lane.heading) < -self.settings.step_m
        {
            self.end_sweep(situation);
            return None;
        }
        Self::drive(here, 0.0, -self.lane.heading * self.settings.step_m)
    }
}
