//! Robots whose odometry has errors: what they believe, and where they are.

use std::time::Duration;

use sextant_channel::{BoxConfig, Obstacle, ObstacleConfig, ObstacleField, Position, ShapeConfig};
use sextant_kernel::{Files, SimTime};
use sextant_sim::{
    CommandOutcome, Controller, Ending, Observer, Odometry, OdometryConfig, PeriodicConfig, Pose, Robot, RobotBody,
    RobotCommand, RobotTask, Setup, Simulation, Situation, Survey, TrafficConfig,
};

use crate::network;

/// What the observer is told of the robot.
#[derive(Default)]
struct Trace {
    truth: Vec<(SimTime, Position)>,
    belief: Vec<(SimTime, Pose)>,
}

impl Observer for Trace {
    fn moved(&mut self, _robot: usize, time: SimTime, position: Position) {
        self.truth.push((time, position));
    }

    fn believed(&mut self, _robot: usize, time: SimTime, pose: Pose) {
        self.belief.push((time, pose));
    }
}

impl Trace {
    fn end(&self) -> Position {
        self.truth[self.truth.len() - 1].1
    }
}

fn setup(robot: Robot, odometry: OdometryConfig, seed: u64) -> Setup {
    let places: Vec<_> = (0..25).map(|i| Position::new(f64::from(i % 5), f64::from(i / 5), 0.0)).collect();
    let traffic = TrafficConfig::Beacon(PeriodicConfig::each(20, 0.5, 0.1));
    let odometry = Odometry::try_from(odometry).expect("good settings");
    let robot = Robot { body: RobotBody { odometry, ..robot.body }, ..robot };
    Setup { robots: vec![robot], ..network::setup(&places, -30.0, network::suburb(5.0), traffic, seed) }
}

fn survey(setup: Setup) -> (Survey, Trace) {
    let mut trace = Trace::default();
    let survey = Simulation::new(setup).expect("good settings").run(&mut trace);
    (survey, trace)
}

/// A square of 4 m, twice.
fn squares() -> Robot {
    let corners = [[4.0, 0.0, 0.0], [4.0, 4.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 0.0]].map(Position::from);
    network::tour([corners, corners].concat(), 0.25, Duration::from_secs(1))
}

fn assert_near(found: Position, expected: [f64; 3], within_m: f64) {
    assert!(found.distance_m(expected.into()) <= within_m, "{found}, not {expected:?}");
}

const EXACT: OdometryConfig = OdometryConfig {
    scale_error: 0.0,
    heading_drift_rad_per_m: 0.0,
    length_noise_m_per_sqrt_m: 0.0,
    heading_noise_rad_per_sqrt_m: 0.0,
};

#[test]
fn a_robot_with_exact_odometry_believes_the_truth() {
    let (survey, trace) = survey(setup(squares(), EXACT, 1));
    assert!(trace.belief.is_empty());
    let places: Vec<Position> = survey.log().stops().iter().map(|stop| stop.position).collect();
    let ends: Vec<Position> = trace.truth[1..].chunks(2).map(|drive| drive[1].1).collect();
    assert_eq!(places, ends);
    assert!((survey.robots[0].path_length_m - 32.0).abs() < 1e-12);
}

#[test]
fn the_log_holds_what_the_robot_believes_and_the_observer_sees_the_truth() {
    let scale_error = 0.05;
    let (with_error, trace) = survey(setup(squares(), OdometryConfig { scale_error, ..EXACT }, 1));
    let (exact, _) = survey(setup(squares(), EXACT, 1));
    // The robot believes, and its clock says, that all is as planned.
    assert_eq!(with_error.log().stops(), exact.log().stops());
    assert_eq!(with_error.end, exact.end);
    // It is at larger squares, so it hears something else.
    assert_ne!(with_error.log(), exact.log());
    assert!((with_error.robots[0].path_length_m - 1.05 * 32.0).abs() < 1e-9);
    assert_eq!(trace.truth.len(), trace.belief.len());
    for ((time, truth), (believed_at, belief)) in trace.truth.iter().zip(&trace.belief) {
        assert_eq!(time, believed_at);
        assert_near(*truth, (belief.position * 1.05).into(), 1e-9);
    }
}

#[test]
fn a_drift_of_the_heading_turns_what_the_robot_believes_to_be_a_square() {
    // Each side of 4 m turns the robot by 0.1 rad to the left: side k begins at a heading of 0.1 k beside the believed
    // one, and its chord points 0.05 more to the left.
    let drift = OdometryConfig { heading_drift_rad_per_m: 0.025, ..EXACT };
    let (survey, trace) = survey(setup(squares(), drift, 1));
    let chord_m = 40.0 * 2.0 * 0.05_f64.sin();
    let (mut x_m, mut y_m) = (0.0, 0.0);
    for side in 0..8 {
        let heading = f64::from(side) * (std::f64::consts::FRAC_PI_2 + 0.1) + 0.05;
        x_m += chord_m * heading.cos();
        y_m += chord_m * heading.sin();
    }
    assert_near(trace.end(), [x_m, y_m, 0.0], 1e-8);
    let belief = trace.belief[trace.belief.len() - 1].1;
    assert_near(belief.position, [0.0; 3], 0.0);
    assert!(trace.end().distance_m(Position::ORIGIN) > 0.5);
    assert!((survey.robots[0].path_length_m - 32.0).abs() < 1e-9);
}

