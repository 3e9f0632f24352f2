//! What lies behind an obstacle (`obstacleRegistry` and `coverObstacles` of the thesis).

use sextant_channel::Position;
use sextant_sim::{RobotCommand, Situation};

use super::lane::Cut;
use super::survey::{AutomatedS, COVERED, Move};

impl AutomatedS {
    /// The lane behind an obstacle, if this lane has just passed the obstacle and can see that lane
    /// (`coverObstacles` of the thesis).
    pub(super) fn uncovered_behind(&self, situation: &Situation<'_>) -> Option<f64> {
        let here = situation.position;
        let lane_m = self.settings.lane_spacing_m;
        let is_behind = |cut: &&Cut| {
            let back_m = self.sweep * (here.x_m - cut.place.x_m);
            let beyond_m = self.lane.heading * (here.y_m - cut.place.y_m);
            cut.heading * self.lane.heading > 0.0
                && beyond_m > 0.0
                && back_m >= self.settings.step_m
                && back_m <= 4.0 * lane_m
                && !self.knowledge.was_near(
                    Position { y_m: here.y_m, ..cut.place },
                    COVERED * lane_m,
                    self.sweep_began..self.knowledge.stops(),
                )
                && situation.clearance_m(Position::new(-self.sweep, 0.0, 0.0), back_m) >= back_m
        };
        Some(self.cuts.iter().find(is_behind)?.place.x_m)
    }

    pub(super) fn go_behind(
        &mut self,
        here: Position,
        x_m: f64,
        from: Position,
        last_move: Move,
    ) -> Option<RobotCommand> {
        let left_m = (here.x_m - x_m).abs();
        let is_there = left_m <= 0.01 * self.settings.step_m;
        let place = here + Position::new(-self.sweep * self.stride(left_m), 0.0, 0.0);
        if is_there || last_move == Move::Blocked || !self.allows(place) {
            if is_there || here.distance_m(from) < self.settings.step_m {
                self.cuts.retain(|cut| (cut.place.x_m - x_m).abs() > 1e-6 || cut.heading * self.lane.heading < 0.0);
            }
            self.begin_lane(here);
            return None;
        }
        Some(RobotCommand::Drive(place))
    }
}
