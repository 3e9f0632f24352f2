//! The octets of packets that are sent over several hops, and of the beacons that build their tree.
//!
//! All numbers are little-endian, stations have 16 bits, and costs are in tenths of a transmission:
//!
//! | octets | beacon | data |
//! | --- | --- | --- |
//! | 1 | 0x3F: no 6LoWPAN | 0x3F |
//! | 1 | kind 0; 0x10 if neighbours should send beacons soon | kind 1 |
//! | 2 or 1 | parent, 0xFFFF if none | hops so far |
//! | 2 | cost of the way to the root, 0xFFFF if none | cost of the sender's way to the root |
//! | 1 or 2 | number of the beacon | origin |
//! | 2 | | number of the packet at its origin |
//! | 0 or 2 | | parent of the origin, if the kind has 0x10 |
//! | 0 or 2 | | the node to which it goes, if the kind has 0x20; it has it already, if the kind has 0x40 too |
//!
//! A packet down has the kind 2, hops so far (1), origin (2), its number there (2), the number of stations on its way after the
//! receiver (1), and these stations (2 each): the last one is where it goes.

use sextant_kernel::StationId;

/// Most stations of a network with routing: their numbers have 16 bits.
pub const MAX_STATIONS: usize = 0xFFFF;

/// Size of the header of a packet (octets).
pub const HEADER_OCTETS: u8 = 9;

/// Size of a beacon (octets).
pub const BEACON_OCTETS: u8 = 7;

/// The first octet: IPv6 over IEEE 802.15.4 never begins so (RFC 4944, 5.1: NALP).
const MAGIC: u8 = 0x3F;
const NONE: u16 = 0xFFFF;
const KIND: u8 = 0x0F;
const BEACON: u8 = 0;
const DATA: u8 = 1;
const DOWN: u8 = 2;
const PULLS: u8 = 0x10;
const HAS_PARENT: u8 = 0x10;
const HAS_TARGET: u8 = 0x20;
const IS_TAKEN: u8 = 0x40;

/// What a station sends to others.
#[derive(Clone, Debug, PartialEq)]
pub enum Packet {
    /// A beacon to all neighbours.
    Beacon(Beacon),
    /// A packet to the next station on its way; what follows the header says nothing.
    Data(Data),
    /// A packet down to the next station on its way; what follows the header says nothing.
    Down(Down),
}

/// What a station tells its neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beacon {
    /// To whom it sends packets to the root.
    pub parent: Option<StationId>,
    /// Expected transmissions of a packet to the root; 0 at the root, and `None` without a way.
    pub cost: Option<f64>,
    /// Number of the beacon: it goes round.
    pub number: u8,
    /// Whether neighbours should send beacons soon, because the station has no way.
    pub pulls: bool,
}

/// The header of a packet to the root.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Data {
    /// The station that had it first.
    pub origin: StationId,
    /// Its number there: it goes round.
    pub number: u16,
    /// Hops before this one.
    pub hops: u8,
    /// Expected transmissions from the sender to the root.
    pub cost: Option<f64>,
    /// The parent of the origin, if the root should know it.
    pub parent: Option<StationId>,
    /// The node to which it goes; `None` if it goes to the root.
    pub target: Option<StationId>,
    /// Whether that node was on the way, and took it: it goes on to tell the root of its origin.
    pub is_taken: bool,
}

/// The header of a packet that goes down from a root.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Down {
    /// The station that had it first: the root, or a node from which it went up.
    pub origin: StationId,
    /// Its number there: it goes round.
    pub number: u16,
    /// Hops before this one.
    pub hops: u8,
    /// The stations on its way after the receiver. If there is none, the receiver is where it goes.
    pub route: Vec<StationId>,
}

/// Size of the header of a packet down with so many stations on its way after the receiver (octets).
#[must_use]
pub const fn down_octets(stations: usize) -> usize {
    8 + 2 * stations
}

