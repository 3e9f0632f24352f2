//! Robots that drive straight, along arcs, halt, and listen and send while they drive, against geometry.

use std::f64::consts::{FRAC_PI_2, PI};
use std::time::Duration;

use sextant_channel::{
    BoxConfig, ChannelConfig, Dbm, Environment, Obstacle, ObstacleConfig, ObstacleField, Position, ShadowingConfig,
    ShapeConfig,
};
use sextant_kernel::{Files, SimTime};
use sextant_mac::csma::CsmaConfig;
use sextant_sim::{
    Application, CommandOutcome, Controller, Delivery, Destination, DriveEnd, Driving, Ending, FrameOutcome,
    Listening, Mac, Network, NetworkId, Observer, Payload, PeriodicConfig, Port, Pose, Robot, RobotBody,
    RobotCommand, RobotTask, Setup, Simulation, Situation, Timer, TrafficConfig, TrafficPlan, Unobserved,
};

use crate::network::{self, Ended};
use crate::on_air::Frames;

const NETWORK: NetworkId = NetworkId(0);

/// A command of a robot at the start.
#[derive(Clone, Copy, Debug)]
enum Command {
    Straight(Position),
    Arc { length_m: f64, turn_rad: f64 },
    Steer { span: Duration, turn_rate_rad_per_s: f64 },
}

/// What a robot of these tests does.
#[derive(Clone, Debug, Default)]
struct Driver {
    commands: Vec<Command>,
    listens: Option<Duration>,
    sends_at: Option<Duration>,
    halts: Halting,
    heard: Vec<u8>,
    ends: Vec<(SimTime, DriveEnd)>,
    poses: Vec<Pose>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Halting {
    #[default]
    Never,
    WhenItHears,
    At(Duration),
}

const START: Timer = Timer(0);
const SEND: Timer = Timer(1);
const HALT: Timer = Timer(2);

impl Driver {
    fn drive_on(&mut self, port: &mut Port<'_>) {
        self.poses.push(port.pose());
        while !self.commands.is_empty() {
            let driving = match self.commands.remove(0) {
                Command::Straight(place) => port.drive(place),
                Command::Arc { length_m, turn_rad } => port.drive_arc(length_m, turn_rad),
                Command::Steer { span, turn_rate_rad_per_s } => port.steer(span, turn_rate_rad_per_s),
            };
            match driving {
                Driving::UnderWay => return,
                Driving::Over(end) => self.ends.push((port.now(), end)),
            }
            self.poses.push(port.pose());
        }
    }
}

/// A station of these tests.
#[derive(Clone, Debug)]
enum Station {
    /// A node that sends a short frame to all at each interval.
    Beacon(Duration),
    /// A node that counts what it hears.
    Ear(u32),
    Robot(Driver),
}

impl Application for Station {
    fn hears(&self) -> bool {
        !matches!(self, Self::Beacon(_))
    }

    fn started(&mut self, port: &mut Port<'_>) {
        port.after(Duration::ZERO, START);
    }

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        match self {
            Self::Beacon(interval) => {
                port.send(NETWORK, Destination::All, Payload::Filler(20)).expect("the queue is empty");
                port.after(*interval, START);
            }
            Self::Ear(_) => {}
            Self::Robot(driver) if timer == START => {
                if let Some(span) = driver.listens {
                    port.listen(NETWORK, span);
                }
                if let Some(span) = driver.sends_at {
                    port.after(span, SEND);
                }
                if let Halting::At(span) = driver.halts {
                    port.after(span, HALT);
                }
                driver.drive_on(port);
            }
            Self::Robot(_) if timer == SEND => {
                port.send(NETWORK, Destination::All, Payload::Filler(20)).expect("the queue is empty");
            }
            Self::Robot(driver) => {
                port.halt();
                driver.drive_on(port);
            }
        }
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        match self {
            Self::Beacon(_) => {}
            Self::Ear(count) => *count += 1,
            Self::Robot(driver) => {
                driver.heard.push(delivery.sequence);
                if driver.halts == Halting::WhenItHears {
                    port.halt();
                    driver.drive_on(port);
                }
            }
        }
    }

    fn drive_ended(&mut self, end: DriveEnd, port: &mut Port<'_>) {
        if let Self::Robot(driver) = self {
            driver.ends.push((port.now(), end));
            driver.drive_on(port);
        }
    }
}

