//! What can be read of a damaged file: the pieces before, between and behind its damage.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use mcap::records::{Record, op};
use mcap::{McapError, parse_record};
use serde::Serialize;

use super::{Chunks, LONGEST_RECORD, McapFileError, Piece, Scan, Shown, cause, each_record};

/// A part of a file that cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Gap {
    /// Where it begins in the file (octets).
    pub from_byte: u64,
    /// Where it ends (octets).
    pub to_byte: u64,
    /// Time of the last message before it (ns); absent if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from_ns: Option<u64>,
    /// Time of the first message behind it (ns); absent if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to_ns: Option<u64>,
    /// What is wrong there.
    pub why: String,
}

/// What is found in a damaged file, in its order.
pub(crate) enum Salvaged<'a> {
    /// A piece.
    Piece(Piece<'a>),
    /// Pieces are missing here.
    Gap(&'a Gap),
}

/// Calls `visit` with each piece of the file `path` that can be read, and with the gaps between them. Damaged chunks are skipped. Where
/// the lengths of records are damaged, it goes on at the next record that is whole. Schemas and channels of a
/// lost chunk are taken from the end of the file. The file was read until octet `sound_until` before: up to there, records may be of
/// unknown kinds, and longer than their fields.
///
/// # Errors
/// If the file cannot be read, or the first error of `visit`.
pub(crate) fn salvage<E: From<McapFileError>>(
    path: &Path,
    sound_until: u64,
    visit: &mut dyn FnMut(Salvaged<'_>) -> Result<(), E>,
) -> Result<Vec<Gap>, E> {
    let failed = |why: io::Error| E::from(McapFileError::Read { path: path.to_owned(), why: why.to_string() });
    let mut records = Records::open(path, sound_until).map_err(failed)?;
    let mut state = Scan::default();
    let summary = records.summary().map_err(failed)?;
    // What is wrong in it is not needed.
    let _ = each_record::<E>(&summary, &mut |opcode, record| match record {
        Record::Schema { .. } | Record::Channel(_) => state.show(record, opcode, &mut |_| Ok(())),
        _ => Ok(Ok(())),
    })?;
    let mut chunks = Chunks::new();
    let mut gaps = Gaps::default();
    while let Some(step) = records.step().map_err(failed)? {
        let Step { from_byte, found } = step;
        let why = match found {
            Ok((op::DATA_END, _)) => break,
            Ok((opcode, data)) => {
                let mut take = |piece: Piece<'_>| {
                    if let Piece::Message { header, .. } = &piece {
                        if let Some(gap) = gaps.close(Some(header.log_time)) {
                            visit(Salvaged::Gap(gap))?;
                        }
                        gaps.last_ns = Some(header.log_time);
                    }
                    visit(Salvaged::Piece(piece))
                };
                let mut unknown = Ok(());
                let mut show = |opcode, record: Record<'_>| -> Shown<E> {
                    match state.show(record, opcode, &mut take)? {
                        Err(why @ (McapError::UnknownChannel(..) | McapError::UnknownSchema(..))) => {
                            unknown = Err(why);
                            Ok(Ok(()))
                        }
                        shown => Ok(shown),
                    }
                };
                let shown = match opcode {
                    op::CHUNK => chunks.records(&data, &mut show)?,
                    _ => match parse_record(opcode, &data) {
                        Ok(record) => show(opcode, record)?,
                        Err(why) => Err(why),
                    },
                };
                match shown.and(unknown) {
                    Ok(()) => continue,
                    Err(why) => cause(&why),
                }
            }
            Err(why) => why.to_owned(),
        };
        chunks = Chunks::new();
        gaps.add(from_byte, records.at, why);
    }
    if let Some(gap) = gaps.close(None) {
        visit(Salvaged::Gap(gap))?;
    }
    Ok(gaps.found)
}

