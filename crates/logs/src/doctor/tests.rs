//! A good log, of which no check finds anything, and the same log broken in each way that a check is for.

use sextant_channel::{Position, Reception, ReceptionLog, Stop};
use sextant_kernel::{NodeId, Purpose, RobotId, Seed, SimTime};

use super::*;
use crate::path::robot_path::{Path, Pose};

pub(super) const NODES: u32 = 12;
const WIDTH_M: f64 = 20.0;
const DEPTH_M: f64 = 12.0;

pub(super) fn draw(what: u64, place: [u64; 2]) -> f64 {
    Seed(11).normal(Purpose::new(8), [what, place[0], place[1]])
}

fn share(what: u64, place: [u64; 2]) -> f64 {
    Seed(11).uniform(Purpose::new(8), [what, place[0], place[1]])
}

pub(super) fn node(number: u32) -> Position {
    let number = u64::from(number);
    Position::new(1.0 + 18.0 * share(1, [number, 0]), 1.0 + 10.0 * share(1, [number, 1]), 0.0)
}

/// Mean strength (dBm): path loss of exponent 2.5, and shadowing of 3 dB that changes over some metres.
pub(super) fn strength_dbm(number: u32, from: Position, at: Position) -> f64 {
    let of_node = u64::from(number);
    let wave = |i: u64| {
        let [x, y] = [0, 1].map(|axis| 0.5 * draw(2, [of_node, 2 * i + axis]));
        libm::cos(x * at.x_m + y * at.y_m + 6.0 * share(3, [of_node, i]))
    };
    let shadowing = 1.5 * (0..8).map(wave).sum::<f64>();
    -45.0 - 25.0 * libm::log10(from.distance_m(at).max(0.3)) + shadowing
}

/// A survey of `places` in order, ten packets of each node at each, with a fading of 3 dB and a receiver that hears -75 dBm.
/// `node_at` says where a node is during a stop.
pub(super) fn log_of(places: &[Position], node_at: impl Fn(u32, u32) -> Position) -> ReceptionLog {
    let stop = |(number, &position): (u64, &Position)| Stop {
        robot: RobotId(0),
        time: SimTime::from_nanos(number * 10_000_000_000),
        position,
        heading_rad: None,
    };
    let stops: Vec<Stop> = (0..).zip(places).map(stop).collect();
    let mut receptions = Vec::new();
    for number in 0..NODES {
        for (index, at) in (0_u32..).zip(places) {
            let mean = strength_dbm(number, node_at(number, index), *at);
            let packets = (0..10).map(|packet| mean + 3.0 * draw(4, [u64::from(number * 1000 + index), packet]));
            let heard: Vec<f64> = packets.filter(|level| *level > -75.0).collect();
            let received = u32::try_from(heard.len()).unwrap();
            let rssi_dbm = (received > 0).then(|| heard.iter().sum::<f64>() / f64::from(received));
            receptions.push(Reception {
                node: NodeId(number),
                stop: index,
                received,
                sent: 10,
                sector: None,
                rssi_dbm,
                snr_db: None,
            });
        }
    }
    let names = (0..NODES).map(|number| format!("n{number}")).collect();
    ReceptionLog::new(names, stops, receptions, Vec::new()).unwrap()
}

/// Stops every 2 m on lanes to and fro.
pub(super) fn lanes() -> Vec<Position> {
    let stop = |i: u32| {
        let (lane, step) = (i / 11, i % 11);
        let step = if lane % 2 == 0 { step } else { 10 - step };
        Position::new(2.0 * f64::from(step), 2.0 * f64::from(lane), 0.0)
    };
    (0..77).map(stop).collect()
}

pub(super) fn good() -> ReceptionLog {
    log_of(&lanes(), |number, _| node(number))
}

/// The log with other stops or receptions.
pub(super) fn changed(
    log: &ReceptionLog,
    stop: impl Fn(Stop) -> Stop,
    row: impl Fn(Reception) -> Reception,
) -> ReceptionLog {
    let stops = log.stops().iter().copied().map(stop).collect();
    let rows = log.receptions().iter().map(row).collect();
    ReceptionLog::new(log.names().to_vec(), stops, rows, Vec::new()).unwrap()
}

/// All that is found of a log of stops.
pub(super) fn findings(log: &ReceptionLog) -> Vec<Finding> {
    let mut levels = Levels::default();
    log.receptions().iter().filter_map(|row| row.rssi_dbm).for_each(|level| levels.take(level));
    let mut found = of_stops(log, None);
    found.extend(of_levels(&levels));
    found.extend(listening::finding(log, None));
    let rest = of_log(log, &found, PlacedBy::Rows);
    found.extend(rest);
    found
}