/// A channel without shadowing, and a hard radius of communication of 5 m.
fn hard_range() -> ChannelConfig {
    ChannelConfig {
        environment: Some(Environment::Suburban),
        shadowing: Some(ShadowingConfig { sigma_db: Some(0.0), ..ShadowingConfig::default() }),
        max_range_m: Some(5.0),
        ..ChannelConfig::default()
    }
}

fn field(obstacles: Vec<ObstacleConfig>) -> ObstacleField {
    let read = |obstacle| Obstacle::read(obstacle, &Files::default()).expect("a good obstacle");
    ObstacleField::new(obstacles.into_iter().map(read).collect())
}

/// A wall whose near face is at x = 4 m.
fn wall() -> ObstacleConfig {
    ObstacleConfig::absorbing(ShapeConfig::Box(BoxConfig::new(Position::new(5.0, 0.0, 0.0), [2.0, 8.0, 4.0])), 1.0)
}

/// Nodes at places, with their applications, and one robot.
struct Scene {
    nodes: Vec<(Position, Station)>,
    robot: RobotBody,
    driver: Driver,
    obstacles: ObstacleField,
    end: Duration,
}

impl Scene {
    /// A robot alone that obeys `commands`.
    fn of(commands: &[Command]) -> Self {
        let driver = Driver { commands: commands.to_vec(), ..Driver::default() };
        let end = Duration::from_secs(100);
        Self { nodes: Vec::new(), robot: network::surveyor_body(), driver, obstacles: ObstacleField::default(), end }
    }

    fn run(self, observer: &mut impl Observer) -> (Driver, Ended<Station>) {
        let (places, mut applications): (Vec<_>, Vec<_>) = self.nodes.into_iter().unzip();
        let traffic = TrafficConfig::Beacon(PeriodicConfig::each(20, 1.0, 0.0));
        let mut setup = network::setup(&places, 0.0, hard_range(), traffic, 3);
        setup.world.obstacles = self.obstacles;
        applications.push(Station::Robot(self.driver));
        let mut link = setup.networks.remove(0);
        let csma = CsmaConfig { rx_on_when_idle: true, ..CsmaConfig::default() };
        network::ieee802154(&mut link).mac = Mac::CsmaUnslotted(csma.try_into().expect("good settings"));
        let setup = Setup {
            robots: network::own_robots([self.robot]),
            duration: Some(self.end),
            ..Setup::of(setup.world, Network { traffic: TrafficPlan::silent(places.len()), ..link }, setup.seed)
        };
        let ended = network::run_watched(setup, applications, observer);
        let driver = match ended.applications.last() {
            Some(Station::Robot(driver)) => driver.clone(),
            _ => panic!("the robot is the last station"),
        };
        (driver, ended)
    }
}

fn at(seconds: f64) -> SimTime {
    SimTime::ZERO + Duration::from_secs_f64(seconds)
}

fn assert_near(found: Position, expected: [f64; 3], within_m: f64) {
    assert!(found.distance_m(expected.into()) <= within_m, "{found}, not {expected:?}");
}

/// Where the robot was, as the observer is told.
#[derive(Default)]
struct Trace {
    moved: Vec<(SimTime, Position)>,
    curved: Vec<(SimTime, Pose)>,
}

impl Observer for Trace {
    fn moved(&mut self, _robot: usize, time: SimTime, position: Position) {
        self.moved.push((time, position));
    }

    fn curved(&mut self, _robot: usize, time: SimTime, pose: Pose) {
        self.curved.push((time, pose));
    }
}

