//! The file around the records: classic pcap for one link type, pcapng for two.

use sextant_kernel::SimTime;

/// Magic number of a pcap file with timestamps in nanoseconds.
const NANOSECOND_MAGIC: u32 = 0xA1B2_3C4D;
/// Version of classic pcap, major and minor.
const VERSION: [u16; 2] = [2, 4];
/// Maximum length of a record (octets).
const SNAP_LENGTH: u32 = 65_535;

/// Types of the blocks of pcapng (draft-ietf-opsawg-pcapng, section 4).
mod block {
    pub(super) const SECTION_HEADER: u32 = 0x0A0D_0D0A;
    pub(super) const INTERFACE_DESCRIPTION: u32 = 1;
    pub(super) const ENHANCED_PACKET: u32 = 6;
}
/// Tells the order of octets in a section.
const BYTE_ORDER_MAGIC: u32 = 0x1A2B_3C4D;
/// Version of pcapng, major and minor.
const NG_VERSION: [u16; 2] = [1, 0];
/// Option of an interface: timestamps count 10^-n seconds.
const IF_TSRESOL: u16 = 9;

/// Type of the records of a link, by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub(super) enum LinkType {
    /// LINKTYPE_IEEE802_15_4_TAP: each frame has a header with data of the receiver.
    Tap = 283,
    /// LINKTYPE_IEEE802_11_RADIOTAP: the same for IEEE 802.11.
    Radiotap = 127,
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
            Self::Ieee802154 => classic_header(LinkType::Tap, file),
            Self::Ieee80211ad => classic_header(LinkType::Radiotap, file),
            Self::Both => {
                let [major, minor] = NG_VERSION;
                write_block(block::SECTION_HEADER, file, |body| {
                    body.extend(BYTE_ORDER_MAGIC.to_le_bytes());
                    body.extend(major.to_le_bytes());
                    body.extend(minor.to_le_bytes());
                    // The length of the section is not given.
                    body.extend(u64::MAX.to_le_bytes());
                });
                for link in [LinkType::Tap, LinkType::Radiotap] {
                    write_block(block::INTERFACE_DESCRIPTION, file, |body| {
                        body.extend((link as u16).to_le_bytes());
                        body.extend([0; 2]);
                        body.extend(SNAP_LENGTH.to_le_bytes());
                        body.extend(IF_TSRESOL.to_le_bytes());
                        body.extend(1_u16.to_le_bytes());
                        // Nanoseconds, padding, end of the options.
                        body.extend([9, 0, 0, 0, 0, 0, 0, 0]);
                    });
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
        let octets = u32::try_from(record.len()).expect("a frame and its header are short");
        if self != Self::Both {
            let since_start = stamp - SimTime::ZERO;
            // A timestamp cannot hold more than 136 years.
            file.extend(u32::try_from(since_start.as_secs()).unwrap_or(u32::MAX).to_le_bytes());
            file.extend(since_start.subsec_nanos().to_le_bytes());
            // Captured length and original length.
            file.extend(octets.to_le_bytes());
            file.extend(octets.to_le_bytes());
            file.extend(record);
            return;
        }
        write_block(block::ENHANCED_PACKET, file, |body| {
            body.extend(interface.to_le_bytes());
            // Most significant half first.
            let [low, high] = halves(stamp.as_nanos());
            body.extend(high.to_le_bytes());
            body.extend(low.to_le_bytes());
            body.extend(octets.to_le_bytes());
            body.extend(octets.to_le_bytes());
            body.extend(record);
            body.extend(std::iter::repeat_n(0, record.len().next_multiple_of(4) - record.len()));
        });
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

fn classic_header(link: LinkType, file: &mut Vec<u8>) {
    let [major, minor] = VERSION;
    file.extend(NANOSECOND_MAGIC.to_le_bytes());
    file.extend(major.to_le_bytes());
    file.extend(minor.to_le_bytes());
    // Time zone and accuracy of the timestamps, which are always zero.
    file.extend([0; 8]);
    file.extend(SNAP_LENGTH.to_le_bytes());
    file.extend(u32::from(link as u16).to_le_bytes());
}

/// A block of pcapng: type, length, body, length again.
fn write_block(kind: u32, file: &mut Vec<u8>, body: impl FnOnce(&mut Vec<u8>)) {
    let start = file.len();
    file.extend(kind.to_le_bytes());
    file.extend([0; 4]);
    body(file);
    let length = u32::try_from(file.len() + 4 - start).expect("a block is short").to_le_bytes();
    file[start + 4..start + 8].copy_from_slice(&length);
    file.extend(length);
}

/// Low and high 32 bits.
fn halves(number: u64) -> [u32; 2] {
    let [a, b, c, d, e, f, g, h] = number.to_le_bytes();
    [u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([e, f, g, h])]
}
