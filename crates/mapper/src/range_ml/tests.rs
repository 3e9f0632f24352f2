//! Maps from ranges that were made with known places and errors.

use sextant_channel::{Position, RangeSample, Stop};
use sextant_kernel::{NodeId, Purpose, Seed, SimTime, Unwatched};

use super::*;
use crate::learned::Finding as _;

/// How ranges are wrong.
#[derive(Clone, Copy, Default)]
struct Errors {
    bias_m: f64,
    scale: f64,
    delay_s: f64,
    noise_m: f64,
    late: f64,
    wild: f64,
}

/// A log of ranges to `nodes` from a drive at 1 m/s through `corners`, four a second and node.
fn log(nodes: &[Position], corners: &[Position], errors: Errors) -> ReceptionLog {
    let mut samples = Vec::new();
    let mut time_s = 0.0;
    for leg in corners.windows(2) {
        let length_m = leg[0].distance_m(leg[1]);
        let velocity = (leg[1] - leg[0]) * (1.0 / length_m);
        for step in 0..crate::numerics::whole(4.0 * length_m) {
            let along_m = 0.25 * step as f64;
            let position = leg[0] + velocity * along_m;
            for (node, &place) in nodes.iter().enumerate() {
                let draw = |which| Seed(4).uniform(Purpose::new(8), [samples.len() as u64, which, 0]);
                let noise = errors.noise_m * Seed(4).normal(Purpose::new(8), [samples.len() as u64, 9, 0]);
                let late = if draw(1) < errors.late { -libm::log(draw(2)) } else { 0.0 };
                let wild = if draw(3) < errors.wild { 100.0 * draw(4) } else { 0.0 };
                let measured_from = position - velocity * errors.delay_s;
                let distance_m = measured_from.distance_m(place);
                let range_m = (1.0 + errors.scale) * distance_m + errors.bias_m + noise + late + wild;
                let time = SimTime::from_nanos(crate::numerics::whole((time_s + along_m) * 1e9) as u64);
                let node = NodeId::from_index(node);
                samples.push(RangeSample { time, velocity, ..RangeSample::of(node, position, range_m) });
            }
        }
        time_s += length_m;
    }
    let stop = Stop::at(corners[0]);
    let names = (0..nodes.len()).map(|node| format!("n{node}")).collect();
    ReceptionLog::new(names, vec![stop], Vec::new(), Vec::new()).unwrap().with_ranges(samples).unwrap()
}

fn at(x_m: f64, y_m: f64) -> Position {
    Position::new(x_m, y_m, 0.0)
}

fn nodes() -> Vec<Position> {
    vec![at(3.0, 4.0), at(17.0, 6.0), at(9.0, 15.0), at(-4.0, 9.0)]
}

fn loops() -> Vec<Position> {
    vec![at(0.0, 0.0), at(20.0, 0.0), at(20.0, 10.0), at(0.0, 10.0), at(0.0, 18.0), at(18.0, 18.0)]
}

fn map(log: &ReceptionLog) -> (TopologyMap, Option<RangeFit>) {
    RangeMl::try_from(RangeMlConfig::default()).unwrap().map(log, &Unwatched).unwrap()
}

#[test]
fn places_and_what_is_wrong_with_ranges_are_found_together() {
    let errors = Errors { bias_m: 1.2, scale: 0.03, delay_s: 0.3, noise_m: 0.1, late: 0.15, wild: 0.01 };
    let (map, fit) = map(&log(&nodes(), &loops(), errors));
    let fit = fit.unwrap();
    let off = |found: f64, truth: f64, deviation: f64| assert!((found - truth).abs() < 4.0 * deviation, "{fit:?}");
    off(fit.bias_m, 1.2, fit.bias_deviation_m);
    off(fit.scale, 0.03, fit.scale_deviation);
    off(fit.delay_s, 0.3, fit.delay_deviation_s);
    assert!(fit.settled && (fit.errors.noise_m() - 0.1).abs() < 0.03, "{fit:?}");
    for (estimate, place) in map.estimates.iter().zip(nodes()) {
        let estimate = estimate.as_ref().unwrap();
        assert!(estimate.position.distance_m(place) < 0.12, "{estimate:?}, {place}");
        assert_eq!(estimate.concern, None);
        let covariance = estimate.covariance.unwrap();
        assert!(covariance[0][0] > 0.0 && covariance[0][0].sqrt() < 0.6 && covariance[2][2] <= 0.0);
    }
}

