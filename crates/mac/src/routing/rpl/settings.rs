//! What a tree of RPL is made by.

use super::objective::{Mrhof, Objective};

/// Who knows ways down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Downward {
    /// Nobody: packets go to the root only (RFC 6550, 6.3.1: mode of operation 0).
    Unknown,
    /// The root (mode 1, non-storing).
    ByRoot,
    /// Each station those below it (mode 2, storing).
    ByStations,
}

/// Whether links are tried before they are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Probing {
    /// A link is used as soon as its neighbour was heard.
    Off,
    /// A first parent needs a link that is known well; others are tried if they seem best.
    On,
}

/// What a tree is made by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DodagSettings {
    /// What makes one parent better than another.
    pub objective: Objective,
    /// The least increase of the rank over a hop (MinHopRankIncrease), which is the rank of the root too.
    pub min_hop_rank_increase: u16,
    /// A station uses no neighbour whose rank is greater by more than that than the least rank that it had itself
    /// (MaxRankIncrease). Zero: any.
    pub max_rank_increase: u16,
    /// Who knows ways down.
    pub downward: Downward,
    /// Whether links are tried.
    pub probing: Probing,
}

impl Default for DodagSettings {
    fn default() -> Self {
        Self {
            objective: Objective::Mrhof(Mrhof::default()),
            min_hop_rank_increase: 256,
            max_rank_increase: 8 * 256,
            downward: Downward::ByRoot,
            probing: Probing::On,
        }
    }
}