#[test]
fn noise_is_drawn_by_the_seed_with_the_given_variance() {
    const DRIVES: usize = 2000;
    let noise = OdometryConfig { length_noise_m_per_sqrt_m: 0.02, heading_noise_rad_per_sqrt_m: 0.005, ..EXACT };
    let way = || {
        let places = (0..DRIVES).map(|i| Position::new(if i % 2 == 0 { 4.0 } else { 0.0 }, 0.0, 0.0)).collect();
        network::tour(places, 0.25, Duration::from_millis(1))
    };
    let (first, trace) = survey(setup(way(), noise, 1));
    let (again, same) = survey(setup(way(), noise, 1));
    let (_, other) = survey(setup(way(), noise, 2));
    assert_eq!(first.log(), again.log());
    assert_eq!(trace.truth, same.truth);
    assert_ne!(trace.truth, other.truth);
    // A turn of 5 degrees, of which the middle would be told too, is nine standard deviations away.
    // Of 4 m, the standard deviation is twice that of 1 m; the chord of an arc is shorter by less than 4 mm * 1e-3.
    let places: Vec<Position> = trace.truth.iter().skip(1).map(|&(_, place)| place).collect();
    let errors: Vec<f64> = places.chunks(2).map(|drive| drive[0].distance_m(drive[1]) - 4.0).collect();
    assert_eq!(errors.len(), DRIVES);
    let n = DRIVES as f64;
    let mean = errors.iter().sum::<f64>() / n;
    let deviation = (errors.iter().map(|error| error * error).sum::<f64>() / n).sqrt();
    // Five standard errors each: a false alarm in 1.7 million.
    assert!(mean.abs() < 5.0 * 0.04 / n.sqrt() + 1e-4, "mean {mean}");
    assert!((deviation / 0.04 - 1.0).abs() < 5.0 / (2.0 * n).sqrt(), "deviation {deviation}");
    // What the robot believes has no noise.
    assert!(first.log().stops().iter().all(|stop| stop.position.y_m.abs() < 1e-9));
}

/// Measures how far the wall is along x, drives there until it is blocked, back home, and to the wall again.
#[derive(Clone)]
struct ToTheWall {
    contacts: u32,
}

impl Controller for ToTheWall {
    fn decide(&mut self, situation: &Situation<'_>) -> RobotCommand {
        match situation.outcome {
            CommandOutcome::Blocked(contact) => {
                assert_near(contact, [5.4 + 0.25, 0.0, 0.0], 2e-3);
                self.contacts += 1;
                if self.contacts > 1 { RobotCommand::Listen } else { RobotCommand::Drive(Position::ORIGIN) }
            }
            CommandOutcome::Listened(_) => RobotCommand::Finish(Ending::Complete),
            CommandOutcome::Started | CommandOutcome::Arrived => {
                let clear_m = situation.clearance_m(Position::new(1.0, 0.0, 0.0), 100.0);
                // The true distance, not the believed one.
                assert!((clear_m - 6.75).abs() < 2e-3, "{clear_m} m");
                RobotCommand::Drive(Position::new(20.0, 0.0, 0.0))
            }
        }
    }
}

#[test]
fn range_sensors_measure_from_the_true_place_and_contacts_are_logged_where_the_robot_believes_them() {
    let wall = ObstacleConfig::absorbing(
        ShapeConfig::Box(BoxConfig::new(Position::new(8.0, 0.0, 0.0), [2.0, 30.0, 4.0])),
        1.0,
    );
    let robot =
        Robot { body: network::surveyor_body(), task: RobotTask::Survey(Box::new(ToTheWall { contacts: 0 })) };
    let mut setup = setup(robot, OdometryConfig { scale_error: 0.25, ..EXACT }, 1);
    setup.world.obstacles = ObstacleField::new(vec![Obstacle::read(wall, &Files::default()).expect("a good wall")]);
    let (survey, trace) = survey(setup);
    // The hull touches the wall at x = 6.75 m, 5.4 m by odometry; the wall is 0.25 m ahead of the robot's centre.
    let [first, second] = survey.log().contacts() else { panic!("{:?}", survey.log().contacts()) };
    for contact in [first, second] {
        assert_near(contact.position, [5.4 + 0.25, 0.0, 0.0], 2e-3);
    }
    assert_near(trace.end(), [6.749, 0.0, 0.0], 1e-6);
    assert_near(survey.log().stops()[0].position, [6.749 / 1.25, 0.0, 0.0], 1e-6);
    assert!((survey.robots[0].path_length_m - 3.0 * 6.749).abs() < 1e-6);
}
