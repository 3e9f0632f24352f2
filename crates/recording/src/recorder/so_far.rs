//! What was recorded so far, while the recording is still being written.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use mcap::Attachment;
use mcap::records::{MessageHeader, Metadata};
use sextant_kernel::SimTime;

use super::relay::Relay;
use crate::container::sink::Sink;
use crate::error::RecordingError;
use crate::output::{Draft, PART};

/// Keeps what a recorder writes, and writes it as a recording of its own whenever somebody asks. Clones share what they
/// keep. The memory is that of all messages.
#[derive(Clone, Debug, Default)]
pub struct RecordingSoFar(Arc<Mutex<Vec<Arc<Piece>>>>);

#[derive(Debug)]
enum Piece {
    Channel { topic: String, schema: foxglove::Schema },
    Message { channel: u16, time: SimTime, data: Vec<u8> },
    Attachment { name: String, media_type: String, data: Vec<u8> },
    Metadata(Metadata),
}

impl RecordingSoFar {
    fn pieces(&self) -> MutexGuard<'_, Vec<Arc<Piece>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn keep(&self, piece: Piece) {
        self.pieces().push(Arc::new(piece));
    }

    /// Number of messages and other records so far. It only grows.
    #[must_use]
    pub fn records(&self) -> usize {
        self.pieces().len()
    }

    /// Writes all of it to `path`, replacing what is there: a recording that can be read like any other.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), RecordingError> {
        // A clone is a list of references: the recorder does not wait until the file is written.
        let pieces = self.pieces().clone();
        let draft = Draft::new(path, PART);
        let mut sink = Sink::create(&draft)?;
        for piece in &pieces {
            match &**piece {
                Piece::Channel { topic, schema } => {
                    sink.channel(topic, schema)?;
                }
                Piece::Message { channel, time, data } => {
                    let time_ns = time.as_nanos();
                    let header =
                        MessageHeader { channel_id: *channel, sequence: 0, log_time: time_ns, publish_time: time_ns };
                    sink.message(&header, data)?;
                }
                Piece::Attachment { name, media_type, data } => sink.attach(&Attachment {
                    log_time: 0,
                    create_time: 0,
                    name: name.clone(),
                    media_type: media_type.clone(),
                    data: data.into(),
                })?,
                Piece::Metadata(metadata) => sink.metadata(metadata)?,
            }
        }
        sink.publish(&draft)
    }
}

impl Relay for RecordingSoFar {
    fn channel(&mut self, _number: u16, topic: &str, schema: &foxglove::Schema) {
        // A container gives numbers in the order of first use, so the copy has the same ones.
        self.keep(Piece::Channel { topic: topic.to_owned(), schema: schema.clone() });
    }

    fn message(&mut self, channel: u16, time: SimTime, data: &[u8]) {
        self.keep(Piece::Message { channel, time, data: data.into() });
    }

    fn attachment(&mut self, name: &str, media_type: &str, data: &[u8]) {
        let (name, media_type, data) = (name.to_owned(), media_type.to_owned(), data.to_vec());
        self.keep(Piece::Attachment { name, media_type, data });
    }

    fn metadata(&mut self, name: &str, values: &BTreeMap<String, String>) {
        self.keep(Piece::Metadata(Metadata { name: name.to_owned(), metadata: values.clone() }));
    }
}
