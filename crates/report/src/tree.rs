//! The tree over which packets went, in a report: who sent to whom when, and who was dead.

use serde::Serialize;
use sextant_kernel::SimTime;
use sextant_recording::RecordedWorld;

use super::column::Column;
use super::frame::Frame;

/// The tree over which packets went.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tree {
    /// The parent of each node at the end, as the number of a station from 1: nodes first and then sinks; 0 without one.
    pub parents: Column,
    /// When the simulation began and ended (s).
    pub span_s: [f64; 2],
    /// The parents that nodes chose, in the order of time; absent if the tree does not change.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chosen: Option<ChosenParents>,
}

/// The parents that nodes chose, one after the other.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChosenParents {
    /// When (s).
    pub times_s: Column,
    /// The nodes.
    pub nodes: Column,
    /// Their new parents, as in [`Tree::parents`].
    pub parents: Column,
}

/// Nodes whose batteries were empty.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Deaths {
    /// When (s).
    pub times_s: Column,
    /// The nodes.
    pub nodes: Column,
}

impl Tree {
    /// The tree of a recording, if it has one.
    pub(super) fn of(drawn: &RecordedWorld, frame: &Frame) -> Option<Self> {
        let number = |parent: Option<u32>| parent.map_or(0, |parent| parent.saturating_add(1));
        let chosen = (!drawn.parents.is_empty()).then(|| ChosenParents {
            times_s: frame.times(drawn.parents.iter().map(|chosen| chosen.time)),
            nodes: Column::U32(drawn.parents.iter().map(|chosen| chosen.node.0).collect()),
            parents: Column::U32(drawn.parents.iter().map(|chosen| number(chosen.parent)).collect()),
        });
        (!drawn.tree.is_empty()).then(|| Self {
            parents: Column::U32(drawn.tree.iter().map(|edge| number(edge.parent)).collect()),
            span_s: [frame.seconds(SimTime::ZERO), frame.seconds(drawn.tree_end)],
            chosen,
        })
    }
}

impl Deaths {
    /// The deaths in a recording, if there are any.
    pub(super) fn of(drawn: &RecordedWorld, frame: &Frame) -> Option<Self> {
        (!drawn.deaths.is_empty()).then(|| Self {
            times_s: frame.times(drawn.deaths.values().copied()),
            nodes: Column::U32(drawn.deaths.keys().map(|node| node.0).collect()),
        })
    }
}
