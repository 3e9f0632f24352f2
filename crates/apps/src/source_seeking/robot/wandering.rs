//! What a robot does that is stuck, or off the map.

use sextant_channel::Position;
use sextant_sim::{Driving, Port};

use super::super::gradient::turn_rate;
use super::super::progress::Progress;
use super::super::settings::WhenStuck;
use super::{Mode, Outlook, SeekRobot};

/// How far outside of the nodes a robot is off the map, as a multiple of their spacing.
const OFF_MAP_SPACINGS: f64 = 2.0;
/// Turn rate of a robot that wanders, for each radian between its heading and its course (1/s).
const WANDERING_GAIN_PER_S: f64 = 2.0;

impl SeekRobot {
    /// Whether it is stuck, or has left the map, where it only guesses how the field goes on.
    pub(super) fn should_wander(&mut self, outlook: &Outlook) -> bool {
        let seeks = matches!(self.mode, Mode::Seeking) && !self.has_arrived_often_enough();
        if !seeks || self.settings.when_stuck == WhenStuck::GoesOn {
            return false;
        }
        let value = outlook.field.smooth;
        let levels = [value, self.settings.goal.level_or(value)];
        let is_stuck = self.progress.is_stuck(levels, self.step_m(), self.reach_m());
        is_stuck || outlook.place.is_some_and(|place| self.is_off_map(place))
    }

    pub(super) fn is_off_map(&self, place: Position) -> bool {
        let (bounds, margin_m) = (self.map.bounds(), OFF_MAP_SPACINGS * self.map.spacing_m());
        let is_off = |at: f64, low: f64, high: f64| at < low - margin_m || at > high + margin_m;
        is_off(place.x_m, bounds.min.x_m, bounds.max.x_m)
            || is_off(place.y_m, bounds.min.y_m, bounds.max.y_m)
            || self.steering.is_spatial() && is_off(place.z_m, bounds.min.z_m, bounds.max.z_m)
    }

    /// A random place on the map, by odometry (m), at the height of the robot unless it moves in space.
    pub(super) fn random_place(&self, port: &Port<'_>) -> Option<Position> {
        let bounds = self.map.bounds();
        let draw = |axis: u64| port.uniform(3 * self.record.wandered + axis);
        let between = |low: f64, high: f64, axis| low + (high - low) * draw(axis);
        let place = Position::new(
            between(bounds.min.x_m, bounds.max.x_m, 0),
            between(bounds.min.y_m, bounds.max.y_m, 1),
            between(bounds.min.z_m, bounds.max.z_m, 2),
        );
        let place = self.place.to_odometry(place)?;
        let z_m = if self.steering.is_spatial() { place.z_m } else { port.pose().position.z_m };
        Some(Position { z_m, ..place })
    }

    /// Drives on to a random place, or seeks again if it is there, or has been under way for long enough to be.
    pub(super) fn wander(&mut self, goal: Position, way_m: f64, outlook: Outlook, port: &mut Port<'_>) {
        let step_m = self.step_m();
        let way = goal - outlook.pose.position;
        if way_m <= 0.0 || way.length_m() <= step_m {
            self.mode = Mode::Seeking;
            self.progress = Progress::default();
            self.steering.restart();
            self.steering.take_over(outlook.pose.heading_rad);
            self.seek(outlook, port);
            return;
        }
        self.mode = Mode::Wandering(goal, way_m - step_m);
        let driving = if self.steering.is_spatial() {
            port.drive(outlook.pose.position + way * (step_m / way.length_m()))
        } else {
            let course_rad = libm::atan2(way.y_m, way.x_m);
            let limit = self.settings.turn_rate_max_rad_per_s;
            let rate = turn_rate(outlook.pose.heading_rad, course_rad, WANDERING_GAIN_PER_S, limit);
            self.record.turned_rad += (rate * self.settings.control.as_secs_f64()).abs();
            port.steer(self.settings.control, rate)
        };
        if let Driving::Over(end) = driving {
            self.ended(end, port);
        }
    }
}
