//! Targets that leave the world: at the end of a listed way, or of a visit.

use proptest::prelude::*;
use sextant_channel::{BoxConfig, ObstacleConfig, ObstacleField, Position, ShapeConfig};
use sextant_kernel::{Files, Seed};
use sextant_sim::layout::{ExplicitConfig, NodesConfig, Region, RegionConfig};
use sextant_sim::{
    AtEnd, Leg, Sensed, StraightConfig, TargetConfig, TargetId, TargetMotionConfig, TurnConfig, WanderConfig,
    WorldConfig,
};

use super::{block, seconds, watched, way, world};
const FIRST: TargetId = TargetId(0);

#[test]
fn a_target_that_leaves_at_the_end_of_its_way_is_not_sensed_any_more() {
    // Within 5 m of the node from x = 10 on; the way ends in its disc, after 14 s.
    let line = way(&[[0.0; 3], [14.0, 0.0, 0.0]], 1.0, AtEnd::Leave);
    let (ended, notebook) = watched(world(&[[15.0, 0.0, 0.0]], &[line], 5.0), 60.0, 1);
    let sensed: Vec<_> = ended.applications[0].sensed.clone();
    assert_eq!(sensed, [(seconds(10.0), Sensed::Entered(FIRST)), (seconds(14.0), Sensed::Left(FIRST))]);
    assert_eq!(notebook.gone, [(FIRST, seconds(14.0))]);
    // Its start and its end, and nothing at the end of the time.
    let moved = [(0.0, 0.0), (14.0, 14.0)].map(|(time, x_m)| (FIRST, seconds(time), Position::new(x_m, 0.0, 0.0)));
    assert_eq!(notebook.moved, moved);
}

fn thesis() -> WanderConfig {
    WanderConfig {
        from_m: Position::new(1.0, 20.0, 0.0),
        to_m: Position::new(1.0, 10.0, 0.0),
        duration_s: 80.0,
        speed_m_per_s: 1.5,
        straight: StraightConfig::MeanM(15.0),
        turn: TurnConfig::UniformDeg(90.0),
        region: RegionConfig::Rectangle {
            min_m: Position::new(2.0, 0.0, 0.0),
            max_m: Position::new(50.0, 40.0, 0.0),
        },
    }
}

fn target(visit: &WanderConfig) -> TargetConfig {
    TargetConfig { name: "visitor".into(), motion: TargetMotionConfig::Wander(visit.clone()), screen: None }
}

fn legs(visit: &WanderConfig, obstacles: &ObstacleField, seed: u64) -> Vec<Leg> {
    let target = target(visit).build(3, obstacles, Seed(seed)).expect("there is a way");
    let mut course = target.course(Seed(seed));
    assert!(course.leaves());
    std::iter::from_fn(|| course.next_leg(obstacles)).collect()
}

/// Checks all that a visit promises.
fn check(visit: &WanderConfig, obstacles: &ObstacleField, seed: u64) -> Result<(), TestCaseError> {
    let legs = legs(visit, obstacles, seed);
    let region = Region::try_from(&visit.region).expect("a good region");
    let (first, last) = (legs[0], legs[legs.len() - 1]);
    prop_assert_eq!((first.from, first.start), (visit.from_m, seconds(0.0)));
    prop_assert_eq!((last.to, last.end), (visit.to_m, seconds(visit.duration_s)));
    for pair in legs.windows(2) {
        prop_assert_eq!((pair[0].to, pair[0].end), (pair[1].from, pair[1].start));
    }
    let length_m: f64 = legs.iter().map(|leg| leg.from.distance_m(leg.to)).sum();
    prop_assert!((length_m - visit.speed_m_per_s * visit.duration_s).abs() < 1e-9, "{length_m} m");
    for (i, leg) in legs.iter().enumerate() {
        let (span_s, leg_m) = ((leg.end - leg.start).as_secs_f64(), leg.from.distance_m(leg.to));
        // A nanosecond at each end.
        prop_assert!((span_s * visit.speed_m_per_s - leg_m).abs() < 1e-8, "{leg:?}");
        prop_assert!(obstacles.blocking(leg.from, leg.to).is_none(), "{leg:?} crosses an obstacle");
        // A way leads in, and one leads out: there, what is outside stays outside.
        let mut was_inside = region.contains(leg.from);
        let mut changes = 0;
        for step in 1..=200 {
            let place = leg.from + (leg.to - leg.from) * (f64::from(step) / 200.0);
            let is_inside = region.contains(place);
            changes += u32::from(is_inside != was_inside);
            was_inside = is_inside;
        }
        let crosses = u32::from(i == 0 && !region.contains(visit.from_m))
            + u32::from(i + 1 == legs.len() && !region.contains(visit.to_m));
        prop_assert!(changes == crosses, "{leg:?}, leg {i} of {}", legs.len());
    }
    Ok(())
}

