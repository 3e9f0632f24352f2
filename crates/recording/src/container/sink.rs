//! The MCAP container of a recording. Chunks are closed by count, and the first error is kept.

use std::collections::BTreeMap;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use mcap::records::{MessageHeader, Metadata, op};
use mcap::write::NoSeek;
use mcap::{Attachment, Compression, WriteOptions, Writer};

use crate::disk::DiskFile;
use crate::error::RecordingError;
use crate::output::Draft;

/// Name of the writer in the header of a recording; fixed, so that equal runs give equal bytes.
const LIBRARY: &str = concat!("sextant ", env!("CARGO_PKG_VERSION"));

/// How the name of the library begins that writes recordings, of any version.
pub(crate) const OWN_LIBRARY: &str = "sextant ";

/// Whether a file that begins with the octets `head` was written by this program, of any version: its header says so.
pub(crate) fn has_own_library(head: &[u8]) -> bool {
    /// Length of the profile, and the profile; the same of the library.
    fn text(octets: &[u8]) -> Option<(&[u8], &[u8])> {
        let (length, rest) = octets.split_first_chunk()?;
        rest.split_at_checked(usize::try_from(u32::from_le_bytes(*length)).ok()?)
    }
    // The number of the record is before its length, in eight octets.
    let header = head.strip_prefix(mcap::MAGIC).and_then(|rest| rest.strip_prefix(&[op::HEADER])?.get(8..));
    let library = header.and_then(text).and_then(|(_, rest)| text(rest));
    library.is_some_and(|(library, _)| library.starts_with(OWN_LIBRARY.as_bytes()))
}

/// A chunk is closed after this many messages, which a killed process may lose. Time does not close a chunk.
const MESSAGES_PER_CHUNK: u32 = 4096;

/// The container closes a chunk after this many uncompressed octets.
const OCTETS_PER_CHUNK: u64 = 1 << 20;

/// A container being written. It does not seek, so that a killed process leaves complete chunks and at most one
/// incomplete chunk.
pub(crate) struct Sink<W: Write> {
    /// None after the first failure.
    writer: Option<Writer<NoSeek<W>>>,
    failure: Option<RecordingError>,
    path: PathBuf,
    in_chunk: u32,
}

impl<W: Write> Sink<W> {
    /// A container that is written to `output`; `path` is its name in errors.
    pub(crate) fn new(output: W, path: &Path) -> Result<Self, RecordingError> {
        let writer = WriteOptions::new()
            .compression(Some(Compression::Zstd))
            .compression_threads(0)
            .chunk_size(Some(OCTETS_PER_CHUNK))
            .library(LIBRARY)
            .profile("")
            .disable_seeking(true)
            .create(NoSeek::new(output))
            .map_err(|why| RecordingError::write(path, &why))?;
        Ok(Self { writer: Some(writer), failure: None, path: path.to_owned(), in_chunk: 0 })
    }

    /// Does one operation on the container, unless an earlier one failed. A failed container is closed at once: a later
    /// write might succeed, and dropping the writer would add a summary after the gap.
    fn act<T>(
        &mut self,
        act: impl FnOnce(&mut Writer<NoSeek<W>>) -> Result<T, mcap::McapError>,
    ) -> Result<T, RecordingError> {
        if let Some(failure) = &self.failure {
            return Err(failure.clone());
        }
        let writer = self.writer.as_mut().expect("there is a writer until the first failure");
        act(writer).map_err(|why| {
            let failure = RecordingError::write(&self.path, &why);
            self.failure = Some(failure.clone());
            if let Some(writer) = self.writer.take() {
                drop(writer.into_inner());
            }
            failure
        })
    }

    /// Adds the channel `topic` with messages of `schema`. Ids are given in the order of first use.
    pub(crate) fn channel(&mut self, topic: &str, schema: &foxglove::Schema) -> Result<u16, RecordingError> {
        self.act(|writer| {
            let schema = writer.add_schema(&schema.name, &schema.encoding, &schema.data)?;
            writer.add_channel(schema, topic, "protobuf", &BTreeMap::new())
        })
    }

    /// Adds the same channel as in another container, with the same id.
    pub(crate) fn copied_channel(&mut self, channel: &mcap::Channel<'_>) -> Result<(), RecordingError> {
        self.act(|writer| {
            let schema = match &channel.schema {
                Some(schema) => writer.add_schema_with_id(schema.id, &schema.name, &schema.encoding, &schema.data)?,
                None => 0,
            };
            let encoding = &channel.message_encoding;
            writer.add_channel_with_id(channel.id, schema, &channel.topic, encoding, &channel.metadata)?;
            Ok(())
        })
    }

    /// Writes a message. Call [`Sink::settle`] where a chunk may end.
    pub(crate) fn message(&mut self, header: &MessageHeader, data: &[u8]) -> Result<(), RecordingError> {
        self.in_chunk += 1;
        self.act(|writer| writer.write_to_known_channel(header, data))
    }

    /// Ends the chunk if it has enough messages. Call it only between messages that do not belong together.
    pub(crate) fn settle(&mut self) -> Result<(), RecordingError> {
        if self.in_chunk >= MESSAGES_PER_CHUNK { self.end_chunk() } else { Ok(()) }
    }

    /// Ends the chunk and flushes it.
    pub(crate) fn end_chunk(&mut self) -> Result<(), RecordingError> {
        self.in_chunk = 0;
        self.act(Writer::flush)
    }

    pub(crate) fn attach(&mut self, attachment: &Attachment<'_>) -> Result<(), RecordingError> {
        self.in_chunk = 0;
        self.act(|writer| writer.attach(attachment))
    }

    pub(crate) fn metadata(&mut self, metadata: &Metadata) -> Result<(), RecordingError> {
        self.in_chunk = 0;
        self.act(|writer| writer.write_metadata(metadata))
    }

    /// Writes the summary section, flushes, and returns the output.
    pub(crate) fn finish(mut self) -> Result<W, RecordingError> {
        self.act(Writer::finish)?;
        let writer = self.writer.take().expect("there is a writer until the first failure");
        let mut output = writer.into_inner().into_inner();
        output.flush().map_err(|why| RecordingError::write(&self.path, &why.into()))?;
        Ok(output)
    }
}

impl Sink<BufWriter<DiskFile>> {
    /// A container in a new file, which has the temporary name of `draft`.
    pub(crate) fn create(draft: &Draft) -> Result<Self, RecordingError> {
        Self::new(draft.open()?, &draft.part)
    }

    /// Finishes the container and gives the file its final name.
    pub(crate) fn publish(self, draft: &Draft) -> Result<(), RecordingError> {
        Ok(draft.name(self.finish()?)?)
    }
}
