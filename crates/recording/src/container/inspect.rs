//! The contents of a recording.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

use serde::Serialize;
use sextant_kernel::text::shortened;

use super::sink::OWN_LIBRARY;
use crate::error::RecordingError;
use crate::mcap_file::{Damage, Piece, scan};

/// The contents of a recording.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Inspection {
    /// Whether it is a recording of `run`, whose times are simulated.
    #[serde(skip)]
    pub is_simulated: bool,
    /// The program that wrote it.
    pub library: String,
    /// Size of the file (octets).
    pub size_bytes: u64,
    /// The first damage; absent if the file is sound.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damage: Option<Damage>,
    /// Topics by name.
    pub topics: Vec<Topic>,
    /// Number of readable messages.
    pub messages: u64,
    /// Simulated time of the earliest message (s); absent without messages.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start_s: Option<f64>,
    /// Simulated time of the latest message (s); absent without messages.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub end_s: Option<f64>,
    /// Attachments in the order of the file.
    pub attachments: Vec<AttachmentInfo>,
    /// Metadata records by name.
    pub metadata: BTreeMap<String, BTreeMap<String, String>>,
}

/// A topic of a recording.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Topic {
    /// Its name.
    pub topic: String,
    /// Name of its message type.
    pub schema: String,
    /// Encoding of its messages.
    pub encoding: String,
    /// Number of its messages.
    pub messages: u64,
}

/// A file within a recording.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct AttachmentInfo {
    /// Its name.
    pub name: String,
    /// Its media type.
    pub media_type: String,
    /// Its size (octets).
    pub size_bytes: u64,
}

/// Lists the contents of the recording `path`. Of a broken recording it lists everything before the damage.
///
/// # Errors
/// If the file cannot be read or is of another format.
pub fn inspect(path: &Path) -> Result<Inspection, RecordingError> {
    let size_bytes = std::fs::metadata(path).map_err(|why| RecordingError::read(path, why))?.len();
    let mut inspection = Inspection {
        is_simulated: false,
        library: String::new(),
        size_bytes,
        damage: None,
        topics: Vec::new(),
        messages: 0,
        start_s: None,
        end_s: None,
        attachments: Vec::new(),
        metadata: BTreeMap::new(),
    };
    let mut topics: BTreeMap<u16, Topic> = BTreeMap::new();
    let mut span: Option<(u64, u64)> = None;
    inspection.damage = scan::<RecordingError>(path, &mut |piece| {
        match piece {
            Piece::Header { library, .. } => inspection.library = library.to_owned(),
            Piece::Message { channel, header, .. } => {
                let topic = topics.entry(channel.id).or_insert_with(|| Topic {
                    topic: channel.topic.clone(),
                    schema: channel.schema.as_ref().map(|schema| schema.name.clone()).unwrap_or_default(),
                    encoding: channel.message_encoding.clone(),
                    messages: 0,
                });
                topic.messages += 1;
                inspection.messages += 1;
                let time = header.log_time;
                span = Some(span.map_or((time, time), |(start, end)| (start.min(time), end.max(time))));
            }
            Piece::Attachment { name, media_type, data } => inspection.attachments.push(AttachmentInfo {
                name: name.to_owned(),
                media_type: media_type.to_owned(),
                size_bytes: data.len() as u64,
            }),
            Piece::Metadata(record) => {
                inspection.metadata.insert(record.name.clone(), record.metadata.clone());
            }
        }
        Ok(())
    })?;
    inspection.is_simulated = inspection.library.starts_with(OWN_LIBRARY);
    let seconds = |nanos| sextant_kernel::SimTime::from_nanos(nanos).as_secs_f64();
    inspection.start_s = span.map(|(start, _)| seconds(start));
    inspection.end_s = span.map(|(_, end)| seconds(end));
    inspection.topics = topics.into_values().collect();
    inspection.topics.sort_by(|a, b| a.topic.cmp(&b.topic));
    Ok(inspection)
}

impl fmt::Display for Inspection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.damage {
            None => writeln!(f, "complete, {} bytes, written by {}", self.size_bytes, self.library)?,
            Some(damage) => writeln!(
                f,
                "BROKEN at byte {} of {}: {}; `sextant recover` copies all that can be read",
                damage.at_byte, self.size_bytes, damage.why
            )?,
        }
        if let (Some(start_s), Some(end_s)) = (self.start_s, self.end_s) {
            let kind = if self.is_simulated { "simulated time" } else { "recorded time" };
            writeln!(f, "{} messages from {start_s:.3} s to {end_s:.3} s of {kind}", self.messages)?;
        }
        let shown =
            self.topics.iter().map(|topic| (shortened(&topic.topic), shortened(&topic.schema), topic.messages));
        let topics: Vec<(Cow<'_, str>, Cow<'_, str>, u64)> = shown.collect();
        let width = topics.iter().map(|(topic, ..)| topic.chars().count()).max().unwrap_or(0).max(5);
        let schema_width = topics.iter().map(|(_, schema, _)| schema.chars().count()).max().unwrap_or(0);
        for (topic, schema, messages) in &topics {
            writeln!(f, "  {topic:<width$}  {schema:<schema_width$}  {messages:>9}")?;
        }
        for AttachmentInfo { name, media_type, size_bytes } in &self.attachments {
            writeln!(f, "attachment {name} ({media_type}, {size_bytes} bytes)")?;
        }
        for (name, values) in &self.metadata {
            let values: Vec<String> = values.iter().map(|(key, value)| format!("{key} = {value}")).collect();
            writeln!(f, "metadata {name}: {}", values.join(", "))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_topic_with_a_very_long_name_is_shown_by_its_start() {
        let topic =
            |topic: String| Topic { topic, schema: "s".repeat(70_000), encoding: "cdr".to_owned(), messages: 3 };
        let inspection = Inspection {
            is_simulated: false,
            library: "another".to_owned(),
            size_bytes: 9,
            damage: None,
            topics: vec![topic("é".repeat(70_000)), topic("/pose".to_owned())],
            messages: 6,
            start_s: None,
            end_s: None,
            attachments: Vec::new(),
            metadata: BTreeMap::new(),
        };
        let text = inspection.to_string();
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines[1].starts_with(&format!("  {}.. (140000 octets)  sss", "é".repeat(200))), "{text}");
        assert!(lines[2].starts_with("  /pose   ") && lines[2].ends_with("s.. (70000 octets)          3"), "{text}");
        assert!(text.len() < 2000);
    }
}