/// The gaps that were found.
#[derive(Default)]
struct Gaps {
    found: Vec<Gap>,
    /// Whether no message followed the last one yet.
    is_open: bool,
    last_ns: Option<u64>,
}

impl Gaps {
    /// Adds a gap. It is one with that before it if no message is between them.
    fn add(&mut self, from_byte: u64, to_byte: u64, why: String) {
        match self.found.last_mut() {
            Some(last) if self.is_open => last.to_byte = to_byte,
            _ => self.found.push(Gap { from_byte, to_byte, from_ns: self.last_ns, to_ns: None, why }),
        }
        self.is_open = true;
    }

    /// The open gap, which ends with a message of this time.
    fn close(&mut self, to_ns: Option<u64>) -> Option<&Gap> {
        let gap = self.found.last_mut().filter(|_| std::mem::take(&mut self.is_open))?;
        gap.to_ns = to_ns;
        Some(gap)
    }
}

/// The records of a file, outside of chunks.
struct Records {
    file: BufReader<File>,
    length: u64,
    /// Where the next record begins (octets).
    at: u64,
    /// Until where the file was read before (octets).
    sound_until: u64,
}

/// A record, or a part of the file that has none.
struct Step {
    from_byte: u64,
    /// The kind and content of the record; why there is none.
    found: Found,
}

type Found = Result<(u8, Vec<u8>), &'static str>;

/// Octets of a record before its content: its kind, and the length of the content.
const HEAD: usize = 9;

/// Octets of the content in which the lengths of its fields stand.
const FIELDS: u64 = 1 << 12;

/// So much of a file is searched at once (octets).
const BLOCK: u64 = 1 << 16;

/// Octets at the end of a file: the last record and the mark.
const FOOTER: usize = HEAD + 20;
const TAIL: usize = FOOTER + mcap::MAGIC.len();

impl Records {
    fn open(path: &Path, sound_until: u64) -> io::Result<Self> {
        let file = File::open(path)?;
        let length = file.metadata()?.len();
        Ok(Self { file: BufReader::new(file), length, at: mcap::MAGIC.len() as u64, sound_until })
    }

    /// The octets from `at` on, at most so many.
    fn octets(&mut self, at: u64, most: u64) -> io::Result<Vec<u8>> {
        self.file.seek(SeekFrom::Start(at))?;
        let mut octets = Vec::new();
        self.file.by_ref().take(most).read_to_end(&mut octets)?;
        Ok(octets)
    }

    /// The next record, or what is unreadable before it; `None` at the end of the file.
    fn step(&mut self) -> io::Result<Option<Step>> {
        let from_byte = self.at;
        if from_byte >= self.length {
            return Ok(None);
        }
        let found = self.record(from_byte)?;
        self.at = match &found {
            Ok((_, data)) => from_byte + (HEAD + data.len()) as u64,
            Err(_) => self.next_whole(from_byte + 1)?,
        };
        Ok(Some(Step { from_byte, found }))
    }

    /// The record that begins at `from`, if the lengths in it agree.
    fn record(&mut self, from: u64) -> io::Result<Found> {
        let start = self.octets(from, HEAD as u64 + FIELDS)?;
        let Some((opcode, length, fields)) = head(&start) else { return Ok(Err(ENDS)) };
        if length > self.length - from - HEAD as u64 {
            return Ok(Err(ENDS));
        }
        let is_sound = from + HEAD as u64 + length < self.sound_until && length <= LONGEST_RECORD as u64;
        if !is_sound && !agrees(opcode, fields, length) {
            return Ok(Err("the length of a record is not that of its content"));
        }
        Ok(Ok((opcode, self.octets(from + HEAD as u64, length)?)))
    }

