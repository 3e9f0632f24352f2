//! Who else gets what is recorded.

use sextant_kernel::SimTime;

/// Gets what a recorder writes: the same messages in the same order, with the same octets. It changes nothing in the
/// recording.
pub trait Relay: Send {
    /// The recording has a new channel with this number, on which messages of `schema` follow.
    fn channel(&mut self, channel: u16, topic: &str, schema: &foxglove::Schema);

    /// A message of a channel was written. It may wait here for as long as it likes.
    fn message(&mut self, channel: u16, time: SimTime, data: &[u8]);
}
