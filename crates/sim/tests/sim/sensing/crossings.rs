//! When targets enter and leave the radius of detection.

use proptest::prelude::*;
use sextant_channel::{ObstacleField, Position};
use sextant_kernel::{NodeId, Seed, SimTime};
use sextant_sim::{AtEnd, Sensed, TargetId};

use super::{Watcher, run, seconds, watched, way, world};

const FIRST: TargetId = TargetId(0);

/// What node `node` senses, with its time (s).
fn sensed_by(ended: &crate::network::Ended<Watcher>, node: usize) -> Vec<(f64, Sensed)> {
    ended.applications[node].sensed.iter().map(|&(time, sensed)| (time.as_secs_f64(), sensed)).collect()
}

#[test]
fn a_straight_way_through_a_disc_is_sensed_at_the_instants_of_pythagoras() {
    // The line passes the first node at 3 m, so it is within 5 m from x = 16 to 24; it touches the disc of the second.
    let nodes = [[20.0, 3.0, 0.0], [50.0, 5.0, 0.0], [80.0, -7.0, 0.0]];
    let line = way(&[[0.0, 0.0, 0.0], [100.0, 0.0, 0.0]], 2.0, AtEnd::Stay);
    let (ended, _) = watched(world(&nodes, &[line], 5.0), 60.0, 1);
    assert_eq!(sensed_by(&ended, 0), [(8.0, Sensed::Entered(FIRST)), (12.0, Sensed::Left(FIRST))]);
    assert_eq!(sensed_by(&ended, 1), []);
    assert_eq!(sensed_by(&ended, 2), []);
}

#[test]
fn a_ball_in_space_is_left_where_the_sphere_is() {
    // Straight up through a node 2 m beside the line.
    let line = way(&[[2.0, 0.0, -10.0], [2.0, 0.0, 10.0]], 1.0, AtEnd::Stay);
    let (ended, _) = watched(world(&[[0.0, 0.0, 1.0]], &[line], 4.0), 60.0, 1);
    let half = 12.0_f64.sqrt();
    let found = sensed_by(&ended, 0);
    assert_eq!(found.len(), 2);
    assert!((found[0].0 - (11.0 - half)).abs() < 1e-9 && (found[1].0 - (11.0 + half)).abs() < 1e-9, "{found:?}");
}

#[test]
fn a_target_that_starts_inside_is_sensed_at_once_and_one_that_stays_is_not_left() {
    let out = way(&[[1.0, 0.0, 0.0], [9.0, 0.0, 0.0]], 1.0, AtEnd::Stay);
    let stands = way(&[[0.0, 1.0, 0.0]], 1.0, AtEnd::Loop);
    let (ended, notebook) = watched(world(&[[0.0; 3]], &[out, stands], 3.0), 60.0, 1);
    let expected = [(0.0, Sensed::Entered(FIRST)), (0.0, Sensed::Entered(TargetId(1))), (2.0, Sensed::Left(FIRST))];
    assert_eq!(sensed_by(&ended, 0), expected);
    let of_first: Vec<_> = notebook.moved.iter().filter(|(target, ..)| *target == FIRST).copied().collect();
    let end = Position::new(9.0, 0.0, 0.0);
    let moved = [(0.0, Position::new(1.0, 0.0, 0.0)), (8.0, end), (60.0, end)];
    assert_eq!(of_first, moved.map(|(time, place)| (FIRST, seconds(time), place)));
}

#[test]
fn a_way_with_turns_is_sensed_on_each_leg() {
    // A square of side 10 around a node at its first corner, walked twice: a quarter of the disc at each visit.
    let square = [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [10.0, 10.0, 0.0], [0.0, 10.0, 0.0]];
    let (ended, _) = watched(world(&[[0.0; 3]], &[way(&square, 1.0, AtEnd::Loop)], 4.0), 80.0, 1);
    let entered = |time| (time, Sensed::Entered(FIRST));
    let left = |time| (time, Sensed::Left(FIRST));
    assert_eq!(sensed_by(&ended, 0), [entered(0.0), left(4.0), entered(36.0), left(44.0), entered(76.0)]);
}

#[test]
fn a_target_that_turns_back_on_the_rim_is_not_sensed() {
    let back = way(&[[10.0, 0.0, 0.0], [4.0, 0.0, 0.0]], 1.0, AtEnd::Loop);
    let (ended, _) = watched(world(&[[0.0; 3]], &[back], 4.0), 50.0, 1);
    assert_eq!(sensed_by(&ended, 0), []);
}

