//! Packets of a network with RPL, to the octet, with headers compressed for IEEE 802.15.4 (RFC 6282).
//!
//! | octets | of | source |
//! | --- | --- | --- |
//! | 7 | IPv6: addresses of 2 octets each, hop limit in line | RFC 6282, 3 |
//! | 1 | next header, if ICMPv6 follows at once | RFC 6282, 3.1.1 |
//! | 8 | option with the rank of the sender, in packets up and in packets down by tables | RFC 6553, 3; RFC 6282, 4.2 |
//! | 8 and 2 for each hop after the first, to a multiple of 8 | source route, if there is more than one hop | RFC 6554, 3; RFC 6282, 4.2 |
//! | 7 | UDP with whole ports and checksum | RFC 6282, 4.3 |
//! | 2 | number of the packet at its origin, which is payload | |
//!
//! A header before ICMPv6 has one octet more. Checksums are zero.

use sextant_kernel::StationId;

use super::address::{of_short, short, take};
use super::message::{DioConfiguration, ICMPV6, Message};
use super::rank::Rank;

/// Hops that a packet can make.
pub const HOP_LIMIT: u8 = 64;

/// The least size of a packet with data that goes up (octets).
pub const LEAST_DATA_OCTETS: u8 = 7 + 8 + 7 + 2;

/// IPv6: traffic class elided, the next header compressed, hop limit in line, ...
const NEXT_COMPRESSED: u8 = 0x7C;
/// ... or the next header in line too.
const NEXT_IN_LINE: u8 = 0x78;
/// Addresses of 16 bits with the prefix of context 0.
const SHORT_ADDRESSES: u8 = 0x66;
/// Options for each hop, and a next header that is compressed; one less if it is in line.
const HOP_BY_HOP: u8 = 0xE1;
/// A routing header, likewise.
const ROUTING: u8 = 0xE3;
const UDP: u8 = 0xF0;
/// Both ports: that of the client in Contiki-NG's example of UDP.
const PORT: [u8; 2] = 8765_u16.to_be_bytes();
/// The RPL option (RFC 6553, 6: type 0x63) and its length.
const OPTION: [u8; 2] = [0x63, 4];
const DOWN: u8 = 0x80;
const RANK_ERROR: u8 = 0x40;
/// Source route (RFC 6554).
const TYPE_SOURCE_ROUTE: u8 = 3;
/// Octets that addresses of a source route share.
const SHARED: u8 = 14;

/// A packet that may go over several hops.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Datagram {
    /// Who had it first.
    pub source: StationId,
    /// Where it goes next by its source route, or at last without one.
    pub destination: StationId,
    /// Hops that it can still make, this one included.
    pub hop_limit: u8,
    /// What says where it comes from.
    pub option: Option<RplOption>,
    /// The rest of its way, if that is in it.
    pub route: Option<SourceRoute>,
    /// What it carries.
    pub content: Content,
}

/// What a packet carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// Data, with the number of the packet at its origin, which goes round.
    Data(u16),
    /// A message.
    Message(Message),
}

/// Which way a packet goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// To the root.
    Up,
    /// Away from it.
    Down,
}

/// What the RPL option of a packet says (RFC 6550, 11.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RplOption {
    /// Which way it goes.
    pub direction: Direction,
    /// What it met.
    pub flags: OptionFlags,
    /// The rank of the sender.
    pub sender_rank: Rank,
}

/// What a packet met on its way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OptionFlags {
    /// Nothing.
    #[default]
    None,
    /// A rank that did not fit.
    RankError,
}

/// The way of a packet, in the packet (RFC 6554).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SourceRoute {
    /// The stations after the first one; those that it has passed are not in order any more.
    stations: Vec<StationId>,
    /// How many are left.
    left: u8,
}

/// Size of a source route over so many stations after the first one (octets).
#[must_use]
pub const fn source_route_octets(stations: usize) -> usize {
    (8 + 2 * stations).next_multiple_of(8)
}

impl SourceRoute {
    /// A route over these stations after the first one; `None` if there are none, or more than 255.
    #[must_use]
    pub fn over(stations: Vec<StationId>) -> Option<Self> {
        let left = u8::try_from(stations.len()).ok().filter(|&left| left > 0)?;
        Some(Self { stations, left })
    }

    /// The station where it ends; `None` if it is over.
    #[must_use]
    pub fn end(&self) -> Option<StationId> {
        self.stations.last().copied().filter(|_| self.left > 0)
    }
}

impl RplOption {
    /// Whether a station of this rank should not get the packet from that of the sender: it would go round.
    #[must_use]
    pub fn is_wrong_at(&self, rank: Rank) -> bool {
        let is_sender_nearer = self.sender_rank < rank;
        match self.direction {
            Direction::Up => is_sender_nearer,
            Direction::Down => !is_sender_nearer,
        }
    }
}

impl Datagram {
    /// Where it goes at last.
    #[must_use]
    pub fn target(&self) -> StationId {
        self.route.as_ref().and_then(SourceRoute::end).unwrap_or(self.destination)
    }

    /// It has come to the station to which its route led next: the one after that is its destination now (RFC 6554, 4.2).
    /// `false` if the route is over, or there is none.
    pub fn advance(&mut self) -> bool {
        let Some(route) = self.route.as_mut().filter(|route| route.left > 0) else { return false };
        let next = route.stations.len() - usize::from(route.left);
        std::mem::swap(&mut route.stations[next], &mut self.destination);
        route.left -= 1;
        true
    }

