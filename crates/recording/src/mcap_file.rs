//! Reads an MCAP file from start to end, up to the first damage, with one chunk in memory.

pub(crate) mod salvage;

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use mcap::records::{MessageHeader, Metadata, Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{Channel, McapError, Schema, parse_record};
use serde::Serialize;
use sextant_kernel::seen;

/// Maximum length of a record or chunk (octets). A damaged length is detected before memory is allocated.
const LONGEST_RECORD: usize = 1 << 29;

/// Most octets that are asked for at once. A file that claims a longer record than it has takes no more memory than this.
const LONGEST_READ: usize = 1 << 16;

/// Why a file cannot be read as an MCAP file at all.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum McapFileError {
    /// The file cannot be opened or read.
    #[error("cannot read `{}`: {why}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's answer.
        why: String,
    },
    /// The file has no octet.
    #[error("`{}` is empty, so there is nothing to read or to recover; record or copy it again", .path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// The file is of another format.
    #[error("`{}` is not an MCAP file, but {seen}", .path.display())]
    NotMcap {
        /// The file.
        path: PathBuf,
        /// What it is.
        seen: String,
    },
}

/// What is wrong at the place of a damage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DamageKind {
    /// The file ends too early, as after a crash of the program that wrote it.
    Truncated,
    /// The octets are not those of a sound file.
    Corrupt,
}

/// Where and why a file cannot be read further.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Damage {
    /// What is wrong.
    #[serde(skip)]
    pub kind: DamageKind,
    /// Number of octets read.
    pub at_byte: u64,
    /// Messages before the damage.
    pub messages: u64,
    /// The error.
    pub why: String,
}

/// An element of a container.
pub enum Piece<'a> {
    /// The first record of the file.
    Header {
        /// The profile of the file, `ros2` for example.
        profile: &'a str,
        /// The library that wrote the file.
        library: &'a str,
    },
    /// A message.
    Message {
        /// Its channel, with the schema.
        channel: &'a Channel<'static>,
        /// Its sequence number and times.
        header: MessageHeader,
        /// Its encoded content.
        data: &'a [u8],
    },
    /// An attachment.
    Attachment {
        /// Its name.
        name: &'a str,
        /// Its media type.
        media_type: &'a str,
        /// Its content.
        data: &'a [u8],
    },
    /// A record of metadata.
    Metadata(&'a Metadata),
}

/// Whether the file `path` begins as an MCAP file does.
#[must_use]
pub fn is_mcap(path: &Path) -> bool {
    let mut magic = [0; mcap::MAGIC.len()];
    File::open(path).and_then(|mut file| file.read_exact(&mut magic)).is_ok() && magic == *mcap::MAGIC
}

