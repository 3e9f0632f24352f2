//! MAC addresses of stations.

use std::fmt;

use sextant_kernel::StationId;

/// A MAC address of 48 bits, in the order on the air.
///
/// Station `n` has the address `02:00:nn:nn:nn:nn` with its number as 32 bits, most significant octet first: station 1
/// is `02:00:00:00:00:01`. The bit 0x02 of the first octet says that the address is given locally (IEEE 802, 8.2.2).
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct MacAddress(pub [u8; 6]);

impl MacAddress {
    /// Every station.
    pub const BROADCAST: Self = Self([0xFF; 6]);

    /// The address of a station.
    #[must_use]
    #[inline]
    pub const fn of(station: StationId) -> Self {
        let [a, b, c, d] = station.0.to_be_bytes();
        Self([0x02, 0, a, b, c, d])
    }

    /// The station that has this address; `None` if no station has it.
    #[must_use]
    #[inline]
    pub const fn station(self) -> Option<StationId> {
        match self.0 {
            [0x02, 0, a, b, c, d] => Some(StationId(u32::from_be_bytes([a, b, c, d]))),
            _ => None,
        }
    }
}

impl fmt::Display for MacAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [a, b, c, d, e, g] = self.0;
        write!(f, "{a:02x}:{b:02x}:{c:02x}:{d:02x}:{e:02x}:{g:02x}")
    }
}

impl fmt::Debug for MacAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_station_has_an_address_of_its_own_and_the_broadcast_address_is_none_of_them() {
        for station in [0, 1, 7, 0x01_0203, u32::MAX].map(StationId) {
            assert_eq!(MacAddress::of(station).station(), Some(station));
        }
        assert_eq!(MacAddress::of(StationId(7)).to_string(), "02:00:00:00:00:07");
        assert_eq!(MacAddress::of(StationId(0x0102_0304)).0, [2, 0, 1, 2, 3, 4]);
        assert_eq!(MacAddress::BROADCAST.station(), None);
        assert_eq!(MacAddress([0x02, 1, 0, 0, 0, 7]).station(), None);
    }
}
