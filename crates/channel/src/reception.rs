//! What a listener heard: all that a mapper may know.

mod builder;
mod columns;
mod view;

use sextant_kernel::{NodeId, SimTime};

use crate::{Position, SectorTable};
pub use builder::ReceptionLogBuilder;
use columns::Columns;
pub use view::{Receptions, ReceptionsIter};

/// A place where the robot listened for a while.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// When listening began.
    pub time: SimTime,
    /// Where the robot stood, in its own odometry frame [m].
    pub position: Position,
}

/// What was heard of one node at one stop. A pair of node and stop without a reception means that
/// the robot listened and heard nothing (0 of 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reception {
    /// The node that was heard.
    pub node: NodeId,
    /// Index of the stop.
    pub stop: u32,
    /// Packets received, at most `sent`.
    pub received: u32,
    /// Packets that the node sent while the robot listened; 0 of 0: no evidence either way.
    pub sent: u32,
    /// Identity of the antenna sector of best reception, if the listener has sectors (0-based).
    pub sector: Option<u8>,
    /// Mean received signal strength of the packets [dBm], if it was measured.
    pub rssi_dbm: Option<f64>,
}

/// A place where a range sensor of the robot met an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// When.
    pub time: SimTime,
    /// The point of the obstacle that was met [m].
    pub position: Position,
}

/// Everything that robots recorded on a survey: where they listened, what they heard there, where
/// they drove and what they met. No ground truth. Receptions are sorted by node, then by stop, at most one a pair.
///
/// Receptions are stored by columns: four octets each for the stop, and more only for what some reception of the log
/// has other than one packet received of one, no sector, no signal strength.
#[derive(Clone, Debug, PartialEq)]
pub struct ReceptionLog {
    names: Vec<String>,
    stops: Vec<Stop>,
    /// Sorted by node, then by stop.
    columns: Columns,
    /// Where the receptions of each node begin, and the end of the last.
    first: Vec<usize>,
    contacts: Vec<Contact>,
    sectors: Option<SectorTable>,
}

impl Default for ReceptionLog {
    /// A log of no nodes and no stops.
    fn default() -> Self {
        Self {
            names: Vec::new(),
            stops: Vec::new(),
            columns: Columns::default(),
            first: vec![0],
            contacts: Vec::new(),
            sectors: None,
        }
    }
}

/// Why a reception log cannot be what it says.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LogError {
    /// A reception names a node that the log does not have.
    #[error("a reception names node {node}, but the log has {nodes} nodes (0 to {})", .nodes.saturating_sub(1))]
    UnknownNode {
        /// The node named.
        node: u32,
        /// Number of nodes.
        nodes: usize,
    },
    /// A reception names a stop that the log does not have.
    #[error("a reception of node `{node}` names stop {stop}, but the log has {stops} stops (0 to {})", .stops.saturating_sub(1))]
    UnknownStop {
        /// Name of the node.
        node: String,
        /// The stop named.
        stop: u32,
        /// Number of stops.
        stops: usize,
    },
    /// More packets received than sent.
    #[error("node `{node}` at stop {stop}: {received} packets received of {sent} sent; at most as many as sent")]
    MoreThanSent {
        /// Name of the node.
        node: String,
        /// Index of the stop.
        stop: u32,
        /// Packets received.
        received: u32,
        /// Packets sent.
        sent: u32,
    },
    /// Two receptions of one node at one stop.
    #[error("node `{node}` at stop {stop} appears twice; give one reception a node and stop")]
    Twice {
        /// Name of the node.
        node: String,
        /// Index of the stop.
        stop: u32,
    },
    /// A reception in a sector that the listener does not have.
    #[error("node `{node}` at stop {stop} was heard in sector {sector}; the listener's sectors are {known}")]
    UnknownSector {
        /// Name of the node.
        node: String,
        /// Index of the stop.
        stop: u32,
        /// The sector named.
        sector: u8,
        /// The sectors that there are.
        known: String,
    },
    /// A stop that is nowhere.
    #[error("stop {stop} is at ({x_m}, {y_m}, {z_m}); coordinates are metres, at most 10⁹ from zero")]
    NotFinite {
        /// Index of the stop.
        stop: usize,
        /// East [m].
        x_m: f64,
        /// North [m].
        y_m: f64,
        /// Up [m].
        z_m: f64,
    },
}

