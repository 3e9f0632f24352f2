//! Robots that capture targets, and what sensors say of them.

use std::time::Duration;

use proptest::prelude::*;
use sextant_channel::{ObstacleField, Position};
use sextant_kernel::{SimTime, StationId};
use sextant_sim::{
    Application, Applications, AtEnd, Estimate, FieldId, Observer, Odometry, OdometryConfig, Port, Robot, RobotBody,
    Sensed, Setup, TargetId, Timer, World,
};

use super::setup;
use crate::network;
use crate::sensing::{discs, seconds, targets, way};

/// A node that writes down what its sensor says, or a robot that tries to capture what it can reach at some instants.
#[derive(Clone, Debug)]
enum Station {
    Watcher(Vec<(f64, Sensed)>),
    Hunter { tries_s: Vec<f64>, reach_m: f64, found: Vec<Vec<TargetId>>, drives_to: Option<Position> },
}

const TRY: Timer = Timer(0);

impl Application for Station {
    fn senses(&self) -> bool {
        true
    }

    fn started(&mut self, port: &mut Port<'_>) {
        if let Self::Hunter { tries_s, drives_to, .. } = self {
            for &at_s in &*tries_s {
                port.after(Duration::from_secs_f64(at_s), TRY);
            }
            if let Some(place) = *drives_to {
                port.drive(place);
            }
        }
    }

    fn timed(&mut self, _timer: Timer, port: &mut Port<'_>) {
        if let Self::Hunter { reach_m, found, .. } = self {
            let within = port.targets_within(*reach_m);
            let captured = port.capture(*reach_m);
            assert_eq!(captured, within);
            assert!(port.targets_within(*reach_m).is_empty() && port.capture(*reach_m).is_empty());
            found.push(captured);
        }
    }

    fn sensed(&mut self, sensed: &Sensed, port: &mut Port<'_>) {
        if let Self::Watcher(heard) = self {
            heard.push((port.now().as_secs_f64(), *sensed));
        }
    }
}

#[derive(Debug, Default, PartialEq)]
struct Notebook {
    moved: Vec<(TargetId, SimTime, Position)>,
    captured: Vec<(usize, TargetId, SimTime)>,
    gone: Vec<(TargetId, SimTime)>,
    robots: Vec<(usize, SimTime, Position)>,
    estimates: Vec<(StationId, SimTime, Estimate)>,
}

impl Observer for Notebook {
    fn target_moved(&mut self, target: TargetId, time: SimTime, position: Position) {
        self.moved.push((target, time, position));
    }

    fn captured(&mut self, robot: usize, target: TargetId, time: SimTime) {
        self.captured.push((robot, target, time));
    }

    fn target_gone(&mut self, target: TargetId, time: SimTime) {
        self.gone.push((target, time));
    }

    fn moved(&mut self, robot: usize, time: SimTime, position: Position) {
        self.robots.push((robot, time, position));
    }

    fn estimated(&mut self, station: StationId, time: SimTime, estimate: &Estimate) {
        self.estimates.push((station, time, *estimate));
    }
}

fn hunter(tries_s: &[f64], reach_m: f64) -> Station {
    Station::Hunter { tries_s: tries_s.to_vec(), reach_m, found: Vec::new(), drives_to: None }
}

fn hunt(setup: Setup, robot: Station) -> (Applications<Station>, Notebook) {
    let nodes = vec![Station::Watcher(Vec::new()); setup.world.nodes.len()];
    let own = Applications { nodes, robots: vec![robot], sinks: Vec::new() };
    let mut notebook = Notebook::default();
    let (_, own) = network::run_own(setup, own, &mut notebook);
    (own, notebook)
}

fn heard(own: &Applications<Station>, node: usize) -> &[(f64, Sensed)] {
    let Station::Watcher(heard) = &own.nodes[node] else { panic!("a node watches") };
    heard
}

fn found(own: &Applications<Station>) -> &[Vec<TargetId>] {
    let Station::Hunter { found, .. } = &own.robots[0] else { panic!("the robot hunts") };
    found
}