pub(super) fn checks(log: &ReceptionLog) -> Vec<&'static str> {
    findings(log).iter().map(|finding| finding.check).collect()
}

#[test]
fn nothing_is_odd_in_a_good_log() {
    assert_eq!(findings(&good()), []);
    let silent = |row: Reception| Reception { rssi_dbm: None, ..row };
    assert_eq!(findings(&changed(&good(), |stop| stop, silent)), [], "without strengths");
}

#[test]
fn places_in_other_units_than_metres_are_found() {
    let scaled = |factor: f64, timed: bool| {
        let time = |time| if timed { time } else { SimTime::ZERO };
        changed(&good(), |stop| Stop { position: stop.position * factor, time: time(stop.time), ..stop }, |row| row)
    };
    assert_eq!(checks(&scaled(1000.0, true)), ["speed"]);
    assert_eq!(checks(&scaled(1000.0, false)), ["extent"]);
    let found = &findings(&scaled(1000.0, false))[0];
    assert!(found.remedy.contains("millimetres by 1000"), "{found}");
    let found = &findings(&scaled(1e-3, true))[0];
    assert!(found.odd.starts_with("all 77 places of the survey are within 0.023 m"), "{found}");
}

#[test]
fn a_stop_far_from_all_others_is_found_and_nothing_else() {
    let far = Position::new(-9999.0, -9999.0, 0.0);
    let second = lanes()[1];
    let log = changed(
        &good(),
        |stop| if stop.position == second { Stop { position: far, ..stop } } else { stop },
        |row| row,
    );
    assert_eq!(checks(&log), ["outlying-stops"]);
}

#[test]
fn losses_at_every_strength_are_found() {
    // A receiver that listens 40 % of the time.
    let lossy = |row: Reception| Reception {
        received: if row.received == 0 { 0 } else { (row.received * 2 / 5).max(1) },
        ..row
    };
    let log = changed(&good(), |stop| stop, lossy);
    assert_eq!(checks(&log), ["flat-losses"]);
    let found = &findings(&log)[0];
    assert!(found.odd.starts_with("60 % of the packets are lost on the strongest quarter of the links"), "{found}");
}

#[test]
fn two_names_of_one_node_are_found() {
    let log = good();
    let mut names = log.names().to_vec();
    names.push("n3 again".to_owned());
    let again = |row: Reception| Reception {
        node: NodeId(NODES),
        rssi_dbm: row.rssi_dbm.map(|level| level + 0.1 * draw(5, [u64::from(row.stop), 0])),
        ..row
    };
    let rows = log.receptions().iter().chain(log.of(NodeId(3)).iter().map(again)).collect();
    let log = ReceptionLog::new(names, log.stops().to_vec(), rows, Vec::new()).unwrap();
    let found = findings(&log);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].odd, "these nodes have nearly the same rows: n3 and n3 again");
    let counts = |row: Reception| Reception { rssi_dbm: None, ..row };
    assert_eq!(checks(&changed(&log, |stop| stop, counts)), ["twins"], "without strengths");
}

#[test]
fn a_strength_that_no_place_explains_is_named_with_its_node_and_stop() {
    let log = good();
    // The stop that hears n5 weakest has one digit too few.
    let of_node = || log.of(NodeId(5)).iter().filter_map(|row| Some((row.stop, row.rssi_dbm?)));
    let (weakest, _) = of_node().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
    let wrong = |row: Reception| match row {
        Reception { node: NodeId(5), stop, rssi_dbm: Some(_), .. } if stop == weakest => {
            Reception { rssi_dbm: Some(-7.0), ..row }
        }
        row => row,
    };
    let found = findings(&changed(&log, |stop| stop, wrong));
    let found: Vec<&Finding> = found.iter().filter(|finding| finding.check == "outlying-strengths").collect();
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].odd.contains(&format!(" m, number {} of ", weakest + 1)), "{}", found[0].odd);
    assert!(
        found[0].odd.contains("n5 at the stop at (") && found[0].odd.contains(": -7 dBm is "),
        "{}",
        found[0].odd
    );
    assert!(found[0].odd.contains(" dB above what its other "), "{}", found[0].odd);
}