fn short(station: Option<StationId>) -> [u8; 2] {
    station.and_then(|station| u16::try_from(station.0).ok()).unwrap_or(NONE).to_le_bytes()
}

fn tenths(cost: Option<f64>) -> [u8; 2] {
    let limited = cost.map(|cost| (10.0 * cost).round()).filter(|&tenths| (0.0..f64::from(NONE)).contains(&tenths));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the range is checked")]
    limited.map_or(NONE, |tenths| tenths as u16).to_le_bytes()
}

impl Beacon {
    /// Writes it to `octets`, in place of what is there.
    pub fn write(&self, octets: &mut Vec<u8>) {
        octets.clear();
        octets.extend([MAGIC, BEACON | if self.pulls { PULLS } else { 0 }]);
        octets.extend(short(self.parent));
        octets.extend(tenths(self.cost));
        octets.push(self.number);
    }
}

impl Data {
    /// That of a packet at its origin, to the root, before anything else is known.
    #[must_use]
    pub const fn new(origin: StationId, number: u16) -> Self {
        Self { origin, number, hops: 0, cost: None, parent: None, target: None, is_taken: false }
    }

    /// Writes the header to `octets`, in place of what is there, and fills up to `size` octets.
    pub fn write(&self, size: usize, octets: &mut Vec<u8>) {
        octets.clear();
        let parent = if self.parent.is_some() { HAS_PARENT } else { 0 };
        let target = if self.target.is_some() { HAS_TARGET } else { 0 };
        let taken = if self.is_taken { IS_TAKEN } else { 0 };
        octets.extend([MAGIC, DATA | parent | target | taken, self.hops]);
        octets.extend(tenths(self.cost));
        octets.extend(short(Some(self.origin)));
        octets.extend(self.number.to_le_bytes());
        for station in [self.parent, self.target] {
            octets.extend(station.map(|station| short(Some(station))).iter().flatten());
        }
        octets.resize(octets.len().max(size), 0);
    }
}

impl Down {
    /// Writes the header to `octets`, in place of what is there, and fills up to `size` octets.
    ///
    /// # Panics
    /// If the way has more than 255 stations.
    pub fn write(&self, size: usize, octets: &mut Vec<u8>) {
        octets.clear();
        octets.extend([MAGIC, DOWN, self.hops]);
        octets.extend(short(Some(self.origin)));
        octets.extend(self.number.to_le_bytes());
        octets.push(u8::try_from(self.route.len()).expect("at most 64 hops"));
        octets.extend(self.route.iter().flat_map(|&station| short(Some(station))));
        octets.resize(octets.len().max(size), 0);
    }
}

impl Packet {
    /// Reads a packet; `None` if the octets are none.
    #[must_use]
    pub fn read(octets: &[u8]) -> Option<Self> {
        let mut rest = octets;
        let [magic, kind] = take(&mut rest)?;
        if magic != MAGIC {
            return None;
        }
        match kind & KIND {
            BEACON => {
                let (parent, cost) = (station(&mut rest)?, cost(&mut rest)?);
                let [number] = take(&mut rest)?;
                Some(Self::Beacon(Beacon { parent, cost, number, pulls: kind & PULLS != 0 }))
            }
            DATA => {
                let [hops] = take(&mut rest)?;
                let cost = cost(&mut rest)?;
                let origin = station(&mut rest)??;
                let number = u16::from_le_bytes(take(&mut rest)?);
                let parent = if kind & HAS_PARENT != 0 { Some(station(&mut rest)??) } else { None };
                let target = if kind & HAS_TARGET != 0 { Some(station(&mut rest)??) } else { None };
                let is_taken = kind & IS_TAKEN != 0;
                Some(Self::Data(Data { origin, number, hops, cost, parent, target, is_taken }))
            }
            DOWN => {
                let [hops] = take(&mut rest)?;
                let origin = station(&mut rest)??;
                let number = u16::from_le_bytes(take(&mut rest)?);
                let [stations] = take(&mut rest)?;
                let route = (0..stations).map(|_| station(&mut rest)?).collect::<Option<_>>()?;
                Some(Self::Down(Down { origin, number, hops, route }))
            }
            _ => None,
        }
    }
}

