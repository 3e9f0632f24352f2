//! The link model part by part: its law comes from nodes of all parts.

use sextant_channel::ReceptionLog;
use sextant_kernel::{NodeId, Watch};

use super::links::StopCells;
use super::{Learned, LinkModel};
use crate::error::MapError;
use crate::knowledge::Knowledge;
use crate::learned::EstimatorFindings;
use crate::log_facts::reach::{centres, gross_m, heard_from, reach_of_m};
use crate::parts::{FixedLaw, LogParts, PartEstimator, PartsError, each_part, sample};
use crate::topology_map::TopologyMap;

/// The law comes from at most so many nodes, which are spread evenly over all that were heard. In one piece it comes from
/// all.
const LAW_NODES: usize = 1024;

/// A law, and what else of the whole log the place of a node depends on.
#[derive(Debug)]
struct LinkLaw<'a> {
    /// `None` if nothing was heard.
    learned: Option<Learned<'a>>,
    cells: StopCells,
    reach_m: f64,
    /// Receptions beyond this are gross errors (m).
    gross_m: f64,
}

impl FixedLaw for LinkLaw<'_> {
    fn map_part(&self, _: &[NodeId], log: &ReceptionLog, watch: &dyn Watch) -> Result<TopologyMap, MapError> {
        let mut map = LinkModel::unmapped(log);
        if let Some(learned) = &self.learned {
            let heard = heard_from(log, &centres(log), self.gross_m);
            learned.locate(&self.cells.links(log, heard, self.reach_m), &mut map, watch)?;
        }
        Ok(map)
    }

    fn learned(self: Box<Self>) -> Option<EstimatorFindings> {
        self.learned.map(|learned| EstimatorFindings::new(learned.fit))
    }
}

impl PartEstimator for LinkModel {
    fn fix<'a>(
        &'a self,
        parts: &dyn LogParts,
        knowledge: &'a Knowledge<'a>,
        watch: &dyn Watch,
    ) -> Result<Box<dyn FixedLaw + 'a>, PartsError> {
        let mut usual_m: Vec<(NodeId, f64)> = Vec::new();
        each_part(parts, watch, &mut |nodes, log| {
            let of_nodes = nodes.iter().zip(centres(log));
            usual_m.extend(of_nodes.filter_map(|(&node, centre)| Some((node, centre?.usual_m))));
            Ok(())
        })?;
        usual_m.sort_unstable_by_key(|&(node, _)| node);
        let gross_m = gross_m(usual_m.iter().map(|&(_, usual_m)| usual_m));
        let mut farthest_m = Vec::new();
        each_part(parts, watch, &mut |_, log| {
            farthest_m.extend(heard_from(log, &centres(log), gross_m).into_iter().map(|heard| heard.farthest_m));
            Ok(())
        })?;
        let reach_m = reach_of_m(parts.whole(), farthest_m.into_iter());
        let cells = StopCells::of(parts.whole(), reach_m, self.config.rssi);
        let every = usual_m.len().div_ceil(LAW_NODES).max(1);
        let nodes: Vec<NodeId> = usual_m.iter().map(|&(node, _)| node).step_by(every).collect();
        let log = sample(parts, &nodes, watch)?;
        let links = cells.links(&log, heard_from(&log, &centres(&log), gross_m), reach_m);
        let learned = if nodes.is_empty() {
            None
        } else {
            self.learn(&links, log.stops(), (usual_m.len(), knowledge.prior), watch)?
        };
        Ok(Box::new(LinkLaw { learned, cells, reach_m, gross_m }))
    }
}
