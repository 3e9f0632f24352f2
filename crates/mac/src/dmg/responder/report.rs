//! What a responder tells its station: a sweep that it heard, and what became of the answer.

use sextant_channel::Db;
use sextant_kernel::SimTime;

use crate::dmg::address::MacAddress;
use crate::dmg::frame::SectorFeedback;
use crate::dmg::sector::TxSector;

/// A sweep that a responder heard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeardSweep {
    /// The station that swept.
    pub initiator: MacAddress,
    /// Its sector that was heard best; of equals, the first.
    pub sector: TxSector,
    /// SNR of that frame.
    pub snr: Db,
    /// Number of frames decoded.
    pub frames: u16,
    /// Number of frames of the whole sweep.
    pub total_sectors: u16,
    /// End of the sweep.
    pub end: SimTime,
    /// Whether it was for this station alone.
    pub is_unicast: bool,
}

/// How an answer ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResponderOutcome {
    /// It was sent, and no feedback is expected.
    Sent,
    /// The initiator received it and chose this sector; in a sweep for one station, the choice was acknowledged.
    Trained(SectorFeedback),
    /// It was sent as often as allowed and never got feedback.
    NoFeedback,
    /// The window for answers ended before the channel was free for it.
    WindowOver,
}

/// What a responder tells its station.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ResponderReport {
    /// A sweep is over of which frames were decoded.
    Heard(HeardSweep),
    /// The answer to it has ended.
    Answered {
        /// The sweep.
        heard: HeardSweep,
        /// The end of the answer.
        outcome: ResponderOutcome,
        /// How often this station swept its sectors.
        sweeps: u8,
    },
}
