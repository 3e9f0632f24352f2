//! What a first pass over a log counts: how much was heard of each node, and where.

use sextant_channel::{Position, Reception};
use sextant_kernel::NodeId;

use crate::summary::LogCounts;

/// What was heard of each node, and where.
#[derive(Clone, Debug, Default)]
pub(super) struct Census {
    nodes: Vec<NodeCounts>,
    /// What the receptions of the log have.
    pub(super) columns: Columns,
    with_strength: u64,
}

/// What was heard of a node.
#[derive(Clone, Copy, Debug)]
pub(super) struct NodeCounts {
    /// Pairs with a stop that the log lists.
    pub(super) listed: u32,
    /// Those of them in which a packet was received.
    heard: u32,
    received: u64,
    sent: u64,
    /// Corners of the rectangle that holds the stops that heard it (m); those of all stops that are listed if none did.
    low: [f32; 2],
    high: [f32; 2],
}

/// What the receptions of a log have, beyond one packet received of one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Columns {
    pub(super) counts: bool,
    pub(super) sectors: bool,
    strengths: bool,
    ratios: bool,
    /// They are rows, of which several may be one reception.
    are_rows: bool,
}

/// Octets of a row while it becomes a reception: as it is, and while rows are sorted.
const ROW: u64 = 60;

impl Columns {
    /// Octets of a reception in a log.
    pub(super) fn bytes(self) -> u64 {
        4 + 8 * u64::from(self.counts)
            + 2 * u64::from(self.sectors)
            + 8 * u64::from(self.strengths)
            + 8 * u64::from(self.ratios)
            + if self.are_rows { ROW } else { 0 }
    }

    /// Octets of the widest column.
    pub(super) fn widest(self) -> u64 {
        if self.counts || self.strengths || self.ratios { 8 } else { 4 }
    }

    /// Octets of a reception in the temporary file, at most.
    pub(super) fn spilled_bytes(self) -> u64 {
        super::row::SMALLEST
            + 8 * u64::from(self.counts)
            + u64::from(self.sectors)
            + 8 * u64::from(self.strengths)
            + 8 * u64::from(self.ratios)
    }
}

impl Default for NodeCounts {
    fn default() -> Self {
        let (low, high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
        Self { listed: 0, heard: 0, received: 0, sent: 0, low, high }
    }
}

impl NodeCounts {
    /// The middle of the stops (m).
    pub(super) fn middle(&self) -> [f64; 2] {
        [0, 1].map(|axis| 0.5 * (f64::from(self.low[axis]) + f64::from(self.high[axis])))
    }

    /// Two opposite corners of the rectangle of the stops (m).
    pub(super) fn corners(&self) -> [[f64; 2]; 2] {
        [self.low, self.high].map(|corner| corner.map(f64::from))
    }

    /// Half the longer side of the rectangle of the stops that heard it (m); `None` if none did.
    fn reach_m(&self) -> Option<f64> {
        let half = |axis: usize| 0.5 * (f64::from(self.high[axis]) - f64::from(self.low[axis]));
        (self.heard > 0).then(|| half(0).max(half(1)))
    }
}

impl Census {
    /// Counts a reception at a stop in this place.
    pub(super) fn count(&mut self, reception: &Reception, place: Position) {
        let &Reception { node, received, sent, sector, rssi_dbm, snr_db, .. } = reception;
        if node.index() >= self.nodes.len() {
            self.nodes.resize(node.index() + 1, NodeCounts::default());
        }
        let counts = &mut self.nodes[node.index()];
        if received > 0 && counts.heard == 0 {
            // Stops that listened in vain say less.
            *counts = NodeCounts { low: [f32::INFINITY; 2], high: [f32::NEG_INFINITY; 2], ..*counts };
        }
        counts.listed = counts.listed.saturating_add(1);
        counts.received += u64::from(received);
        counts.sent += u64::from(sent);
        if received > 0 || counts.heard == 0 {
            for (axis, along) in [place.x_m, place.y_m].into_iter().enumerate() {
                #[expect(clippy::cast_possible_truncation, reason = "only about where a node is")]
                let along = along as f32;
                counts.low[axis] = counts.low[axis].min(along);
                counts.high[axis] = counts.high[axis].max(along);
            }
        }
        if received > 0 {
            counts.heard = counts.heard.saturating_add(1);
            self.with_strength += u64::from(rssi_dbm.is_some());
        }
        self.columns.counts |= (received, sent) != (1, 1);
        self.columns.sectors |= sector.is_some();
        self.columns.strengths |= rssi_dbm.is_some();
        self.columns.ratios |= snr_db.is_some();
    }

    /// What was counted are rows, of which several may be one reception.
    pub(super) fn holds_rows(&mut self) {
        self.columns.are_rows = true;
    }

    /// Makes room for all `nodes` of the log.
    pub(super) fn complete(&mut self, nodes: usize) {
        self.nodes.resize(nodes, NodeCounts::default());
    }

    /// What is known of each node that the log lists at some stop.
    pub(super) fn listed(&self) -> impl Iterator<Item = (NodeId, &NodeCounts)> {
        let numbered = self.nodes.iter().enumerate().map(|(node, counts)| (NodeId::from_index(node), counts));
        numbered.filter(|(_, counts)| counts.listed > 0)
    }

    /// Receptions that the log lists.
    pub(super) fn receptions(&self) -> u64 {
        self.nodes.iter().map(|counts| u64::from(counts.listed)).sum()
    }

    /// Half the longer side of the rectangle of the stops that heard a node: the median over the nodes (m).
    pub(super) fn reach_m(&self) -> f64 {
        let mut reaches: Vec<f64> = self.nodes.iter().filter_map(NodeCounts::reach_m).collect();
        if reaches.is_empty() {
            return 0.0;
        }
        let middle = reaches.len() / 2;
        *reaches.select_nth_unstable_by(middle, f64::total_cmp).1
    }

    /// What a summary and the notes say of the log.
    pub(super) fn log_counts(&self) -> LogCounts {
        let heard = || self.nodes.iter().filter(|counts| counts.received > 0);
        LogCounts {
            receptions: heard().map(|counts| u64::from(counts.heard)).sum(),
            with_strength: self.with_strength,
            received: heard().map(|counts| counts.received).sum(),
            listed_of_heard: heard().map(|counts| u64::from(counts.listed)).sum(),
            sent_of_heard: heard().map(|counts| counts.sent).sum(),
            unheard: (0..)
                .map(NodeId)
                .zip(&self.nodes)
                .filter(|(_, c)| c.received == 0)
                .map(|(node, _)| node)
                .collect(),
        }
    }
}
