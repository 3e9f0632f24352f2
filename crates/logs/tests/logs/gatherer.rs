//! From packets and a path to a reception log.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::{NodeId, Purpose, RobotId, Seed, SimTime};
use sextant_logs::{Gatherer, Packet, Path, PathError, Pose, ReadOptions, RobotLog, RobotLogError, StopRule};

fn at(second: f64) -> SimTime {
    SimTime::ZERO + Duration::from_secs_f64(second)
}

/// A path along x through these places (s, m).
fn path(poses: &[(f64, f64)]) -> Result<Path, PathError> {
    let pose = |&(second, x_m): &(f64, f64)| Pose { time: at(second), position: Position::new(x_m, 0.0, 0.0) };
    Path::new(poses.iter().map(pose).collect())
}

fn options(stop_every: StopRule, packet_interval_s: Option<f64>) -> ReadOptions {
    ReadOptions { stop_every, packet_interval_s, ..ReadOptions::default() }
}

fn gather(path: Path, options: &ReadOptions, packets: &[(f64, &str)]) -> Result<RobotLog, RobotLogError> {
    let mut gatherer = Gatherer::new(path, options)?;
    for &(second, node) in packets {
        gatherer.take(Packet::new(at(second), node))?;
    }
    gatherer.finish()
}

/// Received and sent at each stop; 0 of 1 where the pair is absent.
fn counts(log: &RobotLog, node: u32) -> Vec<(u32, u32)> {
    let mut counts = vec![(0, 1); log.log.stops().len()];
    for reception in log.log.of(NodeId(node)) {
        counts[reception.stop as usize] = (reception.received, reception.sent);
    }
    counts
}

#[test]
fn a_place_is_interpolated_and_unknown_outside_of_the_path() {
    let path = path(&[(1.0, 0.0), (3.0, 4.0), (4.0, 4.0)]).unwrap();
    assert_eq!(path.at(at(2.0)), Some(Position::new(2.0, 0.0, 0.0)));
    assert_eq!(path.at(at(4.0)), Some(Position::new(4.0, 0.0, 0.0)));
    assert_eq!((path.at(at(0.999)), path.at(at(4.001))), (None, None));
}

#[test]
fn a_jitter_is_sorted_and_a_jump_back_is_refused() {
    let late = path(&[(1.0, 1.0), (2.0, 2.0), (1.5, 1.5), (3.0, 3.0)]).unwrap();
    assert_eq!(late.at(at(1.75)), Some(Position::new(1.75, 0.0, 0.0)));
    let error = path(&[(1.0, 1.0), (9.0, 2.0), (2.0, 1.5)]).unwrap_err();
    assert_eq!(error.index(), Some(2));
    assert!(error.to_string().starts_with("the time goes back by 7 s, from 9 s to 2 s; allowed"), "{error}");
    assert!(matches!(path(&[(1.0, 1.0), (1.0, 1.0)]), Err(PathError::TooFew { poses: 1 })));
    assert!(matches!(path(&[(1.0, 1.0), (2.0, 1.0), (2.0, 9.0)]), Err(PathError::TwoPlaces { index: 2, .. })));
    assert!(matches!(path(&[(1.0, 1.0), (2.0, f64::NAN)]), Err(PathError::NotFinite { index: 1, .. })));
}

#[test]
fn a_robot_that_moved_in_a_gap_is_nowhere_in_it() {
    let poses: Vec<(f64, f64)> = (0..10).chain(40..50).map(|second| (f64::from(second), f64::from(second))).collect();
    let moved = path(&poses).unwrap();
    assert_eq!((moved.at(at(9.0)).is_some(), moved.at(at(9.1)), moved.at(at(40.0)).is_some()), (true, None, true));
    let stood: Vec<(f64, f64)> = poses.iter().map(|&(second, _)| (second, 1.0)).collect();
    assert_eq!(path(&stood).unwrap().at(at(20.0)), Some(Position::new(1.0, 0.0, 0.0)));

    let log = gather(
        moved,
        &options(StopRule::Distance(5.0), Some(1.0)),
        &[(3.0, "a"), (20.0, "a"), (45.5, "a"), (60.0, "a")],
    );
    let log = log.unwrap();
    assert_eq!(log.log.stops().len(), 4);
    let notes = log.notes.join("\n");
    assert!(notes.contains("0 packets are from before the path begins and 1 from after it ends, of 4"), "{notes}");
    assert!(notes.contains("1 of 4 packets are from gaps of the path"), "{notes}");
    assert!(notes.contains("the longest is from 9 s to 40 s"), "{notes}");
}

