//! Maps of robots with frames of their own are stitched.

use proptest::prelude::*;
use sextant_channel::{Position, Reception, ReceptionLog, SectorTable, Stop};
use sextant_kernel::{NodeId, Purpose, RobotId, Seed};
use sextant_mapper::{
    FrameChange, FrameKnowledge, Frames, Handedness, Knowledge, MapError, Mapper, MlTm, MlTmConfig, OwnMap,
    PairFault, PairState, PlacedNode, ProfileConfig, RobotOutcome, StitchConfig, StitchRules, Stitched, Stitching,
    TrapezoidConfig, stitch,
};

fn draw(seed: u64, place: [u64; 3]) -> f64 {
    Seed(seed).uniform(Purpose::new(8), place)
}

/// Nodes in an area of 60 m by 30 m.
fn nodes(seed: u64, count: u64) -> Vec<Position> {
    (0..count).map(|i| Position::new(60.0 * draw(seed, [i, 0, 0]), 30.0 * draw(seed, [i, 1, 0]), 0.0)).collect()
}

/// A random frame; that of the world for the first robot.
fn frame(seed: u64, robot: usize, scaled: bool) -> FrameChange {
    if robot == 0 {
        return FrameChange::NONE;
    }
    let draw = |what| draw(seed, [1_000 + robot as u64, 7, what]);
    FrameChange {
        handedness: if draw(0) < 0.5 { Handedness::Same } else { Handedness::Mirrored },
        turn_rad: std::f64::consts::TAU * (draw(1) - 0.5),
        scale: if scaled { 0.8 + 0.4 * draw(2) } else { 1.0 },
        offset: Position::new(200.0 * draw(3) - 100.0, 200.0 * draw(4) - 100.0, 2.0 * draw(5)),
    }
}

/// The maps of robots side by side, each 60 m / robots wide and 5 m more, in their frames. `moved` changes a place.
fn maps(
    places: &[Position],
    frames: &[FrameChange],
    moved: impl Fn(usize, usize, Position) -> Position,
) -> Vec<OwnMap> {
    let width_m = 60.0 / frames.len() as f64;
    let map = |(robot, frame): (usize, &FrameChange)| {
        let first_m = width_m * robot as f64;
        let is_near = |place: &Position| (first_m - 5.0..=first_m + width_m + 5.0).contains(&place.x_m);
        let own = places.iter().enumerate().filter(|(_, place)| is_near(place)).map(|(node, &place)| PlacedNode {
            node: NodeId::from_index(node),
            place: frame.inverse().apply(moved(robot, node, place)),
            variance: 1.0,
            covariance: None,
        });
        OwnMap { nodes: own.collect() }
    };
    frames.iter().enumerate().map(map).collect()
}

fn rules(mirrored: bool, scaled: bool) -> StitchRules {
    StitchConfig { mirrored, scaled, known: None }.into()
}

