//! The map that nodes computed themselves, and its errors.

use std::f64::consts::TAU;

use sextant_apps::distributed::{Category, MappingRecord, MappingRole};
use sextant_channel::Position;
use sextant_kernel::{NodeId, Unwatched};
use sextant_mac::EnergySpent;
use sextant_mapper::{CoordinateFrame, Estimate, KnowledgeKind, PositionError, TopologyMap};
use sextant_recording::messages::MappedNodeMessage;
use sextant_scenario::{NodeMapJob, Scenario};
use sextant_sim::{Network, NetworkRecord, RobotRecord, RoleConfig};

use super::evaluation::{Evaluation, sector_displacement, truth};
use super::mapped_node;
use super::mission::UnalignedMap;
use super::scattering;
use super::simulator::Simulated;
use crate::measure::{Dimensions, Subject, Truth, measure};
use crate::summary::{
    AlignmentSummary, AnchorCounts, DistributedSummary, MapSummary, MeanAndMax, MessagesSummary,
    MobileAnchorsSummary, OrientationErrorSummary, SectorsSummary,
};

/// What the map uses.
const KNOWLEDGE: &[KnowledgeKind] = &[KnowledgeKind::AnchorReceptions, KnowledgeKind::Anchors];

/// The map that the nodes of `scenario` computed, compared with its world; `None` if they computed none. It does not
/// stop when the user interrupts: it is what the nodes had then.
///
/// # Panics
/// Never: nobody stops the work.
#[must_use]
pub(super) fn evaluate_distributed(scenario: &Scenario, simulated: &Simulated) -> Option<Evaluation> {
    let map = scenario.distributed()?;
    let found = topology_map(map, &simulated.nodes);
    let truth = truth(scenario);
    let names: Vec<String> = scenario.world().nodes.iter().map(|node| node.name.clone()).collect();
    let network = scenario.networks()[map.network.index()].name.iter().cloned();
    let subject = Subject { name: &map.name, knowledge: KNOWLEDGE.to_vec(), networks: network.collect() };
    let displacement = sector_displacement(scenario, &[map.network], &found, &truth);
    let known: Vec<Option<Position>> = truth.into_iter().map(Some).collect();
    let known = Truth { places: &known, anchors: scenario.anchors(), dimensions: Dimensions::Space };
    let measured = measure(&subject, &found, None, &names, Some(known), scenario.metrics(), &Unwatched);
    let summary = MapSummary {
        alignment: Some(AlignmentSummary::None),
        sectors: displacement.as_ref().map(SectorsSummary::from),
        message_energy_j: message_energy_j(scenario, map, &simulated.nodes),
        distributed: Some(summary(scenario, map, simulated)),
        ..measured.expect("nobody stops the work")
    }
    .judged();
    let made = UnalignedMap::new(&map.name, &found);
    Some(Evaluation {
        name: map.name.clone(),
        map: found,
        made,
        learned: None,
        summary,
        wall_s: 0.0,
        operations: 0.0,
    })
}

/// The places that the nodes believe in.
fn topology_map(map: &NodeMapJob, nodes: &[MappingRecord]) -> TopologyMap {
    let estimate = |node: &MappingRecord| node.estimate.clone().or_else(|| node.place.map(Estimate::of_place));
    TopologyMap {
        algorithm: map.algorithm,
        estimates: nodes.iter().map(estimate).collect(),
        grid_step_m: Some(map.grid_step_m),
        vertices_evaluated: nodes.iter().map(|node| node.vertices).sum(),
        heights: None,
        frame: CoordinateFrame::World,
    }
}

fn summary(scenario: &Scenario, map: &NodeMapJob, simulated: &Simulated) -> DistributedSummary {
    let (survey, nodes) = (&simulated.survey, &simulated.nodes[..]);
    let record = &survey.networks[map.network.index()];
    let names = scenario.world().nodes.iter().map(|node| &node.name);
    let unplaced: Vec<String> =
        names.zip(nodes).filter(|(_, node)| node.place.is_none()).map(|(name, _)| name.clone()).collect();
    let iterations = nodes.iter().map(|node| node.last_change).max().unwrap_or(0);
    // A node that died computes no more.
    let lives = |node: NodeId| !survey.deaths.iter().any(|death| death.node == node);
    let is_bad = |(index, node): &(usize, &MappingRecord)| {
        let is_placed = node.role == MappingRole::Node && node.place.is_some();
        is_placed && node.category == Category::Bad && lives(NodeId::from_index(*index))
    };
    let bad = nodes.iter().enumerate().filter(is_bad).count();
    let has_time = unplaced.is_empty() || iterations < map.max_iterations;
    let computed = || nodes.iter().filter(|node| node.estimate.is_some());
    let mean = |total: u64| total as f64 / nodes.len() as f64;
    let joules = record.energy[..nodes.len()].iter();
    DistributedSummary {
        iterations,
        converged: !survey.interrupted && bad == 0 && has_time,
        bad,
        unplaced,
        anchors: anchors(map, nodes),
        orientation_error_deg: orientation_error_deg(scenario, map, nodes),
        messages: messages(nodes, record),
        frames_received_mean: mean(nodes.iter().map(|node| node.frames_received).sum()),
        mobile: mobile(scenario, &survey.robots, nodes),
        vertices_mean: (computed().count() > 0)
            .then(|| MeanAndMax::of(computed().map(|node| node.vertices as f64)).mean),
        vertices_max: computed().map(|node| node.vertices).max(),
        memory_octets: MeanAndMax::of(nodes.iter().map(|node| (node.grid_octets + node.table_octets) as f64)),
        scattering: scattering::of_heard(nodes, &truth(scenario)),
        near_scattering: scattering::of_near(nodes, &truth(scenario), scenario.metrics().scattering_neighbourhood_m),
        radio_energy_j: MeanAndMax::of(joules.map(EnergySpent::total_j)),
    }
}

