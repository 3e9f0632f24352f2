//! A log of two robots whose frames of coordinates differ: places are compared only in one frame.

use sextant_channel::{Position, Reception, ReceptionLog, Stop};
use sextant_kernel::{NodeId, RobotId};
use sextant_mapper::{FrameAgreement, JoinedFrame, RobotFrame, RobotOutcome};

use super::tests::{NODES, changed, lanes, log_of, node};
use super::*;

/// The lanes twice: the second time driven by a robot whose frame is turned and far away. With how its frame becomes the other.
fn two_frames() -> (ReceptionLog, FrameChange) {
    let twice = [lanes(), lanes()].concat();
    let change = FrameChange { turn_rad: 2.0, offset: Position::new(90.0, -40.0, 0.0), ..FrameChange::NONE };
    let own = |stop: Stop| match stop.time.as_secs_f64() < 770.0 {
        true => stop,
        false => Stop { robot: RobotId(1), position: change.inverse().apply(stop.position), ..stop },
    };
    let log = changed(&log_of(&twice, |number, _| node(number)), own, |row| row);
    (log.with_robots(vec!["A".to_owned(), "B".to_owned()]).unwrap(), change)
}

#[test]
fn robots_with_frames_of_their_own_are_judged_each_by_itself() {
    let (log, _) = two_frames();
    assert!(!of_log(&log, &[], PlacedBy::Rows).is_empty(), "in one frame this log is odd");
    assert_eq!(of_robots(&log, &[], PlacedBy::Rows), []);
    // What is odd of one of them is told with its name.
    let wrong = |row: Reception| match row {
        Reception { node: NodeId(5), stop: 100, rssi_dbm: Some(_), .. } => Reception { rssi_dbm: Some(-7.0), ..row },
        row => row,
    };
    let found = of_robots(&changed(&log, |stop| stop, wrong), &[], PlacedBy::Rows);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].odd.starts_with("robot `robot-1`: strengths that no place"), "{}", found[0]);
    assert!(found[0].odd.contains("number 24 of 77"), "{}", found[0]);
}

#[test]
fn nodes_of_a_stitched_map_are_compared_with_the_stops_as_it_joined_them() {
    let (log, change) = two_frames();
    // The receiver of the first robot is 20 dB worse.
    let worse = |row: Reception| match row.stop < 77 {
        true => Reception { rssi_dbm: row.rssi_dbm.map(|level| level - 20.0), ..row },
        false => row,
    };
    let log = changed(&log, |stop| stop, worse).with_robots(log.robots().to_vec()).unwrap();
    let places: Vec<_> = (0..NODES).map(|number| Some(node(number))).collect();
    let frame = |name: &str, outcome| RobotFrame { name: name.to_owned(), placed: 12, outcome };
    let joined = JoinedFrame { change, agreement: FrameAgreement::default(), deviation_m: None };
    let stitching = Stitching {
        robots: vec![
            frame("A", RobotOutcome::Known(FrameAgreement::default())),
            frame("B", RobotOutcome::Joined(joined)),
        ],
        members: vec![vec!["A".to_owned()], vec!["B".to_owned()]],
        groups: vec![vec![0, 1]],
        pairs: Vec::new(),
        learned: None,
    };
    let learned = EstimatorFindings::new(stitching);
    assert_eq!(of_map(&log, &places, Some(&learned), PlacedBy::Rows), []);
    let as_they_are = of_map(&log, &places, None, PlacedBy::Rows);
    assert_eq!(as_they_are[0].check, "far-from-strongest", "{as_they_are:?}");
}
