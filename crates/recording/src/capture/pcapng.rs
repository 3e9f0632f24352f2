//! Files of pcapng (IETF draft draft-ietf-opsawg-pcapng), written and read: sections of blocks.

use sextant_kernel::SimTime;

use super::error::CaptureError;
use super::frame::{CaptureEnd, CaptureRecord, SNAP_LENGTH};
use super::parts::{LONGEST, Parts};

/// The type of the first block, the same in both byte orders, and what follows it.
pub(super) const SECTION: u32 = 0x0A0D_0D0A;
/// Tells the order of octets in a section.
const BYTE_ORDER: u32 = 0x1A2B_3C4D;
/// Version of pcapng, major and minor.
const VERSION: [u16; 2] = [1, 0];

/// Types of blocks (section 4).
mod block {
    pub(super) const INTERFACE: u32 = 1;
    pub(super) const PACKET: u32 = 2;
    pub(super) const SIMPLE_PACKET: u32 = 3;
    pub(super) const ENHANCED_PACKET: u32 = 6;
}

/// Options of an interface.
const TIME_RESOLUTION: u16 = 9;
const TIME_OFFSET: u16 = 14;

/// Appends the start of a section.
pub(super) fn write_section(file: &mut Vec<u8>) {
    let [major, minor] = VERSION;
    write_block(SECTION, file, |body| {
        body.extend(BYTE_ORDER.to_le_bytes());
        body.extend(major.to_le_bytes());
        body.extend(minor.to_le_bytes());
        // The length of the section is not given.
        body.extend(u64::MAX.to_le_bytes());
    });
}

/// Appends the description of an interface whose records have the type `link`, and whose timestamps are nanoseconds.
pub(super) fn write_interface(link: u16, file: &mut Vec<u8>) {
    write_block(block::INTERFACE, file, |body| {
        body.extend(link.to_le_bytes());
        body.extend([0; 2]);
        body.extend(SNAP_LENGTH.to_le_bytes());
        body.extend(TIME_RESOLUTION.to_le_bytes());
        body.extend(1_u16.to_le_bytes());
        // Nanoseconds, padding, end of the options.
        body.extend([9, 0, 0, 0, 0, 0, 0, 0]);
    });
}

/// Appends a packet of an interface, which was captured at `stamp`.
pub(super) fn write_packet(interface: u32, stamp: SimTime, record: &[u8], file: &mut Vec<u8>) {
    let octets = u32::try_from(record.len()).expect("a frame and its header are short");
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

/// An interface of a pcapng file.
#[derive(Clone, Copy, Debug)]
struct Interface {
    link: u16,
    snap_length: u32,
    /// Time units per second.
    resolution: u128,
    offset_s: i64,
}

/// A pcapng file: sections of blocks.
pub(super) struct Sections<'p> {
    source: Parts<'p>,
    interfaces: Vec<Interface>,
}

impl<'p> Sections<'p> {
    /// The file after the type of its first block.
    pub(super) const fn new(source: Parts<'p>) -> Self {
        Self { source, interfaces: Vec::new() }
    }

