use sextant_channel::{Position, RangeSample, Reception, ReceptionLog, Stop};
use sextant_kernel::{NodeId, Purpose, Seed, SimTime, Unwatched};

use super::*;

const NODES: [[f64; 2]; 6] = [[4.0, 5.0], [16.0, 3.0], [10.0, 16.0], [-3.0, 12.0], [18.0, 14.0], [8.0, 9.0]];

fn normal(address: [u64; 2]) -> f64 {
    Seed(2).normal(Purpose::new(8), [address[0], address[1], 0])
}

/// True places every half metre of lanes over 20 m, and where odometry has them: its heading drifts.
fn drive(drift_rad_per_m: f64) -> Vec<([f64; 2], [f64; 2])> {
    let mut corners = Vec::new();
    for lane in 0..6 {
        let y = 4.0 * f64::from(lane) - 2.0;
        corners.extend(if lane % 2 == 0 { [[0.0, y], [20.0, y]] } else { [[20.0, y], [0.0, y]] });
    }
    let mut found = vec![(corners[0], corners[0])];
    let mut turn = 0.0;
    for leg in corners.windows(2) {
        let by = [leg[1][0] - leg[0][0], leg[1][1] - leg[0][1]];
        let steps = (libm::hypot(by[0], by[1]) / 0.5).round();
        for _ in 0..crate::numerics::whole(steps) {
            let (truth, believed) = found[found.len() - 1];
            let step = by.map(|along| along / steps);
            let (sin, cos) = libm::sincos(turn);
            let off = [cos * step[0] - sin * step[1], sin * step[0] + cos * step[1]];
            found.push(([truth[0] + step[0], truth[1] + step[1]], [believed[0] + off[0], believed[1] + off[1]]));
            turn += drift_rad_per_m * 0.5;
        }
    }
    found
}

fn time(step: usize) -> SimTime {
    SimTime::from_nanos(step as u64 * 500_000_000)
}

fn place([x_m, y_m]: [f64; 2]) -> Position {
    Position::new(x_m, y_m, 0.0)
}

/// Stops on the believed path, with the ranges or the packets of the true one.
fn log(drive: &[([f64; 2], [f64; 2])], has_ranges: bool) -> ReceptionLog {
    let stop = |(step, (_, believed)): (usize, &([f64; 2], [f64; 2]))| Stop {
        time: time(step),
        ..Stop::at(place(*believed))
    };
    let stops = drive.iter().enumerate().map(stop).collect();
    let nodes: Vec<Position> = if has_ranges {
        NODES.map(place).to_vec()
    } else {
        (0..40_u64)
            .map(|node| place([0, 1].map(|axis| 20.0 * Seed(1).uniform(Purpose::new(8), [node, axis, 0]))))
            .collect()
    };
    let names = (0..nodes.len()).map(|node| format!("n{node}")).collect();
    let pairs = || (0..nodes.len()).flat_map(|node| (0..drive.len()).map(move |step| (node, step)));
    let distance_m = |node: usize, step: usize| place(drive[step].0).distance_m(nodes[node]);
    if has_ranges {
        let samples = pairs().map(|(node, step)| RangeSample {
            time: time(step),
            ..RangeSample::of(
                NodeId::from_index(node),
                place(drive[step].1),
                distance_m(node, step) + 0.3 + 0.1 * normal([node as u64, step as u64]),
            )
        });
        let log = ReceptionLog::new(names, stops, Vec::new(), Vec::new()).unwrap();
        return log.with_ranges(samples.collect()).unwrap();
    }
    let is_heard = |&(node, step): &(usize, usize)| {
        let share = 0.95 / (1.0 + libm::exp((distance_m(node, step) - 3.0) / 0.3));
        Seed(3).uniform(Purpose::new(8), [node as u64, step as u64, 0]) < share
    };
    let heard = pairs()
        .filter(is_heard)
        .map(|(node, step)| Reception::heard(NodeId::from_index(node), u32::try_from(step).unwrap(), 1, 1));
    ReceptionLog::new(names, stops, heard.collect(), Vec::new()).unwrap()
}

/// Root of the mean square distance of an estimated path from the true one (m).
fn error_m(estimated: &EstimatedPath, drive: &[([f64; 2], [f64; 2])]) -> f64 {
    let square = |pose: &PathPose| {
        let step = usize::try_from(pose.time.as_nanos() / 500_000_000).unwrap();
        pose.position.distance_m(place(drive[step].0)).powi(2)
    };
    (estimated.poses.iter().map(square).sum::<f64>() / estimated.poses.len() as f64).sqrt()
}

