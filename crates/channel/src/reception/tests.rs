//! What a log of receptions holds and refuses.

use super::*;

fn heard(node: u32, stop: u32) -> Reception {
    Reception::heard(NodeId(node), stop, 1, 1)
}

#[test]
fn a_log_until_a_stop_has_what_was_heard_before_it() {
    let stop = |nanos| Stop { time: SimTime::from_nanos(nanos), ..Stop::at(Position::ORIGIN) };
    let contact = |nanos| Contact { robot: RobotId(0), time: SimTime::from_nanos(nanos), position: Position::ORIGIN };
    let names = || vec!["a".to_owned(), "b".to_owned()];
    let robots = |log: ReceptionLog| log.with_robots(vec!["r".to_owned()]).unwrap();
    let receptions = vec![heard(0, 0), heard(1, 1), heard(0, 2)];
    let stops = vec![stop(10), stop(20), stop(30)];
    let log = robots(ReceptionLog::new(names(), stops, receptions, vec![contact(5), contact(25)]).unwrap());
    let receptions = vec![heard(0, 0), heard(1, 1)];
    let cut = ReceptionLog::new(names(), vec![stop(10), stop(20)], receptions, vec![contact(5), contact(25)]);
    assert_eq!(log.until(SimTime::from_nanos(30)), robots(cut.unwrap()));
    assert_eq!(log.until(SimTime::from_nanos(31)), log);
    assert!(log.until(SimTime::ZERO).stops().is_empty());
}

fn log(receptions: Vec<Reception>) -> Result<ReceptionLog, LogError> {
    let stops = vec![Stop::at(Position::ORIGIN); 3];
    ReceptionLog::new(vec!["a".into(), "b".into()], stops, receptions, Vec::new())
}

#[test]
fn receptions_are_found_by_node_in_the_order_of_stops() {
    let log = log(vec![heard(1, 2), heard(0, 1), heard(1, 0)]).unwrap();
    assert_eq!(log.of(NodeId(0)), [heard(0, 1)]);
    assert_eq!(log.of(NodeId(1)), [heard(1, 0), heard(1, 2)]);
    assert_eq!(log.of(NodeId(1)).stops(), [0, 2]);
    assert_eq!(log.receptions(), [heard(0, 1), heard(1, 0), heard(1, 2)]);
}

#[test]
fn drives_join_the_stops_of_one_robot_only() {
    let stop = |robot, x_m| Stop { robot: RobotId(robot), ..Stop::at(Position::new(x_m, 0.0, 0.0)) };
    let stops = vec![stop(0, 0.0), stop(1, 100.0), stop(0, 1.0), stop(1, 98.0), stop(0, 4.0)];
    let log = ReceptionLog::new(Vec::new(), stops, Vec::new(), Vec::new()).unwrap();
    let lengths: Vec<(u32, f64)> = log.drives().map(|drive| (drive.robot.0, drive.length_m())).collect();
    assert_eq!(lengths, [(0, 1.0), (1, 2.0), (0, 3.0)]);
    assert_eq!(log.robot_count(), 2);
    let named = log.clone().with_robots(vec!["a".into(), "b".into(), "c".into()]).unwrap();
    assert_eq!((named.robot_count(), named.robots()[1].as_str()), (3, "b"));
    assert_eq!(log.with_robots(vec!["a".into()]), Err(LogError::UnknownRobot { robot: 1, robots: 1 }));
}

#[test]
fn a_slot_counts_as_one_packet_received_if_any_was() {
    let counted = |node, stop, received, sent| Reception { received, sent, ..heard(node, stop) };
    let counts = vec![counted(0, 0, 3, 5), counted(0, 1, 0, 4), counted(1, 0, 0, 0), counted(1, 2, 2, 2)];
    let slots = vec![counted(0, 0, 1, 1), counted(0, 1, 0, 1), counted(1, 0, 0, 0), counted(1, 2, 1, 1)];
    let (counts, slots) = (log(counts).unwrap(), log(slots).unwrap());
    assert_eq!(*counts.at_least_one(), slots);
    assert!(matches!(slots.at_least_one(), Cow::Borrowed(_)));
    let plain = log(vec![heard(0, 0), heard(1, 2)]).unwrap();
    assert_eq!(*log(vec![counted(0, 0, 2, 2), counted(1, 2, 1, 3)]).unwrap().at_least_one(), plain);
}

#[test]
fn impossible_receptions_are_rejected() {
    assert!(matches!(log(vec![heard(2, 0)]), Err(LogError::UnknownNode { node: 2, nodes: 2 })));
    assert!(matches!(log(vec![heard(u32::MAX, 0)]), Err(LogError::UnknownNode { node: u32::MAX, .. })));
    assert!(matches!(log(vec![heard(1, 3)]), Err(LogError::UnknownStop { stop: 3, stops: 3, .. })));
    assert!(matches!(log(vec![heard(1, 1), heard(1, 1)]), Err(LogError::Twice { stop: 1, .. })));
    let apart = vec![heard(1, 1), heard(0, 2), heard(1, 0), heard(1, 1)];
    assert!(matches!(log(apart), Err(LogError::Twice { stop: 1, .. })));
    assert!(matches!(
        log(vec![Reception { received: 2, ..heard(0, 0) }]),
        Err(LogError::MoreThanSent { received: 2, sent: 1, .. })
    ));
}
