//! What is appended to an unfinished part: blocks, each with a line before it that shows whether all of it is there.
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

/// The rows of all blocks up to the first that is not whole: a process that was killed or a power failure cut it off.
#[derive(Debug)]
pub(super) struct Blocks<R> {
    from: R,
    block: Vec<u8>,
    /// How much of the block was taken.
    taken: usize,
    is_over: bool,
    /// How long the work had taken at the last block (s).
    pub(super) wall_s: f64,
}

impl<R: BufRead> Blocks<R> {
    pub(super) fn new(from: R) -> Self {
        Self { from, block: Vec::new(), taken: 0, is_over: false, wall_s: 0.0 }
    }

    /// Reads the next block; whether there is one.
    fn advance(&mut self) -> io::Result<bool> {
        self.taken = 0;
        self.block.clear();
        let mut line = Vec::new();
        self.from.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut line)?;
        let Some((sum, line, length, wall_s)) = parsed(&line) else { return Ok(false) };
        self.from.by_ref().take(length).read_to_end(&mut self.block)?;
        let is_whole = self.block.len() as u64 == length && checksum(line, &self.block) == sum;
        if is_whole {
            self.wall_s = wall_s;
        } else {
            self.block.clear();
        }
        Ok(is_whole)
    }
}

/// The checksum on the line before a block, the rest of the line, and what this says.
fn parsed(line: &[u8]) -> Option<(u32, &str, u64, f64)> {
    let (sum, rest) = std::str::from_utf8(line).ok()?.split_once(',')?;
    let (length, wall_s) = rest.strip_suffix('\n')?.split_once(',')?;
    let length = length.parse().ok().filter(|length| *length <= LONGEST_BLOCK)?;
    Some((u32::from_str_radix(sum, 16).ok()?, rest, length, super::seconds(wall_s)?))
}

impl<R: BufRead> Read for Blocks<R> {
    fn read(&mut self, octets: &mut [u8]) -> io::Result<usize> {
        while self.taken == self.block.len() && !self.is_over {
            self.is_over = !self.advance()?;
        }
        let length = octets.len().min(self.block.len() - self.taken);
        octets[..length].copy_from_slice(&self.block[self.taken..self.taken + length]);
        self.taken += length;
        Ok(length)
    }
}
