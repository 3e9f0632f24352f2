//! Captures of any sniffer, read frame by frame.
//!
//! Crates for these formats were tried: pcap-parser 0.17 takes a time resolution that is a power of two for an unknown one,
//! and reads the time offset of a file in the other byte order wrongly.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use sextant_kernel::seen;

use super::error::CaptureError;
use super::frame::{CaptureEnd, CaptureRecord};
use super::parts::Parts;
use super::pcap;
use super::pcapng::{SECTION, Sections};

/// Whether the file `path` begins as a capture does.
#[must_use]
pub fn is_capture(path: &Path) -> bool {
    let mut magic = [0; 4];
    let read = File::open(path).and_then(|mut file| file.read_exact(&mut magic));
    let known = [pcap::MICROSECONDS, pcap::NANOSECONDS, SECTION];
    read.is_ok() && (known.contains(&u32::from_le_bytes(magic)) || known.contains(&u32::from_be_bytes(magic)))
}

/// Calls `visit` with each frame of the capture `path`, with one in memory.
///
/// # Errors
/// If the file cannot be read, is no capture or is damaged; or the error of `visit`.
pub fn read_capture<E: From<CaptureError>>(
    path: &Path,
    visit: &mut dyn FnMut(CaptureRecord<'_>) -> Result<(), E>,
) -> Result<CaptureEnd, E> {
    let mut source = Parts::open(path)?;
    let not_capture = || CaptureError::NotCapture { path: path.to_owned(), seen: seen(path) };
    if !source.fill(4)? {
        return Err(not_capture().into());
    }
    if source.octets == SECTION.to_le_bytes() {
        return Sections::new(source).frames(visit);
    }
    for is_big_endian in [false, true] {
        source.is_big_endian = is_big_endian;
        let nanoseconds = match source.u32(0) {
            pcap::MICROSECONDS => 1000,
            pcap::NANOSECONDS => 1,
            _ => continue,
        };
        return pcap::frames(source, nanoseconds, visit);
    }
    Err(not_capture().into())
}