#[test]
fn exact_ranges_give_exact_places() {
    let (map, fit) = map(&log(&nodes(), &loops(), Errors::default()));
    for (estimate, place) in map.estimates.iter().zip(nodes()) {
        assert!(estimate.as_ref().unwrap().position.distance_m(place) < 2e-3, "{estimate:?}");
    }
    assert!(fit.unwrap().bias_m.abs() < 1e-2);
}

#[test]
fn a_straight_way_leaves_two_places_and_a_region_that_holds_both() {
    let errors = Errors { noise_m: 0.1, ..Errors::default() };
    let (map, _) = map(&log(&nodes()[..2], &[at(0.0, 0.0), at(20.0, 0.0)], errors));
    for (estimate, place) in map.estimates.iter().zip(nodes()) {
        let estimate = estimate.as_ref().unwrap();
        assert_eq!(estimate.concern, Some(Concern::TwoPlaces));
        let mirrored = at(place.x_m, -place.y_m);
        let off_m = estimate.position.distance_m(place).min(estimate.position.distance_m(mirrored));
        assert!(off_m < 1.0, "{estimate:?}");
        assert!(estimate.covariance.unwrap()[1][1].sqrt() > 0.5 * place.y_m);
    }
}

#[test]
fn a_place_beside_a_straight_way_is_no_farther_than_its_longest_range() {
    // Before and behind the way, the noise hides how far beside it they are.
    let nodes: Vec<Position> =
        (0..6).map(|at_end| at(if at_end < 3 { -2.0 } else { 22.0 } * f64::from(at_end % 3 + 1), 0.5)).collect();
    let log = log(&nodes, &[at(0.0, 0.0), at(20.0, 0.0)], Errors { noise_m: 1.0, ..Errors::default() });
    let (map, fit) = map(&log);
    let longest_m = log.ranges().iter().map(|range| range.range_m).fold(0.0, f64::max);
    for (estimate, place) in map.estimates.iter().zip(&nodes) {
        let Estimate { position, covariance, .. } = estimate.as_ref().unwrap();
        let [[xx, xy, _], [_, yy, _], _] = covariance.unwrap();
        // Bias and scale may make it a little longer.
        assert!(xx.max(yy).sqrt() < longest_m + 10.0, "{estimate:?}");
        let (x, y) = (place.x_m - position.x_m, place.y_m - position.y_m);
        let distance = (yy * x * x - 2.0 * xy * x * y + xx * y * y) / (xx * yy - xy * xy);
        assert!(distance < 6.0, "{estimate:?}");
    }
    let fit = fit.unwrap();
    assert!(!fit.beside.is_empty(), "{:?}", map.estimates);
    for name in &fit.beside {
        let node = log.names().iter().position(|other| other == name).unwrap();
        assert_eq!(map.estimates[node].as_ref().unwrap().concern, Some(Concern::NoEvidence));
    }
}

#[test]
fn a_node_above_a_path_with_heights_is_found_there() {
    let mut corners = loops();
    corners.iter_mut().enumerate().for_each(|(at, corner)| corner.z_m = [0.0, 2.0, 0.5][at % 3]);
    let nodes = [Position::new(8.0, 6.0, 3.0), Position::new(14.0, 12.0, 4.0)];
    let (map, _) = map(&log(&nodes, &corners, Errors { noise_m: 0.05, ..Errors::default() }));
    for (estimate, place) in map.estimates.iter().zip(nodes) {
        assert!(estimate.as_ref().unwrap().position.distance_m(place) < 0.3, "{estimate:?}, {place}");
    }
}

/// The map of ranges of which node 1 has the `few` first ones.
fn with_few(few: usize) -> (TopologyMap, Option<RangeFit>) {
    let full = log(&nodes(), &loops(), Errors { noise_m: 0.1, ..Errors::default() });
    // A second apart.
    let of_one = full.ranges().iter().filter(|range| range.node == NodeId(1)).step_by(8).take(few).copied();
    let others = full.ranges().iter().filter(|range| range.node != NodeId(1)).copied();
    let kept = others.chain(of_one).collect();
    map(&full.with_ranges(kept).unwrap())
}

