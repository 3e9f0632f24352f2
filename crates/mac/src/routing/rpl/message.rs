//! The messages of RPL, to the octet (RFC 6550, 6; ICMPv6 type 155).
//!
//! | message | octets | of which |
//! | --- | --- | --- |
//! | DIO | 76 | ICMPv6 4, base 24 (6.3), configuration 16 (6.7.6), prefix 32 (6.7.10) |
//! | DIS | 6 | ICMPv6 4, base 2 (6.2) |
//! | DAO to the root | 50 | ICMPv6 4, base 4 (6.4), target 20 (6.7.7), transit with a parent 22 (6.7.8) |
//! | DAO to the parent | 34 | the same, transit without a parent 6 |
//! | DAO-ACK | 8 | ICMPv6 4, base 4 (6.5) |
//!
//! A message to neighbours has a header of IPv6 of 4 octets to all and of 3 to one, compressed by RFC 6282: addresses are those
//! of the frame. The checksum is zero.

use sextant_kernel::StationId;

use super::address::{PREFIX, of_whole, take, whole};
use super::rank::Rank;

const ICMP_RPL: u8 = 155;
const CODE_DIS: u8 = 0;
const CODE_DIO: u8 = 1;
const CODE_DAO: u8 = 2;
const CODE_DAO_ACK: u8 = 3;

/// The next header of ICMPv6.
pub(super) const ICMPV6: u8 = 58;

/// The first version of a tree (RFC 6550, 7.2).
const VERSION: u8 = 240;
const ASKS_FOR_ANSWER: u8 = 0x80;
const OPTION_CONFIGURATION: u8 = 4;
const OPTION_TARGET: u8 = 5;
const OPTION_TRANSIT: u8 = 6;
const OPTION_PREFIX: u8 = 8;
/// The unit of lifetimes (s).
const LIFETIME_UNIT_S: u16 = 60;
const REJECTED: u8 = 128;

/// A message of RPL.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Message {
    /// Who hears it should tell its rank.
    Dis,
    /// A station tells its rank.
    Dio(Dio),
    /// A station can be reached.
    Dao(Dao),
    /// The answer to that.
    DaoAck(DaoAck),
}

/// A station tells its rank (DODAG information object).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dio {
    /// The root of its tree.
    pub root: StationId,
    /// Its rank.
    pub rank: Rank,
    /// A greater number than the last one asks those below to register again (DTSN).
    pub dtsn: u8,
}

/// What all DIOs of a tree say beside that.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DioConfiguration {
    /// Mode of operation.
    pub mode: u8,
    /// Doublings of the interval of DIOs.
    pub doublings: u8,
    /// The shortest interval of DIOs is 2 to this number of milliseconds.
    pub interval_min: u8,
    /// How many DIOs of others make one superfluous.
    pub redundancy: u8,
    /// Limit of the rank.
    pub max_rank_increase: u16,
    /// Least increase of the rank.
    pub min_hop_rank_increase: u16,
    /// Number of the objective function.
    pub objective: u16,
    /// How long ways down last (min).
    pub lifetime_min: u8,
}

/// A station can be reached (destination advertisement object).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dao {
    /// The station.
    pub target: StationId,
    /// Its parent, if the root should know it.
    pub parent: Option<StationId>,
    /// How long (min); zero if it can no longer be reached by way of the sender.
    pub lifetime_min: u8,
    /// Number of the message.
    pub number: u8,
    /// Whether an answer should come.
    pub asks: bool,
}

/// The answer to a DAO.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DaoAck {
    /// Number of the message.
    pub number: u8,
    /// What became of it.
    pub status: DaoStatus,
}

/// What became of a DAO.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DaoStatus {
    /// The way is known now.
    Accepted,
    /// There was no room for it.
    Rejected,
}

impl Message {
    /// Adds it to `octets`.
    pub(super) fn write(&self, configuration: &DioConfiguration, octets: &mut Vec<u8>) {
        match self {
            Self::Dis => octets.extend([ICMP_RPL, CODE_DIS, 0, 0, 0, 0]),
            Self::Dio(dio) => dio.write(configuration, octets),
            Self::Dao(dao) => dao.write(octets),
            Self::DaoAck(DaoAck { number, status }) => {
                let status = if *status == DaoStatus::Accepted { 0 } else { REJECTED };
                octets.extend([ICMP_RPL, CODE_DAO_ACK, 0, 0, 0, 0, *number, status]);
            }
        }
    }

