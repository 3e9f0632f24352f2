//! Files of classic pcap (IETF draft draft-ietf-opsawg-pcap), written and read: packets of one link type.

use sextant_kernel::SimTime;

use super::error::CaptureError;
use super::frame::{CaptureEnd, CaptureRecord, SNAP_LENGTH};
use super::parts::{LONGEST, Parts};

/// Magic number of a file with timestamps in microseconds.
pub(super) const MICROSECONDS: u32 = 0xA1B2_C3D4;
/// Magic number of a file with timestamps in nanoseconds.
pub(super) const NANOSECONDS: u32 = 0xA1B2_3C4D;
/// Version, major and minor.
const VERSION: [u16; 2] = [2, 4];

/// Appends the start of a file whose records have the type `link`, and whose timestamps are nanoseconds.
pub(super) fn write_header(link: u16, file: &mut Vec<u8>) {
    let [major, minor] = VERSION;
    file.extend(NANOSECONDS.to_le_bytes());
    file.extend(major.to_le_bytes());
    file.extend(minor.to_le_bytes());
    // Time zone and accuracy of the timestamps, which are always zero.
    file.extend([0; 8]);
    file.extend(SNAP_LENGTH.to_le_bytes());
    file.extend(u32::from(link).to_le_bytes());
}

/// Appends a packet that was captured at `stamp`.
pub(super) fn write_packet(stamp: SimTime, record: &[u8], file: &mut Vec<u8>) {
    let octets = u32::try_from(record.len()).expect("a frame and its header are short");
    let since_start = stamp - SimTime::ZERO;
    // A timestamp cannot hold more than 136 years.
    file.extend(u32::try_from(since_start.as_secs()).unwrap_or(u32::MAX).to_le_bytes());
    file.extend(since_start.subsec_nanos().to_le_bytes());
    // Captured length and original length.
    file.extend(octets.to_le_bytes());
    file.extend(octets.to_le_bytes());
    file.extend(record);
}

/// The packets of a pcap file after its magic number, with times in units of so many nanoseconds.
pub(super) fn frames<E: From<CaptureError>>(
    mut source: Parts<'_>,
    nanoseconds: u64,
    visit: &mut dyn FnMut(CaptureRecord<'_>) -> Result<(), E>,
) -> Result<CaptureEnd, E> {
    if !source.fill(20)? {
        return Ok(CaptureEnd::Truncated);
    }
    // The upper half tells whether frames have a check sequence, for links where they may have none.
    let [low, high] = source.u32(16).to_le_bytes().first_chunk().copied().unwrap_or_default();
    let link = u16::from_le_bytes([low, high]);
    while !source.is_at_end()? {
        if !source.fill(16)? {
            return Ok(CaptureEnd::Truncated);
        }
        let [seconds, fraction, captured, original] = [0, 4, 8, 12].map(|at| source.u32(at));
        if captured > LONGEST {
            return Err(source.damaged(format!("a packet of {captured} octets; allowed: at most {LONGEST}")).into());
        }
        if !source.fill(captured as usize)? {
            return Ok(CaptureEnd::Truncated);
        }
        let time = SimTime::from_nanos(u64::from(seconds) * 1_000_000_000 + u64::from(fraction) * nanoseconds);
        visit(CaptureRecord { time: Some(time), link, octets: &source.octets, is_cut: captured < original })?;
    }
    Ok(CaptureEnd::Whole)
}
