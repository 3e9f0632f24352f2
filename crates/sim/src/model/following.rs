//! Halos that follow their listeners.

use std::time::Duration;

use sextant_kernel::StationId;

use super::Model;
use crate::event::Event;
use crate::station::Motion;

impl Model {
    /// A station moves differently from now on: its halo follows it, if it has one.
    pub(super) fn follow(&mut self, station: StationId) {
        let Some(halo) = self.halo.as_mut().filter(|halo| halo.is_listener(station)) else { return };
        let now = self.scene.now;
        let motion = self.scene.motions[station.index()];
        let place = motion.at(now);
        let mut slack_m = halo.slack_m(station, place);
        if slack_m <= 0.0 {
            halo.draw(station, place);
            slack_m = halo.step_m();
        }
        if !self.scene.roll.is_robot(station) {
            return;
        }
        let robot = self.robot(station);
        let vehicle = &mut self.vehicles[robot.index()];
        if let Some(due) = vehicle.halo_due.take() {
            self.scene.queue.cancel(due);
        }
        if let Motion::Driving(trip) = motion {
            let left_m = trip.speed_m_per_s * (trip.end - now).as_secs_f64();
            if left_m > slack_m {
                let span = Duration::from_secs_f64(slack_m / trip.speed_m_per_s);
                vehicle.halo_due = Some(self.scene.after(span, Event::HaloDue(station)));
            }
        }
    }

    /// The halo of a robot is due: it is drawn round the place where the robot is now.
    pub(crate) fn draw_halo(&mut self, station: StationId) {
        let robot = self.robot(station);
        self.vehicles[robot.index()].halo_due = None;
        let place = self.scene.place(station);
        if let Some(halo) = &mut self.halo {
            halo.draw(station, place);
        }
        self.follow(station);
    }

    /// The halos of all listeners at the start.
    pub(crate) fn draw_halos(&mut self) {
        self.scene.roll.stations().for_each(|station| self.follow(station));
        // Applications have not begun, so none has to be woken.
        if let Some(halo) = &mut self.halo {
            let reached = halo.take_reached();
            halo.give_back(reached);
        }
    }
}
