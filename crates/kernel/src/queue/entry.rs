//! The entries that are sorted: the order of an event, packed, and the slot of the event.

use super::{EventKey, Rank};
use crate::SimTime;

/// Bits of the insertion number beside class and station: with the 32 of `low`, 56 bits, enough for
/// 10⁷ events a second over 228 years.
const HIGH_BITS: u32 = 24;

/// Position of an event in the order, in 24 octets. The most significant field comes first, as the derived order
/// requires.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Entry {
    time: SimTime,
    /// Class (8 bits), station (32 bits), upper 24 bits of the insertion number.
    rank: u64,
    /// Lower 32 bits of the insertion number, slot (32 bits).
    low: u64,
}

impl Entry {
    #[inline]
    pub(super) fn new(time: SimTime, rank: Rank, key: EventKey) -> Self {
        let rank = u64::from(rank.class) << 56 | u64::from(rank.station.0) << HIGH_BITS | key.insertion >> 32;
        // The upper half of the number is in `rank`.
        Self { time, rank, low: key.insertion << 32 | u64::from(key.slot) }
    }

    #[inline]
    pub(super) const fn time(&self) -> SimTime {
        self.time
    }

    #[inline]
    pub(super) fn key(&self) -> EventKey {
        let high = self.rank & ((1 << HIGH_BITS) - 1);
        #[expect(clippy::cast_possible_truncation, reason = "the lower half")]
        let slot = self.low as u32;
        EventKey { insertion: high << 32 | self.low >> 32, slot }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::StationId;

    #[test]
    fn insertion_numbers_order_equal_ranks_beyond_32_bits() {
        let entry = |class, station, insertion, slot| {
            Entry::new(SimTime::ZERO, Rank::new(class, StationId(station)), EventKey { insertion, slot })
        };
        let last = (1 << 32) - 1;
        assert!(entry(3, 8, last, 9) < entry(3, 8, last + 1, 2));
        assert!(entry(3, 8, last + 1, 9) < entry(3, 8, last + 2, 2));
        assert!(entry(3, 8, (1 << 56) - 1, 9) < entry(3, 9, 0, 2));
        assert!(entry(3, u32::MAX, 5, 9) < entry(4, 0, 0, 2));
        let key = EventKey { insertion: (1 << 56) - 2, slot: u32::MAX };
        assert_eq!(Entry::new(SimTime::MAX, Rank::new(u8::MAX, StationId(u32::MAX)), key).key(), key);
    }
}
