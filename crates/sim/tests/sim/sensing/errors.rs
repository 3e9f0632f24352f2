//! Sensors that err: missed passages, false alarms, walls that hide targets.

use sextant_channel::{ObstacleField, Position};
use sextant_kernel::{NodeId, SimTime};
use sextant_sim::{AtEnd, Sensed, Sensors, SensorsConfig, TargetId, TargetSensorConfig, World};

use super::{Notebook, block, discs, seconds, targets, watched, way};
use crate::network;

const RADIUS_M: f64 = 4.0;

fn sensors(config: TargetSensorConfig) -> Sensors {
    Sensors::try_from(SensorsConfig { targets: Some(config), fields: None }).expect("good settings")
}

fn perfect() -> TargetSensorConfig {
    TargetSensorConfig::perfect(RADIUS_M)
}

/// A hundred nodes, and two targets that go round among them.
fn crowd(sensors: Sensors) -> World {
    let places: Vec<Position> =
        (0..100).map(|i| Position::new(f64::from(i % 10) * 3.0, f64::from(i / 10) * 3.0, 0.0)).collect();
    let square = |a: f64, b: f64| [[a, a, 0.0], [b, a, 0.0], [b, b, 0.0], [a, b, 0.0]];
    let motions = [way(&square(2.0, 25.0), 1.5, AtEnd::Loop), way(&square(8.0, 15.5), 1.0, AtEnd::Loop)];
    let targets = targets(&motions, &ObstacleField::default());
    World { nodes: network::nodes(&places), targets, sensors, ..World::default() }
}

fn entries(notebook: &Notebook) -> usize {
    notebook.sensed.iter().filter(|(_, _, sensed)| matches!(sensed, Sensed::Entered(_))).count()
}

#[test]
fn a_missed_passage_is_missed_as_a_whole_and_changes_no_other() {
    let (all, everything) = watched(crowd(discs(RADIUS_M)), 600.0, 1);
    let (some, heard) = watched(crowd(sensors(TargetSensorConfig { miss_probability: 0.3, ..perfect() })), 600.0, 1);
    assert!(heard.sensed.iter().all(|said| everything.sensed.contains(said)), "nothing is said that is not so");
    assert_eq!(heard.moved, everything.moved);
    // No entry without its leaving: what is missing of the ones is missing of the others, but for the last ones.
    assert_eq!(all.sensed.entered, some.sensed.entered + some.sensed.missed);
    assert_eq!((all.sensed.missed, all.sensed.false_alarms), (0, 0));
    let share = some.sensed.missed as f64 / all.sensed.entered as f64;
    // 1154 passages: the standard error of the share is 0.0135, and four of them are 0.054.
    assert!(all.sensed.entered > 1000 && (share - 0.3).abs() < 0.054, "{share} of {}", all.sensed.entered);
    for node in (0..100).map(NodeId) {
        for target in [0, 1].map(TargetId) {
            let said = heard.sensed.iter().filter(|&&(who, ..)| who == node).map(|&(.., sensed)| sensed);
            let said: Vec<Sensed> = said
                .filter(|sensed| matches!(sensed, Sensed::Entered(of) | Sensed::Left(of) if *of == target))
                .collect();
            for pair in said.chunks(2) {
                assert_eq!(pair[0], Sensed::Entered(target));
                assert!(pair.get(1).is_none_or(|second| *second == Sensed::Left(target)));
            }
        }
    }
}

#[test]
fn false_alarms_last_as_long_as_told_and_leave_true_detections_alone() {
    let config = TargetSensorConfig { false_alarms_per_h: 120.0, false_alarm_s: 0.5, ..perfect() };
    // Targets far away: all that is said is false.
    let far = |config| {
        let stands = way(&[[1e4, 0.0, 0.0]], 1.0, AtEnd::Loop);
        World { targets: targets(&[stands.clone(), stands], &ObstacleField::default()), ..crowd(sensors(config)) }
    };
    let (ended, heard) = watched(far(config), 600.0, 1);
    // 100 nodes at 20 in 600 s: the standard deviation is 45.
    let count = ended.sensed.false_alarms;
    assert!((1820..2180).contains(&count), "{count} false alarms");
    assert_eq!(ended.sensed.entered, count);
    let mut overlaps = 0;
    for (i, &(node, time, sensed)) in heard.sensed.iter().enumerate() {
        let Sensed::Entered(target) = sensed else { continue };
        let left = heard.sensed[i..].iter().find(|&&(who, _, said)| who == node && said == Sensed::Left(target));
        let Some(&(_, left, _)) = left else { continue };
        let lasted_s = left.saturating_since(time).as_secs_f64();
        assert!(lasted_s >= 0.5 - 1e-9, "{lasted_s} s");
        overlaps += u32::from(lasted_s > 0.5 + 1e-9);
    }
    assert!(overlaps < 60, "two in a row are one: {overlaps}");
    // Where targets are near, each true detection is still said, or the node says so already.
    let (truly, everything) = watched(crowd(discs(RADIUS_M)), 600.0, 1);
    let (mixed, heard) = watched(crowd(sensors(config)), 600.0, 1);
    assert_eq!(heard.moved, everything.moved);
    let unsaid = everything.sensed.iter().filter(|said| !heard.sensed.contains(said)).count();
    assert!(unsaid < everything.sensed.len() / 20, "{unsaid} of {}", everything.sensed.len());
    assert!(mixed.sensed.entered > truly.sensed.entered && mixed.sensed.false_alarms > 0);
}