#[test]
fn ranges_take_the_drift_from_a_path() {
    let drifted = drive(0.01);
    let found = estimate_path(&log(&drifted, true), PathError::default(), &[], &Unwatched).unwrap();
    assert!(found.fit.is_moved() && found.fit.settled, "{}", found.fit);
    assert!((found.fit.drift_rad_per_m + 0.01).abs() < 0.003, "{}", found.fit);
    assert!(error_m(&found, &drifted) < 0.3, "{} m, {}", error_m(&found, &drifted), found.fit);
}

#[test]
fn a_scale_that_the_log_does_not_tell_stays_as_unsure_as_it_was() {
    for (longer, which) in [(1.01, "shorter"), (0.98, "longer")] {
        let scaled = |[x, y]: [f64; 2]| [longer * x, longer * (y + 2.0) - 2.0];
        let drive: Vec<_> = drive(0.01).into_iter().map(|(truth, believed)| (truth, scaled(believed))).collect();
        let error = PathError { scale: (longer - 1.0_f64).abs(), ..PathError::default() };
        let found = estimate_path(&log(&drive, true), error, &[], &Unwatched).unwrap();
        assert!(found.fit.is_moved() && found.fit.scale_deviation > 0.7 * error.scale, "{}", found.fit);
        let is_held = |pose: &&PathPose| {
            let [x, y] = drive[usize::try_from(pose.time.as_nanos() / 500_000_000).unwrap()].0;
            let (x, y) = (x - pose.position.x_m, y - pose.position.y_m);
            let [[xx, xy], [_, yy]] = pose.covariance;
            yy * x * x - 2.0 * xy * x * y + xx * y * y < 6.0 * (xx * yy - xy * xy)
        };
        let held = found.poses.iter().filter(is_held).count();
        assert!(held * 10 >= 9 * found.poses.len(), "{held} of {}, {}", found.poses.len(), found.fit);
        // That both differ is told, and how much.
        let ranges = found.fit.ranges.unwrap();
        let off = ranges.longer_than_odometry + longer - 1.0;
        assert!(off.abs() < 4.0 * ranges.longer_deviation, "{ranges:?}");
        if error.scale > 0.015 {
            assert!(found.fit.to_string().contains(&format!("% {which} than odometry says")), "{}", found.fit);
        }
    }
}

#[test]
fn ranges_leave_a_right_path_alone() {
    let right = drive(0.0);
    let found = estimate_path(&log(&right, true), PathError::default(), &[], &Unwatched).unwrap();
    assert!(!found.fit.is_moved() && error_m(&found, &right) <= 0.0, "{}", found.fit);
}

#[test]
fn known_nodes_are_the_frame_of_a_path() {
    // Odometry begins elsewhere, turned by 0.4 rad.
    let (sin, cos) = libm::sincos(0.4);
    let turned = |[x, y]: [f64; 2]| [7.0 + cos * x - sin * y, -3.0 + sin * x + cos * y];
    let drive: Vec<_> = drive(0.002).into_iter().map(|(truth, believed)| (truth, turned(believed))).collect();
    let known = [0, 1, 2].map(|node| (NodeId(node), place(NODES[node as usize])));
    let found = estimate_path(&log(&drive, true), PathError::default(), &known, &Unwatched).unwrap();
    assert_eq!(found.fit.frame(), "known-nodes");
    assert!(error_m(&found, &drive) < 0.15, "{} m, {}", error_m(&found, &drive), found.fit);
    assert!(found.fit.contradicted.is_empty(), "{}", found.fit);
}

#[test]
fn a_known_place_that_ranges_contradict_is_told() {
    let drive = drive(0.0);
    let mut known = [0, 1, 2, 3].map(|node| (NodeId(node), place(NODES[node as usize])));
    known[2].1.x_m += 3.0;
    let found = estimate_path(&log(&drive, true), PathError::default(), &known, &Unwatched).unwrap();
    assert!(found.fit.contradicted.iter().any(|of| of.node == "n2" && of.apart_m > 1.0), "{}", found.fit);
    assert!(found.fit.to_string().contains("`n2` is known"), "{}", found.fit);
}