fn letter_u() -> RegionConfig {
    let corners_m = vec![
        [0.0, 0.0],
        [40.0, 0.0],
        [40.0, 40.0],
        [28.0, 40.0],
        [28.0, 12.0],
        [12.0, 12.0],
        [12.0, 40.0],
        [0.0, 40.0],
    ];
    RegionConfig::Polygon { corners_m, z_m: 0.0 }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn a_visit_is_as_long_as_its_time_and_keeps_to_its_region(
        seed: u64,
        shape in 0..5_usize,
        has_obstacles: bool,
        duration_s in 60.0..200.0_f64,
    ) {
        let obstacles = if has_obstacles {
            vec![block([9.0, 5.0, 0.0], [3.0, 2.0, 4.0]), block([22.0, 9.0, 0.0], [4.0, 1.0, 2.0])]
        } else {
            Vec::new()
        };
        let obstacles = ObstacleField::new(obstacles);
        let ends = |from_m: [f64; 3], to_m: [f64; 3], region| WanderConfig {
            from_m: from_m.into(), to_m: to_m.into(), region, duration_s, ..thesis()
        };
        let center_m = Position::new(15.0, 10.0, 0.0);
        let visit = match shape {
            0 => WanderConfig { duration_s, ..thesis() },
            // From one side of the border to another.
            1 => ends([0.0, 4.0, 0.0], [35.0, 40.0, 0.0], letter_u()),
            2 => ends([-3.0, 20.0, 0.0], [44.0, 30.0, 0.0], letter_u()),
            3 => ends([15.0, -20.0, 0.0], [15.0, 10.0, 0.0], RegionConfig::Disc { center_m, radius_m: 24.0 }),
            _ => ends([-20.0, 4.0, 3.0], [30.0, 20.0, -5.0], RegionConfig::Ball { center_m, radius_m: 24.0 }),
        };
        check(&visit, &obstacles, seed)?;
    }
}

#[test]
fn a_visit_that_has_time_for_the_straight_way_alone_is_straight() {
    let visit = WanderConfig { duration_s: 10.0, speed_m_per_s: 1.0, ..thesis() };
    let legs = legs(&visit, &ObstacleField::default(), 1);
    assert_eq!(legs, [Leg { from: visit.from_m, to: visit.to_m, start: seconds(0.0), end: seconds(10.0) }]);
}

#[test]
fn visits_differ_from_seed_to_seed_and_turn_often() {
    let none = ObstacleField::default();
    let (one, other) = (legs(&thesis(), &none, 1), legs(&thesis(), &none, 2));
    assert_eq!(one, legs(&thesis(), &none, 1));
    assert_ne!(one, other);
    // 120 m in pieces of 15 m, of which the last one is longer.
    let count: usize = (0..50).map(|seed| legs(&thesis(), &none, seed).len()).sum();
    assert!((250..600).contains(&count), "{count} legs of 50 visits");
}

#[test]
fn a_visit_ends_on_time_for_sensors_and_observers() {
    // Near the exit, and one that sees all.
    let mut world = world(&[[1.0, 11.0, 0.0], [25.0, 20.0, 0.0]], &[], 60.0);
    world.targets = vec![target(&thesis()).build(0, &ObstacleField::default(), Seed(4)).expect("there is a way")];
    let (ended, notebook) = watched(world, 100.0, 4);
    let all: Vec<_> = ended.applications[1].sensed.clone();
    assert_eq!(all, [(seconds(0.0), Sensed::Entered(FIRST)), (seconds(80.0), Sensed::Left(FIRST))]);
    assert_eq!(notebook.gone, [(FIRST, seconds(80.0))]);
    let last = notebook.moved[notebook.moved.len() - 1];
    assert_eq!(last, (FIRST, seconds(80.0), thesis().to_m));
}

