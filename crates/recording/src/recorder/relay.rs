//! Who else gets what is recorded.

use std::collections::BTreeMap;

use sextant_kernel::SimTime;

/// Gets what a recorder writes: the same messages in the same order, with the same octets. It changes nothing in the
/// recording.
pub trait Relay: Send {
    /// The recording has a new channel with this number, on which messages of `schema` follow.
    fn channel(&mut self, channel: u16, topic: &str, schema: &foxglove::Schema);

    /// A message of a channel was written. It may wait here for as long as it likes.
    fn message(&mut self, channel: u16, time: SimTime, data: &[u8]);

    /// A file was attached: the scenario, a file that it names, or the summary.
    fn attachment(&mut self, _name: &str, _media_type: &str, _data: &[u8]) {}

    /// What is known by name was written, such as the origin.
    fn metadata(&mut self, _name: &str, _values: &BTreeMap<String, String>) {}
}
