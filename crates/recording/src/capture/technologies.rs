//! The file around the records that are written: classic pcap for one link type, pcapng for two.

use sextant_kernel::SimTime;

use super::{link_type, pcap, pcapng};

/// Type of the records of a link, by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub(super) enum LinkType {
    /// LINKTYPE_IEEE802_15_4_TAP: each frame has a header with data of the receiver.
    Tap = link_type::TAP,
    /// LINKTYPE_IEEE802_11_RADIOTAP: the same for IEEE 802.11.
    Radiotap = link_type::RADIOTAP,
}

/// The technologies of the frames of a capture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Technologies {
    /// IEEE 802.15.4: classic pcap.
    Ieee802154,
    /// IEEE 802.11ad: classic pcap.
    Ieee80211ad,
    /// Both: a classic pcap file has one link type, so this is pcapng with two interfaces.
    Both,
}

impl Technologies {
    /// Number of the interface whose records have this type.
    ///
    /// # Panics
    /// If there is none.
    fn interface(self, link: LinkType) -> u32 {
        match (self, link) {
            (Self::Ieee802154 | Self::Both, LinkType::Tap) | (Self::Ieee80211ad, LinkType::Radiotap) => 0,
            (Self::Both, LinkType::Radiotap) => 1,
            _ => panic!("a capture of {self:?} has no frame of type {link:?}"),
        }
    }

    /// The start of the file.
    pub(super) fn header(self, file: &mut Vec<u8>) {
        match self {
            Self::Ieee802154 => pcap::write_header(LinkType::Tap as u16, file),
            Self::Ieee80211ad => pcap::write_header(LinkType::Radiotap as u16, file),
            Self::Both => {
                pcapng::write_section(file);
                for link in [LinkType::Tap, LinkType::Radiotap] {
                    pcapng::write_interface(link as u16, file);
                }
            }
        }
    }

    /// A record of this type with its timestamp.
    ///
    /// # Panics
    /// If no interface has this type.
    pub(super) fn record(self, link: LinkType, stamp: SimTime, record: &[u8], file: &mut Vec<u8>) {
        let interface = self.interface(link);
        match self {
            Self::Both => pcapng::write_packet(interface, stamp, record, file),
            Self::Ieee802154 | Self::Ieee80211ad => pcap::write_packet(stamp, record, file),
        }
    }
}

/// A simulation is shorter than this (s), and begins at time 0. The times of other captures count from 1970.
const LONGEST_SIMULATION_S: u64 = 100_000_000;

/// Whether a file that begins with the octets `head` is a capture of a simulation: it has a header of this program, and its
/// first frame is at a time of simulations.
pub(crate) fn is_of_simulation(head: &[u8]) -> bool {
    [Technologies::Ieee802154, Technologies::Ieee80211ad, Technologies::Both].into_iter().any(|technologies| {
        let mut header = Vec::new();
        technologies.header(&mut header);
        let number = |octets: &[u8]| octets.first_chunk().map(|octets| u64::from(u32::from_le_bytes(*octets)));
        match head.strip_prefix(header.as_slice()) {
            None => false,
            Some([]) => true,
            // Type, length and interface of the block come first, then the two halves of the time in nanoseconds.
            Some(record) if technologies == Technologies::Both => {
                let high = record.get(12..).and_then(number);
                high.is_some_and(|high| (high << 32) / 1_000_000_000 < LONGEST_SIMULATION_S)
            }
            Some(record) => number(record).is_some_and(|seconds| seconds < LONGEST_SIMULATION_S),
        }
    })
}
