//! What the robot takes into account when it decides.

use sextant_channel::Position;
use sextant_sim::Situation;

use super::knowledge::Knowledge;
use super::rules::Rules;

/// How the last move went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Move {
    Free,
    Blocked,
}

/// What the robot takes into account when it decides.
#[derive(Clone, Copy)]
pub(super) struct View<'a> {
    pub(super) situation: &'a Situation<'a>,
    pub(super) last_move: Move,
    pub(super) rules: &'a Rules,
    pub(super) knowledge: &'a Knowledge,
}

impl View<'_> {
    /// Where the robot is (m).
    pub(super) fn here(&self) -> Position {
        self.situation.position
    }
}
