//! How a robot drives to a goal, place by place, round what is in its way.

use std::collections::VecDeque;

use sextant_channel::{Bounds, Position};
use sextant_sim::{DriveEnd, Driving, Port};

use super::config::{PathRule, SearchMotion};
use super::wayfinder::Wayfinder;

/// Ways that it tries one after the other where it stands.
const MOST_ATTEMPTS: u32 = 8;

/// Drives a robot, all by odometry.
#[derive(Clone, Debug)]
pub(super) struct Driver {
    rule: PathRule,
    motion: SearchMotion,
    hull_m: f64,
    step_m: f64,
    wayfinder: Option<Wayfinder>,
    goal: Option<Position>,
    /// The rest of the way (m).
    way: VecDeque<Position>,
    /// Where it will be at the end of the drive that is under way (m).
    bound_for: Option<Position>,
    blocked: u64,
}

impl Driver {
    /// For a robot whose hull has the radius `hull_m` and that drives `step_m` between two decisions.
    pub(super) fn new(rule: PathRule, motion: SearchMotion, hull_m: f64, step_m: f64) -> Self {
        Self {
            rule,
            motion,
            hull_m,
            step_m,
            wayfinder: None,
            goal: None,
            way: VecDeque::new(),
            bound_for: None,
            blocked: 0,
        }
    }

    /// Length of its way between two decisions (m).
    pub(super) fn step_m(&self) -> f64 {
        self.step_m
    }

    /// Where it will be at the end of the drive that is under way (m), if one is.
    pub(super) fn bound_for(&self) -> Option<Position> {
        self.bound_for
    }

    /// Times that an obstacle was in its way.
    pub(super) fn blocked(&self) -> u64 {
        self.blocked
    }

    /// Stands until it is told to drive.
    pub(super) fn stand(&mut self, port: &mut Port<'_>) {
        port.halt();
        self.goal = None;
        self.way.clear();
    }

    /// Drives straight to a place.
    pub(super) fn go_straight(&mut self, to: Position, port: &mut Port<'_>) {
        port.halt();
        self.goal = None;
        self.way = VecDeque::from([to]);
        self.drive_on(port);
    }

    /// Drives to `goal` among nodes within `nodes`, on the best way that it knows.
    pub(super) fn set_out(&mut self, goal: Position, nodes: Bounds, port: &mut Port<'_>) {
        port.halt();
        let wayfinder =
            self.wayfinder.get_or_insert_with(|| Wayfinder::new(self.rule, self.motion, self.hull_m, nodes));
        wayfinder.look_around(port);
        self.goal = Some(goal);
        self.way = wayfinder.way(port.pose().position, goal, self.step_m).into();
        self.drive_on(port);
    }

    /// A drive has ended.
    pub(super) fn ended(&mut self, end: DriveEnd, port: &mut Port<'_>) {
        if let DriveEnd::Blocked(contact) = end {
            self.turn_away(contact, port);
        }
        self.drive_on(port);
    }

    fn drive_on(&mut self, port: &mut Port<'_>) {
        let mut attempts = 0;
        self.bound_for = None;
        while let Some(next) = self.way.pop_front() {
            match port.drive(next) {
                Driving::UnderWay => {
                    self.bound_for = Some(next);
                    return;
                }
                Driving::Over(DriveEnd::Arrived) => {}
                Driving::Over(DriveEnd::Blocked(contact)) => {
                    attempts += 1;
                    if attempts > MOST_ATTEMPTS {
                        return self.way.clear();
                    }
                    self.turn_away(contact, port);
                }
            }
        }
    }

    /// An obstacle is in the way: a way round it is looked for, at once or in the next step.
    fn turn_away(&mut self, contact: Position, port: &Port<'_>) {
        self.blocked += 1;
        self.way.clear();
        if let (Some(wayfinder), Some(goal)) = (&mut self.wayfinder, self.goal) {
            wayfinder.meet(contact);
            if self.motion == SearchMotion::Discrete {
                return;
            }
            wayfinder.look_around(port);
            self.way = wayfinder.way(port.pose().position, goal, self.step_m).into();
        }
    }
}
