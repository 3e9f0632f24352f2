//! The summary of a run.

use sextant_channel::NetworkLog;
use sextant_kernel::NodeId;
use sextant_kernel::text::hexadecimal;
use sextant_scenario::Scenario;
use sextant_sim::{Network, NetworkRecord, Packets, RoleConfig, SimulatedPart, Survey};
use sha2::{Digest, Sha256};

use super::battery;
use super::discovery::Discoveries;
use super::ending;
use super::mac;
use super::routing;
use super::simulator::Simulated;
use crate::summary::{
    EnergySummary, FaultsSummary, GatheringSummary, MapSummary, MissionSummary, NotListenedSummary, RegionSummary,
    ScenarioSummary, SectorReportsSummary, SensingSummary, SensorErrorCounts, SimulationSummary, Summary,
};

/// The summary of a run without timing: of its survey, if it has one, of the discovery before it, of its maps and of its
/// applications.
#[must_use]
pub(super) fn sum_up(
    scenario: &Scenario,
    simulated: Option<&Simulated>,
    discoveries: &Discoveries,
    maps: Vec<MapSummary>,
    applications: Vec<MissionSummary>,
) -> Summary {
    let of_survey = simulated.map(|simulated| of_survey(scenario, simulated)).unwrap_or_default();
    let survey = simulated.map(|simulated| &simulated.survey);
    let time = |of: fn(&MissionSummary) -> f64| applications.iter().map(of).sum::<f64>();
    let events: u64 = applications.iter().map(|application| application.events).sum();
    Summary {
        scenario: Some(identity(scenario)),
        simulation: Some(SimulationSummary {
            sim_time_s: survey.map_or(0.0, |survey| survey.end.as_secs_f64())
                + time(|application| application.sim_time_s),
            events: survey.map_or(0, |survey| survey.events) + events,
            moving_nodes: Some(scenario.world().motions.len()).filter(|&moving| moving > 0),
            nodes: scenario.world().nodes.len(),
            obstacles: scenario.world().obstacles.len(),
            region: survey.and_then(region),
        }),
        discovery: discoveries.summary(scenario),
        maps,
        applications,
        ..of_survey
    }
}

/// The parts of a summary that tell of the survey.
fn of_survey(scenario: &Scenario, simulated: &Simulated) -> Summary {
    let survey = &simulated.survey;
    let has_robots = scenario.config().robots.iter().any(|robot| robot.role == RoleConfig::Survey);
    let mut traffic = mac::traffic(scenario, survey).into_iter();
    Summary {
        mac: traffic.next(),
        other_networks: traffic.collect(),
        routing: routing::of(scenario, simulated),
        battery: battery::of(scenario, survey),
        sensing: sensing(scenario, survey),
        gathering: has_robots.then(|| gathering(scenario, simulated)),
        faults: faults(scenario, survey),
        notes: notes(scenario, simulated),
        ..Summary::default()
    }
}

/// Networks of whose traffic nothing is measured, because no packet was due in the time that counts.
fn notes(scenario: &Scenario, simulated: &Simulated) -> Vec<String> {
    let Simulated { survey, routing, .. } = simulated;
    let nodes = scenario.world().nodes.len();
    let networks = scenario.networks().iter().zip(&survey.networks);
    let is_empty = |(network, record): &(&Network, &NetworkRecord)| {
        let offered: u64 = match routing {
            Some(routing) => routing.stations[..nodes].iter().map(|station| station.packets.offered).sum(),
            None => record.packets[..nodes].iter().map(|packets| packets.offered).sum(),
        };
        offered == 0 && !survey.interrupted && network.traffic.kinds().any(|traffic| !traffic.is_silent())
    };
    let warm_up_s = scenario.warm_up().as_secs_f64();
    let after = if warm_up_s > 0.0 { format!(" after the warm-up of {warm_up_s} s") } else { String::new() };
    let note = |(network, _): (&Network, &NetworkRecord)| {
        let place = network.name.as_ref().map_or(String::new(), |name| format!("network {name}: "));
        format!("{place}no node had a packet{after}, so nothing is measured of its traffic")
    };
    networks.filter(is_empty).map(note).collect()
}

/// Which part of the nodes' traffic was simulated; `None` if all, as the scenario asks for.
fn region(survey: &Survey) -> Option<RegionSummary> {
    match survey.simulated {
        SimulatedPart::All => None,
        SimulatedPart::AllBecause(reason) => {
            Some(RegionSummary { simulated: "all", because: Some(reason.reason()), halo_m: None, share: 1.0 })
        }
        SimulatedPart::NearListeners { halo_m } => {
            #[expect(clippy::cast_precision_loss, reason = "far below 2^53 packets")]
            let [offered, left_out] = [survey.packets.offered as f64, survey.packets.not_simulated as f64];
            let share = if left_out > 0.0 { 1.0 - left_out / offered } else { 1.0 };
            Some(RegionSummary { simulated: "listeners", because: None, halo_m: Some(halo_m), share })
        }
    }
}

