//! Nodes that move: leg by leg.

use sextant_kernel::StationId;

use super::Model;
use crate::event::Event;
use crate::station::Motion;

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
        self.move_as(station, leg.motion());
        self.scene.at(leg.end, Event::NodeTurned(station));
    }
}
