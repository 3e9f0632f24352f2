use sextant_channel::{Mounting, Position};
use sextant_kernel::{Purpose, Seed, SimTime, Unwatched};

use super::*;

const ROOM: [[f64; 2]; 4] = [[0.0, 0.0], [12.0, 1.0], [11.0, 13.0], [-1.0, 12.0]];

fn normal(address: [u64; 2]) -> f64 {
    Seed(2).normal(Purpose::new(8), [address[0], address[1], 0])
}

fn place([x_m, y_m]: [f64; 2]) -> Position {
    Position::new(x_m, y_m, 0.0)
}

fn tenths(number: u64) -> SimTime {
    SimTime::from_nanos(number * 100_000_000)
}

/// A circle round the middle of the room, with 0.8 m/s.
fn circle(second: f64) -> [f64; 2] {
    [6.0 + 4.0 * libm::cos(0.2 * second), 6.0 + 4.0 * libm::sin(0.2 * second)]
}

/// Root of the mean square distance of a track from the truth (m).
fn error_m(track: &Track, truth: impl Fn(f64) -> [f64; 2]) -> f64 {
    let square = |pose: &TrackPose| pose.position.distance_m(at(pose, &truth)).powi(2);
    (track.poses.iter().map(square).sum::<f64>() / track.poses.len() as f64).sqrt()
}

fn at(pose: &TrackPose, truth: impl Fn(f64) -> [f64; 2]) -> Position {
    let [x, y] = truth(pose.time.as_secs_f64());
    Position::new(x, y, pose.position.z_m)
}

/// Ranges with noise (m) to the receivers in turn, every tenth of a second.
fn ranges(receivers: &[Position], count: u64, noise_m: f64, truth: impl Fn(f64) -> [f64; 2]) -> Vec<TagReading> {
    let range = |(number, receiver): (u64, usize)| {
        let distance_m = place(truth(0.1 * number as f64)).distance_m(receivers[receiver]);
        TagReading::range(receiver, tenths(number), distance_m + noise_m * normal([number, 7]))
    };
    (0..count).zip((0..receivers.len()).cycle()).map(range).collect()
}

#[test]
fn a_tag_is_tracked_among_receivers_although_ranges_are_too_long() {
    let receivers = ROOM.map(place);
    let mut all = ranges(&receivers, 800, 0.15, circle);
    for reading in &mut all {
        let TagValue::Range(range_m) = &mut reading.value else { unreachable!("these are ranges") };
        *range_m = 1.03 * *range_m + 0.8;
    }
    let found = track(&receivers, &all, TrackSettings::default(), &Unwatched).unwrap();
    assert!(found.fit.is_among_receivers && found.fit.settled && !found.fit.may_be_mirrored);
    assert!(error_m(&found, circle) < 0.25, "{}, {:?}", error_m(&found, circle), found.fit);
    // Two receivers tell no place.
    let few: Vec<TagReading> = all.iter().filter(|range| range.receiver < 2).copied().collect();
    assert!(track(&receivers, &few, TrackSettings::default(), &Unwatched).is_err());
}

#[test]
fn strengths_track_a_tag_better_than_the_strongest_receiver_and_their_centroid() {
    let receivers =
        [[0.0, 0.0], [6.0, -1.0], [12.0, 1.0], [11.0, 13.0], [5.0, 12.5], [-1.0, 12.0], [-1.0, 6.0], [13.0, 7.0]];
    let receivers = receivers.map(place);
    let strength = |number: u64, receiver: usize| {
        let distance_m = place(circle(0.5 * number as f64)).distance_m(receivers[receiver]);
        -41.0 - 26.0 * libm::log10(distance_m) + 4.0 * normal([number, 20 + receiver as u64])
    };
    let all: Vec<TagReading> = (0..160)
        .flat_map(|number| (0..receivers.len()).map(move |receiver| (number, receiver)))
        .map(|(number, receiver)| TagReading::strength(receiver, tenths(5 * number), strength(number, receiver)))
        .collect();
    let found = track(&receivers, &all, TrackSettings::default(), &Unwatched).unwrap();
    let law = found.fit.of_strengths.unwrap();
    assert!(found.fit.of_ranges.is_none() && found.fit.strengths == all.len());
    assert!((law.exponent - 2.6).abs() < 0.3 && (law.at_1_m_dbm + 41.0).abs() < 3.0, "{law:?}");
    // The literal baselines, each second apart.
    let (mut strongest, mut centroid) = (0.0, 0.0);
    for number in 0..160 {
        let truth = place(circle(0.5 * number as f64));
        let heard: Vec<f64> = (0..receivers.len()).map(|receiver| strength(number, receiver)).collect();
        let best = (0..heard.len()).max_by(|&a, &b| heard[a].total_cmp(&heard[b])).unwrap();
        let weights: Vec<f64> = heard.iter().map(|dbm| libm::pow(10.0, dbm / 20.0)).collect();
        let sum =
            weights.iter().zip(&receivers).fold(Position::ORIGIN, |sum, (&weight, &place)| sum + place * weight);
        strongest += receivers[best].distance_m(truth).powi(2) / 160.0;
        centroid += (sum * (1.0 / weights.iter().sum::<f64>())).distance_m(truth).powi(2) / 160.0;
    }
    let error_m = error_m(&found, circle);
    assert!(error_m < 0.5 * centroid.sqrt() && error_m < 0.3 * strongest.sqrt(), "{error_m} {centroid} {strongest}");
    let held = |pose: &&TrackPose| {
        let apart = pose.position - at(pose, circle);
        let [[xx, xy], [_, yy]] = pose.covariance;
        let square = apart.x_m * apart.x_m * yy - 2.0 * apart.x_m * apart.y_m * xy + apart.y_m * apart.y_m * xx;
        square / (xx * yy - xy * xy) <= 5.991
    };
    assert!(found.poses.iter().filter(held).count() > 120);
}