    /// The frames, after the type of the first block.
    pub(super) fn frames<E: From<CaptureError>>(
        mut self,
        visit: &mut dyn FnMut(CaptureRecord<'_>) -> Result<(), E>,
    ) -> Result<CaptureEnd, E> {
        loop {
            // The octets hold the type of a block.
            let is_section = self.source.octets == SECTION.to_le_bytes();
            let kind = self.source.u32(0);
            if !self.source.fill(4)? {
                return Ok(CaptureEnd::Truncated);
            }
            let mut length_octets = self.source.octets.clone();
            if is_section {
                if !self.source.fill(4)? {
                    return Ok(CaptureEnd::Truncated);
                }
                self.interfaces.clear();
                self.source.is_big_endian = self.source.octets == BYTE_ORDER.to_be_bytes();
                if self.source.u32(0) != BYTE_ORDER {
                    return Err(self.source.damaged("a section without its byte order".to_owned()).into());
                }
            }
            std::mem::swap(&mut self.source.octets, &mut length_octets);
            let length = self.source.u32(0);
            let read = if is_section { 12 } else { 8 };
            if !length.is_multiple_of(4) || length < read + 4 || length > LONGEST {
                let problem = format!("a block of {length} octets; allowed: a multiple of 4, from 12 to {LONGEST}");
                return Err(self.source.damaged(problem).into());
            }
            if !self.source.fill((length - read) as usize)? {
                return Ok(CaptureEnd::Truncated);
            }
            let body = (length - read - 4) as usize;
            let repeated = self.source.u32(body);
            if repeated != length {
                let problem = format!("a block of {length} octets that ends with the length {repeated}");
                return Err(self.source.damaged(problem).into());
            }
            match kind {
                block::INTERFACE if !is_section => {
                    let interface = self.interface(body)?;
                    self.interfaces.push(interface);
                }
                block::ENHANCED_PACKET | block::PACKET | block::SIMPLE_PACKET if !is_section => {
                    visit(self.packet(kind, body)?)?;
                }
                _ => {}
            }
            if self.source.is_at_end()? {
                return Ok(CaptureEnd::Whole);
            }
            if !self.source.fill(4)? {
                return Ok(CaptureEnd::Truncated);
            }
        }
    }

    /// The description of an interface, of `body` octets.
    fn interface(&self, body: usize) -> Result<Interface, CaptureError> {
        let source = &self.source;
        if body < 8 {
            return Err(source.damaged("an interface without its link type".to_owned()));
        }
        let mut interface =
            Interface { link: source.u16(0), snap_length: source.u32(4), resolution: 1_000_000, offset_s: 0 };
        let mut at = 8;
        while at + 4 <= body {
            let (code, length) = (source.u16(at), usize::from(source.u16(at + 2)));
            let Some(value) = source.octets[..body].get(at + 4..at + 4 + length) else {
                return Err(source.damaged("an option of an interface that is longer than its block".to_owned()));
            };
            match (code, value) {
                (0, _) => break,
                (TIME_RESOLUTION, &[resolution]) => {
                    let base: u128 = if resolution & 0x80 == 0 { 10 } else { 2 };
                    interface.resolution = base.checked_pow(u32::from(resolution & 0x7F)).ok_or_else(|| {
                        source.damaged(format!("an interface with the time resolution {resolution:#04x}"))
                    })?;
                }
                (TIME_OFFSET, value) => {
                    if let Ok(octets) = value.try_into() {
                        interface.offset_s = match source.is_big_endian {
                            true => i64::from_be_bytes(octets),
                            false => i64::from_le_bytes(octets),
                        };
                    }
                }
                _ => {}
            }
            at += 4 + length.next_multiple_of(4);
        }
        Ok(interface)
    }

    /// The frame of a block of type `kind` with `body` octets.
    fn packet(&self, kind: u32, body: usize) -> Result<CaptureRecord<'_>, CaptureError> {
        let source = &self.source;
        let header = if kind == block::SIMPLE_PACKET { 4 } else { 20 };
        if body < header {
            return Err(source.damaged("a packet without its header".to_owned()));
        }
        let number = match kind {
            block::SIMPLE_PACKET => 0,
            block::PACKET => u32::from(source.u16(0)),
            _ => source.u32(0),
        };
        let interface = usize::try_from(number).ok().and_then(|number| self.interfaces.get(number));
        let interface = interface
            .ok_or_else(|| source.damaged(format!("a packet of interface {number}, which is not described")))?;
        let (time, captured, original) = if kind == block::SIMPLE_PACKET {
            let original = source.u32(0);
            let limit = if interface.snap_length == 0 { u32::MAX } else { interface.snap_length };
            (None, original.min(limit), original)
        } else {
            let ticks = u128::from(source.u32(4)) << 32 | u128::from(source.u32(8));
            (Some(self.time(interface, ticks)?), source.u32(12), source.u32(16))
        };
        let octets = source.octets[header..body].get(..captured as usize).ok_or_else(|| {
            source.damaged(format!("a packet of {captured} octets in a block of {} octets", body + 12))
        })?;
        Ok(CaptureRecord { time, link: interface.link, octets, is_cut: captured < original })
    }

