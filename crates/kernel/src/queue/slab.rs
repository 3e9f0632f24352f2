//! Storage of pending events, in slots that are reused.

use super::EventKey;

/// Events by key.
pub(super) struct Slab<E> {
    slots: Vec<Slot<E>>,
    /// Empty slots; the last one emptied is filled first, because it is in the cache.
    vacant: Vec<u32>,
}

/// The insertion number tells an event from earlier ones in the same slot: a generation that never wraps.
struct Slot<E> {
    insertion: u64,
    event: Option<E>,
}

impl<E> Default for Slab<E> {
    fn default() -> Self {
        Self { slots: Vec::new(), vacant: Vec::new() }
    }
}

impl<E> Slab<E> {
    /// Stores an event.
    ///
    /// # Panics
    /// If 2³² events are stored already.
    #[inline]
    pub(super) fn insert(&mut self, insertion: u64, event: E) -> EventKey {
        let filled = Slot { insertion, event: Some(event) };
        let slot = if let Some(slot) = self.vacant.pop() {
            self.slots[slot as usize] = filled;
            slot
        } else {
            let slot = u32::try_from(self.slots.len()).expect("fewer than 2^32 pending events");
            self.slots.push(filled);
            slot
        };
        EventKey { insertion, slot }
    }

    /// Removes an event and returns it; `None` if it is no longer here.
    #[inline]
    pub(super) fn take(&mut self, key: EventKey) -> Option<E> {
        let slot = self.slots.get_mut(key.slot as usize).filter(|slot| slot.insertion == key.insertion)?;
        let event = slot.event.take()?;
        self.vacant.push(key.slot);
        Some(event)
    }

    /// Whether the event is here.
    #[inline]
    pub(super) fn holds(&self, key: EventKey) -> bool {
        self.slots.get(key.slot as usize).is_some_and(|slot| slot.insertion == key.insertion && slot.event.is_some())
    }

    /// Number of events stored.
    #[inline]
    pub(super) fn len(&self) -> usize {
        self.slots.len() - self.vacant.len()
    }
}

#[cfg(test)]
impl<E> Slab<E> {
    pub(super) const SLOT_OCTETS: usize = size_of::<Slot<E>>();

    pub(super) fn slots(&self) -> usize {
        self.slots.len()
    }
}
