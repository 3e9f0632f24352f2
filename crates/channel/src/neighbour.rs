//! What nodes heard of each other, and the nodes that know their positions.

use sextant_kernel::NodeId;

use crate::geometry::position::Position;

/// A node that knows its position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anchor {
    /// The node.
    pub node: NodeId,
    /// Where it is, in the world frame (m).
    pub position: Position,
}

/// What one node heard of another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// The node that heard.
    pub listener: NodeId,
    /// The node that was heard.
    pub sender: NodeId,
    /// Packets received, at most `sent`.
    pub received: u32,
    /// Packets that the sender put on air.
    pub sent: u32,
    /// Mean received signal strength of the packets (dBm), if it was measured.
    pub rssi_dbm: Option<f64>,
}

/// What the nodes of a network heard of each other: directed links, at most one per pair of listener and sender. No
/// link means that nothing was heard. No ground truth.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NeighbourLog {
    links: Vec<Link>,
    first: Vec<usize>,
}

/// Why a neighbour log is invalid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NeighbourError {
    /// A link of a node that does not exist.
    #[error("a link names node {node}, but there are {nodes} nodes (0 to {})", .nodes.saturating_sub(1))]
    UnknownNode {
        /// The node named.
        node: u32,
        /// Number of nodes.
        nodes: usize,
    },
    /// A node that heard itself.
    #[error("node {0} has a link with itself; a link joins two nodes")]
    Itself(u32),
    /// More packets received than sent.
    #[error("node {listener} received {received} of {sent} packets of node {sender}; allowed: 0 to {sent}")]
    MoreThanSent {
        /// The node that heard.
        listener: u32,
        /// The node that was heard.
        sender: u32,
        /// Packets received.
        received: u32,
        /// Packets sent.
        sent: u32,
    },
    /// Two links of one listener with one sender.
    #[error("the link of listener {listener} with sender {sender} appears twice; give it once")]
    Twice {
        /// The node that heard.
        listener: u32,
        /// The node that was heard.
        sender: u32,
    },
    /// A signal strength that is not a finite number.
    #[error("node {listener} heard node {sender} with {rssi_dbm} dBm; allowed: a finite number")]
    NotFinite {
        /// The node that heard.
        listener: u32,
        /// The node that was heard.
        sender: u32,
        /// The signal strength, as a person would write it.
        rssi_dbm: String,
    },
}

impl NeighbourLog {
    /// The log of a network of `nodes` nodes. The links may come in any order.
    ///
    /// # Errors
    /// If a link names a node that does not exist, joins a node with itself, has more packets than were sent or no
    /// finite signal strength, or appears twice.
    pub fn new(nodes: usize, mut links: Vec<Link>) -> Result<Self, NeighbourError> {
        links.sort_by_key(|link| (link.listener, link.sender));
        let mut first = vec![0; nodes + 1];
        let mut previous = None;
        for &Link { listener, sender, received, sent, rssi_dbm } in &links {
            if let Some(node) = [listener, sender].into_iter().find(|node| node.index() >= nodes) {
                return Err(NeighbourError::UnknownNode { node: node.0, nodes });
            }
            let (listener, sender) = (listener.0, sender.0);
            if listener == sender {
                return Err(NeighbourError::Itself(listener));
            }
            if received > sent {
                return Err(NeighbourError::MoreThanSent { listener, sender, received, sent });
            }
            if let Some(rssi_dbm) = rssi_dbm.filter(|rssi_dbm| !rssi_dbm.is_finite()) {
                return Err(NeighbourError::NotFinite { listener, sender, rssi_dbm: rssi_dbm.to_string() });
            }
            if previous.replace((listener, sender)) == Some((listener, sender)) {
                return Err(NeighbourError::Twice { listener, sender });
            }
            first[listener as usize + 1] += 1;
        }
        for i in 1..first.len() {
            first[i] += first[i - 1];
        }
        Ok(Self { links, first })
    }

    /// Number of nodes, with links or without.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.first.len().saturating_sub(1)
    }

    /// All links, by listener, then by sender.
    #[must_use]
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// The links of one listener, by sender.
    ///
    /// # Panics
    /// If the log has no such node.
    #[must_use]
    pub fn heard_by(&self, listener: NodeId) -> &[Link] {
        &self.links[self.first[listener.index()]..self.first[listener.index() + 1]]
    }

    /// What `listener` heard of `sender`, if anything.
    ///
    /// # Panics
    /// If the log has no such listener.
    #[must_use]
    pub fn link(&self, listener: NodeId, sender: NodeId) -> Option<&Link> {
        let links = self.heard_by(listener);
        links.binary_search_by_key(&sender, |link| link.sender).ok().map(|at| &links[at])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heard(listener: u32, sender: u32) -> Link {
        Link { listener: NodeId(listener), sender: NodeId(sender), received: 1, sent: 2, rssi_dbm: Some(-70.0) }
    }

    #[test]
    fn links_are_found_by_listener_and_sender() {
        let log = NeighbourLog::new(4, vec![heard(2, 3), heard(0, 1), heard(2, 0)]).unwrap();
        assert_eq!(log.node_count(), 4);
        assert_eq!(log.heard_by(NodeId(2)), [heard(2, 0), heard(2, 3)]);
        assert_eq!(log.heard_by(NodeId(3)), []);
        assert_eq!(log.link(NodeId(2), NodeId(3)), Some(&heard(2, 3)));
        assert_eq!(log.link(NodeId(3), NodeId(2)), None);
    }

    #[test]
    fn impossible_links_are_rejected() {
        let refusal = |link| NeighbourLog::new(3, vec![heard(0, 1), link]).unwrap_err();
        assert_eq!(refusal(heard(0, 3)), NeighbourError::UnknownNode { node: 3, nodes: 3 });
        assert_eq!(refusal(heard(2, 2)), NeighbourError::Itself(2));
        assert_eq!(refusal(heard(0, 1)), NeighbourError::Twice { listener: 0, sender: 1 });
        assert!(matches!(refusal(Link { received: 3, ..heard(1, 0) }), NeighbourError::MoreThanSent { .. }));
        assert!(matches!(
            refusal(Link { rssi_dbm: Some(f64::NAN), ..heard(1, 0) }),
            NeighbourError::NotFinite { .. }
        ));
    }
}
