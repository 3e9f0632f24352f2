//! Robots with own applications in three dimensions.

use sextant_kernel::Files;
use std::f64::consts::TAU;
use std::time::Duration;

use sextant_channel::{BoxConfig, Obstacle, ObstacleConfig, ObstacleField, Position, ShapeConfig};
use sextant_sim::{
    Application, Applications, Delivery, Destination, DriveEnd, Driving, Odometry, OdometryConfig, Payload, Port,
    Robot, RobotBody, Setup, Survey, Timer, Unobserved, World,
};

use super::{NETWORK, setup};
use crate::network;

/// A node that calls each 100 ms, or a robot that flies over places and writes down where it heard a call.
#[derive(Clone, Debug)]
enum Station {
    Caller,
    Flyer(Flyer),
}

#[derive(Clone, Debug, Default)]
struct Flyer {
    places: Vec<Position>,
    flown: usize,
    /// Directions in which it measures the clearance in front of each drive, up to 50 m.
    looks: Vec<Position>,
    clearances_m: Vec<f64>,
    heard_at: Vec<Position>,
    poses: Vec<Position>,
    ends: Vec<DriveEnd>,
}

impl Flyer {
    fn fly_on(&mut self, port: &mut Port<'_>) {
        self.poses.push(port.pose().position);
        self.clearances_m.extend(self.looks.iter().map(|&look| port.clearance_m(look, 50.0)));
        let Some(&place) = self.places.get(self.flown) else { return port.finish() };
        self.flown += 1;
        assert_eq!(port.drive(place), Driving::UnderWay);
    }
}

impl Application for Station {
    fn hears(&self) -> bool {
        matches!(self, Self::Flyer(_))
    }

    fn has_task(&self) -> bool {
        matches!(self, Self::Flyer(_))
    }

    fn started(&mut self, port: &mut Port<'_>) {
        match self {
            Self::Caller => {
                port.after(Duration::from_millis(100).mul_f64(port.uniform(0)), Timer(0));
            }
            Self::Flyer(flyer) => {
                port.listen(NETWORK, Duration::from_secs(1000));
                flyer.fly_on(port);
            }
        }
    }

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        port.send(NETWORK, Destination::All, Payload::Octets(b"here")).expect("a free link");
        port.after(Duration::from_millis(100), timer);
    }

    fn delivered(&mut self, _delivery: &Delivery<'_>, port: &mut Port<'_>) {
        if let Self::Flyer(flyer) = self {
            flyer.heard_at.push(port.pose().position);
        }
    }

    fn drive_ended(&mut self, end: DriveEnd, port: &mut Port<'_>) {
        if let Self::Flyer(flyer) = self {
            flyer.ends.push(end);
            flyer.fly_on(port);
        }
    }
}

fn fly(setup: Setup, flyer: Flyer) -> (Survey, Flyer) {
    let nodes = vec![Station::Caller; setup.world.nodes.len()];
    let own = Applications { nodes, robots: vec![Station::Flyer(flyer)], sinks: Vec::new() };
    let (survey, own) = network::run_own(setup, own, &mut Unobserved);
    match own.robots.into_iter().next() {
        Some(Station::Flyer(flyer)) => (survey, flyer),
        robot => panic!("a robot flies: {robot:?}"),
    }
}

/// Radius of the helix (m), its rise in a turn (m), its turns, and the drives of a turn.
const RADIUS_M: f64 = 4.0;
const PITCH_M: f64 = 6.0;
const TURNS: i32 = 3;
const DRIVES: i32 = 48;

fn helix() -> Vec<Position> {
    let place = |i: i32| {
        let turns = f64::from(i) / f64::from(DRIVES);
        let (sin, cos) = (TAU * turns).sin_cos();
        Position::new(RADIUS_M * cos, RADIUS_M * sin, PITCH_M * turns)
    };
    (0..=TURNS * DRIVES).map(place).collect()
}

