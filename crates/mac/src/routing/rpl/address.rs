//! The IPv6 addresses of stations: `fd00::ff:fe00:N`, by their short addresses (RFC 4944, 6; RFC 6282, 3.2.2).

use sextant_kernel::StationId;

/// The prefix of all addresses: `fd00::/64`.
pub(super) const PREFIX: [u8; 16] = [0xFD, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];

/// The short address of a station, as in an address.
pub(super) fn short(station: StationId) -> [u8; 2] {
    u16::try_from(station.0).unwrap_or(u16::MAX).to_be_bytes()
}

/// The station with this short address.
pub(super) fn of_short(octets: [u8; 2]) -> StationId {
    StationId(u16::from_be_bytes(octets).into())
}

/// The whole address of a station.
pub(super) fn whole(station: StationId) -> [u8; 16] {
    let [high, low] = short(station);
    let mut address = PREFIX;
    [address[11], address[12], address[14], address[15]] = [0xFF, 0xFE, high, low];
    address
}

/// The station with this address; `None` if it is that of nobody here.
pub(super) fn of_whole(address: [u8; 16]) -> Option<StationId> {
    let station = of_short([address[14], address[15]]);
    (whole(station) == address).then_some(station)
}

/// Takes the first octets.
pub(super) fn take<const N: usize>(rest: &mut &[u8]) -> Option<[u8; N]> {
    let (&head, tail) = rest.split_first_chunk()?;
    *rest = tail;
    Some(head)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_is_made_of_the_number_of_a_station() {
        let address = whole(StationId(0x0102));
        let text = std::net::Ipv6Addr::from(address).to_string();
        assert_eq!((text.as_str(), of_whole(address)), ("fd00::ff:fe00:102", Some(StationId(0x0102))));
        assert_eq!(of_whole(PREFIX), None);
    }
}