#[test]
fn nodes_with_up_to_three_ranges_have_a_region_that_holds_them_and_never_converge() {
    for few in 1..=3 {
        let (map, fit) = with_few(few);
        let estimate = map.estimates[1].as_ref().unwrap();
        assert_eq!(estimate.concern, Some(Concern::TooFew), "{few}");
        let [[xx, xy, _], [_, yy, _], _] = estimate.covariance.unwrap();
        let (x, y) = (17.0 - estimate.position.x_m, 6.0 - estimate.position.y_m);
        let distance = (yy * x * x - 2.0 * xy * x * y + xx * y * y) / (xx * yy - xy * xy);
        assert!(distance < 6.0, "{few}: {estimate:?}");
        assert!(
            map.estimates.iter().enumerate().all(|(at, node)| at == 1 || node.as_ref().unwrap().concern.is_none())
        );
        assert_eq!(fit.unwrap().nodes, if few < 3 { 3 } else { 4 });
    }
    assert!(map(&log(&nodes(), &[at(0.0, 0.0), at(0.3, 0.0)], Errors::default())).1.is_none());
}

#[test]
fn ranges_in_another_unit_place_no_node_reliably() {
    for (of_metre, unit) in [
        (2.0, "halve them"),
        (3.28084, "feet"),
        (3.33564, "one way"),
        (6.67, "there and back"),
        (100.0, "centi"),
        (1000.0, "milli"),
    ] {
        let errors = Errors { scale: of_metre - 1.0, noise_m: 0.1 * of_metre, ..Errors::default() };
        let (map, fit) = map(&log(&nodes(), &loops()[..4], errors));
        let concerns: Vec<_> = map.estimates.iter().flatten().map(|node| node.concern).collect();
        assert_eq!(concerns, [Some(Concern::Unsettled); 4], "{unit}");
        let lines = crate::learned::Finding::lines(&fit.unwrap(), "a", &map);
        assert!(lines.iter().any(|line| line.text.contains(unit)), "{unit}: {lines:?}");
    }
    let (_, fit) = map(&log(&nodes(), &loops()[..4], Errors { noise_m: 2.0, ..Errors::default() }));
    assert_eq!(fit.unwrap().unit, None);
}

#[test]
fn settings_beyond_their_limits_are_refused() {
    for (config, key) in [
        (RangeMlConfig { scale_error: 0.6, ..RangeMlConfig::default() }, "scale_error"),
        (RangeMlConfig { delay_error_s: -1.0, ..RangeMlConfig::default() }, "delay_error_s"),
        (RangeMlConfig { z_range_m: Some([1.0, 0.0]), ..RangeMlConfig::default() }, "z_range_m"),
    ] {
        assert!(RangeMl::try_from(config).unwrap_err().to_string().contains(key));
    }
}

/// The log of ranges to a node at `place` from these stops, too long by `bias_m`, with noise, in which `seed` has part.
fn at_stops(seed: u64, stops: &[Position], place: Position, bias_m: f64, noise_m: f64) -> ReceptionLog {
    let sample = |(number, &position): (usize, &Position)| {
        RangeSample::of(
            NodeId(0),
            position,
            position.distance_m(place) + bias_m + noise_m * Seed(seed).normal(Purpose::new(8), [number as u64, 0, 0]),
        )
    };
    let stop = Stop::at(stops[0]);
    let log = ReceptionLog::new(vec!["n0".into()], vec![stop], Vec::new(), Vec::new()).unwrap();
    log.with_ranges(stops.iter().enumerate().map(sample).collect()).unwrap()
}

#[test]
fn few_ranges_place_a_node_as_well_as_least_squares_do() {
    let stops = [at(0.0, 0.0), at(14.0, 2.0), at(18.0, 15.0), at(3.0, 17.0), at(9.0, 8.0), at(6.0, 3.0)];
    let heights = HeightPrior { mean_m: 0.0, deviation_m: 0.0, range_m: None };
    for place in [at(8.0, 11.0), at(33.0, 20.0), at(55.0, -20.0)] {
        let (mut error_m, mut by_squares_m, mut held) = (0.0, 0.0, 0);
        for seed in 0..30 {
            let log = at_stops(seed, &stops, place, 0.4, 0.3);
            let groups = RangeGroups::of(&log, |_| true);
            let state = modes::least_squares(groups.of_node(0), heights).0;
            by_squares_m += at(state[0], state[1]).distance_m(place);
            let estimate = map(&log).0.estimates[0].clone().unwrap();
            error_m += estimate.position.distance_m(place);
            let [[xx, xy, _], [_, yy, _], _] = estimate.covariance.unwrap();
            let (x, y) = (place.x_m - estimate.position.x_m, place.y_m - estimate.position.y_m);
            held += u32::from((yy * x * x - 2.0 * xy * x * y + xx * y * y) / (xx * yy - xy * xy) < 6.0);
        }
        // Of a hundred seeds the mean is not greater; a bias that was estimated from such ranges would make it twice as large.
        assert!(error_m < 1.25 * by_squares_m, "{place}: {error_m} and {by_squares_m}");
        assert!(held >= 26, "{place}: {held}");
    }
}

