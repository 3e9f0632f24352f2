//! Estimators that map each node by itself, part by part.

use sextant_channel::ReceptionLog;
use sextant_kernel::{NodeId, Watch};

use crate::error::MapError;
use crate::estimator::Estimator;
use crate::knowledge::Knowledge;
use crate::parts::FixedLaw;
use crate::topology_map::TopologyMap;

/// The law of an estimator that needs none: it maps each node by itself.
#[derive(Debug)]
pub(crate) struct EachNode<'a, E> {
    pub(crate) estimator: E,
    pub(crate) knowledge: &'a Knowledge<'a>,
}

impl<E: Estimator> FixedLaw for EachNode<'_, E> {
    fn map_part(&self, _: &[NodeId], log: &ReceptionLog, watch: &dyn Watch) -> Result<TopologyMap, MapError> {
        self.estimator.estimate(&Knowledge { log, ..*self.knowledge }, watch).map(|(map, _)| map)
    }
}