    /// Where the next record begins whose lengths agree: a chunk, an attachment, metadata, or the end of the data.
    fn next_whole(&mut self, from: u64) -> io::Result<u64> {
        let mut start = from;
        loop {
            let block = self.octets(start, BLOCK)?;
            for (place, octets) in (start..).zip(block.windows(HEAD)) {
                let Some((op::CHUNK | op::ATTACHMENT | op::METADATA | op::DATA_END, length, _)) = head(octets) else {
                    continue;
                };
                let is_within = length <= self.length - place - HEAD as u64;
                if is_within && self.record(place)?.is_ok() {
                    return Ok(place);
                }
            }
            if (block.len() as u64) < BLOCK {
                return Ok(self.length);
            }
            start += (block.len() - HEAD + 1) as u64;
        }
    }

    /// The records at the end of the file, which repeat schemas and channels; nothing if they are not sound.
    fn summary(&mut self) -> io::Result<Vec<u8>> {
        let nothing = Ok(Vec::new());
        let Some(end) = self.length.checked_sub(TAIL as u64) else { return nothing };
        let tail = self.octets(end, TAIL as u64)?;
        let Some((op::FOOTER, 20, fields)) = head(&tail) else { return nothing };
        let (Some((start, rest)), true) = (fields.split_first_chunk(), tail.ends_with(mcap::MAGIC)) else {
            return nothing;
        };
        let start = u64::from_le_bytes(*start);
        let Some(length) = end.checked_sub(start).filter(|length| *length <= LONGEST_RECORD as u64) else {
            return nothing;
        };
        let octets = self.octets(start, length)?;
        // Behind the place of another part of the summary.
        let saved = rest.get(8..).and_then(|rest| rest.first_chunk()).map_or(0, |saved| u32::from_le_bytes(*saved));
        let mut hasher = crc32fast::Hasher::new();
        hasher.update(&octets);
        hasher.update(&tail[..FOOTER - 4]);
        if saved != 0 && saved != hasher.finalize() { nothing } else { Ok(octets) }
    }
}

const ENDS: &str = "the file ends in the middle of a record, or the length of a record is damaged";

/// The kind of the record that begins `octets`, the length of its content, and what is there of the content.
fn head(octets: &[u8]) -> Option<(u8, u64, &[u8])> {
    let (&opcode, rest) = octets.split_first()?;
    let (length, fields) = rest.split_first_chunk()?;
    Some((opcode, u64::from_le_bytes(*length), fields))
}

/// A field of a record.
enum Field {
    /// So many octets.
    Fixed(u64),
    /// A length in four octets, and so many octets.
    Short,
    /// A length in eight octets, and so many octets.
    Long,
}

/// Whether the fields of a record fill its `length` (the MCAP format, version 0).
fn agrees(opcode: u8, octets: &[u8], length: u64) -> bool {
    use Field::{Fixed, Long, Short};
    let fields: &[Field] = match opcode {
        op::HEADER | op::METADATA => &[Short, Short],
        op::SCHEMA => &[Fixed(2), Short, Short, Short],
        op::CHANNEL => &[Fixed(4), Short, Short, Short],
        op::MESSAGE => return length >= 22,
        op::CHUNK => &[Fixed(28), Short, Long],
        op::MESSAGE_INDEX => &[Fixed(2), Short],
        op::ATTACHMENT => &[Fixed(16), Short, Short, Long, Fixed(4)],
        op::DATA_END => &[Fixed(4)],
        _ => return false,
    };
    let mut at = 0_u64;
    for field in fields {
        let rest = || octets.get(usize::try_from(at).ok()?..);
        let size = match field {
            Fixed(size) => Some(*size),
            Short => rest().and_then(|rest| rest.first_chunk()).map(|size| 4 + u64::from(u32::from_le_bytes(*size))),
            Long => {
                rest().and_then(|rest| rest.first_chunk()).and_then(|size| u64::from_le_bytes(*size).checked_add(8))
            }
        };
        let Some(end) = size.and_then(|size| at.checked_add(size)) else { return false };
        at = end;
    }
    at == length && length <= LONGEST_RECORD as u64
}
