//! Ways on the ground, and plans on them.

use sextant_channel::{Bounds, ObstacleField, Position, Reception, ReceptionLog, Stop, WallConfig};
use sextant_kernel::{NodeId, Unwatched};
use sextant_mapper::{CoordinateFrame, ProfileConfig, ReceptionProfile, TopologyMap, TrapezoidConfig};

use super::*;

fn at(x_m: f64, y_m: f64) -> Position {
    Position::new(x_m, y_m, 0.0)
}

/// Walls of 0.2 m along these lines.
fn walls(lines: &[&[[f64; 2]]]) -> ObstacleField {
    let wall = |points: &&[[f64; 2]]| {
        let points: Vec<String> = points.iter().map(|[x, y]| format!("[{x:?}, {y:?}]")).collect();
        let text =
            format!("points_m = [{}]\nthickness_m = 0.2\nheight_m = 2.5\nmaterial = \"brick\"", points.join(", "));
        let wall: WallConfig = toml::from_str(&text).unwrap();
        wall.obstacles(0).unwrap()
    };
    ObstacleField::new(lines.iter().flat_map(wall).collect())
}

fn terrain<'a>(obstacles: &'a ObstacleField, is_inside: &'a (dyn Fn(Position) -> bool + Sync)) -> Terrain<'a> {
    Terrain {
        bounds: Bounds { min: at(0.0, 0.0), max: at(10.0, 6.0) },
        is_inside,
        obstacles,
        radius_m: 0.2,
        step_m: 1.0,
    }
}

fn everywhere(_: Position) -> bool {
    true
}

#[test]
fn a_room_without_a_door_is_not_entered_and_one_with_a_door_is() {
    let start = at(1.0, 1.0);
    let (closed, open): (&[[f64; 2]], &[&[[f64; 2]]]) =
        (&[[5.0, -1.0], [5.0, 7.0]], &[&[[5.0, -1.0], [5.0, 4.0]], &[[5.0, 5.0], [5.0, 7.0]]]);
    let closed = walls(&[closed]);
    let ground = Ground::new(terrain(&closed, &everywhere), start, &Unwatched).unwrap();
    assert!(
        ground.places().len() > 15 && ground.places().iter().all(|place| place.x_m < 4.8),
        "{:?}",
        ground.places()
    );
    let open = walls(open);
    let ground = Ground::new(terrain(&open, &everywhere), start, &Unwatched).unwrap();
    let places = ground.places();
    let (far, ways_m) =
        (places.iter().position(|place| place.x_m > 8.0 && place.y_m < 1.5).unwrap(), ground.ways_from_start_m());
    let way = ground.way(start, places[far]);
    let way_m = length_m(start, &way);
    // The hull of 0.2 m passes the corner of the door at (5, 4).
    let least_m = start.distance_m(at(4.7, 4.0)) + at(5.3, 4.0).distance_m(places[far]);
    assert!(way_m > least_m && way_m < 1.15 * least_m + 0.6, "{way_m} m of at least {least_m} m");
    assert!(ways_m[far] >= way_m - 1e-9 && ways_m[far] < 1.15 * way_m, "{} m of {way_m} m", ways_m[far]);
    assert!(places.iter().all(|place| open.distance_m(*place) >= 0.2));
}

#[test]
fn a_robot_in_a_wall_or_enclosed_by_walls_is_told() {
    let ring = walls(&[&[[2.0, 2.0], [3.0, 2.0], [3.0, 3.0], [2.0, 3.0], [2.0, 2.0]]]);
    let is_far = |place: Position| place.x_m > 5.0;
    let error = |start| Ground::new(terrain(&ring, &is_far), start, &Unwatched).unwrap_err().to_string();
    assert!(error(at(2.5, 2.0)).contains("the robot is at [2.5, 2, 0], inside obstacle"), "{}", error(at(2.5, 2.0)));
    assert!(error(at(2.5, 2.5)).contains("none of the places can be got to from (2.5, 2.5)"));
    let nothing = ObstacleField::default();
    let ground = Ground::new(terrain(&nothing, &is_far), at(0.0, 0.0), &Unwatched).unwrap();
    assert!(ground.places().iter().all(|place| place.x_m > 5.0));
}

