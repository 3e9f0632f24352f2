//! Reading a frame from its start.

use super::ParseError;

/// The rest of a frame.
pub(super) struct Cursor<'a> {
    rest: &'a [u8],
    /// Size of the whole frame, FCS included.
    octets: usize,
}

impl<'a> Cursor<'a> {
    /// The start of a frame without its FCS.
    pub(super) const fn new(covered: &'a [u8]) -> Self {
        Self { rest: covered, octets: covered.len() + 2 }
    }

    /// The next octets; `part` names them in the error.
    pub(super) fn take<const N: usize>(&mut self, part: &'static str) -> Result<[u8; N], ParseError> {
        let (&head, rest) =
            self.rest.split_first_chunk().ok_or(ParseError::Truncated { octets: self.octets, part })?;
        self.rest = rest;
        Ok(head)
    }

    pub(super) fn u8(&mut self, part: &'static str) -> Result<u8, ParseError> {
        self.take(part).map(u8::from_le_bytes)
    }

    pub(super) fn u16(&mut self, part: &'static str) -> Result<u16, ParseError> {
        self.take(part).map(u16::from_le_bytes)
    }

    pub(super) fn u64(&mut self, part: &'static str) -> Result<u64, ParseError> {
        self.take(part).map(u64::from_le_bytes)
    }

    /// All remaining octets.
    pub(super) fn rest(&mut self) -> &'a [u8] {
        std::mem::take(&mut self.rest)
    }
}
