//! Runs that their caller advances to one time after the other.

use std::time::Duration;

use sextant::channel::{HeardAtStop, Position, Stop};
use sextant::kernel::{SimTime, Work};
use sextant::sim::{NetworkId, Observer};
use sextant::{Programs, RunObserver, RunRecorder, Scenario, SteppedRun, Summary, Unwatched, Watch};

use crate::programs::{results, robots_apart, shipped, star};

/// Nodes that compute a map themselves.
fn distributed() -> Scenario {
    let small = [("world.nodes.lattice.count", "60"), ("world.nodes.lattice.region.rectangle.max_m", "[9.0, 9.0]")];
    small
        .iter()
        .fold(shipped("dmtm/rf.toml"), |scenario, (key, value)| scenario.with(key, value).expect("a good setting"))
}

/// A robot that sweeps its sectors, in a corner of a warehouse.
fn sectors() -> Scenario {
    let area = "robots.0.controller.automated_s.area.box.max_m";
    [(area, "[6.0, 6.0, 0.4]"), ("maps.0.algorithm.mmtm.grid_step_m", "1.0")]
        .iter()
        .fold(shipped("mmtm/one-sweep-warehouse-vaa.toml"), |scenario, (key, value)| {
            scenario.with(key, value).expect("a good setting")
        })
}

/// The summary without its timing, and the octets of the recording, of a run with a step every `step`.
fn stepped(scenario: &Scenario, step: Duration) -> (String, Vec<u8>) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.mcap");
    let mut run = SteppedRun::new(scenario, RunRecorder::new(&path), &Unwatched).expect("a run");
    while !run.has_ended() {
        let time = run.time() + step;
        run.until(time);
        assert!(run.time() == time || run.has_ended(), "{} after {time}", run.time());
    }
    let run = run.finish().expect("a run");
    let summary = Summary { timing: None, ..run.summary().clone() };
    (summary.to_json(), std::fs::read(path).expect("a recording"))
}

#[test]
fn steps_of_any_size_change_no_octet() {
    let scenarios =
        [shipped("smoke.toml"), shipped("mac/packet-trace.toml"), star(), robots_apart(), distributed(), sectors()];
    for scenario in scenarios {
        let whole = results(&scenario, Programs::default());
        for step in [1_000_000, 333_333_333, 7_700_000_000, 5_000_000_000_000].map(Duration::from_nanos) {
            let (summary, recording) = stepped(&scenario, step);
            assert_eq!(summary, whole.0, "{} with steps of {step:?}", scenario.name());
            assert!(recording == whole.1, "{} with steps of {step:?}: another recording", scenario.name());
        }
    }
}

/// Remembers where a robot is, and when its stops ended.
#[derive(Default)]
struct Seen {
    ends: Vec<SimTime>,
    moves: Vec<(SimTime, Position)>,
}

impl Observer for Seen {
    fn moved(&mut self, _: usize, time: SimTime, position: Position) {
        self.moves.push((time, position));
    }

    fn stopped(&mut self, _: NetworkId, _: u32, _: &Stop, end: SimTime, _: HeardAtStop<'_>) {
        self.ends.push(end);
    }
}

impl RunObserver for Seen {}

#[test]
fn a_snapshot_is_what_has_happened_until_then() {
    let scenario = shipped("smoke.toml");
    let mut run = SteppedRun::new(&scenario, Seen::default(), &Unwatched).expect("a run");
    let start = run.snapshot().expect("a survey");
    assert_eq!((start.time, start.has_ended, start.stops, start.packets.offered), (SimTime::ZERO, false, 0, 0));
    assert_eq!(start.robots[0].pose.truth.position, Position::new(-2.0, -2.0, 0.0));
    run.until(SimTime::from_secs(2));
    let mut before = run.snapshot().expect("a survey");
    let (began, from) = *run.observer().moves.last().expect("a drive");
    // On the way at 1 m/s.
    let driven_m = before.robots[0].pose.truth.position.distance_m(from);
    assert!((driven_m - (before.time - began).as_secs_f64()).abs() < 1e-9, "{driven_m} m");
    for second in 3..240 {
        run.until(SimTime::from_secs(second));
        let now = run.snapshot().expect("a survey");
        assert_eq!(now.stops, run.observer().ends.len());
        assert!(run.observer().ends.iter().all(|&end| end <= now.time), "{second} s");
        let packets = [before.packets, now.packets].map(|packets| (packets.offered, packets.received));
        assert!(packets[0].0 <= packets[1].0 && packets[0].1 <= packets[1].1 && before.receptions <= now.receptions);
        before = now;
    }
    assert!(before.has_ended && run.has_ended());
    // Nothing happens any more, and nothing before.
    run.until(SimTime::from_secs(1000));
    run.until(SimTime::from_secs(3));
    assert_eq!(run.snapshot().as_ref(), Some(&before));
    let run = run.finish().expect("a run");
    let survey = run.survey().expect("a survey");
    assert_eq!((before.time, before.packets), (survey.end, survey.packets));
    assert_eq!(Some(before.receptions), run.summary().gathering.as_ref().map(|gathering| gathering.receptions));
    assert_eq!(before.robots[0].pose, survey.robots[0].end_pose);
}

#[test]
fn an_instant_itself_is_still_to_come() {
    let scenario = shipped("smoke.toml");
    let mut whole = Seen::default();
    sextant::run(&scenario, &mut whole, &Unwatched).expect("a run");
    let end = whole.ends[0];
    let mut run = SteppedRun::new(&scenario, Seen::default(), &Unwatched).expect("a run");
    run.until(end);
    assert_eq!((run.time(), run.observer().ends.len()), (end, 0));
    run.until(end + Duration::from_nanos(1));
    assert_eq!(run.observer().ends, [end]);
}

/// A watch that has stopped the work.
#[derive(Debug)]
struct Stopped;

impl Watch for Stopped {
    fn begin(&self, _: Work) {}

    fn advance(&self, _: u64) {}

    fn is_stopped(&self) -> bool {
        true
    }
}

#[test]
fn a_watch_ends_a_run_on_the_way() {
    let scenario = shipped("smoke.toml");
    let mut run = SteppedRun::new(&scenario, (), &Stopped).expect("a run");
    assert!(!run.has_ended());
    run.until(SimTime::from_secs(50));
    assert!(run.has_ended() && run.time() < SimTime::from_secs(50));
    assert!(run.finish().expect("a run").summary().interrupted);
}

#[test]
fn without_a_survey_there_is_nothing_to_step() {
    let scenario = shipped("target/case-1.toml");
    assert!(!scenario.config().has_survey());
    let mut run = SteppedRun::new(&scenario, (), &Unwatched).expect("a run");
    run.until(SimTime::from_secs(1));
    assert!(run.has_ended() && run.snapshot().is_none() && run.time() == SimTime::ZERO);
}
