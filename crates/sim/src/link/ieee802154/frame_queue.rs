//! Frames that a station was given to send, and their payloads.

use std::collections::VecDeque;

use sextant_kernel::SimTime;

use crate::service::report::{Destination, FrameId};

/// A frame that a station was given to send.
#[derive(Clone, Copy, Debug)]
pub(super) struct QueuedFrame {
    pub(super) id: FrameId,
    pub(super) to: Destination,
    pub(super) content: Content,
    pub(super) mpdu_octets: u8,
    pub(super) offered: SimTime,
}

/// What a frame carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    /// Octets that say nothing.
    Filler,
    /// The payload in this slot.
    Octets(u32),
}

/// Frames that wait for the one under way, the first one first.
pub(super) type Waiting = VecDeque<QueuedFrame>;

/// The payloads of the frames that stations were given to send. Slots are used again, so that nothing is allocated
/// once there were as many at a time as there ever are.
#[derive(Debug, Default)]
pub(super) struct Payloads {
    slots: Vec<Vec<u8>>,
    free: Vec<u32>,
}

impl Payloads {
    pub(super) fn keep(&mut self, octets: &[u8]) -> Content {
        let slot = self.free.pop().unwrap_or_else(|| {
            self.slots.push(Vec::new());
            u32::try_from(self.slots.len() - 1).expect("at most 2^32 payloads")
        });
        let kept = &mut self.slots[slot as usize];
        kept.clear();
        kept.extend_from_slice(octets);
        Content::Octets(slot)
    }

    pub(super) fn octets(&self, slot: u32) -> &[u8] {
        &self.slots[slot as usize]
    }

    pub(super) fn release(&mut self, content: Content) {
        if let Content::Octets(slot) = content {
            self.free.push(slot);
        }
    }
}