/// Calls `visit` with each piece of the file `path`, in order. Messages of a chunk that is incomplete or has a wrong
/// checksum are skipped. Returns the damage that ended the reading, if any.
///
/// # Errors
/// If the file cannot be read, is empty or is of another format, or the first error of `visit`.
pub fn scan<E: From<McapFileError>>(
    path: &Path,
    visit: &mut dyn FnMut(Piece<'_>) -> Result<(), E>,
) -> Result<Option<Damage>, E> {
    let unreadable = |why: String| E::from(McapFileError::Read { path: path.to_owned(), why });
    let failed = |why: std::io::Error| unreadable(why.to_string());
    let file = File::open(path).map_err(failed)?;
    let metadata = file.metadata().map_err(failed)?;
    if metadata.is_dir() {
        return Err(unreadable("it is a folder; a recording is one file (MCAP)".to_owned()));
    }
    if metadata.is_file() && metadata.len() == 0 {
        return Err(McapFileError::Empty { path: path.to_owned() }.into());
    }
    let mut source = BufReader::new(file);
    let options = LinearReaderOptions::default()
        .with_emit_chunks(true)
        .with_validate_data_section_crc(true)
        .with_validate_summary_section_crc(true)
        .with_record_length_limit(LONGEST_RECORD);
    let mut reader = LinearReader::new_with_options(options);
    let mut chunks = Chunks::new();
    let mut state = Scan::default();
    let mut at_byte = 0_u64;
    while let Some(event) = reader.next_event() {
        let step = match event {
            Ok(LinearReadEvent::ReadRequest(need)) => {
                let read = loop {
                    match source.read(reader.insert(need.min(LONGEST_READ))) {
                        Err(why) if why.kind() == std::io::ErrorKind::Interrupted => {}
                        answer => break answer.map_err(failed)?,
                    }
                };
                reader.notify_read(read);
                at_byte += read as u64;
                Ok(())
            }
            Ok(LinearReadEvent::Record { opcode: op::CHUNK, data }) => {
                chunks.records(data, &mut |opcode, record| state.show(record, opcode, visit))?
            }
            Ok(LinearReadEvent::Record { opcode, data }) => match parse_record(opcode, data) {
                Ok(record) => state.show(record, opcode, visit)?,
                Err(why) => Err(why),
            },
            Err(McapError::BadMagic) if state.messages == 0 && !state.begun => {
                return Err(McapFileError::NotMcap { path: path.to_owned(), seen: seen(path) }.into());
            }
            Err(why) => Err(why),
        };
        if let Err(why) = step {
            let kind = match why {
                McapError::UnexpectedEof => DamageKind::Truncated,
                _ => DamageKind::Corrupt,
            };
            let why = match why {
                McapError::UnexpectedEof => "it ends in the middle of a record".to_owned(),
                McapError::UnexpectedEoc => "a chunk ends in the middle of a record".to_owned(),
                McapError::RecordTooLarge { len, .. } | McapError::ChunkTooLarge(len) => {
                    format!("the length of a record is {len} octets; allowed: at most {LONGEST_RECORD}")
                }
                why => cause(&why),
            };
            return Ok(Some(Damage { kind, at_byte, messages: state.messages, why }));
        }
    }
    Ok(None)
}

/// Reads the records in chunks.
///
/// The reader of the crate (0.26) does not check that a record ends within its chunk if the chunk is not compressed: a
/// damaged length makes it panic or read the rest of the file as records of the chunk. So such chunks are read here.
struct Chunks {
    /// Reads compressed chunks, one after the other.
    compressed: LinearReader,
}

/// What becomes of a record: the inner error is damage; the outer one ends the reading.
type Shown<E> = Result<Result<(), McapError>, E>;

impl Chunks {
    fn new() -> Self {
        let options = LinearReaderOptions::default()
            .with_skip_start_magic(true)
            .with_skip_end_magic(true)
            .with_prevalidate_chunk_crcs(true)
            .with_record_length_limit(LONGEST_RECORD);
        Self { compressed: LinearReader::new_with_options(options) }
    }

    /// Calls `show` with each record of the chunk `data`, if its checksum is right.
    fn records<E>(&mut self, data: &[u8], show: &mut dyn FnMut(u8, Record<'_>) -> Shown<E>) -> Shown<E> {
        let (header, records) = match parse_record(op::CHUNK, data) {
            Ok(Record::Chunk { header, data: records }) => (header, records),
            Ok(_) => return Ok(Ok(())),
            Err(why) => return Ok(Err(why)),
        };
        if !header.compression.is_empty() {
            return self.decompressed(data, show);
        }
        let (saved, calculated) = (header.uncompressed_crc, crc32fast::hash(&records));
        if saved != 0 && saved != calculated {
            return Ok(Err(McapError::BadChunkCrc { saved, calculated }));
        }
        each_record(&records, show)
    }

    fn decompressed<E>(&mut self, data: &[u8], show: &mut dyn FnMut(u8, Record<'_>) -> Shown<E>) -> Shown<E> {
        let length = (data.len() as u64).to_le_bytes();
        let start = [&[op::CHUNK][..], &length].concat();
        let mut parts = [start.as_slice(), data];
        while let Some(event) = self.compressed.next_event() {
            let shown = match event {
                Ok(LinearReadEvent::ReadRequest(need)) => {
                    let Some(part) = parts.iter_mut().find(|part| !part.is_empty()) else { break };
                    let (now, later) = part.split_at(need.min(part.len()));
                    self.compressed.insert(now.len())[..now.len()].copy_from_slice(now);
                    self.compressed.notify_read(now.len());
                    *part = later;
                    Ok(())
                }
                Ok(LinearReadEvent::Record { opcode, data }) => match parse_record(opcode, data) {
                    Ok(record) => show(opcode, record)?,
                    Err(why) => Err(why),
                },
                Err(why) => Err(why),
            };
            if let Err(why) = shown {
                return Ok(Err(why));
            }
        }
        Ok(Ok(()))
    }
}

/// Calls `show` with each of the records that follow one another in `rest`.
fn each_record<E>(mut rest: &[u8], show: &mut dyn FnMut(u8, Record<'_>) -> Shown<E>) -> Shown<E> {
    while let Some((&opcode, tail)) = rest.split_first() {
        let Some((&length, tail)) = tail.split_first_chunk() else { return Ok(Err(McapError::UnexpectedEoc)) };
        let length = usize::try_from(u64::from_le_bytes(length)).ok();
        let Some((record, tail)) = length.and_then(|length| tail.split_at_checked(length)) else {
            return Ok(Err(McapError::UnexpectedEoc));
        };
        rest = tail;
        match parse_record(opcode, record) {
            Ok(record) => {
                if let Err(why) = show(opcode, record)? {
                    return Ok(Err(why));
                }
            }
            Err(why) => return Ok(Err(why)),
        }
    }
    Ok(Ok(()))
}

/// The state of the reading.
#[derive(Default)]
struct Scan {
    schemas: BTreeMap<u16, Arc<Schema<'static>>>,
    channels: BTreeMap<u16, Channel<'static>>,
    messages: u64,
    begun: bool,
    past_data: bool,
}

impl Scan {
    /// Visits a record. The inner error is damage; the outer one ends the reading.
    fn show<E>(
        &mut self,
        record: Record<'_>,
        opcode: u8,
        visit: &mut dyn FnMut(Piece<'_>) -> Result<(), E>,
    ) -> Shown<E> {
        self.begun = true;
        // The summary section only repeats earlier records.
        self.past_data |= opcode == op::DATA_END;
        if self.past_data {
            return Ok(Ok(()));
        }
        match record {
            Record::Header(header) => visit(Piece::Header { profile: &header.profile, library: &header.library })?,
            Record::Schema { header, data } => {
                let schema = Schema {
                    id: header.id,
                    name: header.name,
                    encoding: header.encoding,
                    data: data.into_owned().into(),
                };
                self.schemas.insert(header.id, Arc::new(schema));
            }
            Record::Channel(channel) => {
                let schema = self.schemas.get(&channel.schema_id).cloned();
                if channel.schema_id != 0 && schema.is_none() {
                    return Ok(Err(McapError::UnknownSchema(channel.topic, channel.schema_id)));
                }
                let linked = Channel {
                    id: channel.id,
                    topic: channel.topic,
                    schema,
                    message_encoding: channel.message_encoding,
                    metadata: channel.metadata,
                };
                self.channels.insert(channel.id, linked);
            }
            Record::Message { header, data } => {
                let Some(channel) = self.channels.get(&header.channel_id) else {
                    return Ok(Err(McapError::UnknownChannel(header.sequence, header.channel_id)));
                };
                visit(Piece::Message { channel, header, data: &data })?;
                self.messages += 1;
            }
            Record::Attachment { header, data, .. } => {
                visit(Piece::Attachment { name: &header.name, media_type: &header.media_type, data: &data })?;
            }
            Record::Metadata(metadata) => visit(Piece::Metadata(&metadata))?,
            _ => {}
        }
        Ok(Ok(()))
    }
}

/// The system's error inside an error of the container, or the error itself.
pub fn cause(error: &McapError) -> String {
    match error {
        McapError::Io(system) => system.to_string(),
        other => other.to_string(),
    }
}
