//! The files of parts that are open, so that rows are read again from where they stand.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader, Read};
use std::sync::{Mutex, PoisonError};

use super::PartName;

/// So many files are open at once.
const MOST_OPEN: usize = 64;

/// What is read of a file at once (octets).
const BUFFER: usize = 1 << 16;

/// Where rows stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RowPlace {
    /// In which part.
    pub part: PartName,
    /// Where they begin in its file (octets).
    pub start: u64,
    /// How long they are (octets).
    pub length: usize,
}

/// The files of parts that are open.
#[derive(Debug, Default)]
pub(super) struct RowFiles(Mutex<BTreeMap<PartName, OpenFile>>);

#[derive(Debug)]
struct OpenFile {
    file: BufReader<File>,
    /// Where its next octet stands in the file.
    at: u64,
    /// Whether it stays open: another process may remove it.
    is_kept: bool,
}

impl RowFiles {
    /// Keeps the `file` of a part open, unless too many are. `at` is where its next octet stands.
    pub(super) fn keep(&self, part: PartName, file: File, at: u64) {
        let mut open = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if open.len() < MOST_OPEN {
            let file = BufReader::with_capacity(BUFFER, file);
            open.insert(part, OpenFile { file, at, is_kept: true });
        }
    }

    /// Adds the rows at `place` to `rows`. If the file is not open, `opened` opens it.
    pub(super) fn read(
        &self,
        place: RowPlace,
        opened: impl FnOnce() -> io::Result<File>,
        rows: &mut Vec<u8>,
    ) -> io::Result<()> {
        let mut open = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if !open.contains_key(&place.part) {
            if open.len() >= MOST_OPEN {
                open.retain(|_, file| file.is_kept);
            }
            let file = BufReader::with_capacity(BUFFER, opened()?);
            open.insert(place.part, OpenFile { file, at: 0, is_kept: false });
        }
        let Some(OpenFile { file, at, .. }) = open.get_mut(&place.part) else { return Ok(()) };
        file.seek_relative(place.start.cast_signed().wrapping_sub(at.cast_signed()))?;
        let begin = rows.len();
        rows.resize(begin + place.length, 0);
        let read = file.read_exact(&mut rows[begin..]);
        *at = place.start + place.length as u64;
        read
    }
}
