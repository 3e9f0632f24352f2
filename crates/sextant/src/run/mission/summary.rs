//! The summary of a mission.

use std::time::Duration;

use sextant_apps::navigation::MapFrame;
use sextant_apps::{LinkRecord, MissionArrival, MissionGoal, MissionOutcome, SoughtField};
use sextant_channel::Position;
use sextant_kernel::{NodeId, SimTime};
use sextant_recording::Way;
use sextant_scenario::{PlannedMission, Scenario};
use sextant_sim::{Estimate, Field, Survey};

use super::maps::WorkingMap;
use super::score::{self, Scored};
use crate::run::outcome::sensor_errors;
use crate::run::witness::Witness;
use crate::summary::{
    ArrivalSummary, EnergySummary, LinkSummary, MissionMessages, MissionRobot, MissionSummary, MissionTarget,
};

/// The summary of `mission`, from what its stations did and what truly happened.
pub(super) fn sum_up(
    scenario: &Scenario,
    mission: &PlannedMission,
    map: &WorkingMap,
    survey: &Survey,
    outcome: MissionOutcome,
    witness: &Witness,
    scored: &[Scored],
) -> MissionSummary {
    let nodes = scenario.world().nodes.len();
    let record = &survey.networks[mission.network.index()];
    let errors_m = map.placement.errors_m();
    let map_error_m = (!errors_m.is_empty()).then(|| errors_m.iter().sum::<f64>() / errors_m.len() as f64);
    let energy = survey.energy;
    let network = &scenario.networks()[mission.network.index()];
    let is_member: Vec<bool> = (0..nodes).map(|node| network.has(NodeId::from_index(node))).collect();
    let summary = MissionSummary {
        name: mission.name.clone(),
        algorithm: mission.algorithm,
        map: mission.map.name().to_owned(),
        map_error_m,
        sim_time_s: survey.end.as_secs_f64(),
        events: survey.events,
        interrupted: survey.interrupted,
        path_length_m: survey.robots.iter().map(|robot| robot.path_length_m).sum(),
        nodes: is_member.iter().filter(|&&is_member| is_member).count(),
        nodes_on_map: is_member.iter().zip(&map.places).filter(|&(&is, place)| is && place.is_some()).count(),
        has_own_frame: map.frame == MapFrame::Unknown,
        deaths: survey.deaths.iter().map(|death| scenario.world().nodes[death.node.index()].name.clone()).collect(),
        sinks: sinks(scenario, mission),
        robots: robots(mission, survey, witness, nodes),
        prediction_error_m: score::errors(scored, |estimate| matches!(estimate, Estimate::TargetPlace { .. })),
        own_place_error_m: score::errors(scored, |estimate| matches!(estimate, Estimate::OwnPlace(_))),
        field_error: score::errors(scored, |estimate| matches!(estimate, Estimate::FieldValue { .. })),
        sensor_errors: sensor_errors(scenario, survey),
        messages: MissionMessages {
            sent: record.packets.iter().map(|packets| packets.sent).sum(),
            kinds: outcome.messages,
            octets: Some(outcome.octets),
        },
        link: outcome.links.as_ref().map(LinkSummary::from),
        steps: outcome.steps,
        energy_j: EnergySummary { tx: energy.tx_j, rx: energy.rx_j, idle: energy.idle_j + energy.sleep_j },
        ..MissionSummary::default()
    };
    match mission.goal() {
        MissionGoal::Targets => {
            let summary = of_search(summary, targets(scenario, mission, witness));
            let captured = summary.captured == Some(true);
            let course = score::course(witness, scored, mission.duration, survey.end, captured);
            MissionSummary { course, ..summary }
        }
        MissionGoal::Field(sought) => of_seeking(scenario, sought, summary, &outcome.arrivals, witness),
        MissionGoal::Link => of_link(summary, outcome.links.as_ref()),
        MissionGoal::Other => summary,
    }
}

/// Names of the sinks of its network.
fn sinks(scenario: &Scenario, mission: &PlannedMission) -> Vec<String> {
    let setup = scenario.setup();
    let is_in = |sink: &&sextant_sim::Sink| sink.is_in(mission.network);
    setup.sinks.iter().filter(is_in).map(|sink| sink.name.clone()).collect()
}

