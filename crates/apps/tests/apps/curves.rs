//! Spirals, Hilbert curves and S paths: what they cover, how long they are, and that they avoid obstacles.

use std::f64::consts::TAU;

use proptest::prelude::*;
use sextant_apps::{ControllerConfig, HilbertConfig, SPathConfig, SpiralConfig};
use sextant_channel::{ObstacleField, Position};
use sextant_kernel::{Purpose, Seed};
use sextant_sim::Ending;
use sextant_sim::layout::{Region, RegionConfig};

use crate::world::{Trace, World, field};

fn at(x_m: f64, y_m: f64) -> Position {
    Position::new(x_m, y_m, 0.0)
}

fn world(field: ObstacleField) -> World {
    World { field, nodes: vec![at(0.0, 0.0)], robot_radius_m: 0.2, reach_m: 5.0, fading: None }
}

fn drive(config: &ControllerConfig, world: &World, start: Position) -> Trace {
    let mut controller = config.build(&world.surroundings(start)).expect("a path");
    world.survey(&mut *controller, start, 1)
}

fn square(side_m: f64) -> RegionConfig {
    RegionConfig::Rectangle { min_m: at(0.0, 0.0), max_m: at(side_m, side_m) }
}

fn spiral(region: RegionConfig, lane_spacing_m: f64, stop_spacing_m: f64) -> ControllerConfig {
    ControllerConfig::Spiral(SpiralConfig { region, lane_spacing_m, stop_spacing_m, height_m: None })
}

fn hilbert(region: RegionConfig, order: Option<u32>, spacing_m: Option<f64>) -> ControllerConfig {
    ControllerConfig::Hilbert(HilbertConfig { region, order, spacing_m, height_m: None })
}

fn s_path(region: RegionConfig, lane_spacing_m: f64) -> ControllerConfig {
    ControllerConfig::SPath(SPathConfig::new(region, lane_spacing_m))
}

/// The greatest distance from a place of the region to the nearest stop, over many places (m).
fn greatest_gap_m(region: &RegionConfig, trace: &Trace) -> f64 {
    const PLACES: u64 = 3000;
    let region = Region::try_from(region).expect("a region");
    let (min, size) = (region.bounds().min, region.bounds().max - region.bounds().min);
    let place = |i| {
        let [u, v] = [0, 1].map(|axis| Seed(9).uniform(Purpose::new(1), [i, axis, 0]));
        min + Position::new(u * size.x_m, v * size.y_m, 0.0)
    };
    let gaps =
        (0..PLACES).map(place).filter(|&place| region.contains(place)).map(|place| trace.nearest_stop_m(place));
    gaps.fold(0.0, f64::max)
}

#[test]
fn each_place_of_a_region_is_within_the_lane_spacing_of_a_stop() {
    let world = world(ObstacleField::default());
    let triangle = vec![[-4.0, -3.0], [9.0, -1.0], [1.0, 8.0]];
    let regions = [
        square(10.0),
        RegionConfig::Rectangle { min_m: at(-3.0, 2.0), max_m: at(14.0, 7.0) },
        RegionConfig::Disc { center_m: at(2.0, -1.0), radius_m: 6.3 },
        RegionConfig::Polygon { corners_m: triangle, z_m: 0.0 },
        RegionConfig::Ball { center_m: at(1.0, 1.0), radius_m: 5.0 },
    ];
    for region in regions {
        // Stops 1 m apart on lanes up to s/2 away.
        for spacing_m in [1.0, 1.7, 3.0] {
            for (config, what) in [
                (spiral(region.clone(), spacing_m, 1.0), "spiral"),
                (s_path(region.clone(), spacing_m), "s_path"),
                (hilbert(region.clone(), None, Some(spacing_m)), "hilbert"),
            ] {
                let gap_m = greatest_gap_m(&region, &drive(&config, &world, at(-5.0, -5.0)));
                // An S path makes no stop outside of a polygon, so that a sharp corner between two lanes is farther.
                let is_clipped = what == "s_path" && matches!(region, RegionConfig::Polygon { .. });
                assert!(
                    gap_m <= if is_clipped { 1.5 * spacing_m } else { spacing_m },
                    "{what} over {region:?}: {gap_m} m of {spacing_m} m"
                );
            }
        }
        let order = hilbert(region.clone(), Some(4), None);
        assert!(greatest_gap_m(&region, &drive(&order, &world, at(-5.0, -5.0))) < 17.0 / 16.0);
    }
}

