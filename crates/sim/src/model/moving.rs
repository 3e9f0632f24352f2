//! Nodes that move: leg by leg.

use sextant_kernel::StationId;

use super::Model;
use crate::event::Event;
use crate::station::{Motion, Pose, Trip};
use crate::world::target::Leg;

impl Model {
    /// The nodes that move set out.
    pub(crate) fn begin_ways(&mut self) {
        for i in 0..self.courses.len() {
            self.turn_node(self.courses[i].0);
        }
    }

    /// A node that moves begins its next leg, or stands from now on.
    ///
    /// # Panics
    /// If the node does not move.
    pub(crate) fn turn_node(&mut self, station: StationId) {
        let place = self.courses.binary_search_by_key(&station, |(station, _)| *station);
        let (_, course) = &mut self.courses[place.expect("only nodes with a way turn")];
        let Some(leg) = course.next_leg() else {
            let place = course.place();
            self.move_as(station, Motion::standing(place));
            return;
        };
        self.move_as(station, motion_of(&leg));
        self.scene.at(leg.end, Event::NodeTurned(station));
    }
}

/// The motion along a leg.
fn motion_of(leg: &Leg) -> Motion {
    let &Leg { from, to, start, end } = leg;
    let length_m = from.distance_m(to);
    if length_m <= 0.0 {
        return Motion::standing(from);
    }
    let speed_m_per_s = length_m / (end - start).as_secs_f64();
    let from = Pose { position: from, heading_rad: 0.0 };
    Motion::Driving(Trip { end, ..Trip::straight(from, to, start, speed_m_per_s) })
}
