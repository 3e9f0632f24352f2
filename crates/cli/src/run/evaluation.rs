//! One map of a survey, and its errors.

use sextant_channel::Position;
use sextant_kernel::{Interrupted, Watch};
use sextant_mapper::{KnowledgeKind, Learned, TopologyMap};
use sextant_sim::Survey;

use super::bound;
use super::discovery::Discoveries;
use super::message_energy::message_energy_j;
use crate::diagnostic::Failure;
use crate::measure::{Truth, in_world, measure};
use crate::scenario::{NamedMap, Scenario};
use crate::summary::MapSummary;

/// A map, what was estimated with it, and its errors.
#[derive(Clone, Debug)]
pub struct Evaluation {
    /// The map, in world coordinates.
    pub map: TopologyMap,
    /// What else was estimated from the log.
    pub learned: Option<Learned>,
    /// Properties of the map, and its errors.
    pub summary: MapSummary,
}

/// Computes the map `named` from `survey` and `discoveries`, and compares it with the world of `scenario`. `bound_m` is
/// the [`bound_m`] of the survey, which is the same for all its maps.
///
/// # Errors
/// If the map cannot be computed, or `watch` stops the work.
pub fn evaluate(
    scenario: &Scenario,
    named: &NamedMap,
    (survey, discoveries): (&Survey, &Discoveries),
    bound_m: Option<f64>,
    watch: &dyn Watch,
) -> Result<Evaluation, Failure> {
    let knowledge = discoveries.knowledge(scenario, survey);
    let (map, learned) = named.mapper.map_and_learn(knowledge, watch)?;
    let truth = truth(scenario);
    let (map, alignment) = in_world(map, Some(&truth));
    let truth = Truth { places: &truth, anchors: scenario.anchors() };
    let summary = MapSummary {
        alignment: Some(alignment),
        message_energy_j: message_energy_j(scenario, &named.mapper, survey, discoveries),
        posterior_bound_m: bound_m.filter(|_| named.mapper.uses().contains(&KnowledgeKind::RobotReceptions)),
        ..measure(named, &map, learned.as_ref(), survey.log.names(), Some(truth), scenario.metrics(), watch)?
    };
    Ok(Evaluation { map, learned, summary })
}

/// The posterior bound for all maps of `survey` (m); `None` if the scenario has no maps or the bound does not apply.
///
/// # Errors
/// If `watch` stops the work.
pub fn bound_m(scenario: &Scenario, survey: &Survey, watch: &dyn Watch) -> Result<Option<f64>, Interrupted> {
    if scenario.maps().is_empty() {
        return Ok(None);
    }
    bound::posterior_bound_m(scenario, survey, &truth(scenario), watch)
}

/// The true positions of the nodes.
pub(super) fn truth(scenario: &Scenario) -> Vec<Position> {
    scenario.world().nodes.iter().map(|node| node.position).collect()
}