fn take<const N: usize>(rest: &mut &[u8]) -> Option<[u8; N]> {
    let (&head, tail) = rest.split_first_chunk()?;
    *rest = tail;
    Some(head)
}

/// The next station; `Some(None)` if it says that there is none.
#[expect(clippy::option_option, reason = "the octets may end, and a station may be absent")]
fn station(rest: &mut &[u8]) -> Option<Option<StationId>> {
    let short = u16::from_le_bytes(take(rest)?);
    Some((short != NONE).then(|| StationId(short.into())))
}

/// The next cost; `Some(None)` if it says that there is none.
#[expect(clippy::option_option, reason = "the octets may end, and a cost may be absent")]
fn cost(rest: &mut &[u8]) -> Option<Option<f64>> {
    let tenths = u16::from_le_bytes(take(rest)?);
    Some((tenths != NONE).then(|| f64::from(tenths) / 10.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packets_have_these_octets_and_are_read_back() {
        let beacon = Beacon { parent: Some(StationId(0x0102)), cost: Some(2.3), number: 7, pulls: true };
        let mut octets = Vec::new();
        beacon.write(&mut octets);
        assert_eq!(octets, [0x3F, 0x10, 0x02, 0x01, 23, 0, 7]);
        assert_eq!(octets.len(), usize::from(BEACON_OCTETS));
        assert_eq!(Packet::read(&octets), Some(Packet::Beacon(beacon)));
        let data = Data { number: 0x1234, hops: 3, cost: Some(1.0), ..Data::new(StationId(5), 0) };
        data.write(12, &mut octets);
        assert_eq!(octets, [0x3F, 0x01, 3, 10, 0, 5, 0, 0x34, 0x12, 0, 0, 0]);
        assert_eq!(Packet::read(&octets), Some(Packet::Data(data)));
        let without_way = Data { cost: None, ..data };
        without_way.write(0, &mut octets);
        assert_eq!(octets.len(), usize::from(HEADER_OCTETS));
        assert_eq!(Packet::read(&octets), Some(Packet::Data(without_way)));
        let told = Data { parent: Some(StationId(7)), target: Some(StationId(0x0908)), ..data };
        told.write(0, &mut octets);
        assert_eq!(octets, [0x3F, 0x31, 3, 10, 0, 5, 0, 0x34, 0x12, 7, 0, 8, 9]);
        assert_eq!(Packet::read(&octets), Some(Packet::Data(told)));
        let taken = Data { is_taken: true, ..told };
        taken.write(0, &mut octets);
        assert_eq!(octets[1], 0x71);
        assert_eq!(Packet::read(&octets), Some(Packet::Data(taken)));
        let down = Down { origin: StationId(5), number: 2, hops: 1, route: vec![StationId(6), StationId(7)] };
        down.write(0, &mut octets);
        assert_eq!(octets, [0x3F, 2, 1, 5, 0, 2, 0, 2, 6, 0, 7, 0]);
        assert_eq!(octets.len(), down_octets(2));
        assert_eq!(Packet::read(&octets), Some(Packet::Down(down)));
        assert_eq!(Packet::read(&octets[..11]), None, "the way is cut");
    }

    #[test]
    fn other_octets_are_no_packet() {
        let data = Data { cost: Some(1.0), ..Data::new(StationId(5), 1) };
        let mut octets = Vec::new();
        data.write(0, &mut octets);
        for end in 0..octets.len() {
            assert_eq!(Packet::read(&octets[..end]), None, "{end} octets");
        }
        octets[0] = 0x41;
        assert_eq!(Packet::read(&octets), None);
    }
}
