//! What a bag holds: its topics and the types of their messages.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use mcap::{Channel, Schema};
use sextant_kernel::text::{choices, shortened};

use super::definition::{Definitions, Dialect, short_name};
use super::files::files;
use crate::error::bag_error::BagError;
use sextant_recording::mcap_file::{Damage, DamageKind, Piece, scan};

/// A topic of a bag.
#[derive(Clone, Debug)]
pub(super) struct Topic {
    pub(super) name: String,
    /// The type of its messages, `PACKAGE/TYPE`.
    pub(super) message_type: String,
    pub(super) messages: u64,
    /// The octets of its first message.
    pub(super) first: Vec<u8>,
    encoding: String,
    schema: Option<Arc<Schema<'static>>>,
    /// Whether it has messages of several types.
    is_mixed: bool,
}

impl Topic {
    /// The definition of its messages.
    ///
    /// # Errors
    /// The problem, if it cannot be read.
    pub(super) fn definitions(&self) -> Result<Definitions, String> {
        if self.is_mixed {
            return Err("its messages have several definitions; allowed: one".to_owned());
        }
        let schema = self.schema.as_ref().ok_or("it has no definition of its messages")?;
        let dialect = match (self.encoding.as_str(), schema.encoding.as_str()) {
            ("cdr", "ros2msg") => Dialect::Ros2,
            ("ros1", "ros1msg") => Dialect::Ros1,
            (encoding, schema) => {
                return Err(format!(
                    "its messages have the encoding `{encoding}` and a definition in `{schema}`; allowed: `cdr` and \
                     `ros2msg`, or `ros1` and `ros1msg`"
                ));
            }
        };
        if schema.data.is_empty() {
            return Err("the bag has no definition of its messages, as bags in SQLite of ROS 2 Humble and before: convert it \
                        to MCAP with `ros2 bag convert`, where the package of the messages is installed"
                .to_owned());
        }
        let text = std::str::from_utf8(&schema.data).map_err(|_| "its definition is not UTF-8 text")?;
        Definitions::parse(dialect, &schema.name, text)
    }
}

/// A bag: its files and what they hold.
#[derive(Clone, Debug)]
pub(crate) struct Bag {
    pub(super) path: PathBuf,
    files: Vec<PathBuf>,
    /// By name.
    topics: BTreeMap<String, Topic>,
    /// What the user should know.
    pub(crate) notes: Vec<String>,
}

/// A message of a bag.
#[derive(Clone, Copy, Debug)]
pub(super) struct Message<'a> {
    pub(super) topic: &'a str,
    /// When it was recorded (ns).
    pub(super) log_ns: u64,
    pub(super) data: &'a [u8],
}

impl Bag {
    /// Looks through the bag `path`. A file that ends too early is read as far as it goes.
    ///
    /// # Errors
    /// If it cannot be read, is of another format or is damaged.
    pub(crate) fn open(path: &Path) -> Result<Self, BagError> {
        let mut bag = Self { path: path.to_owned(), files: files(path)?, topics: BTreeMap::new(), notes: Vec::new() };
        let Self { files, topics, notes, .. } = &mut bag;
        for file in files {
            let damage = scan_messages::<BagError>(file, &mut |channel, _, data| {
                match topics.get_mut(&channel.topic) {
                    Some(topic) => topic.count(channel),
                    None => {
                        topics.insert(channel.topic.clone(), Topic::new(channel, data));
                    }
                }
                Ok(())
            })?;
            match damage {
                None => {}
                Some(damage) if damage.kind == DamageKind::Truncated => notes.push(format!(
                    "`{}` has no end, as after a crash of the recorder: its first {} messages are used",
                    file.display(),
                    damage.messages
                )),
                Some(damage) => return Err(BagError::Damaged { path: file.clone(), damage }),
            }
        }
        Ok(bag)
    }

