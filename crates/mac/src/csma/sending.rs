//! A frame from the end of its channel access to its end, or to the end of its acknowledgement: the same for slotted
//! and unslotted access (IEEE 802.15.4-2006, 7.5.6.4).

use std::time::Duration;

use super::port::{Attempt, Event, Outcome, Radio};
use crate::{Phy, RadioState};

/// Progress of the frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sending {
    TurningToTransmit,
    Transmitting,
    TurningToReceive,
    AwaitingAck,
}

/// Result of an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SendingStep {
    /// The frame is still under way.
    On(Sending),
    /// It is over.
    Ended(Outcome),
    /// The acknowledgement did not come in time, or that of another frame came.
    Unanswered {
        /// For how long the station has been silent since the end of its frame, at least.
        waited: Duration,
    },
}

impl Sending {
    /// The channel is won: the radio starts its turnaround.
    pub(crate) fn begin(phy: Phy, radio: &mut impl Radio) -> Self {
        radio.enter(RadioState::Turnaround);
        radio.after(phy.turnaround(), Event::TransmitReady);
        Self::TurningToTransmit
    }

    /// Handles an event. An acknowledgement with another sequence number ends the wait as a missing one does (IEEE
    /// 802.15.4-2006, 7.5.6.4.3); one that comes while the machine does not wait changes nothing.
    ///
    /// # Panics
    /// If the event is impossible in the current state: the machine did not ask for it.
    pub(crate) fn handle(self, attempt: &mut Attempt, event: Event, phy: Phy, radio: &mut impl Radio) -> SendingStep {
        match (self, event) {
            (Self::TurningToTransmit, Event::TransmitReady) => {
                radio.enter(RadioState::Transmit);
                radio.start_transmission(attempt.frame);
                attempt.transmissions += 1;
                SendingStep::On(Self::Transmitting)
            }
            (Self::Transmitting, Event::TransmissionEnded) if attempt.frame.ack_request => {
                radio.enter(RadioState::Turnaround);
                radio.after(phy.turnaround(), Event::ReceiveReady);
                SendingStep::On(Self::TurningToReceive)
            }
            (Self::Transmitting, Event::TransmissionEnded) => SendingStep::Ended(Outcome::Sent),
            (Self::TurningToReceive, Event::ReceiveReady) => {
                radio.enter(RadioState::Receive);
                radio.after(phy.ack_wait() - phy.turnaround(), Event::AckWaitExpired);
                SendingStep::On(Self::AwaitingAck)
            }
            (Self::AwaitingAck, Event::AckReceived { sequence }) if sequence == attempt.frame.sequence => {
                radio.cancel_timer();
                SendingStep::Ended(Outcome::Acknowledged)
            }
            (Self::AwaitingAck, Event::AckReceived { .. }) => {
                radio.cancel_timer();
                // The receiver heard all of it, from its first symbol on.
                SendingStep::Unanswered { waited: phy.turnaround() + phy.ack_airtime() }
            }
            (Self::AwaitingAck, Event::AckWaitExpired) => SendingStep::Unanswered { waited: phy.ack_wait() },
            (sending, Event::AckReceived { .. }) => SendingStep::On(sending),
            (sending, event) => panic!("{event:?} cannot happen in {sending:?}"),
        }
    }
}
