//! Messages of the 6top protocol (6P), by which two neighbours agree on cells (RFC 8480).
//!
//! ```
//! use sextant_mac::tsch::{CellPlace, SixP, SixPBody, SixPCommand};
//!
//! let cell = CellPlace { timeslot: 7, channel_offset: 3 };
//! let request = SixP { sequence: 5, body: SixPBody::Request(SixPCommand::Add { candidates: vec![cell] }) };
//! let mut octets = Vec::new();
//! request.write(&mut octets);
//! // Version 0 and a request, ADD, function 0 (MSF), sequence number; metadata, a cell to send in, one of them, and the list.
//! assert_eq!(octets, [0x00, 1, 0, 5, 0, 0, 1, 1, 7, 0, 3, 0]);
//! assert_eq!(SixP::read(&octets), Some(request));
//! ```

use super::CellOptions;

/// The scheduling function MSF (RFC 9033, section 7).
const MSF: u8 = 0;

/// Type of a message, above the four bits of the version.
const REQUEST: u8 = 0;
const RESPONSE: u8 = 1 << 4;

/// The place of a cell in a slotframe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellPlace {
    /// The slot in which it is, from 0.
    pub timeslot: u16,
    /// What its channel has beyond the number of the slot.
    pub channel_offset: u16,
}

/// What a station asks of a neighbour. Cells are those in which it sends to the neighbour.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SixPCommand {
    /// One more cell, among these.
    Add {
        /// The cells that suit it.
        candidates: Vec<CellPlace>,
    },
    /// This cell is given up.
    Delete {
        /// The cell.
        cell: CellPlace,
    },
    /// A cell is replaced by one among others.
    Relocate {
        /// The cell.
        cell: CellPlace,
        /// The cells that suit it.
        candidates: Vec<CellPlace>,
    },
    /// All cells between the two are given up.
    Clear,
}

/// What the neighbour answers (RFC 8480, section 6.2.4), as far as it is used here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReturnCode {
    /// It is done as the list of cells says, which may be empty.
    Success,
    /// It failed for another reason.
    Error,
    /// The sequence number is not the next one: the schedules may differ.
    SequenceError,
    /// A cell is not in the schedule.
    CellListError,
    /// Another transaction between the two is under way.
    Busy,
}

impl ReturnCode {
    const ALL: [(Self, u8); 5] =
        [(Self::Success, 0), (Self::Error, 2), (Self::SequenceError, 6), (Self::CellListError, 7), (Self::Busy, 8)];

    fn number(self) -> u8 {
        Self::ALL.into_iter().find(|(code, _)| *code == self).map_or(0, |(_, number)| number)
    }

    /// Codes that are not used here count as errors.
    fn of_number(number: u8) -> Self {
        Self::ALL.into_iter().find(|(_, known)| *known == number).map_or(Self::Error, |(code, _)| code)
    }
}

/// The content of a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SixPBody {
    /// The first message of a transaction.
    Request(SixPCommand),
    /// The second and last one.
    Response {
        /// Whether it is done.
        code: ReturnCode,
        /// The cells that are added or deleted, or the one that replaces another.
        cells: Vec<CellPlace>,
    },
}

/// A message of the 6top protocol.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SixP {
    /// The number of the transaction between the two stations.
    pub sequence: u8,
    /// What it says.
    pub body: SixPBody,
}

impl SixPCommand {
    const fn number(&self) -> u8 {
        match self {
            Self::Add { .. } => 1,
            Self::Delete { .. } => 2,
            Self::Relocate { .. } => 3,
            Self::Clear => 7,
        }
    }
}

impl SixP {
    /// Replaces the content of `octets` with the message (RFC 8480, section 3.2).
    pub fn write(&self, octets: &mut Vec<u8>) {
        octets.clear();
        let (kind, code) = match &self.body {
            SixPBody::Request(command) => (REQUEST, command.number()),
            SixPBody::Response { code, .. } => (RESPONSE, code.number()),
        };
        octets.extend([kind, code, MSF, self.sequence]);
        match &self.body {
            SixPBody::Request(command) => {
                // The metadata is not used by MSF.
                octets.extend([0, 0]);
                let one = [CellOptions::TRANSMIT.bits(), 1];
                match command {
                    SixPCommand::Add { candidates } => {
                        octets.extend(one);
                        write_cells(candidates, octets);
                    }
                    SixPCommand::Delete { cell } => {
                        octets.extend(one);
                        write_cells(&[*cell], octets);
                    }
                    SixPCommand::Relocate { cell, candidates } => {
                        octets.extend(one);
                        write_cells(&[*cell], octets);
                        write_cells(candidates, octets);
                    }
                    SixPCommand::Clear => {}
                }
            }
            SixPBody::Response { cells, .. } => write_cells(cells, octets),
        }
    }