/// How far the frames found are from the true ones over the area (m); infinite if one is not found.
fn worst_m(found: &[Option<FrameChange>], maps: &[OwnMap], frames: &[FrameChange]) -> f64 {
    let apart = |((found, map), frame): ((&Option<FrameChange>, &OwnMap), &FrameChange)| {
        let Some(found) = found else { return f64::INFINITY };
        let apart = map.nodes.iter().map(|node| found.apply(node.place).distance_m(frame.apply(node.place)));
        apart.fold(0.0, f64::max)
    };
    found.iter().zip(maps).zip(frames).map(apart).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn exact_maps_give_exact_frames(seed in 0_u64..1_000_000, robots in 2_usize..6, scaled: bool) {
        let frames: Vec<FrameChange> = (0..robots).map(|robot| frame(seed, robot, scaled)).collect();
        let maps = maps(&nodes(seed, 180), &frames, |_, _, place| place);
        let found = stitch(&maps, &rules(true, scaled), Seed(seed)).changes;
        let worst_m = worst_m(&found, &maps, &frames);
        prop_assert!(worst_m < 1e-6, "{worst_m} m");
    }

    #[test]
    fn wild_places_change_no_frame_if_they_are_less_than_a_third(seed in 0_u64..1_000_000, robots in 2_usize..5) {
        let frames: Vec<FrameChange> = (0..robots).map(|robot| frame(seed, robot, false)).collect();
        let draw = |robot: usize, node: usize, what| draw(seed, [node as u64, 50 + robot as u64, what]);
        let is_wild = |robot: usize, node: usize| draw(robot, node, 0) < 0.12;
        let wild = |robot: usize, node: usize, place: Position| {
            let far = Position::new(40.0 * draw(robot, node, 1) - 20.0, 40.0 * draw(robot, node, 2) - 20.0, 0.0);
            if is_wild(robot, node) { place + far } else { place }
        };
        let maps = maps(&nodes(seed, 240), &frames, wild);
        for (robot, pair) in maps.windows(2).enumerate() {
            let has = |node: NodeId| pair[1].nodes.iter().any(|other| other.node == node);
            let shared: Vec<usize> = pair[0].nodes.iter().filter(|at| has(at.node)).map(|at| at.node.index()).collect();
            let wild = shared.iter().filter(|&&node| is_wild(robot, node) || is_wild(robot + 1, node)).count();
            prop_assume!(3 * wild < shared.len());
        }
        let found = stitch(&maps, &rules(true, false), Seed(seed)).changes;
        let worst_m = worst_m(&found, &maps, &frames);
        prop_assert!(worst_m < 1e-6, "{worst_m} m");
    }
}

#[test]
fn noise_is_averaged_and_the_same_maps_give_the_same_frames() {
    let frames: Vec<FrameChange> = (0..4).map(|robot| frame(3, robot, false)).collect();
    let noisy = |robot: usize, node: usize, place: Position| {
        let draw = |what| Seed(9).normal(Purpose::new(8), [node as u64, robot as u64, what]);
        place + Position::new(0.5 * draw(0), 0.5 * draw(1), 0.0)
    };
    let maps = maps(&nodes(3, 400), &frames, noisy);
    let frames_found = stitch(&maps, &rules(true, false), Seed(1));
    let found = &frames_found.changes;
    let off = |robot: usize| {
        let middle = Position::new(15.0 * robot as f64 + 7.5, 15.0, 0.0);
        let own = frames[robot].inverse().apply(middle);
        found[robot].expect("a frame").apply(own).distance_m(middle)
    };
    // Some 60 nodes in each overlap: the frame is better than a single place, also three overlaps away.
    for robot in 0..4 {
        assert!(off(robot) < 0.5, "{robot}: {} m", off(robot));
    }
    assert_eq!(stitch(&maps, &rules(true, false), Seed(1)), frames_found);
}

#[test]
fn nodes_on_a_line_do_not_tell_the_handedness() {
    let line: Vec<Position> =
        (0..12_u8).map(|i| Position::new(27.0 + 0.5 * f64::from(i), f64::from(i), 0.0)).collect();
    let frames: Vec<FrameChange> = (0..2).map(|robot| frame(5, robot, false)).collect();
    let maps = maps(&line, &frames, |_, _, place| place);
    let Frames { changes: found, pairs, .. } = stitch(&maps, &rules(true, false), Seed(1));
    assert_eq!(found[1], None);
    assert_eq!(pairs[0].state, PairState::Undecided(PairFault::Handedness));
    // A node well off the line tells it, but only one: that may be an error.
    let mut off = line.clone();
    off.push(Position::new(33.0, 2.0, 0.0));
    let pairs = stitch(&self::maps(&off, &frames, |_, _, place| place), &rules(true, false), Seed(1)).pairs;
    assert_eq!(pairs[0].state, PairState::Undecided(PairFault::Handedness));
    off.extend([Position::new(31.0, 12.0, 0.0), Position::new(26.0, 7.0, 0.0)]);
    let found = stitch(&self::maps(&off, &frames, |_, _, place| place), &rules(true, false), Seed(1)).changes;
    assert!(found[1].is_some());
    // Robots of the same handedness need nothing off the line.
    let same: Vec<FrameChange> =
        frames.iter().map(|frame| FrameChange { handedness: Handedness::Same, ..*frame }).collect();
    let maps = self::maps(&line, &same, |_, _, place| place);
    let found = stitch(&maps, &rules(false, false), Seed(1)).changes;
    assert!(worst_m(&found, &maps, &same) < 1e-6);
}

