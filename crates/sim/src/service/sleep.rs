//! How the stations of a network slept.

use std::time::Duration;

/// How a station slept, and what it did to wake others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SleepUse {
    /// How long its radio sent, received or turned around.
    pub on: Duration,
    /// How long that was counted.
    pub span: Duration,
    /// How often it looked at the channel by its schedule.
    pub checks: u64,
    /// Frames that it sent to wake others: strobes, copies of the frame itself, wake-up frames.
    pub strobes: u64,
    /// Packets for which it sent such frames and nothing else, because nobody answered.
    pub unanswered: u64,
    /// Whether it is in the network.
    pub is_member: bool,
}
