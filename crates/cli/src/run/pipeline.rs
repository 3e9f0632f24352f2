//! The stages of a run.

use std::borrow::Cow;
use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::{NodeId, SimTime, Watch};
use sextant_mapper::{Learned, Mapper, Surface, TopologyMap};
use sextant_sim::{Field, SensorsConfig, Survey};

use super::discovery::Discoveries;
use super::distributed::{evaluate_distributed, messages_of_nodes};
use super::evaluation::{self, Evaluation};
use super::fields;
use super::gather::{Gathering, Shown, Sniffed, Sniffer, Track};
use super::outcome::sum_up;
use super::request::Request;
use super::simulator::{Simulated, Simulator};
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::recording::{FileCapture, FileRecorder, GridPlane, Level, Origin, PlacedNode, Solid, Technologies};
use crate::scenario::{NamedMap, Scenario};
use crate::summary::{MapSummary, Stopwatch, Summary, Timing, peak_rss_bytes};
use crate::terminal::{self, Watcher};

/// Simulates `scenario`, records it, computes and measures its maps, and returns the results. If the user interrupts, the
/// receptions and the finished maps are recorded and returned.
///
/// # Errors
/// If the simulation or a file fails.
pub fn record(scenario: &Scenario, request: Request<'_>, interrupt: &Interrupt) -> Result<Summary, Failure> {
    let start = Stopwatch::start();
    let watcher = Watcher::new(interrupt, request.quiet);
    let discoveries = Discoveries::of(scenario, &watcher)?;
    watcher.clear();
    let simulator = Simulator::new(scenario).map_err(|error| Failure::bad_input(error.to_string()))?;
    let _keeper = interrupt.keep();
    let mut recorder = FileRecorder::create(request.recording)?;
    let mut capture = request.pcap.map(|path| FileCapture::create(path, technologies(scenario))).transpose()?;
    open(&mut recorder, scenario)?;
    discoveries.record(scenario, &mut recorder)?;
    let outputs = Outputs { recorder: &mut recorder, capture: capture.as_mut() };
    let (simulated, tracks, fields) = gather(simulator, outputs, scenario, interrupt, request.quiet)?;
    let survey = &simulated.survey;
    if let Some(capture) = capture {
        capture.finish()?;
    }
    let gather_s = start.elapsed_s();
    for track in &tracks {
        recorder.path(survey.end, &track.name, &track.places)?;
    }
    fields::record(scenario, &fields, survey.end, &mut recorder)?;
    let map_start = Stopwatch::start();
    let mut maps = Vec::new();
    record_distributed(scenario, &simulated, &mut recorder, &mut maps)?;
    let interrupted = match map(scenario, survey, &discoveries, (&mut recorder, &mut maps), &watcher) {
        Err(Failure::Interrupted) => true,
        outcome => outcome.map(|()| false)?,
    };
    watcher.clear();
    let map_s = map_start.elapsed_s();
    let mut summary = Summary { interrupted, ..sum_up(scenario, survey, &discoveries, maps) };
    recorder.summary(&summary.to_json()?)?;
    recorder.finish()?;
    let events_per_s = survey.events as f64 / gather_s;
    summary.timing = Some(Timing {
        wall_s: start.elapsed_s(),
        gather_s: Some(gather_s),
        map_s: Some(map_s),
        events_per_s: Some(events_per_s),
        peak_rss_bytes: peak_rss_bytes(),
    });
    Ok(summary)
}

/// The technologies of the networks.
fn technologies(scenario: &Scenario) -> Technologies {
    let mut all = scenario.networks().iter().map(|network| network.link.technology.ieee80211ad().is_some());
    let first = all.next().unwrap_or(false);
    match (first, all.all(|other| other == first)) {
        (_, false) => Technologies::Both,
        (false, true) => Technologies::Ieee802154,
        (true, true) => Technologies::Ieee80211ad,
    }
}