#[test]
fn a_path_is_cut_by_distance_and_by_time() {
    let straight = || path(&[(0.0, 0.0), (10.0, 10.0)]).unwrap();
    let stops = |rule| {
        let log = gather(straight(), &options(rule, None), &[(1.0, "a")]).unwrap().log;
        log.stops().iter().map(|stop| (stop.time.as_secs_f64(), stop.position.x_m)).collect::<Vec<_>>()
    };
    // The place of a stop is the mean over its time.
    assert_eq!(stops(StopRule::Distance(4.0)), [(0.0, 2.0), (4.0, 6.0), (8.0, 9.0)]);
    assert_eq!(stops(StopRule::Time(Duration::from_secs(5))), [(0.0, 2.5), (5.0, 7.5)]);
    assert_eq!(stops(StopRule::Automatic).len(), 20);
    // A robot that stands still and trembles has one stop; the way back is a stop of its own.
    let trembling: Vec<(f64, f64)> = (0..1000).map(|step| (f64::from(step), f64::from(step % 2) * 0.2)).collect();
    let log = gather(path(&trembling).unwrap(), &options(StopRule::Distance(0.5), None), &[(1.0, "a")]).unwrap().log;
    assert_eq!(log.stops().len(), 1);
    // A long path has longer stops.
    let long = path(&[(0.0, 0.0), (1e4, 12_345.0)]).unwrap();
    let log = gather(long, &ReadOptions::default(), &[(1.0, "a")]).unwrap();
    assert_eq!(log.log.stops().len(), 247);
    assert!(log.notes[0].contains("247 stops, one each 50 m"), "{:?}", log.notes);
    let error = gather(straight(), &options(StopRule::Time(Duration::from_micros(1)), None), &[]).unwrap_err();
    assert!(matches!(error, RobotLogError::TooManyStops), "{error}");
}

#[test]
fn lost_packets_are_counted_between_those_that_were_heard() {
    // A node sends at 0.5, 1.5, .. s; the robot drives 1 m/s and stops are 2 m long.
    let heard = [(2.5, "a"), (3.5, "a"), (6.5, "a")];
    let log =
        gather(path(&[(0.0, 0.0), (10.0, 10.0)]).unwrap(), &options(StopRule::Distance(2.0), Some(1.0)), &heard);
    assert_eq!(counts(&log.unwrap(), 0), [(0, 2), (2, 2), (0, 2), (1, 2), (0, 2)]);
    // A node that sends every 4 s has no packet at most stops: no evidence. 0 of 1 is an absent pair.
    let heard = [(2.5, "a"), (10.5, "a")];
    let log =
        gather(path(&[(0.0, 0.0), (16.0, 16.0)]).unwrap(), &options(StopRule::Distance(2.0), Some(4.0)), &heard);
    assert_eq!(counts(&log.unwrap(), 0), [(0, 0), (1, 1), (0, 0), (0, 1), (0, 0), (1, 1), (0, 0), (0, 1)]);
}

/// The times at which nodes send: `period` apart, each late by up to `jitter` periods, and received with probability
/// `delivery`.
fn sent(node: u64, period: f64, jitter: f64, delivery: f64, until: f64) -> Vec<f64> {
    let draw = |kind, at| Seed(11).uniform(Purpose::new(8), [node, kind, at]);
    let start = period * draw(0, 0);
    let packets = (0..).take_while(|&at| start + period * at as f64 <= until).filter(|&at| draw(1, at) < delivery);
    packets.map(|at| start + period * (at as f64 + jitter * draw(2, at))).collect()
}

#[test]
fn the_interval_is_told_by_the_gaps_between_packets() {
    let route = || path(&[(0.0, 0.0), (600.0, 600.0)]).unwrap();
    for (period, jitter, delivery) in [(1.0, 0.0, 0.9), (0.25, 0.1, 0.4), (10.0, 0.05, 0.6), (2.0, 0.1, 0.35)] {
        let mut gatherer = Gatherer::new(route(), &options(StopRule::Distance(50.0), None)).unwrap();
        for node in 0..8 {
            for second in sent(node, period, jitter, delivery, 600.0) {
                gatherer.take(Packet::new(at(second), &format!("n{node}"))).unwrap();
            }
        }
        let log = gatherer.finish().unwrap();
        let all: u32 = (0..8).flat_map(|node| counts(&log, node)).map(|(_, sent)| sent).sum();
        let expected = 8.0 * 600.0 / period;
        assert!((f64::from(all) / expected - 1.0).abs() < 0.03, "{all} of {expected}: {:?}", log.notes);
        assert!(log.notes.iter().any(|note| note.starts_with("the nodes send every")), "{:?}", log.notes);
    }
}

#[test]
fn random_traffic_has_no_interval() {
    // Exponential gaps of 1 s on average, and bursts of three packets.
    let draw = |at| Seed(5).uniform(Purpose::new(8), [at, 0, 0]);
    let mut poisson = vec![0.0];
    let mut bursts = Vec::new();
    for step in 0..500 {
        let last: f64 = poisson[poisson.len() - 1];
        poisson.push(last - (1.0 - draw(step)).ln());
        bursts.extend([0.0, 0.002, 0.004].map(|late| step as f64 + late));
    }
    for times in [poisson, bursts] {
        let end = times[times.len() - 1];
        let packets: Vec<(f64, &str)> = times.into_iter().map(|second| (second, "a")).collect();
        let route = path(&[(0.0, 0.0), (end, 100.0)]).unwrap();
        let log = gather(route, &options(StopRule::Distance(10.0), None), &packets).unwrap();
        assert_eq!(counts(&log, 0), [(1, 1); 10]);
        assert!(
            log.notes.iter().any(|note| note.contains("how often 1 of 1 nodes send cannot be told")),
            "{:?}",
            log.notes
        );
    }
}

