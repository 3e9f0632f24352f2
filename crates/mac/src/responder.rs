//! The receive side of a station's MAC: which frames are accepted, and their acknowledgements
//! (IEEE 802.15.4-2006, 7.5.6.2 and 7.5.6.4).
//!
//! A frame that requests it is acknowledged one turnaround after its end, without CSMA-CA. That gap
//! (12 symbols) is longer than a CCA (8 symbols), so a third station can find the channel idle in
//! the gap and collide with the acknowledgement: a real effect of the standard.

use std::time::Duration;

use crate::frame::{Address, BROADCAST_PAN, Frame, FrameBody};
use crate::{Class, Phy, RadioState};

/// An event of the responder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The turnaround to transmitting is over: the first bit of the acknowledgement goes out now.
    TransmitReady,
    /// The last bit of the acknowledgement is out.
    TransmissionEnded,
}

impl Event {
    /// Class of the event among those of the same instant.
    #[must_use]
    pub const fn class(self) -> Class {
        match self {
            Self::TransmitReady => Class::StartOfSignal,
            Self::TransmissionEnded => Class::EndOfSignal,
        }
    }
}

/// The interface of the machine to its timer and its radio.
pub trait Radio {
    /// Sets the timer: `event` is due `span` from now.
    fn after(&mut self, span: Duration, event: Event);

    /// The radio changes its state now.
    fn enter(&mut self, state: RadioState);

    /// Puts the first bit of an acknowledgement on the air; [`Event::TransmissionEnded`] is due
    /// [`Phy::ack_airtime`] from now.
    fn start_acknowledgement(&mut self, sequence: u8);
}

/// The decision about a received frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It is for this station.
    Deliver,
    /// It is for another station.
    NotForUs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Listening,
    TurningToTransmit { sequence: u8 },
    Transmitting,
}

/// The state machine.
#[derive(Clone, Debug)]
pub struct Responder {
    phy: Phy,
    pan: u16,
    address: Address,
    state: State,
}

impl Responder {
    /// A station with this address that listens.
    #[must_use]
    pub const fn new(phy: Phy, pan: u16, address: Address) -> Self {
        Self { phy, pan, address, state: State::Listening }
    }

    /// Whether an acknowledgement is under way: the radio is deaf, and a CCA of this station reads busy.
    #[must_use]
    pub const fn is_responding(&self) -> bool {
        !matches!(self.state, State::Listening)
    }

    /// Decides about a frame whose last bit arrives now with a correct FCS. If it is for this station and requests an
    /// acknowledgement, the acknowledgement starts one turnaround from now. Copies of a frame are acknowledged like the first one;
    /// that they are copies is known to whoever keeps the packets, for sequence numbers go round.
    ///
    /// # Panics
    /// If an acknowledgement is under way: a deaf radio receives nothing.
    pub fn receive(&mut self, frame: &Frame<'_>, radio: &mut impl Radio) -> Verdict {
        self.receive_and_respond(frame, self.phy.turnaround(), radio)
    }

    /// The same with an acknowledgement that starts `gap` from now: one turnaround or more, because acknowledgements
    /// in a contention access period start on backoff boundaries.
    ///
    /// # Panics
    /// If an acknowledgement is under way.
    pub fn receive_and_respond(&mut self, frame: &Frame<'_>, gap: Duration, radio: &mut impl Radio) -> Verdict {
        assert!(!self.is_responding(), "a deaf radio receives nothing");
        if matches!(frame.body, FrameBody::Acknowledgement) || !self.is_addressed(frame) {
            return Verdict::NotForUs;
        }
        // A broadcast must not request an acknowledgement; if it does, it gets none.
        let is_broadcast = frame.destination.is_none_or(|to| to.address == Address::BROADCAST);
        if !frame.ack_request || is_broadcast {
            return Verdict::Deliver;
        }
        self.state = State::TurningToTransmit { sequence: frame.sequence };
        radio.enter(RadioState::Turnaround);
        radio.after(gap, Event::TransmitReady);
        Verdict::Deliver
    }

    /// Handles an event.
    ///
    /// # Panics
    /// If the event is impossible in the current state: the machine did not ask for it.
    pub fn handle(&mut self, event: Event, radio: &mut impl Radio) {
        self.state = match (self.state, event) {
            (State::TurningToTransmit { sequence }, Event::TransmitReady) => {
                radio.enter(RadioState::Transmit);
                radio.start_acknowledgement(sequence);
                State::Transmitting
            }
            (State::Transmitting, Event::TransmissionEnded) => {
                radio.enter(RadioState::Receive);
                State::Listening
            }
            (state, event) => panic!("{event:?} cannot happen in {state:?}"),
        };
    }

