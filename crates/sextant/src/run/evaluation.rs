//! One map of a survey, and its errors.

use sextant_channel::{NetworkLogs, Position};
use sextant_kernel::{Interrupted, Watch};
use sextant_mapper::{CoordinateFrame, EstimatorFindings, MapError, SectorDisplacement, TopologyMap};
use sextant_scenario::{MapJob, Scenario};
use sextant_sim::{NetworkId, Survey};

use super::bound::{self, LazyBound};
use super::discovery::Discoveries;
use super::error::RunError;
use super::message_energy::message_energy_j;
use super::mission::UnalignedMap;
use super::operations::CountedWork;
use crate::mapping::MapLogs;
use crate::measure::{Dimensions, NodeSectors, Subject, Truth, displacement, in_world, measure};
use crate::summary::{MapSummary, SectorsSummary, Stopwatch};

/// A map, what was estimated with it, and its errors.
#[derive(Clone, Debug)]
pub struct Evaluation {
    /// Its name in the scenario.
    pub name: String,
    /// The map, in world coordinates.
    pub map: TopologyMap,
    /// The map as applications get it.
    pub made: UnalignedMap,
    /// What else was estimated from the log.
    pub learned: Option<EstimatorFindings>,
    /// Properties of the map, and its errors.
    pub summary: MapSummary,
    /// Time to compute and measure it on this machine (s); 0 for a map that the nodes computed in the simulation.
    pub wall_s: f64,
    /// Elementary operations of the algorithm, at most, as it announced them to the watch; 0 if it announced none.
    pub operations: f64,
}

/// Computes the map `named` from `survey` and `discoveries`, and compares it with the world of `scenario`. `bound` is
/// that of the survey, which is the same for all its maps.
///
/// # Errors
/// If the map cannot be computed, or `watch` stops the work.
pub(super) fn evaluate(
    scenario: &Scenario,
    named: &MapJob,
    survey: &Survey,
    discoveries: &Discoveries,
    bound: &LazyBound,
    watch: &dyn Watch,
) -> Result<Evaluation, RunError> {
    let bound = bound::of_map(scenario, named, survey, bound, watch)?;
    let start = Stopwatch::start();
    let logs = MapLogs::from(&survey.logs);
    let networks = scenario.networks_of(named);
    let knowledge = discoveries.knowledge(scenario, &logs, named);
    let counted = CountedWork::new(watch);
    let (map, learned, not_made) = match named.mapper.map_and_learn(knowledge, &counted) {
        Ok((map, learned)) => (map, learned, None),
        // The robots heard or measured nothing of the kind. What they recorded is kept all the same.
        Err(why @ (MapError::Missing { .. } | MapError::NoStops)) => {
            let places = vec![None; logs.of(named).node_count()];
            let map = TopologyMap::of_places(named.mapper.name(), places, CoordinateFrame::World);
            (map, None, Some(why.to_string()))
        }
        Err(error) => return Err(error.into()),
    };
    let operations = counted.operations();
    let made = UnalignedMap::new(&named.name, &map);
    let truth = truth(scenario);
    let known: Vec<Option<Position>> = truth.iter().copied().map(Some).collect();
    let (map, alignment) = in_world(map, Some(&known));
    let displacement = sector_displacement(scenario, &networks, &map, &truth);
    let truth = Truth { places: &known, anchors: scenario.anchors(), dimensions: Dimensions::Space };
    let summary = MapSummary {
        not_made,
        alignment: Some(alignment),
        sectors: displacement.as_ref().map(SectorsSummary::from),
        message_energy_j: message_energy_j(scenario, named, survey, discoveries),
        posterior_bound_m: bound.as_ref().and_then(|bound| bound.as_ref().ok()).copied(),
        posterior_bound_absent: bound.and_then(Result::err).map(|why| why.to_string()),
        ..measure(
            &Subject::new(named, logs.of(named)),
            &map,
            learned.as_ref(),
            logs.of(named).names(),
            Some(truth),
            scenario.metrics(),
            watch,
        )?
    }
    .judged();
    Ok(Evaluation { name: named.name.clone(), map, made, learned, summary, wall_s: start.elapsed_s(), operations })
}

/// The map `named` of `logs`, which are a part of those of a survey, in world coordinates; `None` if the algorithm needs more
/// than they have.
///
/// # Errors
/// If `watch` stops the work.
pub(super) fn map_of_part(
    scenario: &Scenario,
    named: &MapJob,
    logs: &NetworkLogs,
    discoveries: &Discoveries,
    watch: &dyn Watch,
) -> Result<Option<TopologyMap>, Interrupted> {
    let logs = MapLogs::from(logs);
    match named.mapper.map_and_learn(discoveries.knowledge(scenario, &logs, named), watch) {
        Ok((map, _)) => {
            let known: Vec<Option<Position>> = truth(scenario).into_iter().map(Some).collect();
            Ok(Some(in_world(map, Some(&known)).0))
        }
        Err(MapError::Interrupted(interrupted)) => Err(interrupted),
        Err(_) => Ok(None),
    }
}

/// The sector displacement of a map from the logs of `networks`; `None` if the nodes have no sectors in any of them.
pub(super) fn sector_displacement(
    scenario: &Scenario,
    networks: &[NetworkId],
    map: &TopologyMap,
    truth: &[Position],
) -> Option<SectorDisplacement> {
    let mut technologies = networks.iter().map(|network| &scenario.networks()[network.index()].technology);
    let antennas = technologies.find_map(|technology| technology.antennas())?;
    let nodes = antennas.nodes();
    let headings_rad = antennas.node_headings_rad(scenario.seed(), truth.len());
    let sectors = u32::from(nodes.sector_count() / nodes.rings());
    let antennas = NodeSectors { sectors, headings_rad: &headings_rad };
    displacement(truth, map, antennas, scenario.metrics())
}

/// The true positions of the nodes.
pub(super) fn truth(scenario: &Scenario) -> Vec<Position> {
    scenario.world().nodes.iter().map(|node| node.position).collect()
}