#[test]
fn a_hilbert_curve_visits_each_cell_once_in_steps_of_one_cell() {
    let world = world(ObstacleField::default());
    for order in 1..=5 {
        // The corners of the curve are half a cell inside those of the square.
        for (corner, ahead) in [([0.0, 0.0], [1.0, 1.0]), ([8.0, 0.0], [-1.0, 1.0]), ([0.0, 8.0], [1.0, -1.0])] {
            let cells = f64::from(1_u32 << order);
            let cell_m = 8.0 / cells;
            let start = at(corner[0] + 0.5 * cell_m * ahead[0], corner[1] + 0.5 * cell_m * ahead[1]);
            let trace = drive(&hilbert(square(8.0), Some(order), None), &world, start);
            assert_eq!(trace.ending, Ending::Complete);
            assert_eq!(trace.stops.len(), 1 << (2 * order));
            assert_eq!(trace.stops[0], start, "it begins in the nearest corner");
            for step in trace.stops.windows(2) {
                assert!((step[0].distance_m(step[1]) - cell_m).abs() < 1e-12);
            }
            let mut visited: Vec<_> = trace.stops.iter().map(|stop| (stop.x_m / cell_m, stop.y_m / cell_m)).collect();
            visited.sort_by(|a, b| a.partial_cmp(b).expect("finite"));
            visited.dedup_by(|a, b| (a.0 - b.0).abs() + (a.1 - b.1).abs() < 0.5);
            assert_eq!(visited.len(), trace.stops.len(), "no cell twice");
            let length_m = cells.mul_add(cells, -1.0) * cell_m;
            assert!((trace.path_length_m() - length_m).abs() < 1e-9);
        }
    }
}

#[test]
fn a_spiral_over_a_disc_has_the_length_of_its_formula_and_turns_a_lane_apart() {
    let world = world(ObstacleField::default());
    let (spacing_m, radius_m) = (0.8, 6.0);
    let region = RegionConfig::Disc { center_m: at(0.0, 0.0), radius_m };
    let trace = drive(&spiral(region, spacing_m, 0.05), &world, at(0.0, 0.0));
    // The last turn ends half a lane spacing outside the disc.
    let turns = (radius_m + 0.5 * spacing_m) / spacing_m;
    let angle_rad = TAU * turns;
    let b_m = spacing_m / TAU;
    let length_m = 0.5 * b_m * (angle_rad * (1.0 + angle_rad * angle_rad).sqrt() + angle_rad.asinh());
    // Chords of 0.05 m are shorter than their arcs by 0.05³ / 24 r², mostly near the centre.
    assert!((trace.path_length_m() - length_m).abs() < 0.06, "{} for {length_m}", trace.path_length_m());
    for stop in &trace.stops {
        let (radius_m, angle_rad) = (stop.length_m(), stop.y_m.atan2(stop.x_m));
        let turn = radius_m / spacing_m - angle_rad / TAU;
        assert!((turn - turn.round()).abs() < 1e-9, "{stop:?} is no place of the spiral");
    }
}

#[test]
fn a_spiral_that_starts_outside_leads_inwards() {
    let world = world(ObstacleField::default());
    let outwards = drive(&spiral(square(10.0), 1.0, 1.0), &world, at(5.0, 5.0));
    let inwards = drive(&spiral(square(10.0), 1.0, 1.0), &world, at(10.0, 12.0));
    assert_eq!(outwards.stops[0], at(5.0, 5.0));
    assert!(outwards.stops.iter().eq(inwards.stops.iter().rev()));
}