#[test]
fn a_node_that_moves_during_the_survey_is_found() {
    // The lanes are driven twice; in between n5 is carried to the other end of the hall.
    let twice = [lanes(), lanes()].concat();
    let steady = log_of(&twice, |number, _| node(number));
    assert_eq!(checks(&steady), Vec::<&str>::new());
    let there = Position::new(if node(5).x_m < 10.0 { 17.0 } else { 3.0 }, 6.0, 0.0);
    let log = log_of(&twice, |number, stop| if number == 5 && stop >= 77 { there } else { node(number) });
    let found = findings(&log);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].check, "moved-nodes");
    assert!(found[0].odd.contains(": n5 (") && !found[0].odd.contains(", n"), "{}", found[0]);
}

#[test]
fn a_log_of_which_most_pairs_are_no_evidence_is_found() {
    let sparse = |row: Reception| match (u32::from(row.node.0 == row.stop % NODES), row.received) {
        (0, _) => Reception { received: 0, sent: 0, rssi_dbm: None, ..row },
        (_, received) => Reception { received: received.min(1), sent: 1, ..row },
    };
    let log = changed(&good(), |stop| stop, sparse);
    let found = listening::finding(&log, None).unwrap();
    assert!(found.odd.starts_with("at 92 % of the pairs of a node and a stop the node sent nothing"), "{found}");
    let usual = [1, 12].map(std::time::Duration::from_secs);
    let found = listening::finding(&log, Some((usual[0], usual[1]))).unwrap();
    assert!(found.remedy.starts_with("`stop_every=12s`"), "{found}");
}

#[test]
fn an_exponent_of_no_surroundings_is_told_with_its_uncertainty() {
    let places: Vec<_> = (0..NODES).map(|number| Some(node(number))).collect();
    let told = |log: &ReceptionLog, places: &[Option<Position>], exponent: f64| {
        exponent::finding(exponent, &NodeSums::of_map(log, places), PlacedBy::Rows)
    };
    assert_eq!(told(&good(), &places, 2.5), None);
    let flat = |row: Reception| Reception { rssi_dbm: row.rssi_dbm.map(|level| -60.0 + 0.1 * level), ..row };
    let log = changed(&good(), |stop| stop, flat);
    let found = told(&log, &places, 0.25).unwrap();
    assert!(found.odd.starts_with("the path-loss exponent of the map is 0.25 ± 0.20;"), "{found}");
    assert!(found.remedy.ends_with("compare with `algorithm=strongest-stop`"), "{found}");
    // Three nodes that hardly tell it.
    let few: Vec<_> = (0..NODES).map(|number| (number < 3).then(|| node(number + 1))).collect();
    assert_eq!(told(&good(), &few, 1.4), None, "1.4 ± 0.5 is not odd");
}

/// A robot on lanes to and fro at `speed` (m/s).
pub(super) fn path(speed: f64) -> Path {
    let (mut poses, mut time_s, mut at, mut heading) = (Vec::new(), 100.0, Position::ORIGIN, 1.0);
    let mut add = |time_s: f64, at: Position| {
        let time = crate::time::instant::shifted(SimTime::ZERO, time_s).unwrap();
        poses.push(Pose { time, position: at });
    };
    while at.y_m <= DEPTH_M {
        add(time_s, at);
        time_s += 0.2;
        at.x_m += heading * speed * 0.2;
        if !(0.0..=WIDTH_M).contains(&at.x_m) {
            at.x_m = at.x_m.clamp(0.0, WIDTH_M);
            heading = -heading;
            let next_m = at.y_m + 2.0;
            while at.y_m < next_m {
                add(time_s, at);
                time_s += 0.2;
                at.y_m = (at.y_m + speed * 0.2).min(next_m);
            }
        }
    }
    Path::new(poses).unwrap()
}

/// What is told of packets that are late by `delay_s`: each node sends every 0.5 s.
fn clock(path: &Path, delay_s: f64, has_strengths: bool) -> ClockOffset {
    clock_of_body(path, delay_s, has_strengths, |_| 0.0)
}

/// The same of a robot whose body costs `loss_db` in the direction of a node with this cosine from the heading.
pub(super) fn clock_of_body(
    path: &Path,
    delay_s: f64,
    has_strengths: bool,
    loss_db: impl Fn(f64) -> f64,
) -> ClockOffset {
    offset(&packets(path, |_| delay_s, has_strengths, loss_db), &[path]).unwrap()
}