#[test]
fn the_shares_of_mirror_images_are_as_often_right() {
    // Along a way that is nearly straight.
    let stops: Vec<Position> =
        (0..10).map(|stop| at(2.0 * f64::from(stop), 0.25 * f64::from(stop % 3 - 1))).collect();
    let place = at(9.0, 6.0);
    let (mut expected, mut variance, mut right, mut told) = (0.0, 0.0, 0.0, 0);
    for seed in 0..60 {
        let (map, fit) = map(&at_stops(seed, &stops, place, 0.0, 0.5));
        let estimate = map.estimates[0].clone().unwrap();
        let share = fit.unwrap().ambiguous.first().map_or(1.0, |node| node.places[0].1);
        assert_eq!(estimate.concern == Some(Concern::TwoPlaces), share < 0.95);
        assert!(estimate.position.y_m.abs() > 3.0, "{estimate:?}");
        told += u32::from(share < 0.95);
        expected += share;
        variance += share * (1.0 - share);
        right += f64::from(u8::from(estimate.position.y_m > 0.0));
    }
    // Three standard deviations.
    assert!((right - expected).abs() < 3.0 * variance.sqrt(), "{right} of 60 are right, {expected} expected");
    assert!(told > 20, "{told}");
}

/// The same log with ranges that are longer by this, of each range with its node and the direction to that (rad).
fn longer(log: &ReceptionLog, nodes: &[Position], by_m: impl Fn(usize, f64, Position) -> f64) -> ReceptionLog {
    let changed = |sample: &RangeSample| {
        let apart = nodes[sample.node.index()] - sample.position;
        let by_m = by_m(sample.node.index(), libm::atan2(apart.y_m, apart.x_m), sample.position);
        RangeSample { range_m: sample.range_m + by_m, ..*sample }
    };
    log.clone().with_ranges(log.ranges().iter().map(changed).collect()).unwrap()
}

/// How many of the true places are in the regions of the plane, and the widest of these (m).
fn held(map: &TopologyMap, nodes: &[Position]) -> (usize, f64) {
    let (mut held, mut widest_m) = (0, 0.0_f64);
    for (estimate, place) in map.estimates.iter().zip(nodes) {
        let estimate = estimate.as_ref().unwrap();
        let [[xx, xy, _], [_, yy, _], _] = estimate.covariance.unwrap();
        let (x, y) = (place.x_m - estimate.position.x_m, place.y_m - estimate.position.y_m);
        held += usize::from((yy * x * x - 2.0 * xy * x * y + xx * y * y) / (xx * yy - xy * xy) < 6.0);
        widest_m = widest_m.max(xx.max(yy).sqrt());
    }
    (held, widest_m)
}

#[test]
fn regions_hold_what_errors_by_direction_move() {
    let nodes = nodes();
    let plain = log(&nodes, &loops(), Errors { noise_m: 0.1, ..Errors::default() });
    let (map_of_plain, fit) = map(&plain);
    let (of_plain, widest_m) = held(&map_of_plain, &nodes);
    assert!(of_plain == nodes.len() && widest_m < 0.15, "{widest_m} m, {fit:?}");
    // Up to 0.4 m longer on one side of each node.
    let by_side =
        longer(&plain, &nodes, |node, direction, _| 0.4 * libm::cos(direction - 1.3 * node as f64).max(0.0));
    let (found, fit) = map(&by_side);
    assert!(held(&found, &nodes).0 + 1 >= nodes.len(), "{:?}", fit);
    assert!(fit.unwrap().moved_by_direction_m > 0.05);
}

