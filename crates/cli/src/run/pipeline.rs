//! The stages of a run.

use std::time::Duration;

use sextant_kernel::{NodeId, SimTime};
use sextant_sim::{FrameFormat, SensorsConfig, Survey};

use super::application::{self, MadeMap};
use super::discovery::Discoveries;
use super::fields;
use super::gather::{Gathered, Gathering, Manner, Shown, Sniffer};
use super::maps::{Maps, map, record_distributed};
use super::outcome::sum_up;
use super::request::Request;
use super::simulator::{Simulated, Simulator};
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::recording::{FileCapture, FileRecorder, Origin, Phase, PlacedNode, SURVEY, Solid, Technologies};
use crate::scenario::Scenario;
use crate::summary::{ApplicationSummary, Stopwatch, Summary, Timing, peak_rss_bytes};
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
    let simulator = scenario.config().has_survey().then(|| Simulator::new(scenario)).transpose();
    let simulator = simulator.map_err(|error| Failure::bad_input(error.to_string()))?;
    let _keeper = interrupt.keep();
    let mut recorder = FileRecorder::create(request.recording)?;
    let mut capture = request.pcap.map(|path| FileCapture::create(path, technologies(scenario))).transpose()?;
    open(&mut recorder, scenario)?;
    discoveries.record(scenario, &mut recorder)?;
    let simulated = simulator.map(|simulator| {
        let outputs = Outputs { recorder: &mut recorder, capture: capture.as_mut() };
        survey(simulator, outputs, scenario, interrupt, request.quiet)
    });
    let simulated = simulated.transpose()?;
    let survey = simulated.as_ref().map(|simulated| &simulated.survey);
    let gather_s = start.elapsed_s();
    let map_start = Stopwatch::start();
    let end = survey.map_or(SimTime::ZERO, |survey| survey.end);
    let mut maps = Maps { recorder: &mut recorder, end, summaries: Vec::new(), made: Vec::new() };
    if let Some(simulated) = &simulated {
        record_distributed(scenario, simulated, &mut maps)?;
    }
    let mapped = survey.map_or(Ok(()), |survey| map(scenario, survey, &discoveries, &mut maps, &watcher));
    let interrupted = match mapped {
        Err(Failure::Interrupted) => true,
        outcome => outcome.map(|()| false)?,
    };
    watcher.clear();
    let map_s = map_start.elapsed_s();
    let Maps { summaries: maps, made, .. } = maps;
    let mut applied = Applied::default();
    if !(interrupted || scenario.applications().is_empty()) {
        let outputs = Outputs { recorder: &mut recorder, capture: capture.as_mut() };
        applied = apply_all(scenario, (&made, survey), outputs, interrupt, request.quiet)?;
    }
    if let Some(capture) = capture {
        capture.finish()?;
    }
    let interrupted = interrupted || applied.interrupted;
    let applications = applied.summaries;
    let mut summary = Summary { interrupted, ..sum_up(scenario, survey, &discoveries, maps, applications) };
    recorder.summary(&summary.to_json()?)?;
    recorder.finish()?;
    let events_per_s = survey.map(|survey| survey.events as f64 / gather_s);
    summary.timing = Some(Timing {
        wall_s: start.elapsed_s(),
        gather_s: Some(gather_s),
        map_s: Some(map_s),
        events_per_s,
        peak_rss_bytes: peak_rss_bytes(),
    });
    Ok(summary)
}

/// Simulates the survey and records it.
fn survey(
    simulator: Simulator,
    outputs: Outputs<'_>,
    scenario: &Scenario,
    interrupt: &Interrupt,
    quiet: bool,
) -> Result<Simulated, Failure> {
    let Outputs { recorder, capture } = outputs;
    let outputs = Outputs { recorder: &mut *recorder, capture };
    let (simulated, gathered) = gather(simulator, outputs, scenario, interrupt, quiet)?;
    let end = simulated.survey.end;
    for track in &gathered.tracks {
        recorder.path(end, &track.name, &track.places)?;
    }
    fields::record(scenario, &gathered.fields, end, recorder)?;
    Ok(simulated)
}

/// The applications that were run.
#[derive(Default)]
struct Applied {
    summaries: Vec<ApplicationSummary>,
    interrupted: bool,
}

/// Runs the applications one after the other, until the user interrupts, and records them with the phases of the run.
fn apply_all(
    scenario: &Scenario,
    (made, survey): (&[MadeMap], Option<&Survey>),
    outputs: Outputs<'_>,
    interrupt: &Interrupt,
    quiet: bool,
) -> Result<Applied, Failure> {
    let Outputs { recorder, mut capture } = outputs;
    let of_survey = |survey: &Survey| Phase { name: SURVEY.to_owned(), start: SimTime::ZERO, end: survey.end };
    let mut phases: Vec<Phase> = survey.map(of_survey).into_iter().collect();
    let mut applied = Applied::default();
    for application in scenario.applications() {
        if interrupt.is_requested() {
            applied.interrupted = true;
            break;
        }
        let start = phases.last().map_or(SimTime::ZERO, Phase::next_start);
        let outputs =
            application::Outputs { recorder: &mut *recorder, capture: capture.as_deref_mut(), start, quiet };
        let (summary, phase) = application::record(scenario, application, (made, survey), outputs, interrupt)?;
        applied.interrupted |= summary.interrupted;
        applied.summaries.push(summary);
        phases.push(phase);
    }
    recorder.phases(&phases)?;
    Ok(applied)
}

/// The technologies of the networks.
fn technologies(scenario: &Scenario) -> Technologies {
    let mut all = scenario
        .networks()
        .iter()
        .map(|network| matches!(network.technology.frame_format(), FrameFormat::Radiotap { .. }));
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
        if let Some(links) = network.technology.antennas() {
            let other = network.name.as_deref().filter(|_| i > 0);
            recorder.sectors(other, links.robot_sectors())?;
        }
    }
    Ok(())
}

/// The output files of a simulation.
struct Outputs<'a> {
    recorder: &'a mut FileRecorder,
    capture: Option<&'a mut FileCapture>,
}

fn gather<'i>(
    simulator: Simulator,
    outputs: Outputs<'_>,
    scenario: &Scenario,
    interrupt: &'i Interrupt,
    quiet: bool,
) -> Result<(Simulated, Gathered<'i>), Failure> {
    let duration = scenario.config().duration_s.map(Duration::from_secs_f64);
    // Without robots, the end is a time; nodes know when they have computed a map at the latest.
    let end = match scenario.distributed() {
        Some(map) => Some(duration.map_or(map.longest(), |duration| duration.min(map.longest()))),
        None => duration.filter(|_| scenario.robots_of_survey().next().is_none()),
    };
    let (what, steps, shown) = match (end, scenario.distributed()) {
        (Some(end), Some(_)) => ("in nodes", end.as_secs(), Shown::Messages),
        (Some(end), None) => ("simulating", end.as_secs(), Shown::Packets),
        (None, _) => ("gathering", scenario.world().nodes.len() as u64, Shown::NodesHeard),
    };
    let progress = (terminal::Progress::new(what, steps, quiet), shown);
    let names = scenario.robots_of_survey().map(|robot| robot.name.clone());
    let manner = Manner {
        frames: scenario.recording().frames,
        sniffer: outputs.capture.map(|capture| Sniffer::new(capture, scenario, scenario.captured_robot())),
        progress,
        offset: Duration::ZERO,
        witness: None,
    };
    let mut gathering = Gathering::new(outputs.recorder, interrupt, names, scenario, manner);
    let simulated = simulator.run(&mut gathering);
    Ok((simulated, gathering.finish()?))
}
