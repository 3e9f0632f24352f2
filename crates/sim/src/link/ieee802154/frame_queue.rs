//! Frames that a station was given to send.

use std::collections::VecDeque;

use sextant_kernel::SimTime;

use super::data_packet::DataPacket;
use crate::link::payloads::Content;
use crate::service::report::{Destination, FrameId};

/// A frame that a station was given to send.
#[derive(Clone, Copy, Debug)]
pub(super) struct QueuedFrame {
    pub(super) id: FrameId,
    pub(super) to: Destination,
    pub(super) content: Content,
    pub(super) mpdu_octets: u8,
    pub(super) offered: SimTime,
}

impl QueuedFrame {
    /// The packet, as it is counted and traced; `sequence` is the number of its frames.
    pub(super) fn packet(&self, sequence: Option<u8>) -> DataPacket {
        let &Self { id, to, mpdu_octets, offered, .. } = self;
        DataPacket { id, sequence, to, mpdu_octets, offered }
    }
}

/// Frames that wait for the one under way, the first one first.
pub(super) type Waiting = VecDeque<QueuedFrame>;
