//! What a radio that a program commands is told, waits for and says.

use std::time::Duration;

use sextant_kernel::SimTime;

use crate::class::Class;

/// Where a radio is as long as nothing else calls it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rest {
    /// Off.
    Off,
    /// Oscillator on.
    Idle,
    /// Receiver on.
    Receive,
}

/// What a radio waits for: at most one of each kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Event {
    /// It has turned around, or is awake.
    Ready,
    /// It must turn around for a window.
    WindowDue,
    /// A window ends.
    WindowOver,
    /// An assessment of the channel ends.
    AssessmentEnded,
    /// It must turn around for a frame.
    TurnDue,
    /// The first symbol of a frame goes out.
    FrameDue,
    /// A frame is out.
    FrameEnded,
    /// The first symbol of an acknowledgement goes out.
    AcknowledgementDue,
    /// An acknowledgement is out.
    AcknowledgementEnded,
    /// No acknowledgement came.
    WaitOver,
}

impl Event {
    /// Number of kinds of events.
    pub const COUNT: usize = Self::WaitOver as usize + 1;

    /// Class of the event among those of the same instant.
    #[must_use]
    pub const fn class(self) -> Class {
        match self {
            Self::Ready | Self::FrameEnded | Self::AcknowledgementEnded => Class::EndOfSignal,
            Self::AssessmentEnded => Class::EndOfCca,
            Self::FrameDue | Self::AcknowledgementDue => Class::StartOfSignal,
            Self::WindowDue | Self::WindowOver | Self::TurnDue | Self::WaitOver => Class::Timer,
        }
    }
}

/// The timers of a radio.
pub trait Timers {
    /// Sets the timer of an event; one that is pending is replaced.
    fn set(&mut self, event: Event, at: SimTime);

    /// Cancels the timer of an event, if it is pending.
    fn cancel(&mut self, event: Event);
}

/// Whether the receiver was on from the start of an assessment to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Whole {
    /// It was.
    Unbroken,
    /// The radio sent something itself.
    Broken,
}

/// What has happened at a radio.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum News {
    /// It is where it rests, or its receiver is on for a window.
    Ready,
    /// A window is over.
    WindowOver,
    /// An assessment of the channel is over.
    Assessed(Whole),
    /// The frame goes on air now.
    FrameBegins,
    /// The frame is out.
    Sent,
    /// The acknowledgement goes on air now.
    AcknowledgementBegins,
    /// The acknowledgement is out.
    AcknowledgementSent,
    /// No acknowledgement came.
    Unacknowledged,
}

/// No radio is told to do something after this instant: 31 years.
pub(super) const LATEST: SimTime = SimTime::from_secs(1_000_000_000);

/// Why a command is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    /// The radio cannot be ready by then.
    #[error("the instant is {asked}; allowed: {earliest} or later, because the radio needs that time to turn around")]
    TooEarly {
        /// The instant that was asked for.
        asked: SimTime,
        /// The first instant that is possible.
        earliest: SimTime,
    },
    /// No simulation goes on for so long.
    #[error("the instant is {0}; allowed: within {LATEST}")]
    TooLate(SimTime),
    /// It has something to send.
    #[error("the radio has a frame to send, or waits for its acknowledgement, until {until}")]
    Sending {
        /// When it will be free.
        until: SimTime,
    },
    /// It looks at the channel.
    #[error("the radio assesses the channel until {until}")]
    Assessing {
        /// When it will be free.
        until: SimTime,
    },
    /// Its receiver is off, or will be before the end.
    #[error("the receiver is not on during all of that time")]
    NotReceiving,
    /// A window has no length.
    #[error("the window ends at {until}; allowed: after its start at {from}")]
    EmptyWindow {
        /// Its start.
        from: SimTime,
        /// Its end.
        until: SimTime,
    },
}

/// A frame that a radio is to send.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sending {
    /// When its first symbol goes out; as soon as possible if absent.
    pub at: Option<SimTime>,
    /// How long it is on air.
    pub airtime: Duration,
    /// The sequence number of the acknowledgement that the radio waits for afterwards, if it does.
    pub awaited: Option<u8>,
}