/// Records what is known before the first event.
fn open(recorder: &mut FileRecorder, scenario: &Scenario) -> Result<(), Failure> {
    let world = scenario.world();
    recorder.origin(Origin {
        scenario: scenario.name(),
        seed: scenario.seed().0,
        version: env!("CARGO_PKG_VERSION"),
    })?;
    recorder.scenario(scenario.text())?;
    let names: Vec<_> = world.nodes.iter().map(|node| node.name.clone()).collect();
    recorder.nodes(&names)?;
    open_logs(recorder, scenario)?;
    let solids: Vec<_> =
        world.obstacles.obstacles().iter().enumerate().map(|(i, obstacle)| Solid::of(obstacle, i)).collect();
    if !solids.is_empty() {
        recorder.obstacles(SimTime::ZERO, &solids)?;
    }
    let place = |(i, position)| PlacedNode { node: NodeId::from_index(i), position, error_m: None };
    let nodes: Vec<_> = world.nodes.iter().map(|node| node.position).enumerate().map(place).collect();
    recorder.world_nodes(SimTime::ZERO, &nodes)?;
    let sinks = scenario.config().sinks.iter().map(|sink| sink.position_m).enumerate();
    let sinks: Vec<_> = sinks.map(place).collect();
    if !sinks.is_empty() {
        recorder.world_sinks(SimTime::ZERO, &sinks)?;
    }
    let sensors = &scenario.config().sensors;
    if *sensors != SensorsConfig::default() {
        recorder.sensors(sensors)?;
    }
    Ok(())
}

/// Records which networks are surveyed, and the sectors of the robots in each.
fn open_logs(recorder: &mut FileRecorder, scenario: &Scenario) -> Result<(), Failure> {
    let surveyed: Vec<_> = scenario.surveyed().iter().map(|network| &scenario.networks()[network.index()]).collect();
    let names: Vec<String> = surveyed.iter().filter_map(|network| network.name.clone()).collect();
    if surveyed.len() > 1 {
        recorder.networks(&names)?;
    }
    for (i, network) in surveyed.iter().enumerate() {
        if let Some(links) = network.link.technology.ieee80211ad() {
            let other = network.name.as_deref().filter(|_| i > 0);
            recorder.sectors(other, &links.antennas.robot_sectors())?;
        }
    }
    Ok(())
}

/// The output files of a simulation.
struct Outputs<'a> {
    recorder: &'a mut FileRecorder,
    capture: Option<&'a mut FileCapture>,
}

fn gather(
    simulator: Simulator,
    outputs: Outputs<'_>,
    scenario: &Scenario,
    interrupt: &Interrupt,
    quiet: bool,
) -> Result<(Simulated, Vec<Track>, Vec<Field>), Failure> {
    let duration = scenario.config().duration_s.map(Duration::from_secs_f64);
    // Without robots, the end is a time; nodes know when they have computed a map at the latest.
    let end = match scenario.distributed() {
        Some(map) => Some(duration.map_or(map.longest(), |duration| duration.min(map.longest()))),
        None => duration.filter(|_| scenario.config().robots.is_empty()),
    };
    let (what, steps, shown) = match (end, scenario.distributed()) {
        (Some(end), Some(_)) => ("in nodes", end.as_secs(), Shown::Messages),
        (Some(end), None) => ("simulating", end.as_secs(), Shown::Packets),
        (None, _) => ("gathering", scenario.world().nodes.len() as u64, Shown::NodesHeard),
    };
    let progress = (terminal::Progress::new(what, steps, quiet), shown);
    let names = scenario.config().robots.iter().map(|robot| robot.name.clone());
    let sniffer = outputs.capture.map(|capture| Sniffer {
        capture,
        robot: scenario.captured_robot(),
        networks: scenario.networks().iter().map(Sniffed::from).collect(),
        channel: scenario.recording().pcap.channel,
    });
    let frames = scenario.recording().frames;
    let mut gathering = Gathering::new(outputs.recorder, frames, sniffer, interrupt, progress, names, scenario);
    let simulated = simulator.run(&mut gathering);
    let (tracks, fields) = gathering.finish()?;
    Ok((simulated, tracks, fields))
}

/// Records and measures the map that the nodes computed, if they did: also what they had when the user interrupted.
fn record_distributed(
    scenario: &Scenario,
    simulated: &Simulated,
    recorder: &mut FileRecorder,
    summaries: &mut Vec<MapSummary>,
) -> Result<(), Failure> {
    let (Some(map), Some(evaluation)) = (scenario.distributed(), evaluate_distributed(scenario, simulated)) else {
        return Ok(());
    };
    let end = simulated.survey.end;
    for message in messages_of_nodes(simulated, map) {
        recorder.mapped_node(end, &message)?;
    }
    let summary = evaluation.summary;
    record_map(recorder, end, &map.name, &evaluation.map, (&summary, &evaluation::truth(scenario)))?;
    if let Some(distributed) = &summary.distributed {
        let mut warn = |note: String| recorder.note(end, Level::Warning, &map.name, &note);
        if !distributed.unplaced.is_empty() {
            let (unplaced, all) = (distributed.unplaced.len(), simulated.nodes.len());
            let names = distributed.unplaced.join(", ");
            warn(format!("{unplaced} of {all} nodes could not work out a place: {names}"))?;
        }
        if !distributed.converged {
            warn(distributed.unsettled(simulated.survey.interrupted))?;
        }
    }
    summaries.push(summary);
    Ok(())
}