#[test]
fn robots_that_share_too_little_or_disagree_stay_out() {
    let frames = vec![FrameChange::NONE; 3];
    let places = nodes(8, 200);
    let mut maps = maps(&places, &frames, |_, _, place| place);
    maps[2].nodes.retain(|node| places[node.node.index()].x_m > 46.0);
    let Frames { changes: found, pairs, .. } = stitch(&maps, &rules(true, false), Seed(1));
    assert!(found[1].is_some() && found[2].is_none());
    assert_eq!(pairs[1].state, PairState::Undecided(PairFault::TooFew { found: 0 }));
    // A map of random places fits nothing.
    for (i, node) in (0..).zip(&mut maps[1].nodes) {
        node.place = Position::new(30.0 * draw(4, [i, 3, 3]), 30.0 * draw(4, [i, 4, 4]), 0.0);
    }
    let Frames { changes: found, pairs, .. } = stitch(&maps, &rules(true, false), Seed(1));
    assert_eq!(found[1], None);
    assert!(matches!(pairs[0].state, PairState::Undecided(_)), "{:?}", pairs[0]);
}

/// Two robots on lanes over 30 m by 12 m; each hears nodes within 4 m. Their parts overlap by `overlap_m`.
fn log(places: &[Position], frames: &[FrameChange], overlap_m: f64) -> ReceptionLog {
    let (mut stops, mut receptions) = (Vec::new(), Vec::new());
    for (robot, frame) in (0..).zip(frames) {
        let (low_m, high_m) = if robot == 0 { (0.0, 15.0 + 0.5 * overlap_m) } else { (15.0 - 0.5 * overlap_m, 30.0) };
        let mut x_m = low_m;
        while x_m <= high_m + 1e-9 {
            for y in 0..13_u8 {
                let place = Position::new(x_m, f64::from(y), 0.0);
                let stop = u32::try_from(stops.len()).expect("few stops");
                for (node, at) in places.iter().enumerate() {
                    if at.distance_m(place) <= 4.0 {
                        let node = NodeId::from_index(node);
                        receptions.push(Reception::heard(node, stop, 1, 1));
                    }
                }
                let position = frame.inverse().apply(place);
                stops.push(Stop { robot: RobotId(robot), ..Stop::at(position) });
            }
            x_m += 1.5;
        }
    }
    let names = (0..places.len()).map(|node| format!("n{node}")).collect();
    let log = ReceptionLog::new(names, stops, receptions, Vec::new()).expect("a log");
    log.with_robots(vec!["a".to_owned(), "b".to_owned()]).expect("two robots")
}

fn field() -> Vec<Position> {
    (0..90_u64).map(|i| Position::new(30.0 * draw(6, [i, 0, 1]), 12.0 * draw(6, [i, 1, 1]), 0.0)).collect()
}

fn ml_tm() -> Mapper {
    let profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.98, 3.8, 4.2));
    Mapper::new(MlTm::try_from(MlTmConfig::new(0.25, profile)).expect("good settings"))
}

fn mean_error_m(mapper: &Mapper, log: &ReceptionLog, truth: &[Position]) -> (f64, usize) {
    let map = mapper.map(log).expect("a map");
    let errors: Vec<f64> =
        map.positions().iter().zip(truth).filter_map(|(place, truth)| Some((*place)?.distance_m(*truth))).collect();
    (errors.iter().sum::<f64>() / errors.len() as f64, errors.len())
}