#[test]
fn strengths_of_receivers_on_a_line_track_a_tag_beside_it() {
    let receivers = [[0.0, 0.0], [4.0, 0.0], [8.0, 0.0], [12.0, 0.0]].map(place);
    let truth = |second: f64| [2.0 + 0.1 * second, 4.0 + libm::sin(0.1 * second)];
    let strength = |number: u64, receiver: usize| {
        let distance_m = place(truth(0.5 * number as f64)).distance_m(receivers[receiver]);
        -40.0 - 25.0 * libm::log10(distance_m) + 2.0 * normal([number, 40 + receiver as u64])
    };
    let all: Vec<TagReading> = (0..160)
        .flat_map(|number| (0..receivers.len()).map(move |receiver| (number, receiver)))
        .map(|(number, receiver)| TagReading::strength(receiver, tenths(5 * number), strength(number, receiver)))
        .collect();
    for (side, sign) in [([6.0, 1.0], 1.0), ([6.0, -1.0], -1.0)] {
        let settings = TrackSettings { side: Some(side), ..TrackSettings::default() };
        let found = track(&receivers, &all, settings, &Unwatched).unwrap();
        let error_m = error_m(&found, |second| [truth(second)[0], sign * truth(second)[1]]);
        assert!(found.fit.settled && error_m < 2.0, "{error_m} {:?}", found.fit);
        assert!(found.poses.iter().all(|pose| sign * pose.position.y_m > 0.5 && pose.spread_m() < 6.0));
    }
}

#[test]
fn a_side_chooses_between_a_track_and_its_mirror_image() {
    let receivers = [[0.0, 0.0], [5.0, 0.0], [10.0, 0.0]].map(place);
    let truth = |second: f64| [1.0 + 0.2 * second, 4.0 + libm::sin(0.3 * second)];
    let mirrored = |second: f64| [truth(second)[0], -truth(second)[1]];
    let all = ranges(&receivers, 400, 0.05, truth);
    let settings = |side| TrackSettings { side, ..TrackSettings::default() };
    let found = |side| track(&receivers, &all, settings(side), &Unwatched).unwrap();
    let (here, there, unknown) = (found(Some([0.0, 3.0])), found(Some([7.0, -1.0])), found(None));
    assert!(error_m(&here, truth) < 0.3 && error_m(&there, mirrored) < 0.3);
    assert!(!here.fit.may_be_mirrored && unknown.fit.may_be_mirrored);
    assert!(error_m(&unknown, truth).min(error_m(&unknown, mirrored)) < 0.3);
    let room = ROOM.map(place);
    let refused = track(&room, &ranges(&room, 400, 0.1, circle), settings(Some([0.0, 1.0])), &Unwatched).unwrap_err();
    assert!(refused.to_string().contains("straight line"), "{refused}");
}

/// A robot that drives lanes, as odometry has it in a frame of its own; and the truth.
fn lanes(number: u64) -> ([f64; 2], f64, [f64; 2], f64) {
    let way_m = 0.1 * number as f64;
    let (lane, along_m) = ((way_m / 10.0).floor(), way_m % 10.0);
    let is_back = lane % 2.0 > 0.5;
    let x = if is_back { 10.0 - along_m } else { along_m };
    let heading_rad = if is_back { std::f64::consts::PI } else { 0.0 };
    let own = [x, 2.0 * lane];
    let (sin, cos) = libm::sincos(0.8);
    (own, heading_rad, [3.0 + cos * own[0] - sin * own[1], -2.0 + sin * own[0] + cos * own[1]], heading_rad + 0.8)
}

