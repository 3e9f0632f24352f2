//! What a robot does that has an obstacle in its way.

use std::time::Duration;

use sextant_channel::Position;
use sextant_sim::{Driving, Port};

use super::super::boundary::Boundary;
use super::super::gradient::wrapped;
use super::{CONTROL, Mode, Outlook, SeekRobot};

/// A robot that meets an obstacle so soon after it has left one goes on round it.
const SOON: Duration = Duration::from_secs(2);

impl SeekRobot {
    /// An obstacle is in the way.
    pub(super) fn meet(&mut self, port: &Port<'_>) {
        let place = self.place_on_map(port.pose().position);
        let value = self.field_at(place, port.now()).map_or(f64::NEG_INFINITY, |field| field.smooth);
        let heading_rad = port.pose().heading_rad;
        let boundary = match (self.mode, self.left.take()) {
            (Mode::Avoiding(boundary) | Mode::Turning(boundary, _), _) => boundary,
            (_, Some((mut boundary, left))) if port.now().saturating_since(left) < SOON => {
                boundary.met_again(value);
                boundary
            }
            _ => Boundary::meet(heading_rad, value, self.step_m(), clearance(port, self.step_m())),
        };
        self.mode = Mode::Avoiding(boundary);
    }

    /// Goes on round an obstacle, or leaves it.
    pub(super) fn go_round(&mut self, mut boundary: Boundary, outlook: Outlook, port: &mut Port<'_>) {
        let step_m = self.step_m();
        let heading_rad = outlook.pose.heading_rad;
        let course_rad = self.course_rad(&outlook).unwrap_or(heading_rad);
        let value = outlook.field.smooth;
        let levels = [value, self.settings.goal.level_or(value)];
        if boundary.may_leave(course_rad, levels, step_m, clearance(port, f64::INFINITY)) {
            self.left = Some((boundary, port.now()));
            self.mode = Mode::Seeking;
            self.steering.take_over(heading_rad);
            self.seek(outlook, port);
            return;
        }
        let Some(direction) = boundary.direction(heading_rad, step_m, clearance(port, step_m)) else {
            self.mode = Mode::Avoiding(boundary);
            port.after(self.settings.control, CONTROL);
            return;
        };
        let turn_rad = wrapped(direction - heading_rad).abs();
        self.record.turned_rad += turn_rad;
        let turn_s = turn_rad / self.settings.turn_rate_max_rad_per_s;
        if turn_s > self.settings.control.as_secs_f64() {
            // It turns on the spot, which takes time.
            self.mode = Mode::Turning(boundary, direction);
            port.after(Duration::from_secs_f64(turn_s), CONTROL);
        } else {
            self.mode = Mode::Avoiding(boundary);
            self.step(direction, outlook, port);
        }
    }

    /// Drives a step into a direction.
    pub(super) fn step(&mut self, direction_rad: f64, outlook: Outlook, port: &mut Port<'_>) {
        let towards = Position::new(libm::cos(direction_rad), libm::sin(direction_rad), 0.0);
        if let Driving::Over(end) = port.drive(outlook.pose.position + towards * self.step_m()) {
            self.ended(end, port);
        }
    }
}

/// How far the robot can drive into a direction by its odometry (rad), up to `range_m`.
fn clearance(port: &Port<'_>, range_m: f64) -> impl Fn(f64) -> f64 {
    move |direction_rad| {
        let direction = Position::new(libm::cos(direction_rad), libm::sin(direction_rad), 0.0);
        port.clearance_m(direction, range_m)
    }
}