#[test]
fn a_robot_drives_a_circle_and_a_straight_line() {
    // A circle of radius 2 m to the right, then 3 s at a quarter turn to the left, then straight on.
    let half_turn_rate = FRAC_PI_2 / 3.0;
    let (driver, ended) = Scene::of(&[
        Command::Arc { length_m: 4.0 * PI, turn_rad: -2.0 * PI },
        Command::Steer { span: Duration::from_secs(3), turn_rate_rad_per_s: half_turn_rate },
        Command::Straight(Position::new(0.0, 0.0, 0.0)),
        Command::Arc { length_m: 0.0, turn_rad: FRAC_PI_2 },
    ])
    .run(&mut Unobserved);
    let radius = 1.0 / half_turn_rate;
    let places: Vec<Position> = driver.poses.iter().map(|pose| pose.position).collect();
    for (place, expected) in places.iter().zip([[0.0; 3], [0.0; 3], [radius, radius, 0.0], [0.0; 3], [0.0; 3]]) {
        assert_near(*place, expected, 1e-9);
    }
    let back_m = radius * 2_f64.sqrt();
    let ends: Vec<f64> = driver.ends.iter().map(|(time, _)| time.as_secs_f64()).collect();
    for (found, expected) in
        ends.iter().zip([4.0 * PI, 4.0 * PI + 3.0, 4.0 * PI + 3.0 + back_m, 4.0 * PI + 3.0 + back_m])
    {
        assert!((found - expected).abs() < 1e-8, "{ends:?}");
    }
    assert!(driver.ends.iter().all(|(_, end)| *end == DriveEnd::Arrived));
    assert!((ended.robots[0].path_length_m - ends[2]).abs() < 1e-8);
    // It looked back along the diagonal, and turned by a quarter on the spot.
    assert!((driver.poses[4].heading_rad - (-0.75 * PI + FRAC_PI_2)).abs() < 1e-9);
}

#[test]
fn a_robot_on_an_arc_stops_in_front_of_an_obstacle() {
    // The hull of 0.25 m on a circle of 5 m around (0, 5) touches the wall where x = 3.75 m.
    let arc = Command::Arc { length_m: 20.0, turn_rad: 4.0 };
    let (driver, ended) = Scene { obstacles: field(vec![wall()]), ..Scene::of(&[arc]) }.run(&mut Unobserved);
    let turn_rad = 0.75_f64.asin();
    let [(time, DriveEnd::Blocked(contact))] = driver.ends[..] else { panic!("{:?}", driver.ends) };
    let place = driver.poses[1].position;
    let gap_m = 3.75 - place.x_m;
    assert!((0.0..2e-3).contains(&gap_m), "{gap_m} m");
    assert!((place.distance_m(Position::new(0.0, 5.0, 0.0)) - 5.0).abs() < 1e-9, "{place} on the circle");
    assert_near(contact, [4.0, place.y_m, 0.0], 3e-3);
    assert!(contact.x_m >= 4.0 - 1e-9 - 5e-4, "{contact} on the wall");
    let driven_m = 5.0 * turn_rad;
    assert!((0.0..4e-3).contains(&(driven_m - ended.robots[0].path_length_m)), "{:?}", ended.robots[0].path_length_m);
    assert!((time.as_secs_f64() - ended.robots[0].path_length_m).abs() < 1e-6);
    // An arc that turns away in time passes the wall.
    let tight = Command::Arc { length_m: 3.7 * FRAC_PI_2, turn_rad: FRAC_PI_2 };
    let (driver, _) = Scene { obstacles: field(vec![wall()]), ..Scene::of(&[tight]) }.run(&mut Unobserved);
    assert_eq!(driver.ends[0].1, DriveEnd::Arrived);
    assert_near(driver.poses[1].position, [3.7, 3.7, 0.0], 1e-9);
}

#[test]
fn an_observer_sees_an_arc_every_five_degrees_and_a_straight_line_at_its_ends() {
    let mut trace = Trace::default();
    let quarter = Command::Arc { length_m: PI, turn_rad: FRAC_PI_2 };
    Scene::of(&[Command::Straight(Position::new(7.0, 0.0, 0.0)), quarter]).run(&mut trace);
    let times: Vec<SimTime> = trace.moved.iter().map(|&(time, _)| time).collect();
    // A robot with an application of its own is where it starts, too.
    assert_eq!(times, [at(0.0), at(0.0), at(7.0)]);
    assert_eq!(trace.curved.len(), 19);
    for (i, (time, pose)) in trace.curved.iter().enumerate() {
        let turn_rad = FRAC_PI_2 * i as f64 / 18.0;
        assert_near(pose.position, [7.0 + 2.0 * turn_rad.sin(), 2.0 - 2.0 * turn_rad.cos(), 0.0], 1e-7);
        assert!((pose.heading_rad - turn_rad).abs() < 1e-7);
        assert!((time.as_secs_f64() - 7.0 - 2.0 * turn_rad).abs() < 1e-7);
    }
}