    fn time(&self, interface: &Interface, ticks: u128) -> Result<SimTime, CaptureError> {
        let (seconds, rest) = (ticks / interface.resolution, ticks % interface.resolution);
        // Below 2^64 ticks, so the product fits, except for resolutions that no clock has.
        let nanos = rest.checked_mul(1_000_000_000).map_or(0, |nanos| nanos / interface.resolution);
        let total = i128::try_from(seconds).ok().and_then(|seconds| {
            let seconds = seconds + i128::from(interface.offset_s);
            u64::try_from(seconds.checked_mul(1_000_000_000)? + i128::try_from(nanos).ok()?).ok()
        });
        total.map(SimTime::from_nanos).ok_or_else(|| {
            self.source
                .damaged(format!("a packet at {seconds} s plus {} s; allowed: from 1970 to 2554", interface.offset_s))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A block of pcapng in this byte order.
    fn block(is_big_endian: bool, kind: u32, body: &[u8]) -> Vec<u8> {
        let number = |value: u32| if is_big_endian { value.to_be_bytes() } else { value.to_le_bytes() };
        let length = number(u32::try_from(body.len()).unwrap() + 12);
        [&number(kind)[..], &length, body, &length].concat()
    }

    fn times_of(octets: &[u8]) -> Vec<(u16, Option<u64>, Vec<u8>)> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), octets).unwrap();
        let mut found = Vec::new();
        let mut source = Parts::open(file.path()).unwrap();
        assert_eq!(source.fill(4), Ok(true));
        let end = Sections::new(source).frames::<CaptureError>(&mut |frame| {
            found.push((frame.link, frame.time.map(SimTime::as_nanos), frame.octets.to_vec()));
            Ok(())
        });
        assert_eq!(end, Ok(CaptureEnd::Whole));
        found
    }

    #[test]
    fn each_interface_has_its_resolution_and_offset_in_both_byte_orders() {
        for is_big_endian in [false, true] {
            let u16_of = |value: u16| if is_big_endian { value.to_be_bytes() } else { value.to_le_bytes() };
            let u32_of = |value: u32| if is_big_endian { value.to_be_bytes() } else { value.to_le_bytes() };
            let offset: i64 = 1_000_000_000;
            let offset = if is_big_endian { offset.to_be_bytes() } else { offset.to_le_bytes() };
            let section = [&u32_of(BYTE_ORDER)[..], &u16_of(1), &u16_of(0), &[0xFF; 8]].concat();
            let interface = |link: u16, options: &[&[u8]]| {
                block(is_big_endian, 1, &[&u16_of(link)[..], &[0, 0], &u32_of(0), &options.concat()].concat())
            };
            let binary =
                interface(195, &[&u16_of(9), &u16_of(1), &[0x80 | 10, 0, 0, 0], &u16_of(14), &u16_of(8), &offset]);
            let nanoseconds = interface(230, &[&u16_of(9), &u16_of(1), &[9, 0, 0, 0], &u16_of(0), &u16_of(0)]);
            let usual = interface(127, &[]);
            let packet = |number: u32, ticks: u64, octets: &[u8; 4]| {
                let [low, high] =
                    [u32::try_from(ticks & 0xFFFF_FFFF), u32::try_from(ticks >> 32)].map(Result::unwrap);
                let words = [number, high, low, 4, 4].map(u32_of).concat();
                block(is_big_endian, 6, &[&words[..], octets].concat())
            };
            let file = [
                block(is_big_endian, SECTION, &section),
                binary,
                nanoseconds,
                usual,
                packet(0, 5 * 1024 + 512, b"half"),
                // A block of an unknown type is skipped.
                block(is_big_endian, 0x0BAD, &[1; 8]),
                packet(1, 1_700_000_000_123_456_789, b"nano"),
                packet(2, 1_700_000_000_123_456, b"usec"),
                // A simple packet has no time.
                block(is_big_endian, 3, &[&u32_of(4)[..], b"none"].concat()),
                // A new section in the other byte order knows no interfaces of the old one.
                block(!is_big_endian, SECTION, &{
                    let mut other = section.clone();
                    other[..4].reverse();
                    other
                }),
            ];
            let expected = [
                (195, Some(1_000_000_005_500_000_000), b"half".to_vec()),
                (230, Some(1_700_000_000_123_456_789), b"nano".to_vec()),
                (127, Some(1_700_000_000_123_456_000), b"usec".to_vec()),
                (195, None, b"none".to_vec()),
            ];
            assert_eq!(times_of(&file.concat()), expected);
        }
    }

    #[test]
    fn an_impossible_time_is_damage() {
        let interface = Interface { link: 195, snap_length: 0, resolution: 1, offset_s: -10 };
        let file = tempfile::NamedTempFile::new().unwrap();
        let source = Parts::open(file.path()).unwrap();
        let sections = Sections { source, interfaces: vec![interface] };
        assert_eq!(sections.time(&interface, 10), Ok(SimTime::ZERO));
        assert!(sections.time(&interface, 9).is_err());
        assert!(sections.time(&interface, 1 << 40).is_err());
    }
}