#[test]
fn ranges_that_are_pure_noise_place_no_node() {
    let stops: Vec<Position> = (0..12).map(|stop| at(f64::from(7 * stop % 20), f64::from(11 * stop % 15))).collect();
    let samples = (0..8).flat_map(|node| (0..stops.len()).map(move |stop| (node, stop)));
    let noise = samples.map(|(node, stop)| {
        let range_m = 1.0 + 19.0 * Seed(7).uniform(Purpose::new(8), [u64::from(node), stop as u64, 0]);
        RangeSample::of(NodeId(node), stops[stop], range_m)
    });
    let names = (0..8).map(|node| format!("n{node}")).collect();
    let log = ReceptionLog::new(names, vec![Stop::at(stops[0])], Vec::new(), Vec::new()).unwrap();
    let (map, fit) = map(&log.with_ranges(noise.collect()).unwrap());
    let fit = fit.unwrap();
    assert!(fit.is_no_distance(), "{fit:?}");
    assert!(map.estimates.iter().flatten().all(|estimate| estimate.concern.is_some()));
    let lines = crate::learned::Finding::lines(&fit, "a", &map);
    assert!(lines.iter().any(|line| line.text.contains("explain nothing")), "{lines:?}");
}

#[test]
fn heights_that_look_like_a_bias_and_a_scale_are_told() {
    let raised: Vec<Position> = nodes().into_iter().map(|place| Position::new(place.x_m, place.y_m, 2.7)).collect();
    let (_, fit) = map(&log(&raised, &loops(), Errors { noise_m: 0.05, ..Errors::default() }));
    let fit = fit.unwrap();
    assert!(fit.higher_m.is_some_and(|higher_m| (higher_m - 2.7).abs() < 0.5), "{fit:?}");
    let (_, level) = map(&log(&nodes(), &loops(), Errors { noise_m: 0.05, bias_m: 0.5, ..Errors::default() }));
    assert_eq!(level.unwrap().higher_m, None);
}

#[test]
fn an_offset_far_beyond_devices_and_a_clock_seconds_late_are_taken_off() {
    let errors = Errors { bias_m: 150.0, noise_m: 0.1, ..Errors::default() };
    let (found, fit) = map(&log(&nodes(), &loops(), errors));
    let fit = fit.unwrap();
    assert!((fit.bias_m - 150.0).abs() < 0.3 && fit.is_beyond_prior && fit.unit.is_none(), "{fit:?}");
    for (estimate, place) in found.estimates.iter().zip(nodes()) {
        assert!(estimate.as_ref().unwrap().position.distance_m(place) < 0.3, "{estimate:?}");
    }
    // Two seconds late on a way that turns: a step along the velocity would be wrong. On a circle, a delay would be a turn of the map.
    let delay_s = 2.0;
    let eight = |step: i32| at(6.0 * libm::sin(0.25 * f64::from(step)), 4.0 * libm::sin(0.5 * f64::from(step)));
    let corners: Vec<Position> = (0..30).map(eight).collect();
    let right = log(&nodes(), &corners, Errors { noise_m: 0.05, ..Errors::default() });
    let late = late::Paths::of(&right).late_by(&right, -delay_s);
    let (found, fit) = map(&late);
    let fit = fit.unwrap();
    assert!((fit.delay_s - delay_s).abs() < 0.1, "{fit:?}");
    for (estimate, place) in found.estimates.iter().zip(nodes()) {
        assert!(estimate.as_ref().unwrap().position.distance_m(place) < 0.3, "{estimate:?}, {place}");
    }
    assert!(fit.lines("m", &found).iter().any(|line| line.text.contains("`--packet-delay 2.0")));
}

#[test]
fn ranges_of_a_wrong_path_are_not_kilometres() {
    // Each range belongs to another place of the way.
    let right = log(&nodes(), &loops(), Errors { noise_m: 0.1, ..Errors::default() });
    let places: Vec<Position> = right.ranges().iter().map(|range| range.position).collect();
    let wrong = right
        .ranges()
        .iter()
        .enumerate()
        .map(|(at, range)| RangeSample { position: places[(at * 7919) % places.len()] * 0.2, ..*range });
    let wrong = right.clone().with_ranges(wrong.collect()).unwrap();
    assert_eq!(map(&wrong).1.unwrap().unit, None);
}
