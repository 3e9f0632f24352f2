//! Recovery of the readable part of a broken recording.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use mcap::records::Metadata;
use serde::Serialize;
use sextant_kernel::Watch;

use super::sink::Sink;
use crate::disk::{self, DiskFile};
use crate::error::RecordingError;
use crate::mcap_file::salvage::{Gap, Salvaged, salvage};
use crate::mcap_file::{Damage, Piece, scan};
use crate::messages::names::{GAP_METADATA, RECOVERED_METADATA};
use crate::output::{Draft, FileIdentity, RECOVERING};

/// The result of a recovery.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Recovery {
    /// Messages copied.
    pub messages: u64,
    /// Attachments copied.
    pub attachments: u64,
    /// The first damage of the file; absent if the file was sound and was copied completely.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damage: Option<Damage>,
    /// The parts of the file that could not be read.
    pub gaps: Vec<Gap>,
}

/// Copies all that can be read of the recording `broken` into a sound recording `out`. Damaged and incomplete chunks are left out.
/// Where one is missing, the copy has a metadata record `gap/N`: between which octets of the file and which times. The copy
/// is written to `OUT.recovering`, which is renamed to `out` when it is complete; only then is an existing file replaced.
///
/// # Errors
/// If `broken` cannot be read, is a pipe, or is not an MCAP file, if `out` is the same file, if `out` cannot be written, or if the
/// user interrupts. `OUT.recovering` is removed in each case.
pub fn recover(broken: &Path, out: &Path, watch: &dyn Watch) -> Result<Recovery, RecordingError> {
    let draft = Draft::new(out, RECOVERING);
    let metadata = std::fs::metadata(broken).map_err(|why| RecordingError::read(broken, why))?;
    if !metadata.is_file() {
        // A damaged one is read twice, and a pipe that nobody writes would be waited for.
        return Err(RecordingError::read(
            broken,
            io::Error::other("it is no file that can be read twice; copy it to one"),
        ));
    }
    let input = FileIdentity::of(broken);
    if [&draft.path, &draft.part].iter().any(|path| FileIdentity::of(path) == input) {
        return Err(RecordingError::SameFile { path: broken.to_owned() });
    }
    let recovered = copy(broken, &draft, watch);
    if !matches!(recovered, Err(RecordingError::Busy { .. })) {
        // After a success it has got its final name.
        let _ = disk::remove_file(&draft.part);
    }
    recovered.map_err(|error| match error {
        RecordingError::Write { why, .. } => RecordingError::WriteCopy { path: out.to_owned(), why },
        error => error,
    })
}

/// The temporary name of the copy `out` while it is written.
#[must_use]
pub fn unfinished_copy(out: &Path) -> PathBuf {
    Draft::new(out, RECOVERING).part
}

fn copy(broken: &Path, draft: &Draft, watch: &dyn Watch) -> Result<Recovery, RecordingError> {
    let mut copied =
        Copied { draft, sink: None, known: BTreeSet::new(), pieces: 0, messages: 0, attachments: 0, gaps: 0 };
    let damage = scan(broken, &mut |piece| {
        watch.check()?;
        copied.piece(piece)
    })?;
    let mut gaps = Vec::new();
    if let Some(damage) = &damage {
        // Those before the damage were copied.
        let mut rest = copied.pieces;
        gaps = salvage(broken, damage.at_byte, &mut |salvaged| {
            watch.check()?;
            match salvaged {
                Salvaged::Gap(gap) => copied.gap(values(gap)),
                Salvaged::Piece(_) if rest > 0 => {
                    rest -= 1;
                    Ok(())
                }
                Salvaged::Piece(piece) => copied.piece(piece),
            }
        })?;
        let values = [("at_byte", damage.at_byte.to_string()), ("why", damage.why.clone())];
        copied.sink()?.metadata(&Metadata {
            name: RECOVERED_METADATA.to_owned(),
            metadata: BTreeMap::from(values.map(|(key, value)| (key.to_owned(), value))),
        })?;
    }
    watch.check()?;
    copied.sink()?;
    let Copied { sink, messages, attachments, .. } = copied;
    sink.expect("it was made").publish(draft)?;
    Ok(Recovery { messages, attachments, damage, gaps })
}

/// A copy that is being written.
struct Copied<'a> {
    draft: &'a Draft,
    /// None before the first piece: a file of another format leaves nothing behind.
    sink: Option<Sink<BufWriter<DiskFile>>>,
    /// The channels that it has.
    known: BTreeSet<u16>,
    pieces: u64,
    messages: u64,
    attachments: u64,
    gaps: u32,
}

impl Copied<'_> {
    fn sink(&mut self) -> Result<&mut Sink<BufWriter<DiskFile>>, RecordingError> {
        if self.sink.is_none() {
            self.sink = Some(Sink::create(self.draft)?);
        }
        Ok(self.sink.as_mut().expect("it was made"))
    }

    fn gap(&mut self, metadata: BTreeMap<String, String>) -> Result<(), RecordingError> {
        self.gaps += 1;
        let name = format!("{GAP_METADATA}{}", self.gaps);
        self.sink()?.metadata(&Metadata { name, metadata })
    }

    fn piece(&mut self, piece: Piece<'_>) -> Result<(), RecordingError> {
        self.pieces += 1;
        match piece {
            Piece::Header { .. } => self.sink().map(|_| ()),
            Piece::Message { channel, header, data } => {
                self.messages += 1;
                let is_new = self.known.insert(channel.id);
                let sink = self.sink()?;
                if is_new {
                    sink.copied_channel(channel)?;
                }
                sink.message(&header, data)?;
                sink.settle()
            }
            Piece::Attachment { name, media_type, data } => {
                self.attachments += 1;
                self.sink()?.attach(&mcap::Attachment {
                    log_time: 0,
                    create_time: 0,
                    name: name.to_owned(),
                    media_type: media_type.to_owned(),
                    data: data.into(),
                })
            }
            // The file is a recovered one itself.
            Piece::Metadata(record) if record.name.starts_with(GAP_METADATA) => self.gap(record.metadata.clone()),
            Piece::Metadata(record) => self.sink()?.metadata(record),
        }
    }
}

/// A gap as a metadata record.
fn values(gap: &Gap) -> BTreeMap<String, String> {
    let Gap { from_byte, to_byte, from_ns, to_ns, why } = gap;
    let bytes = [("from_byte", from_byte), ("to_byte", to_byte)].map(|(key, value)| (key, value.to_string()));
    let times = [("from_ns", from_ns), ("to_ns", to_ns)];
    let times = times.into_iter().filter_map(|(key, value)| Some((key, (*value)?.to_string())));
    let values = bytes.into_iter().chain(times).chain([("why", why.clone())]);
    values.map(|(key, value)| (key.to_owned(), value)).collect()
}
