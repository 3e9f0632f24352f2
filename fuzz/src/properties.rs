//! What holds of every scenario that is accepted, and of every run.

use std::path::Path;

use serde_json::Value;
use sextant::mapping::{Input, map};
use sextant::run::RunError;
use sextant::scenario::{MapSettings, RecordedScenario};
use sextant::summary::{GatheringSummary, MacSummary, Stopwatch, TrafficSummary};
use sextant::{Run, RunRecorder, Scenario, ScenarioErrors, Summary};
use sextant_channel::{NetworkLogs, ReceptionLog};
use sextant_kernel::Unwatched;
use sextant_logs::ReadOptions;
use sextant_mapper::TopologyMap;
use sextant_recording::read_log;

use crate::budget::Budget;
use crate::scratch;
use crate::threads::on_one_and_three;

/// Longest message of an error (octets).
const LONGEST_MESSAGE: usize = 6000;
/// So often a run asks whether to go on before it is stopped.
const RUN_BUDGET: u64 = 20_000;

/// The errors of a scenario name what is wrong, and are not too long to read.
pub(crate) fn errors_are_clear(errors: &ScenarioErrors) {
    assert!(!errors.errors().is_empty(), "refused without an error");
    for error in errors.errors() {
        let message = error.to_string();
        assert!(!message.trim().is_empty() && message.len() < LONGEST_MESSAGE, "a vague error: {message:?}");
    }
}

/// What the check accepts, the run runs; its summary has no number that is none, and its packets add up. On three threads
/// it writes the same recording and the same summary as on one, and the recording has the log of the run.
pub(crate) fn runs(scenario: &Scenario) {
    let (one, three) = on_one_and_three(scenario.text().as_bytes(), || recorded_run(scenario));
    let Some(one) = one else { return };
    summary_is_sound(&one.summary);
    if let Some(three) = three.flatten() {
        assert_eq!(one.summary, three.summary, "the summaries on one and on three threads differ");
        assert!(one.recording == three.recording, "the recordings on one and on three threads differ");
    }
    assert_eq!(one.mapped_again, one.maps, "the recording gives another map than the run");
    match (&one.read, &one.log) {
        (Some(read), Some(log)) => is_same_log(read, log),
        (read, log) => assert_eq!(read.is_some(), log.is_some(), "a log in the recording, and of the run"),
    }
}

/// The logs are the same, and so are the names of the robots. A robot that stopped nowhere has no name in a recording.
fn is_same_log(read: &NetworkLogs, log: &NetworkLogs) {
    let of_all =
        |logs: &NetworkLogs| -> Vec<_> { logs.iter().map(|of| (of.network.clone(), of.log.clone())).collect() };
    for ((network, read), (other, log)) in of_all(read).into_iter().zip(of_all(log)) {
        assert_eq!(network, other, "the network of a log");
        assert_eq!(read.names(), log.names(), "the names of the nodes");
        let stops = |log: &ReceptionLog| -> Vec<_> {
            let stops = log.stops().iter();
            stops
                .map(|stop| (log.robot_name(stop.robot).into_owned(), stop.time, stop.position, stop.heading_rad))
                .collect()
        };
        assert_eq!(stops(&read), stops(&log), "the stops");
        assert!(read.receptions().iter().eq(log.receptions().iter()), "the receptions of {network:?}");
        assert_eq!(read.sectors(), log.sectors(), "the sectors");
        assert!(read.sector_reports().eq(log.sector_reports()), "the reports of sectors");
    }
}

/// What a run left behind.
struct RecordedRun {
    summary: Summary,
    recording: Vec<u8>,
    /// The logs of the run, if robots surveyed.
    log: Option<NetworkLogs>,
    /// The logs in the recording, if it has any.
    read: Option<NetworkLogs>,
    /// The maps of the robots' logs.
    maps: Vec<TopologyMap>,
    /// The maps that the recording gives.
    mapped_again: Vec<TopologyMap>,
}

/// Runs and records the scenario; `None` if that takes too long.
fn recorded_run(scenario: &Scenario) -> Option<RecordedRun> {
    let path = scratch::path("run.mcap");
    let run = match sextant::run(scenario, &mut RunRecorder::new(&path), &Budget::new(RUN_BUDGET)) {
        Ok(run) => run,
        Err(RunError::Interrupted(_)) => return None,
        Err(error) => panic!("accepted by the check and refused by the run: {error}"),
    };
    let summary = Summary { timing: None, ..run.summary().clone() };
    if summary.interrupted || summary.gathering.as_ref().is_some_and(|gathering| gathering.interrupted) {
        return None;
    }
    let recording = std::fs::read(&path).expect("a finished run has a recording");
    let log = logs(&run);
    let read = read_log(&path).ok().map(|run| run.logs);
    // Maps that the nodes computed themselves are not made from a log.
    let is_of_robots = |name: &str| log.is_some() && scenario.maps().iter().any(|map| map.name == name);
    let of_robots = run.maps().iter().filter(|evaluation| is_of_robots(&evaluation.name));
    let maps: Vec<TopologyMap> = of_robots.map(|evaluation| evaluation.map.clone()).collect();
    let mapped_again = if maps.is_empty() { Vec::new() } else { mapped_again(&path) };
    Some(RecordedRun { summary, recording, log, read, maps, mapped_again })
}