/// Packets that are late by so much at each time since the start (s).
pub(super) fn packets(
    path: &Path,
    delay_s: impl Fn(f64) -> f64,
    has_strengths: bool,
    loss_db: impl Fn(f64) -> f64,
) -> Samples {
    let route = route::Route::new(path);
    let mut samples = Samples::default();
    let (start, end) = path.span();
    for number in 0..NODES {
        let mut time = crate::time::instant::shifted(start, share(6, [u64::from(number), 0])).unwrap();
        let mut packet = 0;
        while time < end {
            let at = path.at(time).unwrap();
            let [hx, hy] = route.at(time).unwrap().1;
            let way = node(number) - at;
            let cosine = (hx * way.x_m + hy * way.y_m) / crate::place::distance::plane_m(node(number), at).max(0.1);
            let faded = strength_dbm(number, node(number), at) + 3.0 * draw(7, [u64::from(number), packet]);
            let level = faded - loss_db(cosine);
            if level > if has_strengths { -80.0 } else { -60.0 } {
                let stamp =
                    crate::time::instant::shifted(time, delay_s(time.saturating_since(start).as_secs_f64())).unwrap();
                samples.take(number, RobotId(0), stamp, has_strengths.then(|| level.round()));
            }
            time = crate::time::instant::shifted(time, 0.5).unwrap();
            packet += 1;
        }
    }
    samples
}

#[test]
fn a_clock_that_drifts_or_is_set_is_told_and_a_steady_one_is_not() {
    let path = path(0.5);
    let drift = |delay_s: fn(f64) -> f64, loss_db: fn(f64) -> f64| {
        ClockDrift::of(&packets(&path, delay_s, true, loss_db), &[&path])
    };
    let none = |_: f64| 0.0;
    for (delay_s, what) in [(none as fn(f64) -> f64, "right"), (|_| 5.0, "late")] {
        assert_eq!(drift(delay_s, none), None, "{what}");
        assert_eq!(drift(delay_s, |cosine| 2.0 * (1.0 - cosine)), None, "{what}, with a body");
    }
    let span_s = path.span().1.saturating_since(path.span().0).as_secs_f64();
    let slow = packets(&path, |time_s| 8.0 * time_s / span_s, true, none);
    let told = ClockDrift::of(&slow, &[&path]).unwrap().finding();
    assert!(told.odd.contains("first half") && told.check == "clock-drift", "{told}");
    let set = packets(&path, |time_s| if 2.0 * time_s > span_s { 4.0 } else { 0.0 }, true, none);
    let drift = ClockDrift::of(&set, &[&path]).unwrap().finding();
    // A few nodes do not tell it from what stands around them.
    let few = set.of_every_second(0).of_every_second(0);
    assert_eq!(ClockDrift::of(&few, &[&path]), None);
    // Nor does a path that jumps.
    let jump = Finding { check: "speed", odd: String::new(), cost: String::new(), remedy: String::new() };
    assert_eq!(told_apart(vec![jump.clone(), drift]), [jump]);
}

#[test]
fn late_packets_tell_their_delay() {
    let path = path(0.5);
    assert_eq!(of_paths(std::iter::once(&path), &good(), None), []);
    let none = clock(&path, 0.0, true);
    assert!(!none.is_clear && none.delay_s.abs() < 0.5 && none.finding().is_none(), "{none:?}");
    for delay_s in [-3.0, 8.0] {
        let found = clock(&path, delay_s, true);
        assert!(found.told_s().is_some_and(|told_s| (told_s - delay_s).abs() < 0.5), "{delay_s} s: {found:?}");
        assert!(found.error_s < 0.5, "{found:?}");
        let text = found.finding().unwrap().to_string();
        assert!(
            text.contains(if delay_s > 0.0 { "s late" } else { "s early" }) && text.contains("`packet_delay=auto`")
        );
    }
}

#[test]
fn late_packets_without_strengths_tell_it_too() {
    let found = clock(&path(0.5), 6.0, false);
    assert!(found.told_s().is_some_and(|told_s| (told_s - 6.0).abs() < 1.0), "{found:?}");
}

#[test]
fn a_delay_of_half_a_lane_has_a_rival() {
    // A lane and a turn take 15.7 s: late by 7.9 s or early by as much, the robot is at mirror images.
    let found = clock(&path(1.4), 7.9, true);
    assert!(found.is_clear && found.told_s().is_none(), "{found:?}");
    let told = [found.delay_s, found.rival_s.unwrap()];
    assert!(told.iter().any(|told| (told - 7.9).abs() < 0.5) && told.iter().any(|told| (told + 7.9).abs() < 0.7));
}