/// Records a map and its main errors.
fn record_map(
    recorder: &mut FileRecorder,
    end: SimTime,
    name: &str,
    map: &TopologyMap,
    (summary, truth): (&MapSummary, &[Position]),
) -> Result<(), Failure> {
    recorder.map(end, name, &placed(map, truth))?;
    for (what, value) in [
        ("position_error_mean_m", summary.position_error_m.map(|error| error.mean)),
        ("connectivity_error", summary.connectivity_error),
    ] {
        if let Some(value) = value {
            recorder.metric(end, &format!("{name}/{what}"), value)?;
        }
    }
    Ok(())
}

/// Computes, records and measures the maps of the scenario in order, until the user interrupts.
fn map(
    scenario: &Scenario,
    survey: &Survey,
    discoveries: &Discoveries,
    (recorder, summaries): (&mut FileRecorder, &mut Vec<MapSummary>),
    watch: &dyn Watch,
) -> Result<(), Failure> {
    watch.check()?;
    let truth = evaluation::truth(scenario);
    let bound_m = evaluation::bound_m(scenario, survey, watch)?;
    for named in scenario.maps() {
        let Evaluation { map, learned, summary } =
            evaluation::evaluate(scenario, named, (survey, discoveries), bound_m, watch)?;
        record_map(recorder, survey.end, &named.name, &map, (&summary, &truth))?;
        if map.unmapped() > 0 {
            let note = format!("{} of {} nodes were never heard and are not mapped", map.unmapped(), truth.len());
            recorder.note(survey.end, Level::Warning, &named.name, &note)?;
        }
        summaries.push(summary);
        record_likelihoods(scenario, named, learned.as_ref(), survey, recorder, watch)?;
    }
    Ok(())
}

fn placed(map: &TopologyMap, truth: &[Position]) -> Vec<PlacedNode> {
    let place = |(i, (mapped, truth)): (usize, (Option<Position>, &Position))| {
        let position = mapped?;
        Some(PlacedNode { node: NodeId::from_index(i), position, error_m: Some(position.distance_m(*truth)) })
    };
    map.positions().into_iter().zip(truth).enumerate().filter_map(place).collect()
}

/// Records the likelihood of each chosen node, on the plane through its maximum.
fn record_likelihoods(
    scenario: &Scenario,
    named: &NamedMap,
    learned: Option<&Learned>,
    survey: &Survey,
    recorder: &mut FileRecorder,
    watch: &dyn Watch,
) -> Result<(), Failure> {
    let log = evaluation::logs(scenario, survey).of(named);
    let fit = match learned {
        Some(Learned::Profile(fit)) => Some(fit),
        _ => None,
    };
    let ml_tm = match (&named.mapper, fit) {
        (Mapper::MlTm(ml_tm), _) => Some(ml_tm.clone()),
        (Mapper::MmTm(mm_tm), fit) => mm_tm.ml_tm(fit),
        (Mapper::FittedMlTm(fitted), Some(fit)) => Some(fitted.with_fit(fit)),
        _ => None,
    };
    let Some(ml_tm) = ml_tm else { return Ok(()) };
    let log = fit.map_or(Cow::Borrowed(log), |fit| Cow::Owned(fit.evidence(log)));
    for name in &scenario.recording().likelihood {
        let at = log.names().iter().position(|other| other == name).expect("the scenario was checked");
        if log.of(NodeId::from_index(at)).is_empty() {
            let note = format!("node {name} was never heard and has no likelihood");
            recorder.note(survey.end, Level::Warning, &named.name, &note)?;
            continue;
        }
        let surface = ml_tm.surface(&log, NodeId::from_index(at), watch)?;
        recorder.likelihood(survey.end, &named.name, name, &plane(&surface))?;
    }
    Ok(())
}

/// The plane through the maximum of a surface.
fn plane(surface: &Surface) -> GridPlane {
    let lattice = &surface.lattice;
    let [columns, rows, _] = lattice.counts();
    let (maximum, _) = surface.maximum();
    let height = |layer: usize| (lattice.position([0, 0, layer]).z_m - maximum.z_m).abs();
    let layer = (0..lattice.counts()[2]).min_by(|&a, &b| height(a).total_cmp(&height(b))).unwrap_or(0);
    let size = columns * rows;
    GridPlane {
        first: lattice.position([0, 0, layer]),
        step_m: lattice.step_m(),
        columns: u32::try_from(columns).expect("fewer than 2^32 columns"),
        values: surface.log_likelihood[layer * size..(layer + 1) * size].to_vec(),
    }
}