fn robots(mission: &PlannedMission, survey: &Survey, witness: &Witness, nodes: usize) -> Vec<MissionRobot> {
    let energy = &survey.networks[mission.network.index()].energy;
    let robot = |(i, record): (usize, &sextant_sim::RobotRecord)| MissionRobot {
        name: record.name.clone(),
        path_length_m: record.path_length_m,
        captures: mission
            .goal()
            .is_targets()
            .then(|| witness.captures.iter().filter(|captured| captured.robot == i).count()),
        energy_j: energy[nodes + i].total_j(),
    };
    survey.robots.iter().enumerate().map(robot).collect()
}

/// What became of each target.
fn targets(scenario: &Scenario, mission: &PlannedMission, witness: &Witness) -> Vec<MissionTarget> {
    let robot = |number: usize| scenario.bodies()[mission.robots[number]].name.clone();
    let target = |(i, target): (usize, &sextant_sim::Target)| {
        let captured = witness.captures.iter().find(|captured| captured.target.index() == i);
        MissionTarget {
            name: target.name().to_owned(),
            captured_s: captured.map(|captured| captured.time.as_secs_f64()),
            robot: captured.map(|captured| robot(captured.robot)),
            left_s: witness.gone[i].filter(|_| captured.is_none()).map(SimTime::as_secs_f64),
        }
    };
    scenario.world().targets.iter().enumerate().map(target).collect()
}

fn of_search(summary: MissionSummary, targets: Vec<MissionTarget>) -> MissionSummary {
    let times: Option<Vec<f64>> = targets.iter().map(|target| target.captured_s).collect();
    MissionSummary {
        captured: Some(times.is_some()),
        time_s: times.and_then(|times| times.into_iter().reduce(f64::max)),
        targets,
        ..summary
    }
}

fn of_link(summary: MissionSummary, links: Option<&LinkRecord>) -> MissionSummary {
    let arrival = |links: &LinkRecord| (links.arrived == links.robots).then(|| links.last_arrival.as_secs_f64());
    let time_s = links.and_then(arrival);
    MissionSummary { arrived: Some(time_s.is_some()), time_s, ..summary }
}

fn of_seeking(
    scenario: &Scenario,
    sought: SoughtField,
    summary: MissionSummary,
    arrivals: &[MissionArrival],
    witness: &Witness,
) -> MissionSummary {
    let field = &witness.fields[sought.field.index()];
    let arrival = |arrival: &MissionArrival| {
        let (place, time) = (witness.robot_at(arrival.robot, arrival.time), before(arrival.time));
        ArrivalSummary {
            robot: summary.robots[arrival.robot].name.clone(),
            time_s: arrival.time.as_secs_f64(),
            believed: arrival.value,
            value: place.map_or(f64::NAN, |place| field.value(place, time)),
            source_m: place.filter(|_| sought.level.is_none()).and_then(|place| source_m(field, place, time)),
        }
    };
    let mut arrivals: Vec<ArrivalSummary> = arrivals.iter().map(arrival).collect();
    arrivals.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    let along = witness.robots.iter().flat_map(|way| way.points());
    let largest = along.map(|&(time, place)| field.value(place, before(time))).max_by(f64::total_cmp);
    MissionSummary {
        arrived: Some(!arrivals.is_empty()),
        time_s: arrivals.first().map(|arrival| arrival.time_s),
        source_m: arrivals.first().and_then(|arrival| arrival.source_m),
        level: sought.level,
        largest_value: largest,
        law_minimum_s: law_minimum_s(scenario, sought, witness),
        arrivals,
        ..summary
    }
}

/// Distance between a place and the nearest source that is there (m).
fn source_m(field: &Field, place: Position, time: SimTime) -> Option<f64> {
    let sources = field.gaussians().iter().filter(|source| source.is_active(time) && source.peak() > 0.0);
    sources.map(|source| source.center().distance_m(place)).min_by(f64::total_cmp)
}

/// Just before `time`: the source that a robot removes at its arrival is still there.
fn before(time: SimTime) -> SimTime {
    time.saturating_sub(Duration::from_nanos(1))
}

/// The least time (s) in which a law with a fixed climb rate takes one of the robots from where it starts to the level.
fn law_minimum_s(scenario: &Scenario, sought: SoughtField, witness: &Witness) -> Option<f64> {
    let rate = sought.climb_rate?;
    let field = &scenario.world().fields[sought.field.index()];
    let start = |way: &Way| way.places().next().map(|place| field.value(place, SimTime::ZERO));
    let highest = witness.robots.iter().filter_map(start).max_by(f64::total_cmp)?;
    Some((sought.arrival_value? - highest).max(0.0) / rate)
}