#[test]
fn odometry_and_arms_of_antennas_tell_the_robot_from_ranges_to_two_receivers() {
    let receivers = [[0.0, 14.0], [9.0, 1.0], [40.0, 40.0]].map(place);
    let arms = [place([1.5, 0.5]), place([-1.0, 0.0])];
    let turned = |arm: Position, by: f64| {
        let (sin, cos) = libm::sincos(by);
        Position::new(cos * arm.x_m - sin * arm.y_m, sin * arm.x_m + cos * arm.y_m, 0.0)
    };
    let reading = |number: u64| {
        let (own, own_heading, truth, heading) = lanes(number);
        let antenna = u32::try_from(number / 2 % 2).unwrap();
        let arm = arms[antenna as usize];
        let receiver = (number % 2) as usize;
        let distance_m = (place(truth) + turned(arm, heading)).distance_m(receivers[receiver]);
        let mounting = Mounting { antenna, arm: turned(arm, own_heading) };
        let on_robot = Some(OnRobot { believed: place(own), mounting });
        TagReading { on_robot, ..TagReading::range(receiver, tenths(number), distance_m) }
    };
    let all: Vec<TagReading> = (0..600).map(reading).collect();
    let truth = |second: f64| lanes(crate::numerics::whole(second * 10.0 + 0.5) as u64).2;
    let settings =
        TrackSettings { odometry: PathError { scale: 0.001, ..PathError::default() }, ..TrackSettings::default() };
    let found = track(&receivers, &all, settings, &Unwatched).unwrap();
    let with_arms_m = error_m(&found, truth);
    assert!(with_arms_m < 0.05, "{with_arms_m}: {:?}", found.fit);
    assert!(matches!(found.fit.motion, TrackMotion::Driven { .. }));
    // Without the arms the antennas are taken for the robot.
    let without = |reading: &TagReading| {
        let on_robot = reading.on_robot.map(|on_robot| OnRobot { mounting: Mounting::default(), ..on_robot });
        TagReading { on_robot, ..*reading }
    };
    let bare: Vec<TagReading> = all.iter().map(without).collect();
    let without_m = error_m(&track(&receivers, &bare, settings, &Unwatched).unwrap(), truth);
    assert!(without_m > 4.0 * with_arms_m, "{without_m} {with_arms_m}");
    // Odometry is of all readings or of none.
    let mixed = [all[0], TagReading { on_robot: None, ..all[1] }, all[2]];
    assert!(track(&receivers, &mixed, settings, &Unwatched).is_err());
}

const WIDE_ROOM: [[f64; 2]; 6] = [[0.0, 0.0], [12.0, 1.0], [11.0, 13.0], [-1.0, 12.0], [6.0, -1.0], [5.0, 14.0]];

#[test]
fn right_receivers_are_not_doubted_and_another_unit_is_told() {
    let receivers = WIDE_ROOM.map(place);
    let all = ranges(&receivers, 900, 0.1, circle);
    let right = track(&receivers, &all, TrackSettings::default(), &Unwatched).unwrap();
    assert!(right.doubted.is_empty() && right.fault.is_none(), "{:?}, {:?}", right.doubted, right.fault);
    let kilometres: Vec<TagReading> = all
        .iter()
        .map(|reading| TagReading { value: TagValue::Range(0.001 * reading.number()), ..*reading })
        .collect();
    let found = track(&receivers, &kilometres, TrackSettings::default(), &Unwatched).unwrap();
    let is_told = matches!(&found.fault, Some(RangeFault::Unit(unit)) if (unit.of_metre - 0.001).abs() < 1e-9);
    assert!(is_told, "{:?}, {:?}", found.fault, found.fit);
}

/// What is wrong with the ranges to the receivers of a room if the known places are in this order.
fn fault(room: &[[f64; 2]], order: &[usize]) -> Option<RangeFault> {
    let receivers: Vec<Position> = room.iter().copied().map(place).collect();
    let all = ranges(&receivers, 900, 0.15, circle);
    let known: Vec<Position> = order.iter().map(|&receiver| receivers[receiver]).collect();
    track(&known, &all, TrackSettings::default(), &Unwatched).unwrap().fault
}

#[test]
fn two_receivers_in_each_others_place_are_named() {
    for (order, pair) in [([0, 4, 2, 3, 1, 5], [1, 4]), ([3, 1, 2, 0, 4, 5], [0, 3]), ([0, 1, 5, 3, 4, 2], [2, 5])] {
        assert_eq!(fault(&WIDE_ROOM, &order), Some(RangeFault::Exchanged(vec![pair])));
    }
    // Two opposite walls of a rectangle cannot be told apart: the one is the mirror image of the other.
    let hall = [[0.0, 0.0], [12.0, 0.0], [12.0, 12.0], [0.0, 12.0]];
    let Some(RangeFault::Exchanged(mut pairs)) = fault(&hall, &[1, 0, 2, 3]) else { panic!("nothing is told") };
    pairs.sort_unstable();
    assert_eq!(pairs, [[0, 1], [2, 3]]);
}

#[test]
fn ranges_that_nothing_explains_are_told() {
    let found = fault(&WIDE_ROOM, &[1, 2, 0, 4, 5, 3]);
    assert!(matches!(&found, Some(RangeFault::Unexplained { usually_m, .. }) if *usually_m > 1.0), "{found:?}");
}