#[test]
fn curves_are_driven_at_their_height() {
    let world = world(ObstacleField::default());
    let region = square(6.0);
    for config in [
        ControllerConfig::Spiral(SpiralConfig {
            region: region.clone(),
            lane_spacing_m: 2.0,
            stop_spacing_m: 1.0,
            height_m: Some(2.5),
        }),
        ControllerConfig::Hilbert(HilbertConfig { region, order: Some(2), spacing_m: None, height_m: Some(2.5) }),
    ] {
        let trace = drive(&config, &world, at(0.0, 0.0));
        assert!(trace.stops.iter().all(|stop| (stop.z_m - 2.5).abs() < 1e-12));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]
    /// The scripted world checks each drive against the exact obstacles, and each place against the radius of the
    /// hull.
    #[test]
    fn random_obstacles_are_driven_round_and_all_free_stops_are_made(
        boxes in prop::collection::vec(
            ((0.0..10.0_f64, 0.0..10.0_f64), (0.3..3.0_f64, 0.3..3.0_f64), 0.0..90.0_f64),
            1..5,
        ),
        curve in 0..3,
    ) {
        let boxes: Vec<_> = boxes.into_iter().map(|((x, y), (w, d), yaw)| ([x, y], [w, d], yaw)).collect();
        let config = match curve {
            0 => spiral(square(10.0), 1.0, 1.0),
            1 => hilbert(square(10.0), None, Some(1.0)),
            _ => s_path(square(10.0), 1.0),
        };
        let start = at(-6.0, -6.0);
        let all = drive(&config, &world(ObstacleField::default()), start);
        let blocked = world(field(&boxes));
        let trace = drive(&config, &blocked, start);
        prop_assert_eq!(trace.ending, Ending::Complete);
        let least_m = blocked.robot_radius_m + 5e-3;
        let free: Vec<_> = all.stops.into_iter().filter(|stop| blocked.field.distance_m(*stop) > least_m).collect();
        // Obstacles may enclose a yard. Only stops in such a yard may be left out.
        prop_assert!(trace.stops.len() <= free.len() && 10 * trace.stops.len() >= 8 * free.len());
        prop_assert!(trace.stops.iter().all(|stop| free.contains(stop)));
    }
}

#[test]
fn invalid_settings_are_rejected_with_their_key() {
    let world = world(field(&[([5.0, 5.0], [40.0, 40.0], 0.0)]));
    let open = self::world(ObstacleField::default());
    let key = |config: &ControllerConfig, world: &World| {
        config.build(&world.surroundings(at(-30.0, 0.0))).err().expect("refused").key
    };
    let flat = RegionConfig::Rectangle { min_m: at(0.0, 0.0), max_m: at(0.0, 1.0) };
    assert_eq!(key(&spiral(flat.clone(), 1.0, 1.0), &open), "spiral.region.rectangle.max_m");
    assert_eq!(key(&spiral(square(1.0), 0.0, 1.0), &open), "spiral.lane_spacing_m");
    assert_eq!(key(&spiral(square(1.0), 1e-9, 1.0), &open), "spiral.lane_spacing_m");
    assert_eq!(key(&spiral(square(1.0), 1.0, f64::NAN), &open), "spiral.stop_spacing_m");
    assert_eq!(key(&spiral(square(1e4), 1.0, 0.1), &open), "spiral.stop_spacing_m");
    assert_eq!(key(&spiral(square(10.0), 1.0, 1.0), &world), "spiral.region");
    assert_eq!(key(&hilbert(flat, Some(2), None), &open), "hilbert.region.rectangle.max_m");
    assert_eq!(key(&hilbert(square(1.0), None, None), &open), "hilbert.order");
    assert_eq!(key(&hilbert(square(1.0), Some(0), None), &open), "hilbert.order");
    assert_eq!(key(&hilbert(square(1.0), Some(10), None), &open), "hilbert.order");
    assert_eq!(key(&hilbert(square(1.0), Some(2), Some(1.0)), &open), "hilbert.spacing_m");
    assert_eq!(key(&hilbert(square(1.0), None, Some(-1.0)), &open), "hilbert.spacing_m");
    assert_eq!(key(&hilbert(square(1000.0), None, Some(1.0)), &open), "hilbert.spacing_m");
    assert_eq!(key(&hilbert(square(10.0), Some(2), None), &world), "hilbert.region");
    let high = HilbertConfig { region: square(1.0), order: Some(1), spacing_m: None, height_m: Some(f64::INFINITY) };
    assert_eq!(key(&ControllerConfig::Hilbert(high), &open), "hilbert.height_m");
}
