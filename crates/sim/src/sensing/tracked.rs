//! A target on its way, and the nodes that detect it.

use std::collections::BTreeMap;

use sextant_kernel::NodeId;

use crate::world::target::{Course, Leg};

/// A target on its way.
pub(super) struct Tracked {
    pub(super) course: Course,
    pub(super) leg: Leg,
    /// The nodes in whose radius it is at the end of the leg, by number.
    pub(super) stays: Vec<Stay>,
    /// Number of its passages through the radius of each node; kept only if some are missed.
    pub(super) passages: BTreeMap<NodeId, u64>,
    /// The nodes that detect it now.
    pub(super) detected: Detected,
    /// Whether it is not in the world any more.
    pub(super) is_gone: bool,
}

/// A target within the radius of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Stay {
    pub(super) node: NodeId,
    /// Whether the sensor misses this passage.
    pub(super) is_missed: bool,
    /// Whether it is counted as missed: that is when it first comes into sight.
    pub(super) is_counted: bool,
    /// Whether the node sees it at the end of the leg.
    pub(super) in_sight: bool,
}

/// The nodes that detect a target now, by number.
#[derive(Clone, Debug, Default)]
pub(super) struct Detected {
    /// It is there.
    truly: Vec<NodeId>,
    /// False alarms; a node stands here once for each.
    falsely: Vec<NodeId>,
}

impl Tracked {
    pub(super) fn new(course: Course, leg: Leg) -> Self {
        Self {
            course,
            leg,
            stays: Vec::new(),
            passages: BTreeMap::new(),
            detected: Detected::default(),
            is_gone: false,
        }
    }
}

impl Stay {
    pub(super) fn new(node: NodeId, is_missed: bool) -> Self {
        Self { node, is_missed, is_counted: false, in_sight: false }
    }
}

impl Detected {
    /// The nodes near which the target is.
    pub(super) fn truly(&self) -> &[NodeId] {
        &self.truly
    }

    /// The target is near a node from now on. Returns whether the node detected nothing before.
    pub(super) fn enter(&mut self, node: NodeId) -> bool {
        match self.truly.binary_search(&node) {
            Ok(_) => false,
            Err(place) => {
                self.truly.insert(place, node);
                self.falsely.binary_search(&node).is_err()
            }
        }
    }

    /// The target is near a node no more. Returns whether the node detects nothing any more.
    pub(super) fn leave(&mut self, node: NodeId) -> bool {
        match self.truly.binary_search(&node) {
            Ok(place) => {
                self.truly.remove(place);
                self.falsely.binary_search(&node).is_err()
            }
            Err(_) => false,
        }
    }

    /// A false alarm of a node begins. Returns whether the node detected nothing before.
    pub(super) fn raise_false_alarm(&mut self, node: NodeId) -> bool {
        let found = self.falsely.binary_search(&node);
        let (Ok(place) | Err(place)) = found;
        self.falsely.insert(place, node);
        found.is_err() && self.truly.binary_search(&node).is_err()
    }

    /// A false alarm of a node is over. Returns whether the node detects nothing any more.
    pub(super) fn end_false_alarm(&mut self, node: NodeId) -> bool {
        if let Ok(place) = self.falsely.binary_search(&node) {
            self.falsely.remove(place);
        }
        self.falsely.binary_search(&node).is_err() && self.truly.binary_search(&node).is_err()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NODE: NodeId = NodeId(3);

    #[test]
    fn a_node_says_only_that_it_begins_or_ends_to_detect() {
        let mut detected = Detected::default();
        assert!(detected.enter(NODE));
        assert!(!detected.raise_false_alarm(NODE), "it detects the target already");
        assert!(!detected.leave(NODE), "the false alarm goes on");
        assert!(!detected.raise_false_alarm(NODE));
        assert!(!detected.end_false_alarm(NODE), "the second one goes on");
        assert!(detected.end_false_alarm(NODE));
        assert!(detected.raise_false_alarm(NODE));
        assert!(!detected.enter(NODE));
        assert!(!detected.end_false_alarm(NODE), "the target is there");
        assert!(detected.leave(NODE));
        assert!(!detected.leave(NODE), "it has said so");
    }
}