#[test]
fn a_robot_flies_a_helix_of_short_drives() {
    let places = helix();
    // The node on the axis at the bottom is in reach of 10 m as long as 4² + z² < 10².
    let world = World { nodes: network::nodes(&[Position::ORIGIN]), ..World::default() };
    let flyer = Flyer { places: places[1..].to_vec(), ..Flyer::default() };
    let (survey, flyer) = fly(setup(world, &[places[0].into()], &[], 600.0, 1), flyer);
    assert!(flyer.ends.iter().all(|&end| end == DriveEnd::Arrived));
    assert_eq!(flyer.poses, places);
    // Each chord rises by its share of the pitch.
    let chord_m = 2.0 * RADIUS_M * (0.5 * TAU / f64::from(DRIVES)).sin();
    let drive_m = chord_m.hypot(PITCH_M / f64::from(DRIVES));
    let length_m = f64::from(TURNS * DRIVES) * drive_m;
    assert!((survey.robots[0].path_length_m - length_m).abs() < 1e-9);
    assert!((survey.end.as_secs_f64() - length_m).abs() < 1e-6, "at 1 m/s");
    // It rises evenly, and hears ten calls a second.
    let highest_m = (10.0_f64.powi(2) - RADIUS_M * RADIUS_M).sqrt();
    let heard_s = highest_m / (PITCH_M * f64::from(TURNS)) * length_m;
    let count = flyer.heard_at.len() as f64;
    assert!((count - 10.0 * heard_s).abs() < 2.0, "{count} calls in {heard_s} s");
    // Between two places it is nearer to the axis, by 0.0086 m at most: it hears a bit higher.
    let top_m = flyer.heard_at.iter().map(|place| place.z_m).fold(0.0, f64::max);
    assert!(top_m < highest_m + 0.02 && top_m > highest_m - 0.1, "{top_m} m");
}

/// A ceiling from 5 m to 6 m above the ground.
fn ceiling() -> Obstacle {
    let shape = BoxConfig { center_m: Position::new(0.0, 0.0, 5.5), size_m: [40.0, 40.0, 1.0], yaw_deg: 30.0 };
    let config =
        ObstacleConfig { name: Some("ceiling".into()), ..ObstacleConfig::of(ShapeConfig::Box(shape), "concrete") };
    Obstacle::read(config, &Files::default()).expect("a good ceiling")
}

#[test]
fn range_sensors_measure_in_all_directions_and_a_ceiling_ends_a_drive() {
    let world = World { obstacles: ObstacleField::new(vec![ceiling()]), ..World::default() };
    let mut setup = setup(world, &[[1.0, 2.0, 1.0]], &[], 600.0, 1);
    let radius_m = setup.robots[0].body.radius_m;
    let looks = [[0.0, 0.0, 1.0], [0.0, 0.0, -2.0], [3.0, 0.0, 0.0], [0.0, 3.0, 4.0]].map(Position::from);
    let places = vec![Position::new(1.0, 2.0, 9.0), Position::new(1.0, -1.0, 4.0)];
    let flyer = Flyer { places, looks: looks.to_vec(), ..Flyer::default() };
    let (_, flown) = fly(setup.clone(), flyer.clone());
    // The hull touches the ceiling when its centre is its radius below 5 m; 5/4 of that on the slope of 3 to 4.
    let up_m = 4.0 - radius_m;
    let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-6, "{found} m, not {expected} m");
    near(flown.clearances_m[0], up_m);
    near(flown.clearances_m[1], 50.0);
    near(flown.clearances_m[2], 50.0);
    near(flown.clearances_m[3], 1.25 * up_m);
    let DriveEnd::Blocked(contact) = flown.ends[0] else { panic!("the ceiling is in the way: {:?}", flown.ends[0]) };
    assert!(contact.distance_m(Position::new(1.0, 2.0, 5.0)) < 1e-6, "{contact:?}");
    // It stops a millimetre before the contact, and may fly on downwards.
    near(flown.poses[1].z_m, 5.0 - radius_m - 1e-3);
    assert_eq!(flown.ends[1], DriveEnd::Arrived);
    // A robot whose odometry exaggerates believes in the same directions.
    let config = OdometryConfig { scale_error: -0.2, ..OdometryConfig::default() };
    let odometry = Odometry::try_from(config).expect("good settings");
    setup.robots =
        setup.robots.into_iter().map(|robot| Robot { body: RobotBody { odometry, ..robot.body }, ..robot }).collect();
    let up = Flyer { places: vec![Position::new(1.0, 2.0, 3.5)], ..flyer };
    let (_, flown) = fly(setup, up);
    // It believes to be 2.5 m higher, and is 2 m higher: the ceiling is at 4 m less 2 m less its hull.
    assert_eq!(flown.poses[1], Position::new(1.0, 2.0, 3.5));
    near(flown.clearances_m[4], up_m - 2.0);
}
