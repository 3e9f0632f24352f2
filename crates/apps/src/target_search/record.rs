//! What robots leave behind.

use sextant_channel::Position;
use sextant_kernel::SimTime;
use sextant_sim::TargetId;

use super::outbox::MessageCounts;

/// What a robot leaves behind.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RobotSearchRecord {
    /// When it first heard where a target was detected.
    pub alarmed: Option<SimTime>,
    /// When it started to search.
    pub started: Option<SimTime>,
    /// The targets that it captured, with the times.
    pub captured: Vec<(TargetId, SimTime)>,
    /// Its decisions.
    pub steps: Vec<SearchStep>,
    /// Answers that it received.
    pub answers: u64,
    /// What it sent.
    pub sent: MessageCounts,
    /// Times that no particle agreed with what nodes detected, so that all were drawn again: of all targets, in their last
    /// update.
    pub fallbacks: u32,
    /// Times that an obstacle was in its way.
    pub blocked: u64,
}

/// A decision of a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchStep {
    /// When.
    pub time: SimTime,
    /// Where it was on the map (m).
    pub place: Position,
    /// The target that it seeks.
    pub target: TargetId,
    /// Where it predicted the target to be, on the map (m).
    pub predicted: Position,
    /// Where it drives, on the map (m).
    pub goal: Position,
    /// The latest time at which a node is known to have detected the target.
    pub latest: SimTime,
}