    /// Size of its headers, and of the number of data (octets).
    #[must_use]
    pub fn header_octets(&self) -> usize {
        let is_data = matches!(self.content, Content::Data(_));
        let option = if self.option.is_some() { 8 } else { 0 };
        let route = self.route.as_ref().map_or(0, |route| source_route_octets(route.stations.len()));
        let content = if is_data { 7 + 2 } else { 0 };
        // The next header of ICMPv6 is in line once.
        7 + option + route + content + usize::from(!is_data)
    }

    /// Writes it to `octets`, in place of what is there, and fills data up to `size` octets.
    pub fn write(&self, size: usize, configuration: &DioConfiguration, octets: &mut Vec<u8>) {
        octets.clear();
        let is_data = matches!(self.content, Content::Data(_));
        // A header says in its last bit that the next one is compressed.
        let is_compressed = is_data || self.option.is_some() || self.route.is_some();
        octets.extend([if is_compressed { NEXT_COMPRESSED } else { NEXT_IN_LINE }, SHORT_ADDRESSES]);
        octets.extend((!is_compressed).then_some(ICMPV6));
        octets.push(self.hop_limit);
        octets.extend(short(self.source));
        octets.extend(short(self.destination));
        let header = |kind: u8, is_last: bool, octets: &mut Vec<u8>| {
            if is_data || !is_last {
                octets.push(kind);
            } else {
                octets.extend([kind - 1, ICMPV6]);
            }
        };
        if let Some(option) = &self.option {
            header(HOP_BY_HOP, self.route.is_none(), octets);
            let down = if option.direction == Direction::Down { DOWN } else { 0 };
            let error = if option.flags == OptionFlags::RankError { RANK_ERROR } else { 0 };
            octets.push(6);
            octets.extend(OPTION);
            octets.extend([down | error, 0]);
            octets.extend(option.sender_rank.0.to_be_bytes());
        }
        if let Some(route) = &self.route {
            header(ROUTING, true, octets);
            let whole = source_route_octets(route.stations.len());
            let pad = whole - 8 - 2 * route.stations.len();
            // The header is written without its own length of two octets.
            octets.push(u8::try_from(whole - 2).expect("at most 64 hops"));
            octets.extend([TYPE_SOURCE_ROUTE, route.left, SHARED << 4 | SHARED]);
            octets.extend([u8::try_from(pad << 4).expect("at most 7 octets"), 0, 0]);
            octets.extend(route.stations.iter().flat_map(|&station| short(station)));
            octets.resize(octets.len() + pad, 0);
        }
        match &self.content {
            Content::Data(number) => {
                octets.push(UDP);
                octets.extend(PORT);
                octets.extend(PORT);
                octets.extend([0, 0]);
                octets.extend(number.to_be_bytes());
                octets.resize(octets.len().max(size), 0);
            }
            Content::Message(message) => message.write(configuration, octets),
        }
    }

    /// Reads it.
    pub(super) fn read(octets: &[u8]) -> Option<Self> {
        let mut rest = octets;
        let [first, addresses] = take(&mut rest)?;
        if !matches!(first, NEXT_COMPRESSED | NEXT_IN_LINE) || addresses != SHORT_ADDRESSES {
            return None;
        }
        if first == NEXT_IN_LINE && take(&mut rest)? != [ICMPV6] {
            return None;
        }
        let [hop_limit, s0, s1, d0, d1] = take(&mut rest)?;
        let (source, destination) = (of_short([s0, s1]), of_short([d0, d1]));
        let mut is_compressed = first == NEXT_COMPRESSED;
        let (mut option, mut route) = (None, None);
        while is_compressed {
            let [kind] = take(&mut rest)?;
            if kind == UDP {
                break;
            }
            is_compressed = kind & 1 != 0;
            if !is_compressed && take(&mut rest)? != [ICMPV6] {
                return None;
            }
            match kind | 1 {
                HOP_BY_HOP => option = Some(read_option(&mut rest)?),
                ROUTING => route = Some(read_route(&mut rest)?),
                _ => return None,
            }
        }
        let content = if is_compressed {
            let [_, _, _, _, _, _, high, low] = take(&mut rest)?;
            Content::Data(u16::from_be_bytes([high, low]))
        } else {
            Content::Message(Message::read(rest)?)
        };
        Some(Self { source, destination, hop_limit, option, route, content })
    }
}

fn read_option(rest: &mut &[u8]) -> Option<RplOption> {
    let [length, kind, size, flags, _, high, low] = take(rest)?;
    let direction = if flags & DOWN != 0 { Direction::Down } else { Direction::Up };
    let met = if flags & RANK_ERROR != 0 { OptionFlags::RankError } else { OptionFlags::None };
    let option = RplOption { direction, flags: met, sender_rank: Rank(u16::from_be_bytes([high, low])) };
    ((length, [kind, size]) == (6, OPTION)).then_some(option)
}

fn read_route(rest: &mut &[u8]) -> Option<SourceRoute> {
    let [length, kind, left, _, pad, _, _] = take(rest)?;
    let (pad, length) = (usize::from(pad >> 4), usize::from(length));
    let stations = length.checked_sub(6 + pad)? / 2;
    if kind != TYPE_SOURCE_ROUTE || usize::from(left) > stations {
        return None;
    }
    let stations = (0..stations).map(|_| take(rest).map(of_short)).collect::<Option<Vec<_>>>()?;
    *rest = rest.get(pad..)?;
    Some(SourceRoute { stations, left })
}

#[cfg(test)]
mod tests;
