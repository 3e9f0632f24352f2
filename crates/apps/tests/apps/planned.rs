//! Paths planned before the start.

use sextant_apps::{ControllerConfig, SPathConfig, WaypointsConfig};
use sextant_channel::{ObstacleField, Position};
use sextant_sim::Ending;
use sextant_sim::layout::RegionConfig;

use crate::world::{Trace, World, field};

fn at(x_m: f64, y_m: f64) -> Position {
    Position::new(x_m, y_m, 0.0)
}

fn world(field: ObstacleField) -> World {
    World { field, nodes: vec![at(0.0, 0.0)], robot_radius_m: 0.25, reach_m: 5.0, fading: None }
}

fn drive(config: &ControllerConfig, world: &World, start: Position) -> Trace {
    let surroundings = world.surroundings(start);
    let mut controller = config.build(&surroundings).expect("a path");
    world.survey(&mut *controller, start, 1)
}

fn s_path(width_m: f64, height_m: f64, overshoot_m: f64) -> ControllerConfig {
    let region = RegionConfig::Rectangle { min_m: at(0.0, 0.0), max_m: at(width_m, height_m) };
    ControllerConfig::SPath(SPathConfig { overshoot_m, ..SPathConfig::new(region, 2.0) })
}

#[test]
fn an_s_path_without_obstacles_has_the_length_and_the_stops_of_its_formula() {
    let world = world(ObstacleField::default());
    for overshoot_m in [0.0, 1.0, 3.0] {
        let trace = drive(&s_path(10.0, 8.0, overshoot_m), &world, at(-overshoot_m, -overshoot_m));
        let (width_m, height_m) = (10.0 + 2.0 * overshoot_m, 8.0 + 2.0 * overshoot_m);
        let length_m = (width_m / 2.0 + 1.0) * height_m + width_m;
        assert_eq!(trace.ending, Ending::Complete);
        assert!((trace.path_length_m() - length_m).abs() < 1e-9, "{}", trace.path_length_m());
        assert!((trace.stops.len() as f64 - (length_m + 1.0)).abs() < 1e-9, "{} stops", trace.stops.len());
    }
}

#[test]
fn an_s_path_over_a_polygon_stays_inside() {
    let world = world(ObstacleField::default());
    // An L whose upper right quarter is empty.
    let corners_m = vec![[0.0, 0.0], [12.0, 0.0], [12.0, 4.0], [6.0, 4.0], [6.0, 8.0], [0.0, 8.0]];
    let stops = |overshoot_m| {
        let region = RegionConfig::Polygon { corners_m: corners_m.clone(), z_m: 0.0 };
        let config = SPathConfig { overshoot_m, ..SPathConfig::new(region, 2.0) };
        drive(&ControllerConfig::SPath(config), &world, at(0.0, 0.0)).stops
    };
    let (exact, grown) = (stops(0.0), stops(1.0));
    assert!(exact.iter().all(|stop| stop.x_m <= 6.0 || stop.y_m <= 4.0), "{exact:?}");
    // Four lanes of nine stops, three of five, and one between any two lanes that lies inside.
    assert_eq!(exact.len(), 4 * 9 + 3 * 5 + 5, "{exact:?}");
    assert!(grown.iter().all(|stop| stop.x_m <= 7.0 || stop.y_m <= 5.0), "{grown:?}");
    assert!(grown.iter().any(|stop| stop.x_m < 0.0 || stop.y_m > 8.0), "{grown:?}");
}