    /// The filter of 7.5.6.2; a beacon has no destination and is for all stations of the PAN.
    fn is_addressed(&self, frame: &Frame<'_>) -> bool {
        match (frame.destination, frame.source) {
            (Some(to), _) => {
                (to.pan == self.pan || to.pan == BROADCAST_PAN)
                    && (to.address == self.address || to.address == Address::BROADCAST)
            }
            (None, Some(from)) => matches!(frame.body, FrameBody::Beacon(_)) && from.pan == self.pan,
            (None, None) => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Endpoint;
    use sextant_kernel::StationId;

    const PAN: u16 = 0x1234;
    const ROBOT: Address = Address::Short(1);

    /// The last commands: timer, state of the radio, acknowledgement.
    #[derive(Debug, Default, PartialEq)]
    struct Script {
        timers: Vec<(Duration, Event)>,
        states: Vec<RadioState>,
        acks: Vec<u8>,
    }

    impl Radio for Script {
        fn after(&mut self, span: Duration, event: Event) {
            self.timers.push((span, event));
        }

        fn enter(&mut self, state: RadioState) {
            self.states.push(state);
        }

        fn start_acknowledgement(&mut self, sequence: u8) {
            self.acks.push(sequence);
        }
    }

    fn robot() -> Responder {
        Responder::new(Phy::Oqpsk2450, PAN, ROBOT)
    }

    fn endpoint(address: Address) -> Endpoint {
        Endpoint { pan: PAN, address }
    }

    /// A frame from `node` to the robot that requests an acknowledgement.
    fn request(node: u32, sequence: u8) -> Frame<'static> {
        let source = endpoint(Address::of(StationId(node)));
        Frame { ack_request: true, ..Frame::data(sequence, source, endpoint(ROBOT), b"?") }
    }

    /// Verdict on a frame, and the acknowledgement that was sent, if any.
    fn respond(responder: &mut Responder, frame: &Frame<'_>) -> (Verdict, Option<u8>) {
        let mut radio = Script::default();
        let verdict = responder.receive(frame, &mut radio);
        if responder.is_responding() {
            responder.handle(Event::TransmitReady, &mut radio);
            responder.handle(Event::TransmissionEnded, &mut radio);
        }
        (verdict, radio.acks.first().copied())
    }

    #[test]
    fn an_acknowledgement_starts_192_us_after_the_frame_without_carrier_sense() {
        let mut radio = Script::default();
        let mut responder = robot();
        assert_eq!(responder.receive(&request(7, 5), &mut radio), Verdict::Deliver);
        assert_eq!(radio.timers, [(Duration::from_micros(192), Event::TransmitReady)]);
        assert!(responder.is_responding() && radio.acks.is_empty());
        responder.handle(Event::TransmitReady, &mut radio);
        assert_eq!(radio.acks, [5]);
        assert!(responder.is_responding());
        responder.handle(Event::TransmissionEnded, &mut radio);
        assert!(!responder.is_responding());
        assert_eq!(radio.states, [RadioState::Turnaround, RadioState::Transmit, RadioState::Receive]);
        assert_eq!(radio.timers.len(), 1);
    }

    #[test]
    fn broadcasts_are_delivered_without_acknowledgement_for_every_sequence_number() {
        let mut responder = robot();
        let source = endpoint(Address::of(StationId(7)));
        let frame = Frame::data(5, source, endpoint(Address::BROADCAST), b"!");
        assert_eq!(respond(&mut responder, &frame), (Verdict::Deliver, None));
        assert_eq!(respond(&mut responder, &frame), (Verdict::Deliver, None));
        let frame = Frame { ack_request: true, ..frame };
        assert_eq!(respond(&mut responder, &frame), (Verdict::Deliver, None));
    }

    #[test]
    fn a_frame_without_acknowledgement_request_gets_none() {
        let frame = Frame { ack_request: false, ..request(7, 5) };
        assert_eq!(respond(&mut robot(), &frame), (Verdict::Deliver, None));
    }

    #[test]
    fn frames_for_others_are_neither_delivered_nor_acknowledged() {
        let mut responder = robot();
        let for_node = Frame { destination: Some(endpoint(Address::Short(2))), ..request(7, 5) };
        let other_pan = Frame { destination: Some(Endpoint { pan: 9, address: ROBOT }), ..request(7, 5) };
        let without_destination = Frame { destination: None, ..request(7, 5) };
        for frame in [for_node, other_pan, without_destination, Frame::acknowledgement(5)] {
            assert_eq!(respond(&mut responder, &frame), (Verdict::NotForUs, None), "{frame:?}");
        }
        let any_pan = Frame { destination: Some(Endpoint { pan: BROADCAST_PAN, address: ROBOT }), ..request(7, 5) };
        assert_eq!(respond(&mut responder, &any_pan), (Verdict::Deliver, Some(5)));
    }
}
