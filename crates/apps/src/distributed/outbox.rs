//! The messages of a node, and which of them were sent.

use sextant_sim::FrameId;

use super::message::Message;
use super::record::MessageCounts;

/// The messages of a node. Those that wait when the last node ends are never sent, and do not count.
#[derive(Debug, Default)]
pub(super) struct Outbox {
    /// All messages so far.
    messages: Vec<OwnMessage>,
    /// Number of those of earlier windows.
    earlier: usize,
    /// The frames that the link has, and the message that each carries.
    under_way: Vec<(FrameId, usize)>,
}

#[derive(Debug)]
struct OwnMessage {
    /// The count of the message alone.
    counts: MessageCounts,
    /// What it is on the air; empty once its window is over.
    octets: Vec<u8>,
    /// Whether any of its repeats was sent.
    is_sent: bool,
}

impl Outbox {
    /// Another window begins: the messages of the last one are not sent any more.
    pub(super) fn begin_window(&mut self) {
        self.messages[self.earlier..].iter_mut().for_each(|message| message.octets = Vec::new());
        self.earlier = self.messages.len();
    }

    /// Adds a message to those of this window.
    pub(super) fn put(&mut self, message: &Message) {
        let mut octets = Vec::new();
        message.write(&mut octets);
        self.messages.push(OwnMessage { counts: MessageCounts::of(message, octets.len()), octets, is_sent: false });
    }

    /// Number of messages of this window.
    pub(super) fn in_window(&self) -> usize {
        self.messages.len() - self.earlier
    }

    /// The octets of message number `message` of this window.
    pub(super) fn octets(&self, message: usize) -> Option<&[u8]> {
        Some(&self.messages.get(self.earlier + message)?.octets)
    }

    /// The link has taken message number `message` of this window, in this frame.
    pub(super) fn give(&mut self, message: usize, frame: FrameId) {
        self.under_way.push((frame, self.earlier + message));
    }

    /// The link is done with a frame.
    pub(super) fn ended(&mut self, frame: FrameId, is_sent: bool) {
        if let Some(place) = self.under_way.iter().position(|&(under_way, _)| under_way == frame) {
            let (_, message) = self.under_way.swap_remove(place);
            self.messages[message].is_sent |= is_sent;
        }
    }

    /// The messages that were sent at least once.
    pub(super) fn sent(&self) -> MessageCounts {
        self.messages.iter().filter(|message| message.is_sent).map(|message| message.counts).sum()
    }
}
