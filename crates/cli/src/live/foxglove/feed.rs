//! What is recorded, on its way to viewers.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use foxglove::websocket::{ChannelView, Client, ServerListener};
use foxglove::{ChannelBuilder, Context, PartialMetadata, RawChannel, Schema, WebSocketServerHandle};
use sextant_kernel::SimTime;
use sextant_recording::Relay;

use super::super::pace::Pace;

/// Sends what is recorded when its time has come.
pub(super) struct Feed {
    pub(super) server: Arc<WebSocketServerHandle>,
    pub(super) context: Arc<Context>,
    pub(super) channels: Arc<Channels>,
    pub(super) pace: Arc<Pace>,
}

/// The channels of the recording, by number.
#[derive(Default)]
pub(super) struct Channels(Mutex<BTreeMap<u16, Channel>>);

struct Channel {
    channel: Arc<RawChannel>,
    /// The last message and its time.
    last: Option<(SimTime, Vec<u8>)>,
}

impl Channels {
    fn lock(&self) -> MutexGuard<'_, BTreeMap<u16, Channel>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A viewer that comes late gets the last message of each channel at once, so that it sees the world.
impl ServerListener for Channels {
    fn on_subscribe(&self, client: Client, view: ChannelView<'_>) {
        let channels = self.lock();
        let found = channels.values().find(|channel| channel.channel.id() == view.id());
        if let Some(Channel { channel, last: Some((time, data)) }) = found {
            let metadata = PartialMetadata::with_log_time(time.as_nanos());
            channel.log_with_meta_to_sink(data, metadata, client.sink_id());
        }
    }
}

impl Relay for Feed {
    fn channel(&mut self, number: u16, topic: &str, schema: &Schema) {
        let builder = ChannelBuilder::new(topic).context(&self.context).message_encoding("protobuf");
        let channel = builder.schema(schema.clone()).build_raw().expect("it has an encoding");
        self.channels.lock().insert(number, Channel { channel, last: None });
    }

    fn message(&mut self, number: u16, time: SimTime, data: &[u8]) {
        self.pace.wait_until(time, |now| self.server.broadcast_time(now.as_nanos()));
        let mut channels = self.channels.lock();
        let Some(Channel { channel, last }) = channels.get_mut(&number) else { return };
        channel.log_with_meta(data, PartialMetadata::with_log_time(time.as_nanos()));
        *last = Some((time, data.to_vec()));
    }
}
