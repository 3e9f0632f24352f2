//! Recovery of the readable part of a broken recording.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use mcap::records::Metadata;
use serde::Serialize;
use sextant_kernel::Watch;

use super::sink::Sink;
use crate::disk;
use crate::error::RecordingError;
use crate::mcap_file::{Damage, Piece, scan};
use crate::messages::names::RECOVERED_METADATA;
use crate::output::{Draft, FileIdentity, RECOVERING};

/// The result of a recovery.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Recovery {
    /// Messages copied.
    pub messages: u64,
    /// Attachments copied.
    pub attachments: u64,
    /// What was wrong with the file; absent if the file was sound and was copied completely.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damage: Option<Damage>,
}

/// Copies the recording `broken`, up to the first damaged or incomplete chunk, into a sound recording `out`. The copy
/// is written to `OUT.recovering`, which is renamed to `out` when it is complete; only then is an existing file replaced.
///
/// # Errors
/// If `broken` cannot be read or is not an MCAP file, if `out` is the same file, if `out` cannot be written, or if the
/// user interrupts. `OUT.recovering` is removed in each case.
pub fn recover(broken: &Path, out: &Path, watch: &dyn Watch) -> Result<Recovery, RecordingError> {
    let draft = Draft::new(out, RECOVERING);
    std::fs::metadata(broken).map_err(|why| RecordingError::read(broken, why))?;
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
    let mut sink = None;
    let mut known = BTreeSet::new();
    let mut recovery = Recovery { messages: 0, attachments: 0, damage: None };
    recovery.damage = scan::<RecordingError>(broken, &mut |piece| {
        watch.check()?;
        // Created at the first piece, so that nothing is created for a file of another format.
        let sink = match &mut sink {
            Some(sink) => sink,
            none => none.insert(Sink::create(draft)?),
        };
        match piece {
            Piece::Header { .. } => Ok(()),
            Piece::Message { channel, header, data } => {
                if known.insert(channel.id) {
                    sink.copied_channel(channel)?;
                }
                sink.message(&header, data)?;
                recovery.messages += 1;
                sink.settle()
            }
            Piece::Attachment { name, media_type, data } => {
                recovery.attachments += 1;
                sink.attach(&mcap::Attachment {
                    log_time: 0,
                    create_time: 0,
                    name: name.to_owned(),
                    media_type: media_type.to_owned(),
                    data: data.into(),
                })
            }
            Piece::Metadata(record) => sink.metadata(record),
        }
    })?;
    let mut sink = match sink {
        Some(sink) => sink,
        None => Sink::create(draft)?,
    };
    if let Some(damage) = &recovery.damage {
        let values = [("at_byte", damage.at_byte.to_string()), ("why", damage.why.clone())];
        sink.metadata(&Metadata {
            name: RECOVERED_METADATA.to_owned(),
            metadata: BTreeMap::from(values.map(|(key, value)| (key.to_owned(), value))),
        })?;
    }
    watch.check()?;
    sink.publish(draft)?;
    Ok(recovery)
}
