//! The file formats of captures: pcap and pcapng (IETF drafts draft-ietf-opsawg-pcap and draft-ietf-opsawg-pcapng).
//!
//! Crates for these formats were tried: pcap-parser 0.17 takes a time resolution that is a power of two for an unknown one,
//! and reads the time offset of a file in the other byte order wrongly.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use sextant_kernel::{SimTime, seen};

use super::captured::{Captured, End};
use super::parts::{LONGEST, Parts};
use super::pcapng::{SECTION, Sections};
use crate::error::sniffer_error::SnifferError;

/// Magic numbers of pcap: microseconds and nanoseconds.
const MICROSECONDS: u32 = 0xA1B2_C3D4;
const NANOSECONDS: u32 = 0xA1B2_3C4D;
/// Whether the file `path` begins as a capture does.
pub(super) fn is_capture(path: &Path) -> bool {
    let mut magic = [0; 4];
    let read = File::open(path).and_then(|mut file| file.read_exact(&mut magic));
    let known = [MICROSECONDS, NANOSECONDS, SECTION];
    read.is_ok() && (known.contains(&u32::from_le_bytes(magic)) || known.contains(&u32::from_be_bytes(magic)))
}

/// Calls `visit` with each frame of the capture `path`, with one in memory.
///
/// # Errors
/// If the file cannot be read, is no capture or is damaged; or the error of `visit`.
pub(super) fn frames<E: From<SnifferError>>(
    path: &Path,
    visit: &mut dyn FnMut(Captured<'_>) -> Result<(), E>,
) -> Result<End, E> {
    let mut source = Parts::open(path)?;
    let not_capture = || SnifferError::NotCapture { path: path.to_owned(), seen: seen(path) };
    if !source.fill(4)? {
        return Err(not_capture().into());
    }
    if source.octets == SECTION.to_le_bytes() {
        return Sections::new(source).frames(visit);
    }
    for is_big_endian in [false, true] {
        source.is_big_endian = is_big_endian;
        let nanoseconds = match source.u32(0) {
            MICROSECONDS => 1000,
            NANOSECONDS => 1,
            _ => continue,
        };
        return packets(source, nanoseconds, visit);
    }
    Err(not_capture().into())
}

/// The packets of a pcap file after its magic number, with times in units of so many nanoseconds.
fn packets<E: From<SnifferError>>(
    mut source: Parts<'_>,
    nanoseconds: u64,
    visit: &mut dyn FnMut(Captured<'_>) -> Result<(), E>,
) -> Result<End, E> {
    if !source.fill(20)? {
        return Ok(End::Truncated);
    }
    // The upper half tells whether frames have a check sequence, for links where they may have none.
    let [low, high] = source.u32(16).to_le_bytes().first_chunk().copied().unwrap_or_default();
    let link = u16::from_le_bytes([low, high]);
    while !source.is_at_end()? {
        if !source.fill(16)? {
            return Ok(End::Truncated);
        }
        let [seconds, fraction, captured, original] = [0, 4, 8, 12].map(|at| source.u32(at));
        if captured > LONGEST {
            return Err(source.damaged(format!("a packet of {captured} octets; allowed: at most {LONGEST}")).into());
        }
        if !source.fill(captured as usize)? {
            return Ok(End::Truncated);
        }
        let time = SimTime::from_nanos(u64::from(seconds) * 1_000_000_000 + u64::from(fraction) * nanoseconds);
        visit(Captured { time: Some(time), link, octets: &source.octets, is_cut: captured < original })?;
    }
    Ok(End::Whole)
}
