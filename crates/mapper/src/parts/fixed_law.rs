//! Estimators whose law is fixed for a whole log before its parts are mapped.

use std::fmt;

use sextant_channel::ReceptionLog;
use sextant_kernel::{NodeId, Unreported, Watch, Work};

use super::survey_parts::SurveyParts;
use super::{LogParts, PartsError};
use crate::error::MapError;
use crate::knowledge::Knowledge;
use crate::learned::EstimatorFindings;
use crate::log_facts::SoughtHeights;
use crate::survey_frame::{Axes, in_survey};
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// An estimator that can map a log part by part.
pub trait PartEstimator {
    /// Fixes all that the estimate of a node takes from other nodes.
    ///
    /// # Errors
    /// If a part cannot be read, the algorithm lacks knowledge, or `watch` ends the work.
    fn fix<'a>(
        &'a self,
        parts: &dyn LogParts,
        knowledge: &'a Knowledge<'a>,
        watch: &dyn Watch,
    ) -> Result<Box<dyn FixedLaw + 'a>, PartsError>;
}

/// What is known before the parts of a log are mapped. The estimate of a node depends on it, on the stops, and on what was
/// heard of the node.
pub trait FixedLaw: fmt::Debug {
    /// The map of a part, whose nodes have the numbers `nodes` in the whole log.
    ///
    /// # Errors
    /// If the map would need more memory than allowed, or `watch` ends the work.
    fn map_part(&self, nodes: &[NodeId], log: &ReceptionLog, watch: &dyn Watch) -> Result<TopologyMap, MapError>;

    /// What was learned from the whole log, if anything.
    fn learned(self: Box<Self>) -> Option<EstimatorFindings> {
        None
    }
}

/// The map of all parts by `estimator`, which is called `name` and works in these axes, with what was learned from the whole log.
pub(crate) fn map_parts(
    estimator: &dyn PartEstimator,
    name: &'static str,
    axes: Axes,
    parts: &dyn LogParts,
    knowledge: &Knowledge<'_>,
    watch: &dyn Watch,
) -> Result<(TopologyMap, Option<EstimatorFindings>), PartsError> {
    let survey = match axes {
        Axes::Log => None,
        Axes::Survey => SurveyParts::of(parts, watch)?,
    };
    let prior = survey.as_ref().zip(knowledge.prior).map(|(survey, prior)| survey.prior(prior));
    let knowledge = match &survey {
        Some(survey) => in_survey(knowledge, survey.whole(), prior.as_ref()),
        None => *knowledge,
    };
    let turned: &dyn LogParts = match &survey {
        Some(survey) => survey,
        None => parts,
    };
    let law = estimator.fix(turned, &knowledge, watch)?;
    let nodes = parts.whole().node_count();
    let mut map = TopologyMap {
        estimates: vec![None; nodes],
        ..TopologyMap::of_places(name, Vec::new(), CoordinateFrame::World)
    };
    let wanted = (0..parts.count()).filter(|&part| parts.is_wanted(part)).count();
    // A part takes about as long as the whole divided by their number; how long that is, only the parts can say.
    watch.begin(Work { name, unit: "tile", steps: wanted as u64, operations: 0.0 });
    for part in (0..parts.count()).filter(|&part| parts.is_wanted(part)) {
        watch.check()?;
        let of_part = match parts.made(part)? {
            Some(made) => made,
            None => {
                let made = law.map_part(turned.nodes(part), &turned.read(part)?, &Unreported(watch))?;
                let made = match &survey {
                    Some(survey) => survey.map_in_log(part, made),
                    None => made,
                };
                parts.keep(part, &made)?;
                made
            }
        };
        for (node, estimate) in parts.nodes(part).iter().zip(of_part.estimates) {
            map.estimates[node.index()] = estimate;
        }
        map.vertices_evaluated += of_part.vertices_evaluated;
        map.grid_step_m = map.grid_step_m.or(of_part.grid_step_m);
        map.heights = joined(map.heights, of_part.heights);
        watch.advance(1);
    }
    let learned = law.learned();
    let in_log = |learned| match &survey {
        Some(survey) => survey.learned_in_log(learned),
        None => learned,
    };
    Ok((map, learned.map(in_log)))
}

/// The heights of two parts of a map.
fn joined(one: Option<SoughtHeights>, other: Option<SoughtHeights>) -> Option<SoughtHeights> {
    let Some((one, other)) = one.zip(other) else { return one.or(other) };
    Some(SoughtHeights { low_m: one.low_m.min(other.low_m), high_m: one.high_m.max(other.high_m), ..one })
}
