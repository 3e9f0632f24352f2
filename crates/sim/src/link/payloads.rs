//! The payloads of the frames that stations were given to send.

use crate::service::report::Payload;

/// What a frame carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    /// Octets that say nothing.
    Filler,
    /// The payload in this slot.
    Octets(u32),
}

/// The payloads of the frames that stations were given to send. Slots are used again, so that nothing is allocated
/// once there were as many at a time as there ever are.
#[derive(Debug, Default)]
pub(super) struct Payloads {
    slots: Vec<Vec<u8>>,
    free: Vec<u32>,
}

impl Payloads {
    pub(super) fn keep(&mut self, payload: Payload<'_>) -> Content {
        match payload {
            Payload::Octets(octets) => Content::Octets(self.store(octets)),
            Payload::Filler(_) => Content::Filler,
        }
    }

    /// Stores octets in a slot.
    pub(super) fn store(&mut self, octets: &[u8]) -> u32 {
        let slot = self.free.pop().unwrap_or_else(|| {
            self.slots.push(Vec::new());
            u32::try_from(self.slots.len() - 1).expect("at most 2^32 payloads")
        });
        let kept = &mut self.slots[slot as usize];
        kept.clear();
        kept.extend_from_slice(octets);
        slot
    }

    pub(super) fn octets(&self, slot: u32) -> &[u8] {
        &self.slots[slot as usize]
    }

    pub(super) fn release(&mut self, content: Content) {
        if let Content::Octets(slot) = content {
            self.free(slot);
        }
    }

    /// Gives a slot back.
    pub(super) fn free(&mut self, slot: u32) {
        self.free.push(slot);
    }
}
