//! How the stations of a network with slots used them.

use std::time::Duration;

use sextant_mac::tsch::{MsfUse, SlotCounts};

/// How a station used its slots.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SlotUse {
    /// Slots by what it did in them.
    pub counts: SlotCounts,
    /// How long its radio sent or listened.
    pub on: Duration,
    /// How long that was counted.
    pub span: Duration,
    /// How much of it was a scan for a network: no slot has it.
    pub scanned: Duration,
    /// How often it lost the network: its clock was not corrected for too long.
    pub lost: u64,
    /// How long after the start it joined for the first time; `None` if it was in the network from the start, or never.
    pub joined_after: Option<Duration>,
    /// Whether it is in the network at the end.
    pub is_member: bool,
    /// How it agreed on cells, if it did.
    pub msf: Option<MsfUse>,
}
