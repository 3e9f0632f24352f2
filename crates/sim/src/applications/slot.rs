//! A slot: the time that a robot spends on what it does at a stop.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::SimTime;

/// The time that a robot spends on what it does at a stop, or on a part of a drive.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    pub(super) since: SimTime,
    pub(super) span: Duration,
    /// Where the robot believes to be in the middle of the slot (m).
    pub(super) place: Position,
}

impl Slot {
    /// When number `number` of `count` things is due that are done in equal intervals, the first one at once.
    pub(super) fn due(&self, number: u32, count: u32) -> SimTime {
        self.since + self.span * number / count
    }
}