const FIRST: TargetId = TargetId(0);
const SECOND: TargetId = TargetId(1);

/// Two targets that go along the x axis at 1 m/s and 2 m/s, and nodes at 4, 10 and 30 m with a radius of 5 m.
fn two_walkers() -> World {
    let line = |speed| way(&[[0.0; 3], [100.0, 0.0, 0.0]], speed, AtEnd::Stay);
    World {
        nodes: network::nodes(&[4.0, 10.0, 30.0].map(|x_m| Position::new(x_m, 0.0, 0.0))),
        targets: targets(&[line(1.0), line(2.0)], &ObstacleField::default()),
        sensors: discs(5.0),
        ..World::default()
    }
}

#[test]
fn a_captured_target_leaves_the_sensors_at_once_and_is_never_sensed_again() {
    // The first target is 6 m from the start after 6 s: one metre from the robot. The second one is at 12 m.
    let (own, notebook) = hunt(setup(two_walkers(), &[[7.0, 0.0, 0.0]], &[], 60.0, 1), hunter(&[4.0, 6.0, 8.0], 1.5));
    // After 4 s the second one is at 8 m.
    assert_eq!(found(&own), [vec![SECOND], vec![FIRST], vec![]]);
    let (entered, left) = (Sensed::Entered, Sensed::Left);
    // Without the robot, the second one would leave the first node after 4.5 s, and the first one after 9 s.
    let first = [(0.0, entered(FIRST)), (0.0, entered(SECOND)), (4.0, left(SECOND)), (6.0, left(FIRST))];
    assert_eq!(heard(&own, 0), first);
    let second = [(2.5, entered(SECOND)), (4.0, left(SECOND)), (5.0, entered(FIRST)), (6.0, left(FIRST))];
    assert_eq!(heard(&own, 1), second);
    assert_eq!(heard(&own, 2), []);
    assert_eq!(notebook.captured, [(0, SECOND, seconds(4.0)), (0, FIRST, seconds(6.0))]);
    assert_eq!(notebook.gone, [(SECOND, seconds(4.0)), (FIRST, seconds(6.0))]);
    // The starts, and where they were captured; nothing at the end of the legs or of the time.
    let place = |x_m| Position::new(x_m, 0.0, 0.0);
    let starts = [(FIRST, seconds(0.0), place(0.0)), (SECOND, seconds(0.0), place(0.0))];
    assert_eq!(notebook.moved[..2], starts);
    assert_eq!(notebook.moved[2..], [(SECOND, seconds(4.0), place(8.0)), (FIRST, seconds(6.0), place(6.0))]);
    assert_eq!(notebook.robots[0], (0, seconds(0.0), place(7.0)));
}

#[test]
fn a_robot_touches_what_is_near_its_true_place() {
    // It believes to drive 8 m, and drives 10 m: it believes to be 2 m in front of the target that it touches.
    let mut setup = setup(two_walkers(), &[[0.0; 3]], &[], 60.0, 1);
    let stands = way(&[[10.0, 0.5, 0.0]], 1.0, AtEnd::Stay);
    setup.world.targets = targets(&[stands], &ObstacleField::default());
    let config = OdometryConfig { scale_error: 0.25, ..OdometryConfig::default() };
    let body =
        RobotBody { odometry: Odometry::try_from(config).expect("good settings"), ..setup.robots[0].body.clone() };
    setup.robots = vec![Robot { body, ..setup.robots[0].clone() }];
    let mut robot = hunter(&[20.0], 1.0);
    if let Station::Hunter { drives_to, .. } = &mut robot {
        *drives_to = Some(Position::new(8.0, 0.0, 0.0));
    }
    let (own, _) = hunt(setup, robot);
    assert_eq!(found(&own), [vec![FIRST]]);
}

