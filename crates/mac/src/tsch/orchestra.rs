//! Orchestra: cells that each station knows without negotiation, by the addresses of the others.

use sextant_kernel::StationId;

use super::{Cell, CellOptions, CellPeer, Slotframe};

/// Who owns the cells between two stations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnicastCells {
    /// The receiver: it has one cell, in which all others may send to it.
    ReceiverBased,
    /// The sender: it has one cell, in which all that it may send to listen.
    SenderBased,
}

/// The rules of Orchestra (Duquennoy, Al Nahas, Landsiedel, Watteyne, SenSys 2015), with the numbers of Contiki-NG: a slotframe
/// for enhanced beacons, one for frames between two stations, and one that all share for the rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Orchestra {
    /// Length of the slotframe of enhanced beacons (slots).
    pub beacon_length: u16,
    /// Length of the slotframe of frames between two stations (slots).
    pub unicast_length: u16,
    /// Length of the slotframe of the rest (slots).
    pub shared_length: u16,
    /// Who owns the cells between two stations.
    pub unicast: UnicastCells,
    /// Number of channels in the sequence.
    pub channels: u16,
    /// The station itself: its number is its address.
    pub station: StationId,
}

const BEACON_HANDLE: u8 = 0;
const UNICAST_HANDLE: u8 = 1;
const SHARED_HANDLE: u8 = 2;

/// The last octet of an address.
fn hash(station: StationId) -> u16 {
    u16::from(station.0.to_le_bytes()[0])
}

impl Orchestra {
    /// The channel offset of frames to a station: not one of those of the other slotframes, 0 and 1, if there are more than two
    /// channels.
    fn unicast_offset(&self, receiver: StationId) -> u16 {
        if self.channels > 2 { 2 + hash(receiver) % (self.channels - 2) } else { 0 }
    }

    fn unicast_slotframe(&self) -> Slotframe {
        Slotframe { handle: UNICAST_HANDLE, length: self.unicast_length }
    }

    /// The cell of frames to a station.
    #[must_use]
    pub fn cell_to(&self, peer: StationId) -> Option<Cell> {
        (peer != self.station).then(|| {
            let (owner, options) = match self.unicast {
                UnicastCells::ReceiverBased => (peer, CellOptions::TRANSMIT.and(CellOptions::SHARED)),
                // Others with the same last octet may have it too.
                UnicastCells::SenderBased => (self.station, CellOptions::TRANSMIT.and(CellOptions::SHARED)),
            };
            Cell {
                slotframe: self.unicast_slotframe(),
                timeslot: hash(owner) % self.unicast_length,
                channel_offset: self.unicast_offset(peer),
                options,
                peer: CellPeer::Station(peer),
            }
        })
    }

    /// The cells that the station has whatever it sends: those of beacons, of which it hears that of its time source, those in
    /// which the stations `senders` may send to it, and the one that all share.
    pub fn cells(&self, time_source: Option<StationId>, senders: impl Iterator<Item = StationId>) -> Vec<Cell> {
        let beacons = Slotframe { handle: BEACON_HANDLE, length: self.beacon_length };
        let beacon = |owner: StationId, options| Cell {
            slotframe: beacons,
            timeslot: hash(owner) % self.beacon_length,
            channel_offset: if self.channels > 1 { 1 } else { 0 },
            options,
            peer: CellPeer::Beacons,
        };
        let mut cells = vec![beacon(self.station, CellOptions::TRANSMIT)];
        let heard = CellOptions::RECEIVE.and(CellOptions::TIMEKEEPING);
        cells.extend(time_source.map(|source| beacon(source, heard)));
        let unicast = |owner: StationId| Cell {
            slotframe: self.unicast_slotframe(),
            timeslot: hash(owner) % self.unicast_length,
            channel_offset: self.unicast_offset(self.station),
            options: CellOptions::RECEIVE,
            peer: CellPeer::All,
        };
        match self.unicast {
            UnicastCells::ReceiverBased => cells.push(unicast(self.station)),
            UnicastCells::SenderBased => {
                for cell in senders.map(unicast) {
                    if !cells.contains(&cell) {
                        cells.push(cell);
                    }
                }
            }
        }
        cells.push(Cell {
            slotframe: Slotframe { handle: SHARED_HANDLE, length: self.shared_length },
            timeslot: 0,
            channel_offset: 0,
            options: CellOptions::TRANSMIT.and(CellOptions::RECEIVE).and(CellOptions::SHARED),
            peer: CellPeer::All,
        });
        cells
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Asn, Schedule};
    use super::*;

    fn rules(station: u32, unicast: UnicastCells) -> Orchestra {
        Orchestra {
            beacon_length: 397,
            unicast_length: 17,
            shared_length: 31,
            unicast,
            channels: 16,
            station: StationId(station),
        }
    }

    #[test]
    fn sender_and_receiver_find_the_same_cell() {
        for unicast in [UnicastCells::ReceiverBased, UnicastCells::SenderBased] {
            for (from, to) in [(3, 9), (9, 3), (300, 20), (0, 255)] {
                let sent = rules(from, unicast).cell_to(StationId(to)).expect("two stations");
                let others = [from, 77].into_iter().map(StationId);
                let heard = rules(to, unicast).cells(None, others);
                let same = |cell: &&Cell| {
                    cell.listens() && (cell.timeslot, cell.channel_offset) == (sent.timeslot, sent.channel_offset)
                };
                assert!(heard.iter().any(|cell| same(&cell)), "{unicast:?}: {from} to {to}");
            }
        }
        assert_eq!(rules(4, UnicastCells::ReceiverBased).cell_to(StationId(4)), None);
    }

    #[test]
    fn the_default_listens_in_a_share_of_the_slots_that_has_a_closed_form() {
        // Lengths without a common factor: 1 - (1 - 1/397)(1 - 1/31)(1 - 1/17).
        let cells = rules(5, UnicastCells::ReceiverBased).cells(Some(StationId(40)), std::iter::empty());
        let period = 397 * 31 * 17;
        let listens = Schedule::new(cells).listens_within(Asn(0), Asn(period));
        assert_eq!(listens, period - 396 * 30 * 16);
        assert!((listens as f64 / period as f64 - 0.091_48).abs() < 1e-5);
    }
}
