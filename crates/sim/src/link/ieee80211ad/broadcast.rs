//! Payloads that stations were given to send to all.

use sextant_kernel::SimTime;
use sextant_mac::dmg::MAX_BEACON_PAYLOAD_OCTETS;

use crate::link::payloads::{Content, Payloads};
use crate::service::outcome::FrameOutcome;
use crate::service::report::FrameId;

/// A payload that a station was given to send to all, in one frame from each of its sectors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Broadcast {
    pub(super) id: FrameId,
    pub(super) content: Content,
    pub(super) payload_octets: u16,
    pub(super) offered: SimTime,
    /// Frames sent so far.
    pub(super) frames: u32,
    /// The best outcome of these.
    pub(super) outcome: FrameOutcome,
}

impl Broadcast {
    /// Its number on the air.
    pub(super) fn sequence(&self) -> u8 {
        self.id.0.to_le_bytes()[0]
    }

    /// Its octets.
    pub(super) fn payload<'a>(&self, payloads: &'a Payloads) -> &'a [u8] {
        const FILLER: &[u8] = &[0; MAX_BEACON_PAYLOAD_OCTETS as usize];
        match self.content {
            Content::Filler => &FILLER[..usize::from(self.payload_octets)],
            Content::Octets(slot) => payloads.octets(slot),
        }
    }
}