#[test]
fn an_s_path_leaves_out_covered_stops_and_drives_round_obstacles() {
    let open = world(ObstacleField::default());
    let blocked = world(field(&[([4.0, 4.0], [3.0, 4.0], 0.0), ([8.0, 7.0], [2.0, 5.0], 30.0)]));
    let config = s_path(10.0, 8.0, 0.0);
    let all = drive(&config, &open, at(-1.0, -1.0));
    let trace = drive(&config, &blocked, at(-1.0, -1.0));
    assert_eq!(trace.ending, Ending::Complete);
    let least_m = blocked.robot_radius_m + 5e-3;
    let free: Vec<Position> =
        all.stops.into_iter().filter(|stop| blocked.field.distance_m(*stop) > least_m).collect();
    assert!(free.len() < 59, "the obstacles cover some");
    assert_eq!(trace.stops, free, "all the others are made, in the same order");
    assert!(trace.path_length_m() > all_length_m(&free), "the way round is longer");
}

fn all_length_m(stops: &[Position]) -> f64 {
    stops.windows(2).map(|drive| drive[0].distance_m(drive[1])).sum()
}

#[test]
fn the_way_to_a_place_behind_a_box_leads_round_its_nearer_corners() {
    let world = world(field(&[([0.0, 1.0], [2.0, 6.0], 0.0)]));
    let config = ControllerConfig::Waypoints(WaypointsConfig { places_m: vec![at(-3.0, 0.0), at(3.0, 0.0)] });
    let trace = drive(&config, &world, at(-3.0, 0.0));
    assert_eq!(trace.stops, [at(-3.0, 0.0), at(3.0, 0.0)]);
    // The way passes the southern corners at the radius of the hull: 0.25 m south of y = -2.
    let shortest_m = 2.0 * 2_f64.hypot(2.0) + 2.0;
    let length_m = trace.path_length_m();
    assert!(length_m > shortest_m && length_m < 1.1 * shortest_m, "{length_m} for {shortest_m}");
}

#[test]
fn a_robot_that_flies_may_pass_over_an_obstacle() {
    let world = world(field(&[([0.0, 0.0], [2.0, 200.0], 0.0)]));
    let places_m = vec![Position::new(-3.0, 0.0, 4.0), Position::new(3.0, 0.0, 4.0)];
    let trace =
        drive(&ControllerConfig::Waypoints(WaypointsConfig { places_m: places_m.clone() }), &world, at(-3.0, 0.0));
    assert_eq!(trace.stops, places_m);
    assert!((trace.path_length_m() - 10.0).abs() < 1e-9);
}

#[test]
fn places_that_cannot_be_reached_are_rejected_with_their_index() {
    // Four walls enclose a yard round (10, 0).
    let walls = [
        ([10.0, 3.0], [7.0, 1.0], 0.0),
        ([10.0, -3.0], [7.0, 1.0], 0.0),
        ([7.0, 0.0], [1.0, 7.0], 0.0),
        ([13.0, 0.0], [1.0, 7.0], 0.0),
    ];
    let world = world(field(&walls));
    let surroundings = world.surroundings(at(0.0, 0.0));
    let fault = |places_m: Vec<Position>| {
        let error =
            ControllerConfig::Waypoints(WaypointsConfig { places_m }).build(&surroundings).err().expect("refused");
        (error.key.clone(), error.found().to_owned())
    };
    assert_eq!(fault(vec![]).0, "waypoints.places_m");
    assert_eq!(fault(vec![at(1.0, f64::NAN)]).0, "waypoints.places_m[0]");
    let (key, found) = fault(vec![at(1.0, 1.0), at(7.0, 0.0)]);
    assert_eq!((key.as_str(), found.as_str()), ("waypoints.places_m[1]", "[7, 0, 0], inside an obstacle"));
    let (key, found) = fault(vec![at(10.0, 0.0)]);
    assert_eq!((key.as_str(), found.as_str()), ("waypoints.places_m[0]", "[10, 0, 0], with no way to it"));
    let region = RegionConfig::Disc { center_m: at(10.0, 0.0), radius_m: 1.0 };
    let enclosed = ControllerConfig::SPath(SPathConfig::new(region, 1.0)).build(&surroundings);
    assert_eq!(enclosed.err().expect("refused").key, "s_path.region");
}