#[test]
fn a_stitched_map_is_as_good_as_one_in_a_common_frame() {
    let truth = field();
    let frames = [FrameChange::NONE, frame(17, 3, false)];
    let (shared, apart) = (log(&truth, &[FrameChange::NONE; 2], 6.0), log(&truth, &frames, 6.0));
    let stitched = Stitched::mapper(ml_tm(), StitchConfig::default()).expect("a map of what robots hear");
    let known = mean_error_m(&ml_tm(), &shared, &truth);
    let (unknown, naive) = (mean_error_m(&stitched, &apart, &truth), mean_error_m(&ml_tm(), &apart, &truth));
    assert_eq!(unknown.1, truth.len());
    assert!(known.0 < 0.3 && unknown.0 < known.0 + 0.3, "{known:?} {unknown:?}");
    assert!(naive.0 > 5.0, "{naive:?}");
    let (_, learned) = stitched.map_and_learn(&apart, &sextant_kernel::Unwatched).expect("a map");
    let learned = learned.expect("frames");
    let stitching: &Stitching = learned.get().expect("frames");
    assert_eq!((stitching.joined(), stitching.robots[1].name.as_str()), (2, "b"));
}

#[test]
fn a_robot_without_an_overlap_stays_out_with_a_reason() {
    let truth = field();
    let frames = [FrameChange::NONE, frame(17, 3, false)];
    let far: Vec<Position> = truth.iter().filter(|place| (place.x_m - 15.0).abs() > 5.0).copied().collect();
    let stitched = Stitched::mapper(ml_tm(), StitchConfig::default()).expect("a map of what robots hear");
    let log = log(&far, &frames, 0.0);
    let (map, learned) = stitched.map_and_learn(&log, &sextant_kernel::Unwatched).expect("a map");
    let learned = learned.expect("frames");
    let stitching: &Stitching = learned.get().expect("frames");
    assert_eq!(stitching.joined(), 1);
    let RobotOutcome::LeftOut { why } = &stitching.robots[1].outcome else { panic!("{:?}", stitching.robots[1]) };
    assert!(why.contains("with a, "), "{why}");
    assert!(learned.lines("map", &map).iter().any(|line| line.text.contains("b is not in the map")));
    // What only the second robot heard is not on the map.
    let east = far.iter().zip(map.positions()).filter(|(place, _)| place.x_m > 22.0);
    assert!(east.into_iter().all(|(_, place)| place.is_none()));
}

#[test]
fn logs_that_cannot_be_stitched_are_refused() {
    let truth = field();
    let stitched = Stitched::mapper(ml_tm(), StitchConfig::default()).expect("a map of what robots hear");
    let log = log(&truth, &[FrameChange::NONE; 2], 6.0);
    let stops = log.stops().iter().map(|stop| Stop { robot: RobotId(0), ..*stop }).collect();
    let receptions = || log.receptions().iter().collect();
    let alone = ReceptionLog::new(log.names().to_vec(), stops, receptions(), Vec::new()).expect("a log");
    let refused = stitched.map(&alone).expect_err("one robot");
    assert_eq!(refused, MapError::OneRobot { robot: "robot-0".to_owned() });
    assert!(refused.to_string().contains("give the stops a column `robot`"), "{refused}");
    let sectors = SectorTable::default();
    let with_sectors = log.clone().with_sectors(sectors).expect("no sector is named");
    assert_eq!(stitched.map(&with_sectors).expect_err("sectors"), MapError::StitchedSectors);
}

/// The names of two robots.
fn names() -> [String; 2] {
    ["a".to_owned(), "b".to_owned()]
}

