//! What is recorded, on its way to the page.

use std::collections::BTreeMap;
use std::sync::Arc;

use sextant_kernel::SimTime;
use sextant_recording::{RecordingSoFar, Relay, Schema};

use super::super::pace::Pace;

/// Keeps what is recorded when its time has come.
pub(super) struct Feed {
    pub(super) so_far: RecordingSoFar,
    pub(super) pace: Arc<Pace>,
}

impl Relay for Feed {
    fn channel(&mut self, number: u16, topic: &str, schema: &Schema) {
        self.so_far.channel(number, topic, schema);
    }

    fn message(&mut self, number: u16, time: SimTime, data: &[u8]) {
        self.pace.wait_until(time, |_| ());
        self.so_far.message(number, time, data);
    }

    fn attachment(&mut self, name: &str, media_type: &str, data: &[u8]) {
        self.so_far.attachment(name, media_type, data);
    }

    fn metadata(&mut self, name: &str, values: &BTreeMap<String, String>) {
        self.so_far.metadata(name, values);
    }
}
