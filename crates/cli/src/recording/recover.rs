//! Saving what a crash has left of a recording.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use mcap::records::Metadata;
use serde::Serialize;

use super::error::RecordingError;
use super::names::RECOVERED_METADATA;
use super::scan::{Damage, Piece, scan};
use super::sink::Sink;
use crate::output::Draft;

/// What was saved.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Recovery {
    /// Messages copied.
    pub messages: u64,
    /// Attachments copied.
    pub attachments: u64,
    /// What was wrong with the file; absent if it was sound, and then it was copied whole.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damage: Option<Damage>,
}

/// Copies all that can be read of the recording `broken`, up to the first damaged or cut chunk, into a sound
/// recording `out`. An existing file `out` is replaced once the copy is whole.
///
/// # Errors
/// If `broken` cannot be read or is no MCAP file, if `out` is the same file, or if `out` cannot be written.
pub fn recover(broken: &Path, out: &Path) -> Result<Recovery, RecordingError> {
    let draft = Draft::new(out, ".recovering");
    let input = broken.canonicalize().map_err(|why| RecordingError::read(broken, why))?;
    if [&draft.path, &draft.part].iter().any(|path| path.canonicalize().is_ok_and(|path| path == input)) {
        return Err(RecordingError::SameFile { path: broken.to_owned() });
    }
    let mut sink = None;
    let mut known = BTreeSet::new();
    let mut recovery = Recovery { messages: 0, attachments: 0, damage: None };
    recovery.damage = scan(broken, &mut |piece| {
        // Created at the first piece, so that a file of another format leaves nothing behind.
        let sink = match &mut sink {
            Some(sink) => sink,
            none => none.insert(Sink::create(&draft)?),
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
        None => Sink::create(&draft)?,
    };
    if let Some(damage) = &recovery.damage {
        let values = [("at_byte", damage.at_byte.to_string()), ("why", damage.why.clone())];
        sink.metadata(&Metadata {
            name: RECOVERED_METADATA.to_owned(),
            metadata: BTreeMap::from(values.map(|(key, value)| (key.to_owned(), value))),
        })?;
    }
    sink.publish(&draft)?;
    Ok(recovery)
}