/// Nodes at `places` with a standard deviation along x and y (m) each, heard by a robot at (1, 1).
fn outlook(nodes: &[(Position, f64)], profile: TrapezoidConfig) -> Outlook {
    let stop = Stop::at(at(1.0, 1.0));
    let heard = |node| Reception::heard(NodeId::from_index(node), 0, 1, 1);
    let names = (0..nodes.len()).map(|node| format!("n{node}")).collect();
    let log = ReceptionLog::new(names, vec![stop], (0..nodes.len()).map(heard).collect(), Vec::new()).unwrap();
    let places = nodes.iter().map(|(place, _)| Some(*place)).collect();
    let mut map = TopologyMap::of_places("test", places, CoordinateFrame::World);
    for (estimate, (_, deviation_m)) in map.estimates.iter_mut().flatten().zip(nodes) {
        let variance = deviation_m * deviation_m;
        estimate.covariance = Some([[variance, 0.0, 0.0], [0.0, variance, 0.0], [0.0; 3]]);
    }
    let profile = ReceptionProfile::for_grid(ProfileConfig::Trapezoid(profile), 0.0).unwrap();
    Outlook::of(&log, &map, None, Some(&profile), &[]).unwrap()
}

const BUDGET: StopBudget =
    StopBudget { stops: 4, way_m: f64::INFINITY, speed_m_per_s: 0.5, listen_s: 2.0, least_s: 2.0 };

#[test]
fn stops_are_where_the_uncertain_node_is_and_each_brings_what_it_says() {
    let nodes = [(at(2.0, 2.0), 0.05), (at(8.0, 4.0), 1.5)];
    let outlook = outlook(&nodes, TrapezoidConfig::new(1.0, 0.5, 4.0));
    let nothing = ObstacleField::default();
    let ground = Ground::new(terrain(&nothing, &everywhere), at(1.0, 1.0), &Unwatched).unwrap();
    let found = plan(&outlook, &ground, &BUDGET, &Unwatched).unwrap();
    assert_eq!((found.stops.len(), found.end), (4, PlanEnd::Stops));
    let mut error_m = found.error_m;
    assert!((error_m - (0.05 + 1.5) * 2.0_f64.sqrt() / 2.0).abs() < 1e-9, "{error_m}");
    let mut here = ground.start();
    for stop in &found.stops {
        assert!(stop.place.distance_m(nodes[1].0) < 4.0 + 2.0 * 1.5, "{stop:?}");
        assert!((error_m - stop.error_m - stop.gain.fall_m / 2.0).abs() < 1e-9, "{stop:?}");
        assert!((stop.time_s - 2.0 - stop.place.distance_m(here) / 0.5).abs() < 1e-9, "{stop:?}");
        assert!(stop.gain.fall_m > 0.0);
        (error_m, here) = (stop.error_m, stop.place);
    }
    assert!(error_m < 0.8 * found.error_m, "{error_m} of {}", found.error_m);
    // With half the way, less is brought, and the way is kept.
    let way_m: f64 = found.stops.iter().map(|stop| stop.way_m).sum();
    let short = plan(&outlook, &ground, &StopBudget { way_m: 0.8 * way_m, stops: 50, ..BUDGET }, &Unwatched).unwrap();
    assert!(short.stops.iter().map(|stop| stop.way_m).sum::<f64>() <= 0.8 * way_m + 1e-9);
    assert!(short.end != PlanEnd::Stops && !short.stops.is_empty());
}

#[test]
fn where_all_is_heard_for_sure_nothing_is_to_be_gained() {
    let outlook = outlook(&[(at(5.0, 3.0), 0.5)], TrapezoidConfig::new(1.0, 30.0, 31.0));
    let nothing = ObstacleField::default();
    let ground = Ground::new(terrain(&nothing, &everywhere), at(1.0, 1.0), &Unwatched).unwrap();
    let found = plan(&outlook, &ground, &BUDGET, &Unwatched).unwrap();
    assert_eq!((found.stops.len(), found.end), (0, PlanEnd::NothingMore));
}
