//! Addresses of stations.

use sextant_kernel::StationId;

use super::ParseError;
use super::cursor::Cursor;

/// PAN identifier of all PANs.
pub(crate) const BROADCAST_PAN: u16 = 0xFFFF;

/// Largest short address of a station: 0xFFFE means no short address, 0xFFFF is the broadcast address.
const MAX_SHORT: u32 = 0xFFFD;

/// Address within a PAN.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Address {
    /// Given by the coordinator.
    Short(u16),
    /// Given by the manufacturer (EUI-64).
    Extended(u64),
}

/// A PAN and an address in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Endpoint {
    /// PAN identifier.
    pub pan: u16,
    /// Address.
    pub address: Address,
}

/// Size of an address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Width {
    Short,
    Extended,
}

impl Address {
    /// Every station.
    pub const BROADCAST: Self = Self::Short(0xFFFF);

    /// The value that means that a station has no short address.
    pub const NONE: u16 = 0xFFFE;

    /// The address of a station: short for the first 65534, extended for later ones.
    #[must_use]
    pub fn of(station: StationId) -> Self {
        match u16::try_from(station.0) {
            Ok(short) if station.0 <= MAX_SHORT => Self::Short(short),
            _ => Self::Extended(u64::from(station.0)),
        }
    }

    /// The station that has this address; `None` if no station has it.
    #[must_use]
    pub fn station(self) -> Option<StationId> {
        let station = match self {
            Self::Short(short) => StationId(u32::from(short)),
            Self::Extended(extended) => StationId(u32::try_from(extended).ok()?),
        };
        (Self::of(station) == self).then_some(station)
    }

    /// Size of the address (octets).
    #[must_use]
    pub const fn octets(self) -> u8 {
        match self {
            Self::Short(_) => 2,
            Self::Extended(_) => 8,
        }
    }

    pub(super) const fn width(self) -> Width {
        match self {
            Self::Short(_) => Width::Short,
            Self::Extended(_) => Width::Extended,
        }
    }

    pub(crate) fn write(self, mpdu: &mut Vec<u8>) {
        match self {
            Self::Short(short) => mpdu.extend(short.to_le_bytes()),
            Self::Extended(extended) => mpdu.extend(extended.to_le_bytes()),
        }
    }

    pub(super) fn parse(width: Width, cursor: &mut Cursor<'_>) -> Result<Self, ParseError> {
        match width {
            Width::Short => cursor.u16("addresses").map(Self::Short),
            Width::Extended => cursor.u64("addresses").map(Self::Extended),
        }
    }
}
