//! What a part has: blocks, each with a line before it that shows whether all of it is there.
//!
//! The line has the CRC-32 of what follows on it and of the block, the length of the block (octets), and how long the work had
//! taken when it was written (s).

use std::io::{self, BufRead, Read};

/// The longest line before a block, and the longest block (octets); what is longer was not written here.
const LONGEST_LINE: u64 = 64;
const LONGEST_BLOCK: u64 = 1 << 28;

/// A block with these `rows`.
pub(super) fn block(rows: &[u8], wall_s: f64) -> Vec<u8> {
    let line = format!("{},{wall_s:.3}\n", rows.len());
    [format!("{:08x},", checksum(&line, rows)).as_bytes(), line.as_bytes(), rows].concat()
}

fn checksum(line: &str, rows: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(line.as_bytes());
    hasher.update(rows);
    hasher.finalize()
}

/// Rows that stand together in the file of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RowBlock<'a> {
    /// Where they begin in the file (octets).
    pub start: u64,
    /// Their text.
    pub rows: &'a [u8],
}

/// All blocks up to the first that is not whole: a process that was killed, a power failure or a full disk cut it off.
#[derive(Debug)]
pub(super) struct Blocks<R> {
    pub(super) from: R,
    /// Where the next block begins in the file (octets).
    at: u64,
    block: Vec<u8>,
    is_over: bool,
    /// How long the work had taken at the last block (s).
    pub(super) wall_s: f64,
}

impl<R: BufRead> Blocks<R> {
    /// Of what stands in the file from `at` on.
    pub(super) fn new(from: R, at: u64) -> Self {
        Self { from, at, block: Vec::new(), is_over: false, wall_s: 0.0 }
    }

    /// Reads the next block.
    pub(super) fn advance(&mut self) -> io::Result<Option<RowBlock<'_>>> {
        if self.is_over {
            return Ok(None);
        }
        self.block.clear();
        let mut line = Vec::new();
        self.from.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut line)?;
        let Some((sum, rest, length, wall_s)) = parsed(&line) else {
            self.is_over = true;
            return Ok(None);
        };
        self.from.by_ref().take(length).read_to_end(&mut self.block)?;
        if self.block.len() as u64 != length || checksum(rest, &self.block) != sum {
            self.is_over = true;
            return Ok(None);
        }
        self.wall_s = wall_s;
        let start = self.at + line.len() as u64;
        self.at = start + length;
        Ok(Some(RowBlock { start, rows: &self.block }))
    }
}

/// The checksum on the line before a block, the rest of the line, and what this says.
fn parsed(line: &[u8]) -> Option<(u32, &str, u64, f64)> {
    let (sum, rest) = std::str::from_utf8(line).ok()?.split_once(',')?;
    let (length, wall_s) = rest.strip_suffix('\n')?.split_once(',')?;
    let length = length.parse().ok().filter(|length| *length <= LONGEST_BLOCK)?;
    Some((u32::from_str_radix(sum, 16).ok()?, rest, length, super::seconds(wall_s)?))
}