    /// Calls `visit` with each message, file by file.
    ///
    /// # Errors
    /// If a file cannot be read; or the error of `visit`.
    pub(super) fn messages<E: From<BagError> + From<sextant_recording::mcap_file::McapFileError>>(
        &self,
        mut visit: impl FnMut(Message<'_>) -> Result<(), E>,
    ) -> Result<(), E> {
        for file in &self.files {
            let damage = scan_messages::<E>(file, &mut |channel, log_ns, data| {
                visit(Message { topic: &channel.topic, log_ns, data })
            })?;
            match damage {
                Some(damage) if damage.kind == DamageKind::Corrupt => {
                    return Err(BagError::Damaged { path: file.clone(), damage }.into());
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// The topics with messages, by name.
    pub(super) fn topics(&self) -> impl Iterator<Item = &Topic> {
        self.topics.values()
    }

    /// The topic `name`.
    pub(super) fn topic(&self, name: &str) -> Option<&Topic> {
        self.topics.get(name)
    }

    /// `topics` for an error: names and types.
    pub(super) fn list<'a>(topics: impl Iterator<Item = &'a Topic>) -> String {
        let list: Vec<_> =
            topics.map(|topic| format!("{} ({})", shortened(&topic.name), shortened(&topic.message_type))).collect();
        choices(&list)
    }

    /// An error of the bag as a whole.
    pub(super) fn problem(&self, problem: impl Into<String>) -> BagError {
        BagError::Content { path: self.path.clone(), problem: problem.into() }
    }

    /// An error of a topic.
    pub(super) fn topic_problem(&self, topic: &str, problem: impl Into<String>) -> BagError {
        BagError::Topic { path: self.path.clone(), topic: topic.to_owned(), problem: problem.into() }
    }
}

impl Topic {
    fn new(channel: &Channel<'static>, first: &[u8]) -> Self {
        Self {
            name: channel.topic.clone(),
            message_type: channel.schema.as_ref().map_or_else(String::new, |schema| short_name(&schema.name)),
            messages: 1,
            first: first.to_owned(),
            encoding: channel.message_encoding.clone(),
            schema: channel.schema.clone(),
            is_mixed: false,
        }
    }

    /// Counts a further message.
    fn count(&mut self, channel: &Channel<'static>) {
        self.messages += 1;
        let is_same = match (&self.schema, &channel.schema) {
            (Some(own), Some(other)) => Arc::ptr_eq(own, other) || (own.name == other.name && own.data == other.data),
            (own, other) => own.is_none() && other.is_none(),
        };
        self.is_mixed |= !is_same || self.encoding != channel.message_encoding;
    }
}

/// Calls `visit` with each message of a file: its channel, when it was recorded (ns), and its octets. Returns the damage that
/// ended the reading, if any.
fn scan_messages<E: From<BagError> + From<sextant_recording::mcap_file::McapFileError>>(
    file: &Path,
    visit: &mut impl FnMut(&Channel<'static>, u64, &[u8]) -> Result<(), E>,
) -> Result<Option<Damage>, E> {
    #[cfg(feature = "sqlite-bags")]
    if super::files::is_sqlite(file) {
        return super::sqlite::scan(file, visit).map(|()| None);
    }
    scan::<E>(file, &mut |piece| match piece {
        Piece::Message { channel, header, data } => visit(channel, header.log_time, data),
        _ => Ok(()),
    })
}

/// Whether the MCAP file `path` is a bag and not a recording of ours or of another program.
pub(super) fn is_bag_file(path: &Path) -> bool {
    match scan::<Answer>(path, &mut |piece| match piece {
        Piece::Header { profile: "ros1" | "ros2", .. } => Err(Answer::Bag),
        Piece::Message { channel, .. } => match channel.message_encoding.as_str() {
            "cdr" | "ros1" => Err(Answer::Bag),
            _ if channel.schema.as_ref().is_some_and(|schema| schema.name.starts_with("sextant.")) => {
                Err(Answer::Other)
            }
            _ => Ok(()),
        },
        _ => Ok(()),
    }) {
        Err(Answer::Bag) => true,
        Ok(_) | Err(Answer::Other) => false,
    }
}

/// What ends the look into a file.
enum Answer {
    Bag,
    Other,
}

impl From<sextant_recording::mcap_file::McapFileError> for Answer {
    fn from(_: sextant_recording::mcap_file::McapFileError) -> Self {
        Self::Other
    }
}