    /// Reads a message.
    pub(super) fn read(octets: &[u8]) -> Option<Self> {
        let mut rest = octets;
        let [icmp, code, _, _] = take(&mut rest)?;
        if icmp != ICMP_RPL {
            return None;
        }
        match code {
            CODE_DIS => take::<2>(&mut rest).map(|_| Self::Dis),
            CODE_DIO => {
                let [_, _, high, low, _, dtsn, _, _] = take(&mut rest)?;
                let root = of_whole(take(&mut rest)?)?;
                Some(Self::Dio(Dio { root, rank: Rank(u16::from_be_bytes([high, low])), dtsn }))
            }
            CODE_DAO => {
                let [_, flags, _, number] = take(&mut rest)?;
                let [_, _, _, _] = take(&mut rest)?;
                let target = of_whole(take(&mut rest)?)?;
                let [_, length, _, _, _, lifetime_min] = take(&mut rest)?;
                let parent = if length == 20 { Some(of_whole(take(&mut rest)?)?) } else { None };
                let asks = flags & ASKS_FOR_ANSWER != 0;
                Some(Self::Dao(Dao { target, parent, lifetime_min, number, asks }))
            }
            CODE_DAO_ACK => {
                let [_, _, number, status] = take(&mut rest)?;
                let status = if status < REJECTED { DaoStatus::Accepted } else { DaoStatus::Rejected };
                Some(Self::DaoAck(DaoAck { number, status }))
            }
            _ => None,
        }
    }
}

impl Dio {
    fn write(&self, configuration: &DioConfiguration, octets: &mut Vec<u8>) {
        let &DioConfiguration { mode, doublings, interval_min, redundancy, lifetime_min, .. } = configuration;
        octets.extend([ICMP_RPL, CODE_DIO, 0, 0, 0, VERSION]);
        octets.extend(self.rank.0.to_be_bytes());
        octets.extend([mode << 3, self.dtsn, 0, 0]);
        octets.extend(whole(self.root));
        octets.extend([OPTION_CONFIGURATION, 14, 0, doublings, interval_min, redundancy]);
        octets.extend(configuration.max_rank_increase.to_be_bytes());
        octets.extend(configuration.min_hop_rank_increase.to_be_bytes());
        octets.extend(configuration.objective.to_be_bytes());
        octets.extend([0, lifetime_min]);
        octets.extend(LIFETIME_UNIT_S.to_be_bytes());
        // The prefix, for addresses of one's own, for ever.
        octets.extend([OPTION_PREFIX, 30, 64, 0x40]);
        octets.extend([0xFF; 8]);
        octets.extend([0; 4]);
        octets.extend(PREFIX);
    }
}

impl Dao {
    fn write(&self, octets: &mut Vec<u8>) {
        let flags = if self.asks { ASKS_FOR_ANSWER } else { 0 };
        octets.extend([ICMP_RPL, CODE_DAO, 0, 0, 0, flags, 0, self.number]);
        octets.extend([OPTION_TARGET, 18, 0, 128]);
        octets.extend(whole(self.target));
        let length = if self.parent.is_some() { 20 } else { 4 };
        octets.extend([OPTION_TRANSIT, length, 0, 0, 0, self.lifetime_min]);
        octets.extend(self.parent.map(whole).iter().flatten());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::routing::rpl::frame::{RplFrame, local_octets};

    const CONFIGURATION: DioConfiguration = DioConfiguration {
        mode: 1,
        doublings: 8,
        interval_min: 12,
        redundancy: 0,
        max_rank_increase: 2048,
        min_hop_rank_increase: 256,
        objective: 1,
        lifetime_min: 30,
    };

    fn written(message: &Message, to: Option<StationId>) -> Vec<u8> {
        let mut octets = vec![1];
        local_octets(message, to, &CONFIGURATION, &mut octets);
        octets
    }

    #[test]
    fn messages_have_the_sizes_of_their_parts_and_are_read_back() {
        let one = Some(StationId(3));
        let dao = Dao { target: StationId(5), parent: one, lifetime_min: 30, number: 7, asks: true };
        let ack = DaoAck { number: 7, status: DaoStatus::Rejected };
        for (message, to, octets) in [
            (Message::Dis, None, 4 + 6),
            (Message::Dis, one, 3 + 6),
            (Message::Dio(Dio { root: StationId(0x0203), rank: Rank(0x1234), dtsn: 9 }), None, 4 + 76),
            (Message::Dao(dao), one, 3 + 50),
            (Message::Dao(Dao { parent: None, asks: false, lifetime_min: 0, ..dao }), one, 3 + 34),
            (Message::DaoAck(ack), one, 3 + 8),
            (Message::DaoAck(DaoAck { status: DaoStatus::Accepted, ..ack }), one, 3 + 8),
        ] {
            let written = written(&message, to);
            assert_eq!(written.len(), octets, "{message:?}");
            assert_eq!(RplFrame::read(&written), Some(RplFrame::Local(message)));
            for end in 0..octets.min(30) {
                assert_ne!(RplFrame::read(&written[..end]), Some(RplFrame::Local(message)), "{end} octets");
            }
        }
    }

    #[test]
    fn a_dio_says_what_its_tree_is_made_by() {
        let octets = written(&Message::Dio(Dio { root: StationId(1), rank: Rank(256), dtsn: 0 }), None);
        assert_eq!(octets[..4], [0x7B, 0x3B, 58, 0x1A], "to ff02::1a, and ICMPv6");
        assert_eq!(octets[4..16], [155, 1, 0, 0, 0, 240, 1, 0, 8, 0, 0, 0]);
        assert_eq!(octets[32..48], [4, 14, 0, 8, 12, 0, 8, 0, 1, 0, 0, 1, 0, 30, 0, 60]);
    }
}