#[test]
fn impossible_visits_are_refused_with_their_key() {
    let obstacles = ObstacleField::new(vec![block([20.0, 20.0, 0.0], [4.0; 3])]);
    let error = |visit: WanderConfig| target(&visit).build(0, &obstacles, Seed(1)).unwrap_err();
    let key = |visit| error(visit).key;
    let late = error(WanderConfig { duration_s: 6.0, ..thesis() });
    assert_eq!(late.key, "motion.wander.duration_s");
    assert_eq!(late.found(), "6: enough for 9 m");
    assert!(late.allowed().starts_with("at least 6.666") && late.allowed().contains("10 m"), "{late}");
    assert_eq!(key(WanderConfig { to_m: Position::new(20.0, 20.0, 0.0), ..thesis() }), "motion.wander.to_m");
    assert_eq!(key(WanderConfig { from_m: Position::new(1.0, 20.0, 1.0), ..thesis() }), "motion.wander.from_m");
    let straight = StraightConfig::MeanM(1e-3);
    assert_eq!(key(WanderConfig { straight, duration_s: 1e3, ..thesis() }), "motion.wander.straight");
    assert_eq!(key(WanderConfig { speed_m_per_s: 0.0, ..thesis() }), "motion.wander.speed_m_per_s");
    // An exit behind a wall with no way around it that is inside the region.
    let wall = BoxConfig::new(Position::new(25.0, 15.0, 0.0), [100.0, 1.0, 4.0]);
    let wall = ObstacleConfig::of(ShapeConfig::Box(wall), "concrete");
    let wall = ObstacleField::new(vec![sextant_channel::Obstacle::read(wall, &Files::default()).unwrap()]);
    let error = target(&thesis()).build(0, &wall, Seed(1)).unwrap_err();
    assert_eq!(error.key, "motion.wander.duration_s");
    assert!(error.found().contains("no way of 120 m"), "{error}");
    let alone = way(&[[0.0; 3]], 1.0, AtEnd::Leave);
    let alone =
        TargetConfig { name: "t".into(), motion: alone, screen: None }.build(0, &obstacles, Seed(1)).unwrap_err();
    assert_eq!(alone.key, "motion.waypoints.at_end");
}

#[test]
fn a_visit_is_written_as_in_a_scenario() {
    let text = "name = \"visitor\"\n[motion.wander]\nfrom_m = [1.0, 20.0]\nto_m = [1.0, 10.0]\nduration_s = 80.0\n\
                speed_m_per_s = 1.5\nstraight.mean_m = 15.0\nturn.uniform_deg = 90.0\n\
                region.rectangle = { min_m = [2.0, 0.0], max_m = [50.0, 40.0] }\n";
    assert_eq!(toml::from_str::<TargetConfig>(text).expect("a target"), target(&thesis()));
}

#[test]
fn a_target_far_from_all_nodes_is_refused() {
    let nodes = ExplicitConfig {
        positions_m: vec![Position::ORIGIN, Position::new(3000.0, 0.0, 0.0)],
        names: None,
        storeys: Default::default(),
    };
    let key = |motion: TargetMotionConfig| {
        let config = WorldConfig {
            motions: Vec::new(),
            nodes: NodesConfig::Explicit(nodes.clone()),
            obstacles: Vec::new(),
            storeys: Vec::new(),
            walls: Vec::new(),
            targets: vec![TargetConfig { name: "t".into(), motion, screen: None }],
            fields: Vec::new(),
        };
        config
            .build(Seed(1), &Files::default())
            .map_err(|error| (error.key.clone(), error.found().to_owned(), error.allowed().to_owned()))
    };
    let near = [[2500.0, 0.0, 0.0], [900.0, 400.0, 0.0]];
    assert!(key(way(&near, 1.0, AtEnd::Stay)).is_ok());
    let far = [[2500.0, 0.0, 0.0], [900.0, 500.0, 0.0]];
    let (found, allowed) = ("[900, 500, 0]".to_owned(), "a place within 1000 m of a node".to_owned());
    let refused = key(way(&far, 1.0, AtEnd::Stay)).unwrap_err();
    assert_eq!(refused, ("targets[0].motion.waypoints.places_m[1]".to_owned(), found, allowed));
    let visit = WanderConfig { to_m: Position::new(1500.0, 10.0, 0.0), ..thesis() };
    assert_eq!(key(TargetMotionConfig::Wander(visit)).unwrap_err().0, "targets[0].motion.wander.to_m");
}
