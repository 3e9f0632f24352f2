//! A file that is read in parts, in one of two byte orders.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

use super::error::CaptureError;

/// Maximum length of a packet or block (octets). A damaged length is detected before memory is allocated.
pub(super) const LONGEST: u32 = 1 << 24;

/// A file that is read in parts.
pub(super) struct Parts<'p> {
    path: &'p Path,
    input: BufReader<File>,
    /// Octets read.
    at_byte: u64,
    pub(super) is_big_endian: bool,
    /// The last part.
    pub(super) octets: Vec<u8>,
}

impl<'p> Parts<'p> {
    /// The start of the file `path`.
    pub(super) fn open(path: &'p Path) -> Result<Self, CaptureError> {
        let file = File::open(path).map_err(|why| CaptureError::read(path, &why))?;
        Ok(Self { path, input: BufReader::new(file), at_byte: 0, is_big_endian: false, octets: Vec::new() })
    }

    /// Reads the next `count` octets. Returns whether there were so many.
    pub(super) fn fill(&mut self, count: usize) -> Result<bool, CaptureError> {
        self.octets.resize(count, 0);
        match self.input.read_exact(&mut self.octets) {
            Ok(()) => {
                self.at_byte += count as u64;
                Ok(true)
            }
            Err(why) if why.kind() == io::ErrorKind::UnexpectedEof => Ok(false),
            Err(why) => Err(CaptureError::read(self.path, &why)),
        }
    }

    pub(super) fn is_at_end(&mut self) -> Result<bool, CaptureError> {
        self.input.fill_buf().map(<[u8]>::is_empty).map_err(|why| CaptureError::read(self.path, &why))
    }

    pub(super) fn u16(&self, at: usize) -> u16 {
        let octets = [self.octets[at], self.octets[at + 1]];
        if self.is_big_endian { u16::from_be_bytes(octets) } else { u16::from_le_bytes(octets) }
    }

    pub(super) fn u32(&self, at: usize) -> u32 {
        let octets = [0, 1, 2, 3].map(|offset| self.octets[at + offset]);
        if self.is_big_endian { u32::from_be_bytes(octets) } else { u32::from_le_bytes(octets) }
    }

    pub(super) fn damaged(&self, problem: String) -> CaptureError {
        CaptureError::Damaged { path: self.path.to_owned(), at_byte: self.at_byte, problem }
    }
}
