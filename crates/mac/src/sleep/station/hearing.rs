//! What a station does with a frame that it has received.

use std::time::Duration;

use super::{Rest, Sleeper, State, Then};
use crate::energy::RadioState;
use crate::sleep::port::{Ended, Event, MeantFor, Radio, Sent};

impl Sleeper {
    /// Whether it takes a frame that ends now: its receiver is on for whatever comes.
    fn takes_frames(&self) -> bool {
        match self.state {
            State::Hearing | State::AwaitingData => true,
            State::Resting => self.rest == Rest::Listening,
            _ => false,
        }
    }

    /// It has received something that wakes a station, but for CSL.
    pub fn hear_strobe(&mut self, meant_for: MeantFor, radio: &mut impl Radio) {
        if !self.takes_frames() {
            return;
        }
        match meant_for {
            MeantFor::This => self.start(Sent::Acknowledgement, Then::AwaitData, radio),
            MeantFor::All => {
                let airtime = self.settings.strobe_airtime(Duration::ZERO);
                self.await_data(self.settings.whole(airtime) + self.settings.period(airtime), radio);
            }
            MeantFor::Another => self.go_to_rest(radio),
        }
    }

    /// It has received a wake-up frame of CSL: the frame itself follows after `rendezvous`.
    pub fn hear_wake_up(&mut self, meant_for: MeantFor, rendezvous: Duration, radio: &mut impl Radio) {
        if !self.takes_frames() {
            return;
        }
        let turnaround = self.turnaround();
        match meant_for {
            MeantFor::Another => self.go_to_rest(radio),
            _ if self.rest == Rest::Asleep && rendezvous > turnaround * 2 => {
                let drift = rendezvous.mul_f64(2.0 * self.settings.allowed_drift);
                self.state = State::AwaitingRendezvous(drift * 2);
                radio.enter(RadioState::Sleep);
                radio.after((rendezvous - turnaround).saturating_sub(drift), Event::SleepOver);
            }
            _ => self.await_data(rendezvous + self.data_wait(), radio),
        }
    }

    /// It has received the frame itself. Returns whether it acknowledges it.
    pub fn hear_data(&mut self, meant_for: MeantFor, radio: &mut impl Radio) -> bool {
        if !self.takes_frames() {
            return false;
        }
        match meant_for {
            MeantFor::This => {
                self.start(Sent::Acknowledgement, Then::Rest, radio);
                true
            }
            MeantFor::All | MeantFor::Another => {
                self.go_to_rest(radio);
                false
            }
        }
    }

    /// It has received the acknowledgement of its frame.
    pub fn hear_acknowledgement(&mut self, radio: &mut impl Radio) -> Option<Ended> {
        let State::AwaitingAcknowledgement(sent) = self.state else { return None };
        match sent {
            Sent::Strobe => {
                self.start(Sent::Data, Then::Rest, radio);
                None
            }
            _ => {
                self.go_to_rest(radio);
                self.end(Ended::Acknowledged)
            }
        }
    }
}