impl ReceptionLog {
    /// A log of the nodes `names` (index = [`NodeId`]; nodes never heard included where they are known to exist).
    /// The receptions may come in any order. A log too large for a list of [`Reception`]s is made with a
    /// [`ReceptionLogBuilder`].
    ///
    /// # Errors
    /// If a reception names a node or stop that does not exist, appears twice, or has more packets than were sent;
    /// if a stop is not finite.
    pub fn new(
        names: Vec<String>,
        stops: Vec<Stop>,
        receptions: Vec<Reception>,
        contacts: Vec<Contact>,
    ) -> Result<Self, LogError> {
        let mut builder = ReceptionLogBuilder::default();
        builder.extend(receptions);
        builder.build(names, stops, contacts)
    }

    /// The same log of a listener that has these sectors.
    ///
    /// # Errors
    /// If a reception names a sector that is not among them.
    pub fn with_sectors(self, sectors: SectorTable) -> Result<Self, LogError> {
        self.check_sectors(&sectors)?;
        Ok(Self { sectors: Some(sectors), ..self })
    }

    /// Whether every sector of a reception is among `sectors`.
    ///
    /// # Errors
    /// If one is not.
    pub fn check_sectors(&self, sectors: &SectorTable) -> Result<(), LogError> {
        let heard_in = |id: Option<u8>| id.filter(|&id| !sectors.contains(id));
        let place = self.receptions().sectors().and_then(|ids| ids.iter().position(|&id| heard_in(id).is_some()));
        match place.and_then(|at| self.receptions().get(at)) {
            Some(Reception { node, stop, sector: Some(sector), .. }) => Err(LogError::UnknownSector {
                node: self.names[node.index()].clone(),
                stop,
                sector,
                known: sectors.identities(),
            }),
            _ => Ok(()),
        }
    }

    /// The sectors of the listener, if the log tells.
    #[must_use]
    pub fn sectors(&self) -> Option<&SectorTable> {
        self.sectors.as_ref()
    }

    /// Number of nodes, heard or not.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.names.len()
    }

    /// Names of the nodes; the index is the [`NodeId`].
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// All stops, in the order of the survey.
    #[must_use]
    pub fn stops(&self) -> &[Stop] {
        &self.stops
    }

    /// All receptions, by node, then by stop.
    #[must_use]
    pub fn receptions(&self) -> Receptions<'_> {
        Receptions::of_nodes(self, 0..self.names.len())
    }

    /// The receptions of one node, by stop.
    ///
    /// # Panics
    /// If the log has no such node.
    #[must_use]
    pub fn of(&self, node: NodeId) -> Receptions<'_> {
        Receptions::of_nodes(self, node.index()..node.index() + 1)
    }

    /// Where the robots met obstacles.
    #[must_use]
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heard(node: u32, stop: u32) -> Reception {
        Reception { node: NodeId(node), stop, received: 1, sent: 1, sector: None, rssi_dbm: None }
    }

    fn log(receptions: Vec<Reception>) -> Result<ReceptionLog, LogError> {
        let stops = vec![Stop { time: SimTime::ZERO, position: Position::ORIGIN }; 3];
        ReceptionLog::new(vec!["a".into(), "b".into()], stops, receptions, Vec::new())
    }

    #[test]
    fn receptions_are_found_by_node_in_the_order_of_stops() {
        let log = log(vec![heard(1, 2), heard(0, 1), heard(1, 0)]).unwrap();
        assert_eq!(log.of(NodeId(0)), [heard(0, 1)]);
        assert_eq!(log.of(NodeId(1)), [heard(1, 0), heard(1, 2)]);
        assert_eq!(log.of(NodeId(1)).stops(), [0, 2]);
        assert_eq!(log.receptions(), [heard(0, 1), heard(1, 0), heard(1, 2)]);
    }

    #[test]
    fn impossible_receptions_are_refused() {
        assert!(matches!(log(vec![heard(2, 0)]), Err(LogError::UnknownNode { node: 2, nodes: 2 })));
        assert!(matches!(log(vec![heard(u32::MAX, 0)]), Err(LogError::UnknownNode { node: u32::MAX, .. })));
        assert!(matches!(log(vec![heard(1, 3)]), Err(LogError::UnknownStop { stop: 3, stops: 3, .. })));
        assert!(matches!(log(vec![heard(1, 1), heard(1, 1)]), Err(LogError::Twice { stop: 1, .. })));
        let apart = vec![heard(1, 1), heard(0, 2), heard(1, 0), heard(1, 1)];
        assert!(matches!(log(apart), Err(LogError::Twice { stop: 1, .. })));
        assert!(matches!(
            log(vec![Reception { received: 2, ..heard(0, 0) }]),
            Err(LogError::MoreThanSent { received: 2, sent: 1, .. })
        ));
    }
}