#[test]
fn packets_take_the_drift_from_a_path() {
    let drifted: Vec<_> = drive(0.01).into_iter().step_by(2).collect();
    let log_of_drift = log(&drifted, false);
    let found = estimate_path(&log_of_drift, PathError::default(), &[], &Unwatched).unwrap();
    let believed_m = drifted.iter().map(|(truth, believed)| place(*truth).distance_m(place(*believed)).powi(2));
    let believed_m = (believed_m.sum::<f64>() / drifted.len() as f64).sqrt();
    let corrected_m = error_m(&found, &drifted);
    assert!(
        found.fit.is_moved() && corrected_m < 0.25 * believed_m,
        "{corrected_m} of {believed_m} m, {}",
        found.fit
    );
    // The stops of the log that is mapped are on the new path.
    let moved = found.log(&log_of_drift);
    assert_eq!(moved.stops()[40].position, found.poses[40].position);
}

#[test]
fn packets_leave_a_right_path_alone() {
    let right: Vec<_> = drive(0.0).into_iter().step_by(2).collect();
    let found = estimate_path(&log(&right, false), PathError::default(), &[], &Unwatched).unwrap();
    assert!(!found.fit.is_moved() && error_m(&found, &right) <= 0.0, "{}", found.fit);
    assert!(found.fit.to_string().contains("may remain"), "{}", found.fit);
}

#[test]
fn errors_of_odometry_are_read() {
    let found: PathError = "scale=2%,heading=0.02/m".parse().unwrap();
    assert_eq!(found, PathError { scale: 0.02, drift_rad_per_m: 0.02, ..PathError::default() });
    for text in ["scale", "scale=x", "turn=1", "scale=-1", "scale=200%"] {
        assert!(text.parse::<PathError>().is_err(), "{text}");
    }
}

#[test]
fn ranges_that_are_late_take_the_drift_from_a_path_with_their_delay() {
    // The robot drives with 1 m/s, and each range is of half a second before.
    let drifted = drive(0.01);
    let mut log = log(&drifted, true);
    let moved = |sample: &RangeSample| {
        let step = usize::try_from(sample.time.as_nanos() / 500_000_000).unwrap();
        let before = step.saturating_sub(1);
        let now = place(drifted[step].0).distance_m(place(NODES[sample.node.index()]));
        let then = place(drifted[before].0).distance_m(place(NODES[sample.node.index()]));
        let velocity = (place(drifted[step].1) - place(drifted[before].1)) * 2.0;
        RangeSample { range_m: sample.range_m + then - now, velocity, ..*sample }
    };
    let late = log.ranges().iter().map(moved).collect();
    log = log.with_ranges(late).unwrap();
    let found = estimate_path(&log, PathError::default(), &[], &Unwatched).unwrap();
    let ranges = found.fit.ranges.unwrap();
    assert!((ranges.delay_s - 0.5).abs() < 0.05, "{ranges:?}");
    assert!(
        found.fit.is_moved() && error_m(&found, &drifted) < 0.3,
        "{} m, {}",
        error_m(&found, &drifted),
        found.fit
    );
}

#[test]
fn a_path_does_not_bend_to_packets_that_are_late() {
    let right: Vec<_> = drive(0.0).into_iter().step_by(2).collect();
    let late = LateClock { delay_s: 2.0, deviation_s: 0.2 };
    let found = EstimatedPath::believed(&log(&right, false), PathError::default(), late);
    assert!(!found.fit.is_moved() && error_m(&found, &right) <= 0.0);
    assert!(found.fit.to_string().contains("2.00 ± 0.40 s late"), "{}", found.fit);
}

#[test]
fn a_path_in_a_frame_of_its_own_is_turned_to_known_nodes() {
    // Without drift, in a frame that is turned by 90° and shifted.
    let turned = |[x, y]: [f64; 2]| place([40.0 - y, x - 7.0]);
    let drive = drive(0.0);
    let known = [0, 2].map(|node| (NodeId(node), turned(NODES[node as usize])));
    let found = estimate_path(&log(&drive, true), PathError::default(), &known, &Unwatched).unwrap();
    let off_m = found.poses.iter().zip(&drive).map(|(pose, (truth, _))| pose.position.distance_m(turned(*truth)));
    assert!(off_m.fold(0.0, f64::max) < 0.2 && found.fit.contradicted.is_empty(), "{}", found.fit);
    let framed = found.fit.framed.unwrap();
    assert!((framed.turn_rad.to_degrees() - 90.0).abs() < 1.0 && !found.fit.is_moved(), "{}", found.fit);
    assert!(found.fit.to_string().contains("to the places of 2 known nodes"), "{}", found.fit);
    // In the frame of the nodes it stays.
    let known = [0, 2].map(|node| (NodeId(node), place(NODES[node as usize])));
    let found = estimate_path(&log(&drive, true), PathError::default(), &known, &Unwatched).unwrap();
    assert_eq!((found.fit.framed, found.fit.is_moved()), (None, false), "{}", found.fit);
}