fn is_anchor(node: &&MappingRecord) -> bool {
    node.role != MappingRole::Node
}

fn anchors(map: &NodeMapJob, nodes: &[MappingRecord]) -> AnchorCounts {
    let count = |is: fn(&MappingRecord) -> bool| nodes.iter().filter(|node| is(node)).count();
    let gave_up = count(|node| node.gave_up);
    let initial = count(|node| node.role == MappingRole::InitialAnchor) + gave_up;
    let new = count(|node| matches!(node.role, MappingRole::NewAnchor { .. }));
    let all = nodes.iter().filter(is_anchor);
    let without_directions = map.has_sectors().then(|| all.clone().filter(|node| node.directions.is_none()).count());
    AnchorCounts { initial, gave_up, new, without_directions }
}

fn messages(nodes: &[MappingRecord], record: &NetworkRecord) -> MessagesSummary {
    let sum = |of: fn(&MappingRecord) -> u64| nodes.iter().map(of).sum::<u64>();
    MessagesSummary {
        place: sum(|node| node.messages.place),
        report: sum(|node| node.messages.report),
        beacon: sum(|node| node.messages.beacon),
        coordinates: sum(|node| node.messages.coordinates),
        octets: sum(|node| node.messages.octets),
        mean_per_node: sum(|node| node.messages.total()) as f64 / nodes.len() as f64,
        sent: sum(|node| node.sent),
        lost_queue: record.packets[..nodes.len()].iter().map(|packets| packets.lost_queue).sum(),
    }
}

fn mobile(scenario: &Scenario, robots: &[RobotRecord], nodes: &[MappingRecord]) -> Option<MobileAnchorsSummary> {
    let mobile = || scenario.robots_of_survey().zip(robots).filter(|(config, _)| config.role == RoleConfig::Anchor);
    mobile().next()?;
    let heard = nodes.iter().filter(|node| node.mobile_stops_heard > 0).count();
    Some(MobileAnchorsSummary {
        heard_share: heard as f64 / nodes.len() as f64,
        stops: mobile().map(|(_, robot)| robot.stops).sum(),
        stops_heard_mean: MeanAndMax::of(nodes.iter().map(|node| node.mobile_stops_heard as f64)).mean,
        path_length_m: mobile().map(|(_, robot)| robot.path_length_m).sum(),
    })
}

/// Errors of the azimuths of anchors, in degrees.
fn orientation_error_deg(
    scenario: &Scenario,
    map: &NodeMapJob,
    nodes: &[MappingRecord],
) -> Option<OrientationErrorSummary> {
    let antennas = scenario.networks()[map.network.index()].technology.antennas()?;
    let headings_rad = antennas.node_headings_rad(scenario.seed(), nodes.len());
    let first = antennas.nodes().sectors().iter().next()?.wedge().ok()?;
    let first_rad = first.azimuth_from_rad + 0.5 * first.azimuth_width_rad;
    let error_deg = |(node, heading_rad): (&MappingRecord, &f64)| {
        let turn = (node.directions.as_ref()?.azimuth_rad - heading_rad - first_rad) / TAU;
        Some(360.0 * (turn - turn.round()).abs())
    };
    let errors_deg: Vec<f64> = nodes.iter().zip(&headings_rad).filter_map(error_deg).collect();
    let statistics = PositionError::of(&errors_deg)?;
    Some(OrientationErrorSummary { mean: statistics.mean, p90: statistics.p90 })
}

/// Energy of the messages by the formulas of the thesis (eq. 5.9 and 5.10), with frames of the mean size of the messages
/// that were sent (J). The anchors and stops heard are means over the nodes; the anchors are the initial ones.
fn message_energy_j(scenario: &Scenario, map: &NodeMapJob, nodes: &[MappingRecord]) -> Option<f64> {
    let messages: u64 = nodes.iter().map(|node| node.messages.total()).sum();
    let octets: u64 = nodes.iter().map(|node| node.messages.octets).sum();
    if messages == 0 {
        return None;
    }
    let payload = u16::try_from(octets.div_ceil(messages)).ok()?;
    let Network { technology, radio_states, .. } = &scenario.networks()[map.network.index()];
    let frame = technology.frame_energy(radio_states, technology.frame_octets(payload))?;
    let mean = |of: fn(&MappingRecord) -> usize| MeanAndMax::of(nodes.iter().map(|node| of(node) as f64)).mean;
    let anchors = scenario.anchors().len();
    let (anchors, others) = (anchors as f64, (nodes.len() - anchors) as f64);
    let (heard, sectors) = (mean(|node| node.anchors_heard), f64::from(map.sectors()));
    let has_mobile = scenario.config().robots.iter().any(|robot| robot.role == RoleConfig::Anchor);
    Some(if has_mobile {
        frame.dmmtm_hs_j(others, anchors, sectors, heard, mean(|node| node.mobile_stops_heard))
    } else {
        frame.dmmtm_ss_j(others, anchors, sectors, heard)
    })
}

/// What each node found, for a recording.
pub(super) fn messages_of_nodes(simulated: &Simulated, map: &NodeMapJob) -> impl Iterator<Item = MappedNodeMessage> {
    let energy = &simulated.survey.networks[map.network.index()].energy;
    simulated
        .nodes
        .iter()
        .zip(energy)
        .enumerate()
        .map(|(index, (node, spent))| mapped_node::message(NodeId::from_index(index), node, spent.total_j()))
}