fn gathering(scenario: &Scenario, simulated: &Simulated) -> GatheringSummary {
    let survey = &simulated.survey;
    let packets = survey.packets;
    GatheringSummary {
        path_length_m: Some(survey.robots.iter().map(|robot| robot.path_length_m).sum()),
        path_is_by_stops: false,
        duration_s: Some(survey.end.as_secs_f64()),
        packets_not_simulated: matches!(survey.simulated, SimulatedPart::NearListeners { .. })
            .then_some(packets.not_simulated),
        packets_offered: Some(packets.offered),
        packets_sent: Some(packets.sent),
        packets_received: Some(packets.received),
        packets_received_by_robots: None,
        lost_collision: Some(packets.lost_collision),
        lost_channel_access: Some(packets.lost_channel_access),
        lost_signal: Some(packets.lost_signal),
        lost_queue: Some(packets.lost_queue),
        out_of_range: Some(packets.out_of_range),
        not_listened: Some(packets.not_listened),
        not_listened_by: Some(NotListenedSummary::from(&packets)),
        died: packets.died,
        pending: Some(packets.pending),
        energy_j: Some(EnergySummary {
            tx: survey.energy.tx_j,
            rx: survey.energy.rx_j,
            idle: survey.energy.idle_j + survey.energy.sleep_j,
        }),
        robots: ending::robots(scenario, simulated),
        interrupted: survey.interrupted,
        stops: stops(scenario, survey),
        sweeps: sweeps(scenario, survey),
        sector_reports: sector_reports(scenario, survey),
        receptions: heard(survey),
        ranges: GatheringSummary::ranges_of(survey.logs.iter().map(|network| &network.log)),
    }
}

/// What went wrong; `None` if no node can die and no anchor can lie.
fn faults(scenario: &Scenario, survey: &Survey) -> Option<FaultsSummary> {
    let (faults, nodes) = (&scenario.config().faults, &scenario.world().nodes);
    let name = |node: NodeId| nodes[node.index()].name.clone();
    let lying = || scenario.anchors().iter().filter(|anchor| anchor.position != nodes[anchor.node.index()].position);
    let is_depleted =
        |node: NodeId| survey.batteries.get(node.index()).is_some_and(|record| record.depleted.is_some());
    let others = || survey.deaths.iter().filter(|death| !is_depleted(death.node));
    let summary = FaultsSummary {
        deaths: faults.deaths.as_ref().map(|_| others().map(|death| name(death.node)).collect()),
        lying_anchors: faults.lying_anchors.as_ref().map(|_| lying().map(|anchor| name(anchor.node)).collect()),
    };
    (summary != FaultsSummary::default()).then_some(summary)
}

/// Stops at which robots listened.
fn stops(scenario: &Scenario, survey: &Survey) -> usize {
    let robots = survey.robots.iter().zip(scenario.robots_of_survey());
    robots.filter(|(_, config)| config.role == RoleConfig::Survey).map(|(record, _)| record.stops).sum()
}

/// Sector sweeps of the robots; `None` if there is no network with sector sweeps.
fn sweeps(scenario: &Scenario, survey: &Survey) -> Option<u64> {
    let nodes = scenario.world().nodes.len();
    let of_robots = |record: &NetworkRecord| -> u64 {
        record.packets[nodes..nodes + survey.robots.len()].iter().map(|packets| packets.sent).sum()
    };
    let has_sweeps = |network: &Network| network.technology.antennas().is_some();
    let networks = scenario.networks().iter().zip(&survey.networks).filter(|(network, _)| has_sweeps(network));
    networks.map(|(_, record)| of_robots(record)).reduce(|sum, sweeps| sum + sweeps)
}

/// Reports of all sectors that the robots asked for; `None` if they asked for none.
fn sector_reports(scenario: &Scenario, survey: &Survey) -> Option<SectorReportsSummary> {
    let nodes = scenario.world().nodes.len();
    let of_robots =
        |record: &NetworkRecord| record.packets[nodes..nodes + survey.robots.len()].iter().copied().sum::<Packets>();
    let Packets { reports_asked: asked, reports_received: received, .. } =
        survey.networks.iter().map(of_robots).sum();
    (asked > 0).then_some(SectorReportsSummary { asked, received })
}

/// Pairs of a stop and a node heard there, in each network.
fn heard(survey: &Survey) -> usize {
    survey
        .logs
        .iter()
        .map(|NetworkLog { log, .. }| log.receptions().iter().filter(|reception| reception.received > 0).count())
        .sum()
}

/// What the sensors said, if there was anything to sense.
fn sensing(scenario: &Scenario, survey: &Survey) -> Option<SensingSummary> {
    let world = scenario.world();
    let is_empty = world.targets.is_empty() && world.fields.is_empty();
    (!is_empty).then_some(SensingSummary {
        targets: world.targets.len(),
        fields: world.fields.len(),
        detections: survey.sensed.entered,
        samples: survey.sensed.sampled,
        errors: sensor_errors(scenario, survey),
    })
}

/// How often the sensors of targets erred, if they do.
pub(super) fn sensor_errors(scenario: &Scenario, survey: &Survey) -> Option<SensorErrorCounts> {
    let errs = scenario.world().sensors.targets.is_some_and(|sensor| sensor.errs());
    errs.then_some(SensorErrorCounts {
        missed_detections: survey.sensed.missed,
        false_detections: survey.sensed.false_alarms,
    })
}

/// The identity of the scenario.
fn identity(scenario: &Scenario) -> ScenarioSummary {
    ScenarioSummary {
        name: scenario.name().to_owned(),
        file: scenario.file_name(),
        sha256: hexadecimal(&Sha256::digest(scenario.text())),
        seed: scenario.seed().0,
        version: env!("CARGO_PKG_VERSION").to_owned(),
    }
}
