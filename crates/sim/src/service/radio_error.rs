//! Why the radio of a station refuses what its program commands.

use std::time::Duration;

use sextant_channel::Dbm;
use sextant_kernel::StationId;
use sextant_mac::program::Refusal;

use super::report::FrameId;

/// Why the radio of a station refuses what its program commands. Nothing has changed then.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RadioError {
    /// The stations of the network do not command their radios.
    #[error("the network has a channel access of its own; only with `mac.program` do programs command the radios")]
    NotProgrammed,
    /// The station is not in the network.
    #[error("this station is not in the network")]
    NotThere,
    /// The radio cannot do that now.
    #[error(transparent)]
    Refused(#[from] Refusal),
    /// A frame is being received.
    #[error("a frame is being received; turn the receiver off to give it up")]
    ReceivingFrame,
    /// The radio may not tune to this channel.
    #[error("the channel is {0}; allowed: `radio.channel`, and those of `mac.program.channels`")]
    Channel(u8),
    /// The transmit power is out of range.
    #[error("the transmit power is {} dBm; allowed: -200 to {} dBm, that of the settings", found.0, most.0)]
    Power {
        /// What was asked for.
        found: Dbm,
        /// The greatest power.
        most: Dbm,
    },
    /// The threshold of carrier sense is out of range.
    #[error("the threshold is {} dBm; allowed: -200 to 100 dBm", .0.0)]
    Threshold(Dbm),
    /// A look at the channel has not this length.
    #[error("the time to assess the channel is {found:?}; allowed: {least:?} to {most:?}")]
    Span {
        /// What was asked for.
        found: Duration,
        /// One symbol.
        least: Duration,
        /// 128 symbols.
        most: Duration,
    },
    /// An acknowledgement would not be over by then.
    #[error("the wait for an acknowledgement is {found:?}; allowed: at least {least:?}")]
    AckWait {
        /// What was asked for.
        found: Duration,
        /// A turnaround and an acknowledgement.
        least: Duration,
    },
    /// The payload is too large.
    #[error("the payload has {found} octets; allowed: at most {allowed}")]
    Oversized {
        /// Its size (octets).
        found: usize,
        /// The largest size (octets).
        allowed: usize,
    },
    /// The frame goes to its own sender, or to a station that is not there.
    #[error("{0} cannot receive the frame")]
    NoSuchStation(StationId),
    /// Nobody acknowledges a frame to all.
    #[error("a frame to all asks for an acknowledgement; allowed: a frame to one station")]
    AcknowledgedByAll,
    /// The packet was never offered, or is done.
    #[error("there is no open packet number {}", .0.0)]
    NoSuchPacket(FrameId),
}