#[test]
fn sensors_that_err_are_the_same_again_and_other_seeds_are_others() {
    let config =
        TargetSensorConfig { miss_probability: 0.4, false_alarms_per_h: 60.0, walls_hide: true, ..perfect() };
    let heard = |seed| watched(crowd(sensors(config)), 200.0, seed).1;
    assert_eq!(heard(3), heard(3));
    assert_ne!(heard(3).sensed, heard(4).sensed);
    assert!(entries(&heard(3)) > 100);
}

#[test]
fn without_obstacles_walls_hide_nothing() {
    let (_, open) = watched(crowd(discs(RADIUS_M)), 300.0, 1);
    let (_, hiding) = watched(crowd(sensors(TargetSensorConfig { walls_hide: true, ..perfect() })), 300.0, 1);
    assert_eq!(open, hiding);
}

/// The ways through the radius are looked at every 5 ms, by the rule of a line in a turned box.
#[test]
fn a_node_detects_a_target_exactly_while_no_wall_is_between_them() {
    let obstacles = || ObstacleField::new(vec![block([10.0, 8.0, 0.0], [5.0, 2.0, 3.0])]);
    let nodes: Vec<Position> = (0..6).map(|i| Position::new(5.0 + 2.0 * f64::from(i), 5.0, 0.0)).collect();
    let line = way(&[[0.0, 11.0, 0.0], [20.0, 10.5, 0.0], [9.0, 12.0, 0.0]], 1.25, AtEnd::Loop);
    let config = TargetSensorConfig { walls_hide: true, ..TargetSensorConfig::perfect(7.0) };
    let world = World {
        nodes: network::nodes(&nodes),
        targets: targets(&[line], &obstacles()),
        obstacles: obstacles(),
        sensors: sensors(config),
        ..World::default()
    };
    let (_, notebook) = watched(world, 60.0, 1);
    let target = |time: SimTime| {
        let after = notebook.moved.iter().position(|&(_, at, _)| at > time).expect("the end is told");
        let [(_, t0, a), (_, t1, b)] = [notebook.moved[after - 1], notebook.moved[after]];
        a + (b - a) * (time.saturating_since(t0).as_secs_f64() / t1.saturating_since(t0).as_secs_f64())
    };
    let is_in_block = |p: Position| {
        let (sin, cos) = 20_f64.to_radians().sin_cos();
        let (x, y) = (p.x_m - 10.0, p.y_m - 8.0);
        (cos * x + sin * y).abs() < 2.5 && (cos * y - sin * x).abs() < 1.0
    };
    let (mut seen, mut hidden) = (0, 0);
    for (i, &node) in nodes.iter().enumerate() {
        let said: Vec<_> = notebook.sensed.iter().filter(|(who, ..)| who.index() == i).collect();
        for step in 1..11_990 {
            let time = seconds(f64::from(step) * 0.005);
            let place = target(time);
            let is_near = place.distance_m(node) < 7.0;
            let crosses = (1..1000).any(|k| is_in_block(node + (place - node) * (f64::from(k) / 1000.0)));
            // What it said last, unless something changes within 10 ms.
            if said
                .iter()
                .any(|(_, at, _)| at.saturating_since(time).max(time.saturating_since(*at)).as_secs_f64() < 0.01)
            {
                continue;
            }
            let last = said.iter().rev().find(|(_, at, _)| *at <= time);
            let detects = last.is_some_and(|(.., sensed)| matches!(sensed, Sensed::Entered(_)));
            assert_eq!(detects, is_near && !crosses, "node {i} at {time}");
            seen += u32::from(detects);
            hidden += u32::from(is_near && crosses);
        }
    }
    assert!(seen > 3000 && hidden > 3000, "{seen} seen, {hidden} hidden");
}
