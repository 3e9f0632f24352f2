//! The tree over which packets went, as figures show it.

use prost::Message as _;
use sextant_kernel::{NodeId, SimTime};

use super::RecordedWorld;
use crate::messages::{BatteryMessage, ParentChangeMessage, TreeEdgeMessage};

/// A node in the tree at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordedEdge {
    /// The node.
    pub node: NodeId,
    /// Its parent among the stations, nodes first and then sinks; `None` without one.
    pub parent: Option<u32>,
    /// Hops to a sink along the parents; `None` without a way.
    pub depth: Option<u32>,
    /// Whether it died, by a fault or of an empty battery.
    pub is_dead: bool,
}

/// A node has its first parent, or another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordedParent {
    /// When.
    pub time: SimTime,
    /// The node.
    pub node: NodeId,
    /// The new parent among the stations; `None` if the node has lost its way.
    pub parent: Option<u32>,
    /// Whether it had another one before.
    pub is_change: bool,
}

/// Reads the message of one node, and when it died.
pub(super) fn edge(data: &[u8]) -> Result<(RecordedEdge, Option<SimTime>), String> {
    let message = TreeEdgeMessage::decode(data).map_err(|why| why.to_string())?;
    let TreeEdgeMessage { node, parent_station, depth, died_ns, .. } = message;
    let edge = RecordedEdge { node: NodeId(node), parent: parent_station, depth, is_dead: died_ns.is_some() };
    Ok((edge, died_ns.map(SimTime::from_nanos)))
}

/// Reads the message of a parent that a node chose.
pub(super) fn parent(data: &[u8]) -> Result<RecordedParent, String> {
    let message = ParentChangeMessage::decode(data).map_err(|why| why.to_string())?;
    Ok(RecordedParent {
        time: SimTime::from_nanos(message.time_ns),
        node: NodeId(message.node),
        parent: message.parent_station,
        is_change: !message.old_parent.is_empty(),
    })
}

/// Reads when the battery of a node was empty, if it was.
pub(super) fn death(data: &[u8]) -> Result<Option<(NodeId, SimTime)>, String> {
    let message = BatteryMessage::decode(data).map_err(|why| why.to_string())?;
    Ok(message.depleted_ns.map(|at| (NodeId(message.node), SimTime::from_nanos(at))))
}

impl RecordedWorld {
    /// The tree at an instant: the parents that the nodes had chosen until then, or those at the end if nodes chose none. No way
    /// leads over a node that had died.
    #[must_use]
    pub fn tree_at(&self, time: SimTime) -> Vec<RecordedEdge> {
        let is_dead = |node: NodeId| self.deaths.get(&node).is_some_and(|&death| death <= time);
        let mut edges: Vec<RecordedEdge> =
            self.tree.iter().map(|edge| RecordedEdge { is_dead: is_dead(edge.node), ..*edge }).collect();
        if !self.parents.is_empty() {
            edges.iter_mut().for_each(|edge| edge.parent = None);
            for chosen in self.parents.iter().take_while(|chosen| chosen.time <= time) {
                if let Some(edge) = edges.get_mut(chosen.node.index()) {
                    edge.parent = chosen.parent;
                }
            }
        }
        let depths: Vec<Option<u32>> = edges.iter().map(|edge| depth(&edges, edge)).collect();
        edges.iter_mut().zip(depths).for_each(|(edge, depth)| edge.depth = depth);
        edges
    }
}

/// Hops from a node to a sink over nodes that live; `None` without a way, or along a loop.
fn depth(edges: &[RecordedEdge], from: &RecordedEdge) -> Option<u32> {
    let mut at = from;
    // The edges are those of all nodes, in their order.
    for hops in 1..=edges.len() {
        let parent = at.parent.filter(|_| !at.is_dead)?;
        match edges.get(parent as usize) {
            Some(next) => at = next,
            None => return u32::try_from(hops).ok(),
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    fn at(s: u64) -> SimTime {
        SimTime::ZERO + Duration::from_secs(s)
    }

    #[test]
    fn a_tree_at_an_instant_has_the_parents_of_then_and_no_way_over_the_dead() {
        // Node 0 hears the sink, which is station 3; 1 goes over 0, and 2 over 1, then over 0.
        let edge =
            |(node, parent)| RecordedEdge { node: NodeId(node), parent: Some(parent), depth: None, is_dead: false };
        let chosen = |(s, node, parent, is_change)| RecordedParent {
            time: at(s),
            node: NodeId(node),
            parent: Some(parent),
            is_change,
        };
        let world = RecordedWorld {
            tree: [(0, 3), (1, 0), (2, 0)].map(edge).into(),
            parents: [(1, 0, 3, false), (2, 1, 0, false), (3, 2, 1, false), (5, 2, 0, true)].map(chosen).into(),
            deaths: [(NodeId(1), at(8))].into(),
            ..RecordedWorld::default()
        };
        let depths = |s| world.tree_at(at(s)).iter().map(|edge| edge.depth).collect::<Vec<_>>();
        assert_eq!(depths(0), [None, None, None]);
        assert_eq!(depths(2), [Some(1), Some(2), None]);
        assert_eq!(depths(4), [Some(1), Some(2), Some(3)]);
        assert_eq!(depths(6), [Some(1), Some(2), Some(2)]);
        assert_eq!(depths(8), [Some(1), None, Some(2)]);
        // Without a word on changes, the tree is that of the end; over the dead no way leads.
        let fixed = RecordedWorld { parents: Vec::new(), deaths: [(NodeId(0), at(8))].into(), ..world.clone() };
        assert_eq!(
            fixed.tree_at(at(7)).iter().map(|edge| edge.depth).collect::<Vec<_>>(),
            [Some(1), Some(2), Some(2)]
        );
        assert_eq!(fixed.tree_at(at(8)).iter().map(|edge| edge.depth).collect::<Vec<_>>(), [None; 3]);
        // A loop leads nowhere.
        let looping = RecordedWorld { tree: [(0, 1), (1, 0)].map(edge).into(), ..RecordedWorld::default() };
        assert_eq!(looping.tree_at(at(1)).iter().map(|edge| edge.depth).collect::<Vec<_>>(), [None, None]);
    }
}