/// The maps that `sextant map` computes of the recording.
fn mapped_again(path: &Path) -> Vec<TopologyMap> {
    let mut input = Input::read(path, None, &ReadOptions::default()).expect("a recording of a run is read");
    let text = input.scenario.clone().expect("a recording has its scenario");
    let files = input.files.clone();
    let scenario = RecordedScenario { name: "scenario.toml", text: &text, files: &files };
    let settings = MapSettings::new(Some(scenario), None, None, None, &[]).expect("its maps are accepted");
    let made = map(&mut input, &settings, None, Stopwatch::start(), &Unwatched);
    let (_, maps) = made.unwrap_or_else(|error| panic!("the run was mapped, and its recording is not: {error}"));
    maps.into_iter().map(|computed| computed.map).collect()
}

/// The logs of a run in which robots stopped somewhere.
fn logs(run: &Run) -> Option<NetworkLogs> {
    let logs = run.survey()?.logs.clone();
    (!logs.first().stops().is_empty()).then_some(logs)
}

/// All numbers are numbers, and packets add up.
pub(crate) fn summary_is_sound(summary: &Summary) {
    let text = summary.to_json();
    let json: Value = serde_json::from_str(&text).expect("a summary is JSON");
    if let Some(path) = missing_number(&json) {
        panic!("`{path}` of the summary is no number: {text}");
    }
    if let Some(gathering) = &summary.gathering {
        survey_adds_up(gathering);
    }
    summary.mac.iter().chain(&summary.other_networks).for_each(traffic_adds_up);
}

/// Where a summary has no value though it has the key: JSON has no other form for NaN and infinities.
fn missing_number(value: &Value) -> Option<String> {
    match value {
        Value::Null => Some(String::new()),
        Value::Array(items) => {
            items.iter().enumerate().find_map(|(i, item)| Some(format!("[{i}]{}", missing_number(item)?)))
        }
        Value::Object(object) => {
            object.iter().find_map(|(key, item)| Some(format!(".{key}{}", missing_number(item)?)))
        }
        _ => None,
    }
}

/// Each packet offered is in one place of the ledger.
fn survey_adds_up(gathering: &GatheringSummary) {
    let Some(offered) = gathering.packets_offered else { return };
    let parts = [
        gathering.packets_received,
        gathering.lost_collision,
        gathering.lost_channel_access,
        gathering.lost_signal,
        gathering.lost_queue,
        gathering.out_of_range,
        gathering.not_listened,
        gathering.pending,
    ];
    assert_eq!(
        offered,
        parts.iter().flatten().sum::<u64>(),
        "the packets of the survey do not add up: {gathering:?}"
    );
    if let (Some(by), Some(all)) = (gathering.not_listened_by, gathering.not_listened) {
        assert_eq!(by.transmitting + by.asleep + by.off, all, "reasons of packets that nobody listened to");
    }
    assert!(gathering.packets_sent <= gathering.packets_offered, "more packets sent than offered: {gathering:?}");
}

/// The same of the traffic to sinks, of all nodes, of groups and of each node; and the nodes together are all.
fn traffic_adds_up(mac: &MacSummary) {
    let named = mac.groups.iter().chain(&mac.nodes).map(|named| &named.traffic);
    std::iter::once(&mac.all).chain(named).for_each(ledger_adds_up);
    if !mac.nodes.is_empty() {
        let of_nodes =
            |count: fn(&TrafficSummary) -> u64| mac.nodes.iter().map(|node| count(&node.traffic)).sum::<u64>();
        assert_eq!(of_nodes(|traffic| traffic.offered), mac.all.offered, "offered by nodes, and by all");
        assert_eq!(of_nodes(|traffic| traffic.delivered), mac.all.delivered, "delivered of nodes, and of all");
    }
}

fn ledger_adds_up(traffic: &TrafficSummary) {
    let lost = traffic.lost_collision + traffic.lost_channel_access + traffic.lost_queue + traffic.lost_signal;
    let rest = traffic.out_of_range + traffic.not_listened + traffic.pending;
    assert_eq!(traffic.offered, traffic.delivered + lost + rest, "packets do not add up: {traffic:?}");
    let by = traffic.not_listened_by;
    assert_eq!(
        by.transmitting + by.asleep + by.off,
        traffic.not_listened,
        "reasons of packets that nobody listened to"
    );
    assert!(traffic.sent <= traffic.offered && traffic.retries <= traffic.transmissions, "{traffic:?}");
    assert!(traffic.prr.is_none_or(|prr| (0.0..=1.0).contains(&prr)), "{traffic:?}");
}