#[test]
fn a_robot_that_halts_is_where_it_was_at_that_time() {
    for (command, place, heading_rad) in [
        (Command::Straight(Position::new(8.0, 0.0, 0.0)), [2.5, 0.0, 0.0], 0.0),
        (Command::Arc { length_m: 10.0, turn_rad: 4.0 }, [2.5 * 1_f64.sin(), 2.5 * (1.0 - 1_f64.cos()), 0.0], 1.0),
    ] {
        let mut scene = Scene::of(&[command, Command::Straight(Position::ORIGIN)]);
        scene.driver.halts = Halting::At(Duration::from_millis(2500));
        let mut trace = Trace::default();
        let (driver, ended) = scene.run(&mut trace);
        assert_near(driver.poses[1].position, place, 1e-9);
        let back_m = Position::from(place).distance_m(Position::ORIGIN);
        // Only the way back ends by itself.
        let [(end, DriveEnd::Arrived)] = driver.ends[..] else { panic!("{:?}", driver.ends) };
        assert!((end.as_secs_f64() - 2.5 - back_m).abs() < 1e-8);
        assert!((ended.robots[0].path_length_m - 2.5 - back_m).abs() < 1e-9);
        assert_near(trace.moved[trace.moved.len() - 1].1, [0.0; 3], 1e-9);
        assert!((driver.poses[1].heading_rad - heading_rad).abs() < 1e-9);
        // Nothing is told of the rest of an arc that was halted.
        assert!(trace.curved.iter().all(|(time, _)| *time <= at(2.5)));
    }
    // An obstacle that was not reached is not met.
    let mut scene =
        Scene { obstacles: field(vec![wall()]), ..Scene::of(&[Command::Straight(Position::new(9.0, 0.0, 0.0))]) };
    scene.driver.halts = Halting::At(Duration::from_secs(1));
    let (driver, ended) = scene.run(&mut Unobserved);
    assert_eq!((driver.ends.len(), ended.log().contacts().len()), (0, 0));
    assert_near(driver.poses[1].position, [1.0, 0.0, 0.0], 1e-9);
}

#[test]
fn what_a_robot_has_driven_at_the_end_of_the_simulation_counts() {
    let arc = Command::Arc { length_m: 10.0, turn_rad: 4.0 };
    let mut trace = Trace::default();
    let (driver, ended) = Scene { end: Duration::from_millis(2500), ..Scene::of(&[arc]) }.run(&mut trace);
    assert!((ended.robots[0].path_length_m - 2.5).abs() < 1e-9 && driver.ends.is_empty());
    let (time, pose) = trace.curved[trace.curved.len() - 1];
    assert_eq!(time, at(2.5));
    assert_near(pose.position, [2.5 * 1_f64.sin(), 2.5 * (1.0 - 1_f64.cos()), 0.0], 1e-9);
}

/// The frames of nodes on air: first symbol, sequence number, power at the robot if it received the frame.
fn frames() -> Frames<(SimTime, u8, Option<Dbm>)> {
    Frames::kept(|frame| (frame.start, frame.bytes[2], frame.heard.first().map(|heard| heard.power)))
}

#[test]
fn a_robot_that_passes_a_node_hears_exactly_the_frames_that_begin_in_range() {
    // The way of 30 m at 0.75 m/s passes 3 m beside the node: a chord of 8 m is within 5 m of it.
    let node = Position::new(15.0, 3.0, 0.0);
    let speed_m_per_s = 0.75;
    let mut scene = Scene::of(&[Command::Straight(Position::new(30.0, 0.0, 0.0))]);
    scene.nodes = vec![(node, Station::Beacon(Duration::from_millis(70)))];
    scene.robot.speed_m_per_s = speed_m_per_s;
    scene.driver.listens = Some(Duration::from_secs(40));
    scene.end = Duration::from_secs(41);
    let mut frames = frames();
    let (driver, _) = scene.run(&mut frames);
    let in_range = |time: SimTime| (11.0..=19.0).contains(&(speed_m_per_s * time.as_secs_f64()));
    let expected: Vec<u8> = frames.0.iter().filter(|frame| in_range(frame.0)).map(|frame| frame.1).collect();
    assert_eq!(driver.heard, expected);
    // 8 m at 0.75 m/s last 152.4 intervals of 70 ms.
    assert!((151..=154).contains(&expected.len()) && frames.0.len() > 500, "{} frames", expected.len());
    // The power is that of the distance at the start of the frame. Two powers give the constant and the exponent.
    let heard: Vec<(f64, f64)> = (frames.0.iter())
        .filter_map(|&(start, _, power)| {
            let place = Position::new(speed_m_per_s * start.as_secs_f64(), 0.0, 0.0);
            Some((10.0 * place.distance_m(node).log10(), power?.0))
        })
        .collect();
    let (first, middle) = (heard[0], heard[heard.len() / 2]);
    let exponent = (middle.1 - first.1) / (first.0 - middle.0);
    for (decades, power) in &heard {
        assert!((power - (first.1 - exponent * (decades - first.0))).abs() < 1e-6, "{power} dBm");
    }
    assert!(exponent > 2.0 && exponent < 4.0, "{exponent}");
}

