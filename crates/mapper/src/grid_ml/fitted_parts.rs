//! ML-TM under a profile that is fitted to a log in parts.

use sextant_channel::ReceptionLog;
use sextant_kernel::{Interrupted, NodeId, Watch};

use super::fitted_ml_tm::{GridKind, map_evidence};
use super::ml_tm_parts::fixed;
use crate::each_node::EachNode;
use crate::error::MapError;
use crate::grid_ml::fitted::{CurveSample, Fit, FitScene, GridSize, SettledCurve, add_heard};
use crate::grid_ml::fitted_ml_tm::FittedMlTm;
use crate::grid_ml::ml_tm::MlTm;
use crate::knowledge::Knowledge;
use crate::learned::EstimatorFindings;
use crate::log_facts::reach::{HeardNode, centres, gross_m, heard_from};
use crate::log_facts::search_box::{Limits, SearchBox};
use crate::parts::{FixedLaw, LogParts, PartEstimator, PartsError, each_part, sample};
use crate::topology_map::TopologyMap;

/// A fitted profile, and what else of the whole log the map of a node depends on.
#[derive(Debug)]
struct FittedLaw {
    ml_tm: MlTm,
    fit: Fit,
    limits: Limits,
    /// Receptions beyond this are gross errors (m).
    gross_m: f64,
    grid: GridKind,
    /// The algorithm that needs sectors in the log, if one does.
    needs_sectors: Option<&'static str>,
}

impl FixedLaw for FittedLaw {
    fn map_part(&self, nodes: &[NodeId], log: &ReceptionLog, watch: &dyn Watch) -> Result<TopologyMap, MapError> {
        if let Some(algorithm) = self.needs_sectors {
            self.ml_tm.demand_sectors(log, algorithm)?;
        }
        let evidence = self.fit.evidence_of(log, |node| nodes[node.index()]);
        let boxes = boxes(&evidence, self.gross_m, &self.limits);
        map_evidence(&self.ml_tm, &self.fit, self.grid, &evidence, &boxes, watch)
    }

    fn learned(self: Box<Self>) -> Option<EstimatorFindings> {
        Some(EstimatorFindings::new(self.fit))
    }
}

/// The boxes of the nodes of `log` that were heard.
fn boxes(log: &ReceptionLog, gross_m: f64, limits: &Limits) -> Vec<(HeardNode, SearchBox)> {
    let heard = heard_from(log, &centres(log), gross_m);
    heard.into_iter().map(|heard| (heard, limits.of(&heard))).collect()
}

/// The first facts of a log in parts.
#[derive(Debug)]
struct Facts {
    /// The usual distance of each node that was heard from its stops (m), by node.
    usual_m: Vec<(NodeId, f64)>,
    /// Packets that the log lists.
    listed: u64,
    /// Packets of all nodes that each stop heard.
    heard_at: Vec<u64>,
}

impl Facts {
    fn of(ml_tm: &MlTm, parts: &dyn LogParts, watch: &dyn Watch) -> Result<Self, PartsError> {
        let heard_at = vec![0; parts.whole().stops().len()];
        let mut facts = Self { usual_m: Vec::new(), listed: 0, heard_at };
        each_part(parts, watch, &mut |nodes, log| {
            let log = &*ml_tm.counted(log);
            facts.listed += log.receptions().iter().map(|reception| u64::from(reception.sent)).sum::<u64>();
            add_heard(log, &mut facts.heard_at);
            let centres = centres(log);
            let of_nodes = nodes.iter().zip(&centres);
            facts.usual_m.extend(of_nodes.filter_map(|(&node, centre)| Some((node, centre.as_ref()?.usual_m))));
            Ok(())
        })?;
        facts.usual_m.sort_unstable_by_key(|&(node, _)| node);
        Ok(facts)
    }
}

impl FittedMlTm {
    /// The law of a log in parts; `None` if no node was heard.
    fn law(
        &self,
        parts: &dyn LogParts,
        needs_sectors: Option<&'static str>,
        watch: &dyn Watch,
    ) -> Result<Option<FittedLaw>, PartsError> {
        let (fitted, ml_tm, z_range_m) = self.stages();
        let whole = parts.whole();
        let facts = Facts::of(ml_tm, parts, watch)?;
        let of_packets_m = gross_m(facts.usual_m.iter().map(|&(_, usual_m)| usual_m));
        let mut farthest_m = Vec::new();
        each_part(parts, watch, &mut |_, log| {
            let log = &*ml_tm.counted(log);
            farthest_m.extend(heard_from(log, &centres(log), of_packets_m).into_iter().map(|heard| heard.farthest_m));
            Ok(())
        })?;
        let Some(scene) = FitScene::of(whole, z_range_m, ml_tm.grid_step_m(), &farthest_m) else { return Ok(None) };
        let every = scene.every(facts.usual_m.len(), whole.node_count(), facts.listed);
        let nodes: Vec<NodeId> = facts.usual_m.iter().map(|&(node, _)| node).step_by(every).collect();
        let few = sample(parts, &nodes, watch)?;
        let few = &*ml_tm.counted(&few);
        let sampled = numbered(boxes(few, of_packets_m, &scene.limits));
        let sampled = CurveSample { log: few, nodes: &sampled, heard_at: &facts.heard_at };
        let Some(settled) = fitted.settle(&sampled, &scene, ml_tm.sectors(), watch)? else { return Ok(None) };
        let fit = with_outliers(&settled, &scene, of_packets_m, ml_tm, parts, watch)?;
        let ml_tm = fixed(&self.with_fit(&fit), &PartsEvidence { parts, fit: &fit }, watch)?;
        let limits = Limits::new(whole, fit.reach_m, fit.heights);
        let (gross_m, grid) = grid(&ml_tm, &fit, &limits, parts, watch)?;
        Ok(Some(FittedLaw { ml_tm, fit, limits, gross_m, grid, needs_sectors }))
    }