#[test]
fn the_order_of_packets_does_not_change_the_counts() {
    let route = || path(&[(0.0, 0.0), (100.0, 100.0)]).unwrap();
    let mut packets: Vec<(f64, &str)> = Vec::new();
    for (node, name) in [(0, "a"), (1, "b")] {
        packets.extend(sent(node, 1.0, 0.0, 0.7, 100.0).into_iter().map(|second| (second, name)));
    }
    let rule = options(StopRule::Distance(7.0), Some(1.0));
    let by_node = gather(route(), &rule, &packets).unwrap();
    packets.sort_by(|a, b| a.1.cmp(b.1).then(b.0.total_cmp(&a.0)));
    let backwards = gather(route(), &rule, &packets).unwrap();
    assert_eq!(by_node.log, backwards.log);
    assert!(backwards.notes.iter().any(|note| note.contains("packets are earlier than the packet")));
}

#[test]
fn signal_strength_is_averaged_and_the_best_sector_is_taken() {
    let mut gatherer =
        Gatherer::new(path(&[(0.0, 0.0), (4.0, 1.0)]).unwrap(), &options(StopRule::Distance(9.0), Some(1.0)))
            .unwrap();
    for (second, sector, rssi_dbm, snr_db) in [(0.0, 3, -70.0, 9.0), (1.0, 3, -80.0, 12.0), (2.0, 5, -60.0, 4.0)] {
        let packet = Packet {
            sector: Some(sector),
            rssi_dbm: Some(rssi_dbm),
            snr_db: Some(snr_db),
            ..Packet::new(at(second), "a")
        };
        gatherer.take(packet).unwrap();
    }
    let log = gatherer.finish().unwrap().log;
    let reception = log.of(NodeId(0)).get(0).unwrap();
    assert_eq!((reception.received, reception.sent, reception.sector), (3, 5, Some(5)));
    assert_eq!((reception.rssi_dbm, reception.snr_db), (Some(-70.0), Some(12.0)));
}

#[test]
fn stops_of_several_robots_are_in_the_order_of_time() {
    let paths = vec![path(&[(0.0, 0.0), (4.0, 4.0)]).unwrap(), path(&[(1.0, 50.0), (5.0, 54.0)]).unwrap()];
    let robots = vec!["west".to_owned(), "east".to_owned()];
    let mut gatherer = Gatherer::of_robots(paths, robots, &options(StopRule::Distance(2.0), Some(1.0))).unwrap();
    gatherer.take(Packet { robot: RobotId(1), ..Packet::new(at(3.5), "a") }).unwrap();
    gatherer.take(Packet::new(at(0.5), "a")).unwrap();
    assert!(gatherer.take(Packet { robot: RobotId(2), ..Packet::new(at(3.5), "a") }).is_err());
    let log = gatherer.finish().unwrap();
    let robots: Vec<u32> = log.log.stops().iter().map(|stop| stop.robot.0).collect();
    assert_eq!(robots, [0, 1, 0, 1]);
    // West hears at 0.5 s what east hears at 3.5 s three packets later.
    assert_eq!(counts(&log, 0), [(1, 2), (0, 2), (0, 2), (1, 2)]);
}

#[test]
fn packets_of_another_clock_are_an_error_that_states_both() {
    let error =
        gather(path(&[(0.0, 0.0), (4.0, 4.0)]).unwrap(), &ReadOptions::default(), &[(1.7e9, "a"), (1.8e9, "b")]);
    let text = error.unwrap_err().to_string();
    assert!(text.contains("none of the 2 packets"), "{text}");
    assert!(text.contains("from 1700000000 s to 1800000000 s, the path is from 0 s to 4 s"), "{text}");
    assert!(matches!(
        gather(path(&[(0.0, 0.0), (4.0, 4.0)]).unwrap(), &ReadOptions::default(), &[]),
        Err(RobotLogError::NoPackets)
    ));
}

#[test]
fn rules_for_stops_are_read() {
    assert_eq!("1.5m".parse(), Ok(StopRule::Distance(1.5)));
    assert_eq!(" 2 s".parse(), Ok(StopRule::Time(Duration::from_secs(2))));
    assert_eq!("auto".parse(), Ok(StopRule::Automatic));
    for text in ["", "1", "m", "0m", "-1s", "nan m", "inf s", "1km"] {
        assert!(text.parse::<StopRule>().is_err(), "{text}");
    }
}
