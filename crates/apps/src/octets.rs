//! Numbers, places and stations as octets of a message. All numbers are little-endian.

use sextant_channel::Position;
use sextant_kernel::StationId;

/// Why octets are not a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MessageError {
    /// The message ends too early.
    #[error("the message has {octets} octets and ends within {part}")]
    Truncated {
        /// Its size (octets).
        octets: usize,
        /// Where it ends.
        part: &'static str,
    },
    /// Octets are left over.
    #[error("{0} octets follow the end of the message")]
    TooLong(usize),
    /// The version is another one.
    #[error("the message has version {0}; allowed: 1")]
    Version(u8),
    /// The kind is another one.
    #[error("the message has kind {found}; allowed: {allowed}")]
    Kind {
        /// The kind.
        found: u8,
        /// The kinds that there are, in words.
        allowed: &'static str,
    },
    /// A number is not finite.
    #[error("{0} is not finite")]
    NotFinite(&'static str),
}

/// Adds a number as IEEE 754 binary32.
#[expect(clippy::cast_possible_truncation, reason = "messages carry numbers as binary32")]
pub(crate) fn put(octets: &mut Vec<u8>, number: f64) {
    octets.extend((number as f32).to_le_bytes());
}

/// Adds a place: x, y and z.
pub(crate) fn put_place(octets: &mut Vec<u8>, place: Position) {
    [place.x_m, place.y_m, place.z_m].into_iter().for_each(|axis_m| put(octets, axis_m));
}

/// Adds the number of a station.
pub(crate) fn put_station(octets: &mut Vec<u8>, station: StationId) {
    octets.extend(station.0.to_le_bytes());
}

/// Reads a message from its start to its end. In each method, `part` names in the error what was read.
pub(crate) struct Reader<'a> {
    rest: &'a [u8],
    /// Size of the whole message.
    octets: usize,
}

impl<'a> Reader<'a> {
    pub(crate) fn new(octets: &'a [u8]) -> Self {
        Self { rest: octets, octets: octets.len() }
    }

    /// Number of octets that are not read.
    pub(crate) fn left(&self) -> usize {
        self.rest.len()
    }

    /// Refuses octets that are not read.
    pub(crate) fn end(&self) -> Result<(), MessageError> {
        if self.rest.is_empty() { Ok(()) } else { Err(MessageError::TooLong(self.rest.len())) }
    }

    /// The next octets.
    pub(crate) fn take<const N: usize>(&mut self, part: &'static str) -> Result<[u8; N], MessageError> {
        let (&head, rest) =
            self.rest.split_first_chunk().ok_or(MessageError::Truncated { octets: self.octets, part })?;
        self.rest = rest;
        Ok(head)
    }

    /// An integer of 16 bits.
    pub(crate) fn u16(&mut self, part: &'static str) -> Result<u16, MessageError> {
        Ok(u16::from_le_bytes(self.take(part)?))
    }

    /// An integer of 32 bits.
    pub(crate) fn u32(&mut self, part: &'static str) -> Result<u32, MessageError> {
        Ok(u32::from_le_bytes(self.take(part)?))
    }

    /// A number as IEEE 754 binary32.
    pub(crate) fn number(&mut self, part: &'static str) -> Result<f64, MessageError> {
        let number = f32::from_le_bytes(self.take(part)?);
        if number.is_finite() { Ok(number.into()) } else { Err(MessageError::NotFinite(part)) }
    }

    /// The number of a station.
    pub(crate) fn station(&mut self, part: &'static str) -> Result<StationId, MessageError> {
        Ok(StationId(self.u32(part)?))
    }

    /// A place: x, y and z.
    pub(crate) fn place(&mut self, part: &'static str) -> Result<Position, MessageError> {
        Ok(Position::new(self.number(part)?, self.number(part)?, self.number(part)?))
    }
}
