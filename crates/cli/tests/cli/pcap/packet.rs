//! An independent reader of pcap and TAP headers, based on the specifications and not on the writer.

use std::collections::BTreeMap;

/// A record of a capture.
#[derive(Debug, PartialEq)]
pub(crate) struct Packet {
    /// Timestamp (ns).
    pub(crate) stamp_ns: u64,
    /// Values of the TAP header by type, without padding.
    pub(crate) fields: BTreeMap<u16, Vec<u8>>,
    pub(crate) mpdu: Vec<u8>,
}

/// Removes `count` octets from the front.
fn take<'a>(octets: &mut &'a [u8], count: usize) -> &'a [u8] {
    let (head, rest) = octets.split_at_checked(count).expect("the file is complete");
    *octets = rest;
    head
}

fn number(octets: &[u8]) -> u64 {
    octets.iter().rev().fold(0, |sum, &octet| sum << 8 | u64::from(octet))
}

fn size(octets: &[u8]) -> usize {
    usize::try_from(number(octets)).expect("it fits")
}

/// Reads all packets of a capture.
pub(crate) fn read(file: &[u8]) -> Vec<Packet> {
    let mut rest = file;
    let header = take(&mut rest, 24);
    assert_eq!(number(&header[..4]), 0xA1B2_3C4D, "nanoseconds, little-endian");
    assert_eq!((number(&header[4..6]), number(&header[6..8])), (2, 4), "version");
    assert_eq!(number(&header[20..24]), 283, "IEEE 802.15.4 TAP");
    let mut packets = Vec::new();
    while !rest.is_empty() {
        let head = take(&mut rest, 16);
        let nanos = number(&head[4..8]);
        assert!(nanos < 1_000_000_000);
        let captured = size(&head[8..12]);
        assert_eq!(captured, size(&head[12..16]), "nothing was cut");
        let mut record = take(&mut rest, captured);
        assert_eq!(record[..2], [0, 0], "version of the TAP header");
        let header_octets = size(&record[2..4]);
        let mut tap = take(&mut record, header_octets);
        take(&mut tap, 4);
        let mut fields = BTreeMap::new();
        while !tap.is_empty() {
            let head = take(&mut tap, 4);
            let length = size(&head[2..]);
            let value = take(&mut tap, length).to_vec();
            let padding = take(&mut tap, length.div_ceil(4) * 4 - length);
            assert!(padding.iter().all(|&octet| octet == 0));
            assert_eq!(fields.insert(u16::try_from(number(&head[..2])).unwrap(), value), None, "once each");
        }
        let stamp_ns = number(&head[..4]) * 1_000_000_000 + nanos;
        packets.push(Packet { stamp_ns, fields, mpdu: record.to_vec() });
    }
    packets
}

impl Packet {
    fn value(&self, field: u16) -> Option<&[u8]> {
        self.fields.get(&field).map(Vec::as_slice)
    }

    pub(crate) fn rss_dbm(&self) -> Option<f32> {
        self.value(1).map(|value| f32::from_le_bytes(value.try_into().expect("four octets")))
    }

    /// Channel number and page.
    pub(crate) fn channel(&self) -> (u64, u8) {
        let value = self.value(3).expect("a channel");
        assert_eq!(value.len(), 3);
        (number(&value[..2]), value[2])
    }

    /// Start of the first symbol and end of the last one (ns).
    pub(crate) fn span_ns(&self) -> (u64, u64) {
        let [start, end] = [5, 6].map(|field| self.value(field).expect("a stamp"));
        assert_eq!((start.len(), end.len()), (8, 8));
        (number(start), number(end))
    }

    pub(crate) fn link_quality(&self) -> Option<u8> {
        self.value(10).map(|value| value[0])
    }

    /// Type of the frame, from its control field.
    pub(crate) fn kind(&self) -> u8 {
        self.mpdu[0] & 7
    }

    pub(crate) fn sequence(&self) -> u8 {
        self.mpdu[2]
    }

    /// Whether the last two octets are the check sequence of the others, computed bit by bit as in the standard.
    pub(crate) fn has_good_fcs(&self) -> bool {
        let (covered, check) = self.mpdu.split_last_chunk::<2>().expect("a frame has a check sequence");
        let mut register = 0_u16;
        for bit in covered.iter().flat_map(|octet| (0..8).map(move |shift| u16::from(octet >> shift & 1))) {
            let feedback = register & 1 ^ bit;
            register = register >> 1 ^ if feedback == 1 { 0x8408 } else { 0 };
        }
        u16::from_le_bytes(*check) == register && self.value(0) == Some(&[1])
    }
}
