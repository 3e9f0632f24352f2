//! Grids part by part: what they take from a whole log before its parts are mapped.

use sextant_channel::ReceptionLog;
use sextant_kernel::{NodeId, Watch};

use crate::each_node::EachNode;
use crate::grid_ml::ml_tm::MlTm;
use crate::grid_ml::sector_errors;
use crate::knowledge::Knowledge;
use crate::parts::{FixedLaw, LogParts, PartEstimator, PartsError, each_part, sample};

impl PartEstimator for MlTm {
    fn fix<'a>(
        &'a self,
        parts: &dyn LogParts,
        knowledge: &'a Knowledge<'a>,
        watch: &dyn Watch,
    ) -> Result<Box<dyn FixedLaw + 'a>, PartsError> {
        let estimator = fixed(self, parts, watch)?;
        Ok(Box::new(EachNode { estimator, knowledge }))
    }
}

/// `ml_tm` with what it estimates from the whole log.
pub(super) fn fixed(ml_tm: &MlTm, parts: &dyn LogParts, watch: &dyn Watch) -> Result<MlTm, PartsError> {
    if !ml_tm.needs_sample() {
        return Ok(ml_tm.clone());
    }
    let mut heard = Vec::new();
    each_part(parts, watch, &mut |nodes, log| {
        heard.extend(heard_of(log).map(|node| nodes[node.index()]));
        Ok(())
    })?;
    heard.sort_unstable();
    let every = sector_errors::every(heard.len());
    let nodes: Vec<NodeId> = heard.into_iter().step_by(every).collect();
    Ok(ml_tm.with_errors_of(&sample(parts, &nodes, watch)?, watch)?)
}

/// The nodes of `log` that were heard.
fn heard_of(log: &ReceptionLog) -> impl Iterator<Item = NodeId> {
    let is_heard = |&node: &NodeId| log.of(node).iter().any(|reception| reception.received > 0);
    (0..log.node_count()).map(NodeId::from_index).filter(is_heard)
}
