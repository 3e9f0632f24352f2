//! A log that is read part by part.

use std::fmt;

use sextant_channel::{Reception, ReceptionLog, ReceptionLogBuilder, SectorReport};
use sextant_kernel::{NodeId, Watch};

use super::PartsError;
use crate::error::MapError;
use crate::topology_map::TopologyMap;

/// A log that is read part by part, as often as needed. Each node that was heard belongs to one part.
pub trait LogParts: fmt::Debug {
    /// The names of all nodes, all stops, and the sectors of the listener, without receptions.
    fn whole(&self) -> &ReceptionLog;

    /// Number of parts, at least one.
    fn count(&self) -> usize;

    /// The nodes of a part, in the order of their numbers in the whole log.
    fn nodes(&self, part: usize) -> &[NodeId];

    /// All that was heard of the nodes of a part, at all stops. Nodes have new numbers, in the order of
    /// [`nodes`](Self::nodes).
    ///
    /// # Errors
    /// If it cannot be read.
    fn read(&self, part: usize) -> Result<ReceptionLog, PartsError>;

    /// Whether a part is to be mapped. The nodes of others have no estimate.
    fn is_wanted(&self, _part: usize) -> bool {
        true
    }

    /// The map of a part, if it was made and kept before.
    ///
    /// # Errors
    /// If it cannot be read.
    fn made(&self, _part: usize) -> Result<Option<TopologyMap>, PartsError> {
        Ok(None)
    }

    /// Keeps the map of a part, so that it need not be made again.
    ///
    /// # Errors
    /// If it cannot be written.
    fn keep(&self, _part: usize, _map: &TopologyMap) -> Result<(), PartsError> {
        Ok(())
    }
}

/// Looks at a part: its nodes and its log.
type VisitPart<'a> = &'a mut dyn FnMut(&[NodeId], &ReceptionLog) -> Result<(), MapError>;

/// Calls `visit` with the nodes of each part, and with the part.
pub(crate) fn each_part(parts: &dyn LogParts, watch: &dyn Watch, visit: VisitPart<'_>) -> Result<(), PartsError> {
    for part in 0..parts.count() {
        watch.check()?;
        visit(parts.nodes(part), &parts.read(part)?)?;
    }
    Ok(())
}

/// The log of a few nodes, whose numbers are in ascending order.
pub(crate) fn sample(parts: &dyn LogParts, nodes: &[NodeId], watch: &dyn Watch) -> Result<ReceptionLog, PartsError> {
    let mut receptions = ReceptionLogBuilder::default();
    each_part(parts, watch, &mut |of_part, log| {
        for (at, node) in (0_u32..).map(NodeId).zip(of_part) {
            if let Ok(number) = nodes.binary_search(node) {
                let renumbered = |reception| Reception { node: NodeId::from_index(number), ..reception };
                receptions.extend(log.of(at).iter().map(renumbered));
            }
        }
        for report in log.sector_reports() {
            if let Ok(number) = nodes.binary_search(&of_part[report.node.index()]) {
                receptions.report(SectorReport { node: NodeId::from_index(number), ..report });
            }
        }
        if log.receptions().sectors().is_some() {
            receptions.keep_sectors();
        }
        Ok(())
    })?;
    let names = nodes.iter().map(|node| parts.whole().names()[node.index()].clone()).collect();
    parts.whole().part(names, receptions).map_err(|why| MapError::from(why).into())
}
