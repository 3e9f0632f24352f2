//! Maps by gains of a log in parts.

use std::fmt;

use sextant_channel::{ReceptionLog, SectorGains};
use sextant_kernel::{NodeId, Watch};

use super::fit::thinned;
use super::scene::{AntennaScene, LeastStrengths};
use super::settled::SettledLaw;
use super::{KnownObstacles, PatternMap};
use crate::count_rule::CountRule;
use crate::error::MapError;
use crate::learned::EstimatorFindings;
use crate::log_facts::reach::{centres, gross_m, heard_from};
use crate::parts::{FixedLaw, LogParts, PartsError, each_part, sample};
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// The law of a log in parts; no law if nothing was heard.
struct LawOfParts {
    settled: Option<SettledLaw>,
    counts: CountRule,
    /// Receptions beyond this are gross errors (m).
    gross_m: f64,
    name: &'static str,
}

impl fmt::Debug for LawOfParts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LawOfParts").field("name", &self.name).finish_non_exhaustive()
    }
}

impl PatternMap {
    /// The law of a log in parts, the same as of the whole log.
    ///
    /// # Errors
    /// If a part cannot be read, or `watch` ends the work.
    pub(crate) fn fix(
        self,
        parts: &dyn LogParts,
        gains: &SectorGains,
        known: Option<KnownObstacles<'_>>,
        name: &'static str,
        watch: &dyn Watch,
    ) -> Result<Box<dyn FixedLaw>, PartsError> {
        let counts = self.counts;
        let mut usual_m = Vec::new();
        let mut least = LeastStrengths::default();
        each_part(parts, watch, &mut |_, log| {
            least = least.and(LeastStrengths::of(log));
            usual_m.extend(centres(&counts.counted(log)).iter().flatten().map(|centre| centre.usual_m));
            Ok(())
        })?;
        let gross_m = gross_m(usual_m.into_iter());
        let mut heard: Vec<(NodeId, f64)> = Vec::new();
        each_part(parts, watch, &mut |nodes, log| {
            let log = &*counts.counted(log);
            let of_part = heard_from(log, &centres(log), gross_m);
            heard.extend(of_part.iter().map(|heard| (nodes[heard.node.index()], heard.farthest_m)));
            Ok(())
        })?;
        heard.sort_unstable_by_key(|&(node, _)| node);
        let farthest_m: Vec<f64> = heard.iter().map(|&(_, farthest_m)| farthest_m).collect();
        let settled = match AntennaScene::of(&self, parts.whole(), gains, &farthest_m, least) {
            Some(scene) => {
                let scene = scene.among(known, parts.whole());
                let nodes: Vec<NodeId> = thinned(&heard).into_iter().map(|(node, _)| node).collect();
                let few = sample(parts, &nodes, watch)?;
                let few = &*counts.counted(&few);
                let boxes = scene.boxes(&heard_from(few, &centres(few), gross_m));
                Some(SettledLaw::of(self, scene, few, &boxes, name, watch)?)
            }
            None => None,
        };
        Ok(Box::new(LawOfParts { settled, counts, gross_m, name }))
    }
}

impl FixedLaw for LawOfParts {
    fn map_part(&self, _: &[NodeId], log: &ReceptionLog, watch: &dyn Watch) -> Result<TopologyMap, MapError> {
        let log = &*self.counts.counted(log);
        match &self.settled {
            Some(settled) => settled.map(log, &heard_from(log, &centres(log), self.gross_m), self.name, watch),
            None => Ok(TopologyMap::of_places(self.name, vec![None; log.node_count()], CoordinateFrame::World)),
        }
    }

    fn learned(self: Box<Self>) -> Option<EstimatorFindings> {
        self.settled.map(|settled| EstimatorFindings::new(settled.into_fit()))
    }
}
