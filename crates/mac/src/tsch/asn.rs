//! The number of a slot.

/// Absolute slot number: slots since the start of the network. It has 40 bits on the air.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Asn(pub u64);

impl Asn {
    /// Its octets on the air, the lowest one first.
    #[must_use]
    pub const fn octets(self) -> [u8; 5] {
        let [a, b, c, d, e, ..] = self.0.to_le_bytes();
        [a, b, c, d, e]
    }

    /// The number with these octets.
    #[must_use]
    pub const fn of_octets([a, b, c, d, e]: [u8; 5]) -> Self {
        Self(u64::from_le_bytes([a, b, c, d, e, 0, 0, 0]))
    }

    /// The slot after this one.
    #[must_use]
    #[inline]
    pub const fn next(self) -> Self {
        Self(self.0 + 1)
    }

    /// The first slot from this one on that has the number `timeslot` in slotframes of `length` slots.
    #[must_use]
    #[inline]
    pub const fn next_at(self, timeslot: u16, length: u16) -> Self {
        let (length, at) = (length as u64, self.0 % length as u64);
        let wait = (timeslot as u64 + length - at) % length;
        Self(self.0 + wait)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forty_bits_go_there_and_back() {
        for asn in [Asn(0), Asn(513), Asn(1 << 32), Asn((1 << 40) - 1)] {
            assert_eq!(Asn::of_octets(asn.octets()), asn);
        }
        assert_eq!(Asn(513).octets(), [1, 2, 0, 0, 0]);
    }

    #[test]
    fn the_next_slot_with_a_number_may_be_this_one() {
        assert_eq!(Asn(0).next_at(0, 101), Asn(0));
        assert_eq!(Asn(1).next_at(0, 101), Asn(101));
        assert_eq!(Asn(205).next_at(5, 101), Asn(207));
        assert_eq!(Asn(7).next_at(0, 1), Asn(7));
    }
}
