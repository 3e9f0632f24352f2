//! What a station that sleeps is told, waits for and says.

use std::time::Duration;

use crate::class::Class;
use crate::energy::RadioState;

/// What a station waits for: at most one at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// Its receiver has come on.
    ReceiverOn,
    /// A look at the channel ends.
    LookOver,
    /// It wakes up for the next look, or for a rendezvous.
    SleepOver,
    /// The first symbol of its frame goes out.
    FrameStarts,
    /// Its frame is out.
    FrameEnded,
    /// It has waited long enough.
    WaitOver,
}

impl Event {
    /// Class of the event among those of the same instant.
    #[must_use]
    pub const fn class(self) -> Class {
        match self {
            Self::ReceiverOn | Self::FrameEnded => Class::EndOfSignal,
            Self::LookOver => Class::EndOfCca,
            Self::FrameStarts => Class::StartOfSignal,
            Self::SleepOver | Self::WaitOver => Class::Timer,
        }
    }
}

/// What a station sends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sent {
    /// A short frame that wakes its receiver.
    Strobe,
    /// A wake-up frame of CSL.
    WakeUp {
        /// From its end to the start of the frame that it announces.
        rendezvous: Duration,
    },
    /// The frame itself.
    Data,
    /// An acknowledgement.
    Acknowledgement,
}

/// For whom a frame is that a station has received.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeantFor {
    /// For this station.
    This,
    /// For all.
    All,
    /// For another station.
    Another,
}

/// The radio and the timer of a station.
pub trait Radio {
    /// Sets the timer; one that is pending is replaced.
    fn after(&mut self, span: Duration, event: Event);

    /// Cancels the timer.
    fn stop(&mut self);

    /// The radio changes its state.
    fn enter(&mut self, state: RadioState);

    /// Whether the channel was busy in the look that ends now.
    fn is_busy(&mut self) -> bool;

    /// How long the frame or the preamble lasts that the receiver is locked on to; `None` if it is locked on to none.
    fn followed_for(&mut self) -> Option<Duration>;

    /// Something goes on air; returns how long it is there.
    fn begin(&mut self, sent: Sent) -> Duration;
}

/// A frame that a station is to send.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Job {
    /// To whom.
    pub to: Recipient,
    /// Time on air of the frame itself.
    pub airtime: Duration,
    /// From the start of the first frame that wakes the receiver to the start of the last one, at most.
    pub span: Duration,
}

/// To whom a frame goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Recipient {
    /// To one station, which acknowledges it.
    One,
    /// To all.
    All,
}

/// How an attempt to send ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// It was acknowledged.
    Acknowledged,
    /// Nobody acknowledged it.
    Unacknowledged,
    /// It was sent to all.
    Sent,
    /// The channel was busy: nothing was sent.
    Busy,
}
