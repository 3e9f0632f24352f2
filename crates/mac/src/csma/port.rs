//! The interface of a channel access machine: frames, events, its radio, reports.

use std::time::Duration;

use crate::{Class, RadioState};

/// A frame to send: the properties that channel access needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutgoingFrame {
    /// Size of the MPDU (octets), FCS included: 5 to 127.
    pub mpdu_octets: u8,
    /// Whether the frame requests an acknowledgement. A broadcast must not.
    pub ack_request: bool,
    /// Sequence number of the frame: its acknowledgement carries the same.
    pub sequence: u8,
}

/// An event of channel access.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The backoff is over: the CCA starts now.
    BackoffExpired,
    /// The turnaround from idle to receiving is over: the CCA starts now.
    SenseReady,
    /// The CCA that [`Radio::start_cca`] started is over.
    CcaEnded {
        /// Whether the channel was busy.
        busy: bool,
    },
    /// The turnaround to transmitting is over: the first bit goes out now.
    TransmitReady,
    /// The last bit of the frame of this station is out.
    TransmissionEnded,
    /// The turnaround to receiving is over: from now on an acknowledgement can be heard.
    ReceiveReady,
    /// The last bit of an acknowledgement was received, for this station or for another one.
    AckReceived {
        /// Its sequence number.
        sequence: u8,
    },
    /// No acknowledgement came in time.
    AckWaitExpired,
    /// The interframe spacing after a frame is over.
    InterframeSpaceEnded,
}

impl Event {
    /// Class of the event among those of the same instant.
    #[must_use]
    #[inline]
    pub const fn class(self) -> Class {
        match self {
            Self::TransmissionEnded | Self::AckReceived { .. } | Self::ReceiveReady => Class::EndOfSignal,
            Self::CcaEnded { .. } => Class::EndOfCca,
            Self::TransmitReady => Class::StartOfSignal,
            Self::BackoffExpired | Self::SenseReady => Class::StartOfCca,
            Self::AckWaitExpired | Self::InterframeSpaceEnded => Class::Timer,
        }
    }
}

/// The interface of the machine to its timer and its radio.
pub trait Radio {
    /// Number of backoff periods to wait, drawn uniformly from `0..=max_inclusive`.
    fn backoff_periods(&mut self, max_inclusive: u32) -> u32;

    /// Sets the timer: `event` is due `span` from now, ordered by [`Event::class`] among events of the same instant.
    /// `span` may be zero. Never called while the timer is pending.
    fn after(&mut self, span: Duration, event: Event);

    /// Cancels the pending timer.
    fn cancel_timer(&mut self);

    /// The radio changes its state now; called whenever the state changes, and before
    /// [`Radio::start_cca`] and [`Radio::start_transmission`]. In [`RadioState::Turnaround`] and
    /// [`RadioState::Transmit`] it is deaf.
    fn enter(&mut self, state: RadioState);

    /// Starts to sense the channel with a receiver that was told to be on now: if the radio was idle before, it turned
    /// around in the last part of that time. [`Event::CcaEnded`] is due [`Phy::cca`](crate::Phy::cca) from now. A station
    /// that sends an acknowledgement, or is about to, reads busy.
    fn start_cca(&mut self);

    /// Puts the first bit on the air; [`Event::TransmissionEnded`] is due [`Phy::airtime`](crate::Phy::airtime) from
    /// now.
    fn start_transmission(&mut self, frame: OutgoingFrame);
}

/// How a frame ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It was sent and requested no acknowledgement.
    Sent,
    /// It was sent and acknowledged.
    Acknowledged,
    /// It was sent as often as allowed and was never acknowledged.
    NoAck,
    /// The channel was busy too often; with acknowledgements, possibly after earlier transmissions.
    ChannelAccessFailure,
}

/// The end of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Report {
    /// The frame.
    pub frame: OutgoingFrame,
    /// How it ended.
    pub outcome: Outcome,
    /// Number of clear channel assessments.
    pub ccas: u32,
    /// Number of transmissions.
    pub transmissions: u32,
}

/// A frame under way, whether slotted or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Attempt {
    pub(crate) frame: OutgoingFrame,
    /// Busy CCAs of this channel access: NB of the standard.
    pub(crate) busy: u8,
    /// Backoff exponent: BE of the standard.
    pub(crate) exponent: u8,
    pub(crate) ccas: u32,
    pub(crate) transmissions: u32,
}

impl Attempt {
    pub(crate) const fn new(frame: OutgoingFrame) -> Self {
        Self { frame, busy: 0, exponent: 0, ccas: 0, transmissions: 0 }
    }

    pub(crate) const fn with_cca(self) -> Self {
        Self { ccas: self.ccas + 1, ..self }
    }

    pub(crate) const fn report(self, outcome: Outcome) -> Report {
        Report { frame: self.frame, outcome, ccas: self.ccas, transmissions: self.transmissions }
    }
}