    /// The same for an `algorithm` that needs sectors in the log.
    pub(super) fn fix_for<'a>(
        &'a self,
        parts: &dyn LogParts,
        knowledge: &'a Knowledge<'a>,
        needs_sectors: Option<&'static str>,
        watch: &dyn Watch,
    ) -> Result<Box<dyn FixedLaw + 'a>, PartsError> {
        if let Some(algorithm) = needs_sectors {
            each_part(parts, watch, &mut |_, log| self.stages().1.demand_sectors(log, algorithm))?;
        }
        match self.law(parts, needs_sectors, watch)? {
            Some(law) => Ok(Box::new(law)),
            None => Ok(Box::new(EachNode { estimator: self.stages().1.clone(), knowledge })),
        }
    }
}

impl PartEstimator for FittedMlTm {
    fn fix<'a>(
        &'a self,
        parts: &dyn LogParts,
        knowledge: &'a Knowledge<'a>,
        watch: &dyn Watch,
    ) -> Result<Box<dyn FixedLaw + 'a>, PartsError> {
        self.fix_for(parts, knowledge, None, watch)
    }
}

/// The nodes with their boxes.
fn numbered(boxes: Vec<(HeardNode, SearchBox)>) -> Vec<(NodeId, SearchBox)> {
    boxes.into_iter().map(|(heard, within)| (heard.node, within)).collect()
}

/// The fit of a settled curve, with the outliers of all parts.
fn with_outliers(
    settled: &SettledCurve,
    scene: &FitScene,
    gross_m: f64,
    ml_tm: &MlTm,
    parts: &dyn LogParts,
    watch: &dyn Watch,
) -> Result<Fit, PartsError> {
    let mut outliers: Vec<(NodeId, u32)> = Vec::new();
    each_part(parts, watch, &mut |nodes, log| {
        let log = &*ml_tm.counted(log);
        let heard = numbered(boxes(log, gross_m, &scene.limits));
        let found: Result<_, Interrupted> = settled.outliers(log, &heard, scene, watch);
        outliers.extend(found?.into_iter().map(|(node, stop)| (nodes[node.index()], stop)));
        Ok(())
    })?;
    outliers.sort_unstable();
    Ok(settled.fit(scene, outliers))
}

/// The distance beyond which receptions of the evidence are gross errors (m), and the grid that suits all nodes.
fn grid(
    ml_tm: &MlTm,
    fit: &Fit,
    limits: &Limits,
    parts: &dyn LogParts,
    watch: &dyn Watch,
) -> Result<(f64, GridKind), PartsError> {
    let evidence = PartsEvidence { parts, fit };
    let mut usual_m: Vec<f64> = Vec::new();
    each_part(&evidence, watch, &mut |_, log| {
        usual_m.extend(centres(log).iter().flatten().map(|centre| centre.usual_m));
        Ok(())
    })?;
    let gross_m = gross_m(usual_m.into_iter());
    let mut size = GridSize::default();
    each_part(&evidence, watch, &mut |nodes, log| {
        let mut boxes = boxes(log, gross_m, limits);
        boxes.iter_mut().for_each(|(heard, _)| heard.node = nodes[heard.node.index()]);
        size.add(&boxes, log.receptions().len(), fit, ml_tm.grid_step_m());
        Ok(())
    })?;
    let stops = parts.whole().stops().len() - fit.dead_stops.len();
    Ok((gross_m, GridKind::of(parts.whole(), size, stops)))
}

/// The part of a log in parts that is evidence under a fit.
#[derive(Debug)]
struct PartsEvidence<'a> {
    parts: &'a dyn LogParts,
    fit: &'a Fit,
}

impl LogParts for PartsEvidence<'_> {
    fn whole(&self) -> &ReceptionLog {
        self.parts.whole()
    }

    fn count(&self) -> usize {
        self.parts.count()
    }

    fn nodes(&self, part: usize) -> &[NodeId] {
        self.parts.nodes(part)
    }

    fn read(&self, part: usize) -> Result<ReceptionLog, PartsError> {
        let nodes = self.nodes(part);
        Ok(self.fit.evidence_of(&self.parts.read(part)?, |node| nodes[node.index()]))
    }
}
