//! Tags that climb, and measures that are not metres, with four receivers.

use sextant_channel::Position;
use sextant_kernel::{Purpose, Seed, SimTime, Unwatched};

use super::*;

/// Four receivers at different heights.
const CORNERS: [[f64; 3]; 4] = [[-3.0, 2.0, 2.4], [-2.6, -2.9, 0.4], [2.9, -2.8, 2.2], [2.8, 2.1, 0.5]];

fn receivers(scale: f64) -> Vec<Position> {
    CORNERS.iter().map(|&[x, y, z]| Position::new(x * scale, y * scale, z * scale)).collect()
}

/// Ranges of a tag on a circle at a height over time, to the receivers in turn, changed in the end.
fn ranges(height_m: impl Fn(f64) -> f64, changed: impl Fn(f64) -> f64) -> Vec<TagReading> {
    let places = receivers(1.0);
    let range = |number: u64| {
        let second = 0.1 * number as f64;
        let [x, y] = circle(second);
        let receiver = (number % 4) as usize;
        let distance_m = Position::new(x, y, height_m(second)).distance_m(places[receiver]);
        let noise_m = 0.05 * Seed(4).normal(Purpose::new(8), [number, 3, 0]);
        TagReading::range(receiver, SimTime::from_nanos(number * 100_000_000), changed(distance_m + noise_m))
    };
    (0..900).map(range).collect()
}

fn circle(second: f64) -> [f64; 2] {
    [1.2 * libm::cos(0.2 * second), 1.2 * libm::sin(0.2 * second)]
}

fn found(receivers: &[Position], readings: &[TagReading]) -> Track {
    track(receivers, readings, TrackSettings::default(), &Unwatched).unwrap()
}

/// Roots of the mean square errors in the plane and of the height (m), and the share of heights that are within twice their deviation.
fn errors(track: &Track, height_m: impl Fn(f64) -> f64) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for pose in &track.poses {
        let second = pose.time.as_secs_f64();
        let [x, y] = circle(second);
        let up_m = pose.position.z_m - height_m(second);
        sums[0] += (pose.position.x_m - x).powi(2) + (pose.position.y_m - y).powi(2);
        sums[1] += up_m.powi(2);
        sums[2] += if up_m.powi(2) < 4.0 * pose.height_variance_m2.unwrap() { 1.0 } else { 0.0 };
    }
    let [plane, up, held] = sums.map(|sum| sum / track.poses.len() as f64);
    [plane.sqrt(), up.sqrt(), held]
}

#[test]
fn a_tag_that_climbs_has_heights_over_time_and_one_that_does_not_has_one() {
    let climb = |second: f64| 0.3 + 0.02 * second;
    let climbing = found(&receivers(1.0), &ranges(climb, |range| range));
    let [plane_m, up_m, held] = errors(&climbing, climb);
    assert_eq!(climbing.fit.height, TrackHeight::Wandering, "{:?}", climbing.fit);
    assert!(plane_m < 0.15 && up_m < 0.25 && held > 0.8, "{plane_m} {up_m} {held}");
    let level = found(&receivers(1.0), &ranges(|_| 1.0, |range| range));
    assert!(
        matches!(level.fit.height, TrackHeight::Constant { deviation_m } if deviation_m < 0.3),
        "{:?}",
        level.fit
    );
    // Receivers on one level tell no height.
    let flat: Vec<Position> = receivers(1.0).iter().map(|place| Position::new(place.x_m, place.y_m, 0.0)).collect();
    let assumed = found(&flat, &ranges(|_| 1.0, |range| range));
    assert_eq!((assumed.fit.height, assumed.poses[0].height_variance_m2), (TrackHeight::OfReceivers, None));
}

#[test]
fn ranges_there_and_back_and_an_offset_are_told_with_four_receivers() {
    let twice = found(&receivers(1.0), &ranges(|_| 1.0, |range| 2.0 * range)).fault;
    assert!(matches!(&twice, Some(RangeFault::Unit(unit)) if (unit.of_metre - 2.0).abs() < 1e-9), "{twice:?}");
    let late = found(&receivers(1.0), &ranges(|_| 1.0, |range| range + 150.0)).fault;
    assert!(matches!(late, Some(RangeFault::Offset { offset_m }) if (offset_m - 150.0).abs() < 2.0), "{late:?}");
}

#[test]
fn known_places_in_millimetres_are_told_and_not_ranges_in_kilometres() {
    let found = found(&receivers(1000.0), &ranges(|_| 1.0, |range| range)).fault;
    assert!(matches!(&found, Some(RangeFault::Places(unit)) if unit.name == "millimetres"), "{found:?}");
}