#[test]
fn robots_whose_frames_are_known_are_not_stitched() {
    let truth = field();
    let shared = log(&truth, &[FrameChange::NONE; 2], 6.0);
    let plain = ml_tm().map(&shared).expect("a map");
    let stitched = |known: Option<&[&str]>| {
        let known = known.map(|known| known.iter().map(|&name| name.to_owned()).collect());
        Stitched::mapper(ml_tm(), StitchConfig { known, ..StitchConfig::default() })
            .expect("a map of what robots hear")
    };
    let names = names();
    let (nobody, both) = (FrameKnowledge::Shared(&[]), FrameKnowledge::Shared(&names));
    // What the settings say goes before what else is known.
    for (known, frames, is_stitched) in [
        (None, nobody, true),
        (None, both, false),
        (None, FrameKnowledge::SharedByAll, false),
        (Some(&["b", "a"][..]), nobody, false),
        (Some(&[]), both, true),
        (Some(&["a"]), FrameKnowledge::SharedByAll, true),
    ] {
        let knowledge = Knowledge { frames, ..Knowledge::from(&shared) };
        let (map, learned) = stitched(known).map_and_learn(knowledge, &sextant_kernel::Unwatched).expect("a map");
        let learned = learned.expect("frames");
        let stitching: &Stitching = learned.get().expect("frames");
        assert_eq!((stitching.joined(), map == plain), (2, !is_stitched), "{known:?} {frames:?}");
        let says = learned.lines("m", &map).iter().any(|line| line.text.contains("nothing was stitched"));
        assert_eq!(says, !is_stitched, "{known:?} {frames:?}");
    }
    let refused = stitched(Some(&["a", "c"])).map(&shared).expect_err("no such robot");
    assert_eq!(refused, MapError::NoRobot { name: "c".to_owned(), known: "a, b".to_owned() });
}

#[test]
fn a_stitched_map_has_the_frame_of_the_robots_whose_frames_are_known() {
    let truth = field();
    let frames = [frame(17, 3, false), FrameChange::NONE];
    let apart = log(&truth, &frames, 6.0);
    let names = names();
    let stitched = Stitched::mapper(ml_tm(), StitchConfig::default()).expect("a map of what robots hear");
    // The first robot has a frame of its own, the second that of the world.
    let knowledge = Knowledge { frames: FrameKnowledge::Shared(&names[1..]), ..Knowledge::from(&apart) };
    let map = stitched.map(knowledge).expect("a map");
    let errors = map.positions().into_iter().zip(&truth).filter_map(|(place, truth)| Some(place?.distance_m(*truth)));
    let worst_m = errors.fold(0.0, f64::max);
    assert!(worst_m < 1.5, "{worst_m} m");
}

#[test]
fn groups_that_cannot_be_joined_are_named() {
    // Robots a and b hear nodes in the west, c and d others in the east.
    let truth = field();
    let moved = |robot: u32| Stop { robot: RobotId(robot), ..Stop::at(Position::ORIGIN) };
    let west = log(&truth, &[FrameChange::NONE, frame(17, 3, false)], 6.0);
    let (mut stops, mut receptions) = (Vec::new(), Vec::new());
    let nodes = u32::try_from(truth.len()).expect("few nodes");
    for half in 0..2_u32 {
        let first = u32::try_from(stops.len()).expect("few stops");
        stops.extend(west.stops().iter().map(|stop| Stop {
            position: stop.position,
            ..moved(2 * half + u32::try_from(stop.robot.index()).expect("two robots"))
        }));
        receptions.extend(west.receptions().iter().map(|reception| Reception {
            node: NodeId(u32::try_from(reception.node.index()).expect("few nodes") + half * nodes),
            stop: reception.stop + first,
            ..reception
        }));
    }
    let all = (0..2 * truth.len()).map(|node| format!("n{node}")).collect();
    let log = ReceptionLog::new(all, stops, receptions, Vec::new()).expect("a log");
    let log = log.with_robots(["a", "b", "c", "d"].map(str::to_owned).to_vec()).expect("four robots");
    let stitched = Stitched::mapper(ml_tm(), StitchConfig::default()).expect("a map of what robots hear");
    let (map, learned) = stitched.map_and_learn(&log, &sextant_kernel::Unwatched).expect("a map");
    let learned = learned.expect("frames");
    let stitching: &Stitching = learned.get().expect("frames");
    assert_eq!(stitching.groups, [vec![0, 1], vec![2, 3]]);
    let lines: Vec<String> = learned.lines("m", &map).into_iter().map(|line| line.text).collect();
    let has = |part: &str| lines.iter().any(|line| line.contains(part));
    assert!(has("c, d fit together, but not to a, b; `stitch.known = [\"c\"]`"), "{lines:#?}");
    assert!(has("c is not in the map: with ") && has("d is not in the map: with "), "{lines:#?}");
}
