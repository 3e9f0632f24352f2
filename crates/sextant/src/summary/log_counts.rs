//! How much a log has.

use sextant_channel::ReceptionLog;
use sextant_kernel::NodeId;

/// How much was heard in a log.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct LogCounts {
    /// Pairs of a stop and a node from which at least one packet was received there.
    pub(crate) receptions: u64,
    /// Those of them with a signal strength.
    pub(crate) with_strength: u64,
    /// Packets received.
    pub(crate) received: u64,
    /// Pairs of a stop and a node that was heard somewhere, as far as the log lists them.
    pub(crate) listed_of_heard: u64,
    /// Packets sent in these pairs.
    pub(crate) sent_of_heard: u64,
    /// The nodes that were never heard.
    pub(crate) unheard: Vec<NodeId>,
}

impl LogCounts {
    /// Those of `log`.
    pub(crate) fn of(log: &ReceptionLog) -> Self {
        let mut counts = Self::default();
        for node in (0..log.node_count()).map(NodeId::from_index) {
            let entries = log.of(node);
            let heard = || entries.iter().filter(|reception| reception.received > 0);
            if heard().next().is_none() {
                counts.unheard.push(node);
                continue;
            }
            counts.receptions += heard().count() as u64;
            counts.with_strength += heard().filter(|reception| reception.rssi_dbm.is_some()).count() as u64;
            counts.listed_of_heard += entries.len() as u64;
            counts.received += entries.iter().map(|reception| u64::from(reception.received)).sum::<u64>();
            counts.sent_of_heard += entries.iter().map(|reception| u64::from(reception.sent)).sum::<u64>();
        }
        counts
    }

    /// Adds those of a part, whose nodes have the numbers `nodes` in the whole log.
    pub(crate) fn add(&mut self, part: Self, nodes: &[NodeId]) {
        self.receptions += part.receptions;
        self.with_strength += part.with_strength;
        self.received += part.received;
        self.listed_of_heard += part.listed_of_heard;
        self.sent_of_heard += part.sent_of_heard;
        self.unheard.extend(part.unheard.into_iter().map(|node| nodes[node.index()]));
    }

    /// Number of the nodes that were heard, of `nodes`.
    pub(crate) fn heard(&self, nodes: usize) -> u64 {
        (nodes - self.unheard.len()) as u64
    }
}