#[test]
fn a_robot_on_an_arc_hears_exactly_the_frames_that_begin_in_range() {
    // A full circle of radius 4 m around (0, 4); the node stands 3 m above its top, so 5 m are reached on an arc there.
    let node = Position::new(0.0, 11.0, 0.0);
    let mut scene = Scene::of(&[Command::Arc { length_m: 8.0 * PI, turn_rad: 2.0 * PI }]);
    scene.nodes = vec![(node, Station::Beacon(Duration::from_millis(50)))];
    scene.driver.listens = Some(Duration::from_secs(26));
    scene.end = Duration::from_secs(27);
    let mut frames = frames();
    let (driver, _) = scene.run(&mut frames);
    // Law of cosines with the centre 7 m from the node: 25 = 16 + 49 - 56 cos a.
    let reach_rad = (40.0_f64 / 56.0).acos();
    let in_range = |time: SimTime| (time.as_secs_f64() / 4.0 - PI).abs() <= reach_rad;
    let expected: Vec<u8> = frames.0.iter().filter(|frame| in_range(frame.0)).map(|frame| frame.1).collect();
    assert_eq!(driver.heard, expected);
    assert!((123..=126).contains(&expected.len()), "{} frames in 6.2 s", expected.len());
}

#[test]
fn a_robot_halts_when_it_hears_a_node() {
    let node = Position::new(20.0, 0.0, 0.0);
    let mut scene = Scene::of(&[Command::Straight(node)]);
    scene.nodes = vec![(node, Station::Beacon(Duration::from_millis(100)))];
    scene.driver.listens = Some(Duration::from_secs(30));
    scene.driver.halts = Halting::WhenItHears;
    let mut frames = frames();
    let (driver, ended) = scene.run(&mut frames);
    let first = frames.0.iter().find(|frame| frame.2.is_some()).expect("it heard the node").0;
    assert!(first >= at(15.0) && first < at(15.12), "{first:?}");
    // A frame of 20 octets takes 832 us.
    let halted_m = first.as_secs_f64() + 832e-6;
    assert_near(driver.poses[1].position, [halted_m, 0.0, 0.0], 1e-8);
    assert!((ended.robots[0].path_length_m - halted_m).abs() < 1e-8 && driver.ends.is_empty());
}

#[test]
fn a_robot_sends_from_where_it_is_while_it_drives_and_listens() {
    // The node at x = 20 m is reached from x = 15 m on.
    for (seconds, heard) in [(14.9, 0), (15.01, 1)] {
        let mut scene = Scene::of(&[Command::Straight(Position::new(20.0, 0.0, 0.0))]);
        scene.nodes = vec![(Position::new(20.0, 0.0, 0.0), Station::Ear(0))];
        scene.driver.listens = Some(Duration::from_secs(30));
        scene.driver.sends_at = Some(Duration::from_secs_f64(seconds));
        let mut outcomes = Frames::kept(|frame| frame.outcome);
        let (driver, ended) = scene.run(&mut outcomes);
        assert!(matches!(ended.applications[0], Station::Ear(count) if count == heard), "at {seconds} s");
        let is_received: Vec<bool> = outcomes.0.iter().map(|outcome| *outcome == FrameOutcome::Received).collect();
        assert_eq!(is_received, [heard > 0]);
        assert_eq!(driver.ends, [(at(20.0), DriveEnd::Arrived)]);
    }
}

