//! Autonomous cells: those that a station knows by the addresses of others (RFC 9033, section 3).

use sextant_kernel::StationId;

use super::super::{Cell, CellOptions, CellPeer, CellPlace, Slotframe};

/// The slotframe of autonomous cells: after that of the minimal schedule, before that of negotiated ones.
const HANDLE: u8 = 1;

/// The autonomous cells of a station.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Autonomous {
    /// Length of the slotframe (slots).
    pub length: u16,
    /// Number of channel offsets.
    pub channels: u16,
    /// The station itself.
    pub station: StationId,
}

/// The hash SAX of an address below `below`: for each octet c, h = (((h << l) + (h >> r) + c) xor h) mod T (Ramakrishna and Zobel
/// 1997, as RFC 9033, appendix A, uses it), with h = 0 at first, l = 0 and r = 1. The address of a station has its number in eight
/// octets, the highest one first.
fn sax(station: StationId, below: u16) -> u16 {
    let below = u32::from(below);
    let hash = u64::from(station.0).to_be_bytes().into_iter().fold(0_u32, |hash, octet| {
        let sum = hash + (hash >> 1) + u32::from(octet);
        (sum ^ hash) % below
    });
    u16::try_from(hash).expect("below a number of 16 bits")
}

impl Autonomous {
    /// Where a station listens for frames of any other.
    #[must_use]
    pub fn place_of(&self, station: StationId) -> CellPlace {
        // Slot 0 is that of the minimal schedule.
        CellPlace { timeslot: 1 + sax(station, self.length - 1), channel_offset: sax(station, self.channels) }
    }

    fn cell(&self, owner: StationId, options: CellOptions, peer: CellPeer) -> Cell {
        let CellPlace { timeslot, channel_offset } = self.place_of(owner);
        let slotframe = Slotframe { handle: HANDLE, length: self.length };
        Cell { slotframe, timeslot, channel_offset, options, peer }
    }

    /// The cell in which the station listens.
    #[must_use]
    pub fn receive_cell(&self) -> Cell {
        self.cell(self.station, CellOptions::RECEIVE, CellPeer::All)
    }

    /// The cell of frames to another station, as long as none is negotiated.
    #[must_use]
    pub fn cell_to(&self, peer: StationId) -> Option<Cell> {
        let options = CellOptions::TRANSMIT.and(CellOptions::SHARED);
        (peer != self.station).then(|| self.cell(peer, options, CellPeer::Station(peer)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_of_an_address_is_that_of_its_octets() {
        // Number 5: seven octets of zero leave 0, and the last one is the hash.
        assert_eq!(sax(StationId(5), 100), 5);
        // Number 0x0203: 2, and then ((2 + 1 + 3) xor 2) = 4.
        assert_eq!(sax(StationId(0x0203), 100), 4);
        // Number 0x0101FF below 16: 1; ((1 + 0 + 1) xor 1) = 3; ((3 + 1 + 255) xor 3) mod 16 = 256 mod 16.
        assert_eq!(sax(StationId(0x0101FF), 16), 0);
    }

    #[test]
    fn a_sender_finds_the_cell_in_which_the_receiver_listens() {
        for (from, to) in [(0, 1), (7, 300), (300, 7)] {
            let of = |station| Autonomous { length: 101, channels: 16, station: StationId(station) };
            let (sent, heard) = (of(from).cell_to(StationId(to)).expect("two stations"), of(to).receive_cell());
            assert_eq!((sent.timeslot, sent.channel_offset), (heard.timeslot, heard.channel_offset));
            assert!((1..101).contains(&sent.timeslot) && sent.is_shared() && !heard.sends());
        }
        let own = Autonomous { length: 101, channels: 16, station: StationId(3) };
        assert_eq!(own.cell_to(StationId(3)), None);
    }
}
