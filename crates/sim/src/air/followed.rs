//! What a radio can say of the signals at its antenna while they are on air.

use sextant_channel::Milliwatts;
use sextant_kernel::{SimTime, StationId};

use super::receiver_id::ReceiverId;
use super::sense::Sense;
use super::{Air, Transmission};

impl Air {
    /// The radios that a transmission on air has reached so far, and their stations, by radio.
    pub(crate) fn reached_by(&self, transmission: &Transmission) -> &[(ReceiverId, StationId)] {
        self.reached.on_air(transmission.signal.packet)
    }

    /// Whether a radio is locked on to a transmission on air.
    pub(crate) fn follows(&mut self, now: SimTime, receiver: ReceiverId, transmission: &Transmission) -> bool {
        let rules = &self.rules[self.rules_of[receiver.index()] as usize];
        self.receivers[receiver.index()].follows(now, transmission.signal.packet, rules)
    }

    /// Until when a radio follows a signal that began before `end`: the end of the one that it is locked on to, or the end of
    /// a preamble; `None` if it follows none.
    pub(crate) fn followed_until(&mut self, now: SimTime, receiver: ReceiverId, end: SimTime) -> Option<SimTime> {
        let rules = *self.rules(receiver);
        let medium = &self.medium;
        let end_of = |packet| medium.span_of(packet).filter(|span| span.start < end).map(|span| span.end);
        self.receivers[receiver.index()].followed_until(now, &rules, end_of)
    }

    /// Mean power that a radio hears from others in a window.
    pub(crate) fn mean_power(&mut self, sense: &Sense) -> Milliwatts {
        self.medium.mean_power(sense)
    }
}