/// Drives half a circle, listens at its end, and drives straight to the wall.
#[derive(Clone)]
struct Bend(u32);

impl Controller for Bend {
    fn decide(&mut self, situation: &Situation<'_>) -> RobotCommand {
        self.0 += 1;
        match (self.0, situation.outcome) {
            (1, CommandOutcome::Started) => RobotCommand::DriveArc { length_m: 2.0 * PI, turn_rad: PI },
            (2, CommandOutcome::Arrived) => RobotCommand::Listen,
            (3, CommandOutcome::Listened(_)) => RobotCommand::Drive(Position::new(9.0, 4.0, 0.0)),
            (4, CommandOutcome::Blocked(contact)) => {
                assert_near(contact, [4.0, 4.0, 0.0], 2e-3);
                RobotCommand::Finish(Ending::Complete)
            }
            (_, outcome) => panic!("{outcome:?}"),
        }
    }
}

#[test]
fn a_survey_listens_in_equal_slots_while_it_drives() {
    let body = RobotBody {
        listen: Duration::from_secs(2),
        listening: Listening::AlsoWhileDriving,
        ..network::surveyor_body()
    };
    let traffic = TrafficConfig::Beacon(PeriodicConfig::each(20, 0.1, 0.0));
    let mut setup: Setup = network::setup(&[Position::new(0.0, 2.0, 0.0)], 0.0, hard_range(), traffic, 5);
    setup.world.obstacles = field(vec![wall()]);
    setup.robots = vec![Robot { body, task: RobotTask::Survey(Box::new(Bend(0))) }];
    let survey = Simulation::new(setup).expect("good settings").run(&mut Unobserved);
    let stops = survey.log().stops();
    // Half a circle of radius 2 m around (0, 2) in 6.28 s: three slots, at 30, 90 and 150 degrees. Then a stop of 2 s.
    // Then 3.75 m in one slot.
    let slot = 2.0 * PI / 3.0;
    let root = 3_f64.sqrt();
    let expected = [
        (0.0, [1.0, 2.0 - root, 0.0]),
        (slot, [2.0, 2.0, 0.0]),
        (2.0 * slot, [1.0, 2.0 + root, 0.0]),
        (3.0 * slot, [0.0, 4.0, 0.0]),
        (3.0 * slot + 2.0, [0.5 * 3.749, 4.0, 0.0]),
    ];
    assert_eq!(stops.len(), expected.len());
    for (stop, (time_s, place)) in stops.iter().zip(expected) {
        assert!((stop.time.as_secs_f64() - time_s).abs() < 1e-6, "{stop:?}");
        assert_near(stop.position, place, 1e-6);
    }
    assert!((survey.robots[0].path_length_m - 2.0 * PI - 3.749).abs() < 1e-6);
    assert_eq!((survey.log().contacts().len(), survey.robots[0].stops), (1, 5));
    // The node is always within 5 m, and sends every 0.1 s.
    let received: u32 = survey.log().receptions().iter().map(|reception| reception.received).sum();
    let span_s = survey.end.as_secs_f64();
    assert!((f64::from(received) - span_s / 0.1).abs() < 8.0, "{received} in {span_s} s");
    assert_eq!(survey.robots[0].packets, [received]);
}

#[test]
fn a_drive_shorter_than_a_slot_is_driven_without_listening() {
    let traffic = TrafficConfig::Beacon(PeriodicConfig::each(20, 0.1, 0.0));
    let places = vec![Position::new(1.5, 0.0, 0.0), Position::new(5.5, 0.0, 0.0)];
    let mut robot = network::tour(places, 0.25, Duration::from_secs(2));
    robot.body.listening = Listening::AlsoWhileDriving;
    let mut setup = network::setup(&[Position::new(0.0, 2.0, 0.0)], 0.0, hard_range(), traffic, 5);
    setup.robots = vec![robot];
    let survey = Simulation::new(setup).expect("good settings").run(&mut Unobserved);
    let stops: Vec<(SimTime, f64)> = survey.log().stops().iter().map(|stop| (stop.time, stop.position.x_m)).collect();
    // 1.5 s of driving, a stop of 2 s, two slots of 2 s on the way of 4 m, a stop.
    assert_eq!(stops, [(at(1.5), 1.5), (at(3.5), 2.5), (at(5.5), 4.5), (at(7.5), 5.5)]);
}
