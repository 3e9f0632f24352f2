//! The links of stations that die.

use sextant_kernel::StationId;
use sextant_mac::RadioState;

use super::Links;
use crate::event::ieee80211ad::Event;
use crate::link::ieee80211ad::stack::Role;
use crate::scene::Scene;

impl Links {
    /// A station dies: its radio is off from now on, or from the end of the frame on air.
    pub(super) fn turn_off(&mut self, station: StationId, scene: &mut Scene) {
        let radio = &mut self.stacks[station.index()].radio;
        if radio.on_air.is_some() {
            return;
        }
        radio.state = RadioState::Sleep;
        self.transceiver(station, Role::Responder, scene).0.tune();
    }

    /// Whether an event is the end of the frame that a station has on air.
    pub(super) fn is_end_of_frame(&self, station: StationId, event: Event) -> bool {
        matches!(event, Event::InitiatorTransmitted | Event::ResponderTransmitted)
            && self.stacks[station.index()].radio.on_air.is_some()
    }
}
