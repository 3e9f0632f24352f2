//! Cells: what a station may do in a slot of each slotframe.

use sextant_kernel::StationId;

use super::Asn;

/// A slotframe: so many slots that come again and again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Slotframe {
    /// Its number: in a slot with cells of several slotframes, that with the lowest number counts.
    pub handle: u8,
    /// Its length (slots).
    pub length: u16,
}

/// What a cell is for, as the bits of a frame say it (IEEE 802.15.4-2015, 7.4.4.3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CellOptions(u8);

impl CellOptions {
    /// The station may send.
    pub const TRANSMIT: Self = Self(1);
    /// The station listens.
    pub const RECEIVE: Self = Self(2);
    /// Others may send too: a failure is followed by a back-off.
    pub const SHARED: Self = Self(4);
    /// What is heard corrects the clock.
    pub const TIMEKEEPING: Self = Self(8);

    /// All of both.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether it has all of `other`.
    #[must_use]
    #[inline]
    pub const fn has(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// The bits.
    #[must_use]
    pub const fn bits(self) -> u8 {
        self.0
    }

    /// The options with these bits; the upper ones are reserved and ignored.
    #[must_use]
    pub const fn of_bits(bits: u8) -> Self {
        Self(bits & 0x0F)
    }
}

/// Whom a cell is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellPeer {
    /// All neighbours.
    All,
    /// One of them.
    Station(StationId),
    /// All, for enhanced beacons and nothing else.
    Beacons,
}

/// A cell of a station.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// The slotframe in which it is.
    pub slotframe: Slotframe,
    /// The slot in which it is, from 0.
    pub timeslot: u16,
    /// What its channel has beyond the number of the slot.
    pub channel_offset: u16,
    /// What it is for.
    pub options: CellOptions,
    /// Whom it is for.
    pub peer: CellPeer,
}

impl Cell {
    /// The first slot from `asn` on in which it comes.
    #[must_use]
    #[inline]
    pub const fn next_from(&self, asn: Asn) -> Asn {
        asn.next_at(self.timeslot, self.slotframe.length)
    }

    /// Whether it comes in a slot.
    #[must_use]
    #[inline]
    pub const fn is_at(&self, asn: Asn) -> bool {
        asn.0 % self.slotframe.length as u64 == self.timeslot as u64
    }

    /// Whether others may send in it too.
    #[must_use]
    #[inline]
    pub const fn is_shared(&self) -> bool {
        self.options.has(CellOptions::SHARED)
    }

    /// Whether the station may send in it.
    #[must_use]
    #[inline]
    pub const fn sends(&self) -> bool {
        self.options.has(CellOptions::TRANSMIT)
    }

    /// Whether the station listens in it.
    #[must_use]
    #[inline]
    pub const fn listens(&self) -> bool {
        self.options.has(CellOptions::RECEIVE)
    }
}