#[test]
fn sensors_that_nobody_looks_at_cost_no_event() {
    let line = || way(&[[-9.0, 0.0, 0.0], [9.0, 0.0, 0.0]], 1.0, AtEnd::Stay);
    let blind = vec![Watcher { is_blind: true, ..Watcher::default() }];
    let mut notebook = super::Notebook::default();
    let ended = run(world(&[[0.0; 3]], &[line()], 4.0), blind, 60.0, 1, &mut notebook);
    // The two ends of the leg.
    assert_eq!((ended.events, notebook.sensed.len(), notebook.moved.len()), (2, 0, 3));
    let (ended, _) = watched(world(&[[0.0; 3]], &[], 4.0), 60.0, 1);
    assert_eq!(ended.events, 0);
}

#[test]
fn an_observer_hears_what_applications_hear() {
    let line = way(&[[-9.0, 1.0, 0.0], [9.0, 0.0, 0.0]], 1.0, AtEnd::Loop);
    let (ended, notebook) = watched(world(&[[0.0; 3], [3.0, 0.0, 0.0]], &[line], 4.0), 200.0, 1);
    for (i, watcher) in ended.applications.iter().enumerate() {
        let observed = notebook.sensed.iter().filter(|(node, ..)| node.index() == i);
        assert_eq!(observed.map(|&(_, time, sensed)| (time, sensed)).collect::<Vec<_>>(), watcher.sensed);
        assert!(watcher.sensed.len() > 15);
    }
}

fn place() -> impl Strategy<Value = [f64; 3]> {
    [-20.0..20.0, -20.0..20.0, -4.0..4.0_f64]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_dense_poll_finds_the_same_detections(
        nodes in proptest::collection::vec(place(), 1..30),
        ways in proptest::collection::vec((proptest::collection::vec(place(), 1..6), 0.3..9.0_f64, any::<bool>()), 1..4),
        radius_m in 0.3..12.0_f64,
    ) {
        const DURATION_S: f64 = 40.0;
        const STEP_NS: usize = 20_000_000;
        let motions: Vec<_> = ways.iter().map(|(places, speed, loops)| {
            way(places, *speed, if *loops { AtEnd::Loop } else { AtEnd::Stay })
        }).collect();
        let world = world(&nodes, &motions, radius_m);
        let (targets, none) = (world.targets.clone(), ObstacleField::default());
        let (_, notebook) = watched(world, DURATION_S, 1);
        for (number, target) in targets.iter().enumerate() {
            let target_id = TargetId(u16::try_from(number).unwrap());
            let mut course = target.course(Seed(1));
            let legs: Vec<_> = std::iter::from_fn(|| course.next_leg(&none))
                .take_while(|leg| leg.start < seconds(DURATION_S))
                .collect();
            let place = |time| {
                let leg = legs.get(legs.partition_point(|leg| leg.end < time)).or(legs.last());
                leg.map_or(target.start(), |leg| leg.at(time))
            };
            for (i, &node) in nodes.iter().enumerate() {
                let distance_m = |time| place(time).distance_m(node.into());
                let changes: Vec<_> = notebook.sensed.iter()
                    .filter(|(by, _, sensed)| *by == NodeId::from_index(i)
                        && matches!(sensed, Sensed::Entered(id) | Sensed::Left(id) if *id == target_id))
                    .collect();
                for (i, &&(_, time, sensed)) in changes.iter().enumerate() {
                    prop_assert_eq!(matches!(sensed, Sensed::Entered(_)), i % 2 == 0, "in turn: {:?}", &changes);
                    let is_start = time == SimTime::ZERO && distance_m(time) < radius_m;
                    // A nanosecond at 9 m/s.
                    prop_assert!(is_start || (distance_m(time) - radius_m).abs() < 2e-8, "{}", distance_m(time));
                }
                for now in (0..seconds(DURATION_S).as_nanos()).step_by(STEP_NS) {
                    let time = SimTime::from_nanos(now);
                    let detected = changes.iter().filter(|(_, at, _)| *at <= time).count() % 2 == 1;
                    if (distance_m(time) - radius_m).abs() > 2e-8 {
                        prop_assert_eq!(detected, distance_m(time) < radius_m, "{} m at {}", distance_m(time), time);
                    }
                }
            }
        }
    }
}
