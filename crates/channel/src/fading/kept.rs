//! What is remembered of links, so that it need not be worked out again.

/// What is remembered of links, each in the slot of its pair of stations, which another link may take.
#[derive(Clone, Debug)]
pub(super) struct Kept<T> {
    /// A power of two.
    slots: Vec<Option<(u64, T)>>,
    taken: usize,
    /// The most slots.
    most: usize,
}

/// Number of slots at first.
const FIRST: usize = 1 << 10;

impl<T: Clone> Kept<T> {
    /// Nothing yet; `most` is the number of slots that there may be, a power of two.
    pub(super) fn new(most: usize) -> Self {
        Self { slots: vec![None; FIRST], taken: 0, most }
    }

    /// What is remembered of a pair.
    #[inline]
    pub(super) fn get(&self, pair: u64) -> Option<&T> {
        let (known, value) = self.slots[self.slot(pair)].as_ref()?;
        (*known == pair).then_some(value)
    }

    /// Remembers it of a pair. If half of the slots are taken there are more, and the others are forgotten.
    pub(super) fn put(&mut self, pair: u64, value: T) {
        if 2 * self.taken >= self.slots.len() && self.slots.len() < self.most {
            self.slots = vec![None; 4 * self.slots.len()];
            self.taken = 0;
        }
        let slot = self.slot(pair);
        self.taken += usize::from(self.slots[slot].is_none());
        self.slots[slot] = Some((pair, value));
    }

    /// The slot of a pair (Fibonacci hashing; Knuth 1998, section 6.4).
    #[inline]
    fn slot(&self, pair: u64) -> usize {
        #[expect(clippy::cast_possible_truncation, reason = "below the number of slots")]
        let slot = (pair.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> (64 - self.slots.len().trailing_zeros())) as usize;
        slot
    }
}
