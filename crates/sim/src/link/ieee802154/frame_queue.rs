//! Frames that a station was given to send.

use std::collections::VecDeque;

use sextant_kernel::SimTime;

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

/// Frames that wait for the one under way, the first one first.
pub(super) type Waiting = VecDeque<QueuedFrame>;