fn place() -> impl Strategy<Value = [f64; 3]> {
    [-20.0..20.0, -20.0..20.0, -4.0..4.0_f64]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn sensors_say_what_they_said_without_the_capture_and_then_that_the_targets_left(
        nodes in proptest::collection::vec(place(), 1..20),
        ways in proptest::collection::vec((proptest::collection::vec(place(), 2..6), 0.3..9.0_f64), 1..4),
        radius_m in 1.0..12.0_f64,
        try_s in 0.5..39.5_f64,
        reach_m in 1.0..40.0_f64,
    ) {
        let none = ObstacleField::default();
        let motions: Vec<_> = ways.iter().map(|(places, speed)| way(places, *speed, AtEnd::Loop)).collect();
        let places: Vec<Position> = nodes.iter().copied().map(Position::from).collect();
        let world = World {
            nodes: network::nodes(&places), targets: targets(&motions, &none), sensors: discs(radius_m), ..World::default()
        };
        let run = |robot| hunt(setup(world.clone(), &[[0.0; 3]], &[], 40.0, 1), robot).0;
        let (free, hunted) = (run(hunter(&[], 1.0)), run(hunter(&[try_s], reach_m)));
        let captured = &found(&hunted)[0];
        // The true places at that instant, leg by leg.
        let time = seconds(try_s);
        for (number, target) in world.targets.iter().enumerate() {
            let mut course = target.course(sextant_kernel::Seed(1));
            let legs = std::iter::from_fn(|| course.next_leg(&none));
            let leg = legs.into_iter().find(|leg| leg.end > time).expect("it goes on for ever");
            let id = TargetId(u16::try_from(number).expect("few targets"));
            let distance_m = leg.at(time).length_m();
            if (distance_m - reach_m).abs() > 1e-6 {
                prop_assert_eq!(captured.contains(&id), distance_m < reach_m);
            }
        }
        for node in 0..nodes.len() {
            for number in 0..world.targets.len() {
                let id = TargetId(u16::try_from(number).expect("few targets"));
                let of_target = |heard: &[(f64, Sensed)]| -> Vec<(f64, bool)> {
                    let mine = |&(time, sensed): &(f64, Sensed)| match sensed {
                        Sensed::Entered(other) => (other == id).then_some((time, true)),
                        Sensed::Left(other) => (other == id).then_some((time, false)),
                        Sensed::Sampled { .. } => None,
                    };
                    heard.iter().filter_map(mine).collect()
                };
                let mut expected = of_target(heard(&free, node));
                if captured.contains(&id) {
                    expected.retain(|&(time, _)| time <= try_s);
                    if let Some((_, true)) = expected.last() {
                        expected.push((time.as_secs_f64(), false));
                    }
                }
                prop_assert_eq!(of_target(heard(&hunted, node)), expected);
            }
        }
    }
}

/// A robot that tells what it thinks.
struct Thinker;

const THOUGHTS: [Estimate; 3] = [
    Estimate::OwnPlace(Position::new(1.0, 2.0, 3.0)),
    Estimate::TargetPlace { target: TargetId(3), place: Position::ORIGIN },
    Estimate::FieldValue { field: FieldId(2), value: 0.5 },
];

impl Application for Thinker {
    fn started(&mut self, port: &mut Port<'_>) {
        THOUGHTS.into_iter().for_each(|thought| port.tell(thought));
        port.after(Duration::from_secs(2), Timer(0));
    }

    fn timed(&mut self, _timer: Timer, port: &mut Port<'_>) {
        port.tell(THOUGHTS[0]);
    }
}

#[test]
fn an_observer_is_told_what_an_application_works_out() {
    let own = Applications { nodes: Vec::new(), robots: vec![Thinker], sinks: Vec::new() };
    let setup = setup(World::default(), &[[0.0; 3]], &[], 60.0, 1);
    let mut notebook = Notebook::default();
    network::run_own(setup, own, &mut notebook);
    let robot = StationId(0);
    let at = |time, thought| (robot, seconds(time), thought);
    let [a, b, c] = THOUGHTS;
    assert_eq!(notebook.estimates, [at(0.0, a), at(0.0, b), at(0.0, c), at(2.0, a)]);
}