    /// Reads a message; `None` if it is another one than [`SixP::write`] makes.
    #[must_use]
    pub fn read(octets: &[u8]) -> Option<Self> {
        let (&[kind, code, function, sequence], rest) = octets.split_first_chunk()?;
        if function != MSF {
            return None;
        }
        let body = match kind {
            REQUEST => {
                let (_metadata, rest) = rest.split_first_chunk::<2>()?;
                SixPBody::Request(read_command(code, rest)?)
            }
            RESPONSE => SixPBody::Response { code: ReturnCode::of_number(code), cells: read_cells(rest)? },
            _ => return None,
        };
        Some(Self { sequence, body })
    }
}

fn read_command(code: u8, rest: &[u8]) -> Option<SixPCommand> {
    if code == SixPCommand::Clear.number() {
        return rest.is_empty().then_some(SixPCommand::Clear);
    }
    let (&[options, count], rest) = rest.split_first_chunk()?;
    if CellOptions::of_bits(options) != CellOptions::TRANSMIT || count != 1 {
        return None;
    }
    let mut cells = read_cells(rest)?;
    match code {
        1 => Some(SixPCommand::Add { candidates: cells }),
        2 => Some(SixPCommand::Delete { cell: cells.pop().filter(|_| cells.is_empty())? }),
        3 if !cells.is_empty() => Some(SixPCommand::Relocate { cell: cells.remove(0), candidates: cells }),
        _ => None,
    }
}

fn write_cells(cells: &[CellPlace], octets: &mut Vec<u8>) {
    for cell in cells {
        octets.extend(cell.timeslot.to_le_bytes());
        octets.extend(cell.channel_offset.to_le_bytes());
    }
}

fn read_cells(octets: &[u8]) -> Option<Vec<CellPlace>> {
    let (cells, rest) = octets.as_chunks::<4>();
    let cell = |&[a, b, c, d]: &[u8; 4]| CellPlace {
        timeslot: u16::from_le_bytes([a, b]),
        channel_offset: u16::from_le_bytes([c, d]),
    };
    rest.is_empty().then(|| cells.iter().map(cell).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(timeslot: u16) -> CellPlace {
        CellPlace { timeslot, channel_offset: timeslot % 16 }
    }

    #[test]
    fn messages_go_there_and_back_with_the_sizes_of_the_standard() {
        let list: Vec<CellPlace> = (300..305).map(cell).collect();
        let request = SixPBody::Request;
        for (body, size) in [
            (request(SixPCommand::Add { candidates: list.clone() }), 4 + 4 + 20),
            (request(SixPCommand::Delete { cell: cell(9) }), 4 + 4 + 4),
            (request(SixPCommand::Relocate { cell: cell(9), candidates: list.clone() }), 4 + 4 + 4 + 20),
            (request(SixPCommand::Clear), 4 + 2),
            (SixPBody::Response { code: ReturnCode::Success, cells: vec![cell(9)] }, 4 + 4),
            (SixPBody::Response { code: ReturnCode::SequenceError, cells: Vec::new() }, 4),
        ] {
            let message = SixP { sequence: 200, body };
            let mut octets = Vec::new();
            message.write(&mut octets);
            assert_eq!(octets.len(), size, "{message:?}");
            assert_eq!(SixP::read(&octets), Some(message));
        }
    }

    #[test]
    fn other_octets_are_refused() {
        for octets in [
            &[][..],
            &[0, 1, 0],
            // Another function, another version, another command.
            &[0, 1, 1, 5, 0, 0, 1, 1],
            &[1, 1, 0, 5, 0, 0, 1, 1],
            &[0, 4, 0, 5, 0, 0, 1, 1],
            // A half cell, two cells to delete, a cell to receive in.
            &[0, 1, 0, 5, 0, 0, 1, 1, 7, 0],
            &[0, 2, 0, 5, 0, 0, 1, 1, 7, 0, 3, 0, 8, 0, 3, 0],
            &[0, 1, 0, 5, 0, 0, 2, 1, 7, 0, 3, 0],
        ] {
            assert_eq!(SixP::read(octets), None, "{octets:?}");
        }
    }
}
