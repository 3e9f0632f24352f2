//! Robots that send messages at their stops instead of surveying, to nodes with applications of their own.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::SimTime;
use sextant_sim::{
    Application, Applications, Broadcast, Delivery, Ending, Listening, Network, PeriodicConfig, Port, Pose, Robot,
    RobotBody, Setup, SilentConfig, Simulation, Survey, TrafficConfig, Unobserved, World,
};

use crate::{broadcasts, network};

/// Says at which x it is (m), and counts its stops; the last one has no message.
#[derive(Clone)]
struct Place {
    stops_left: u32,
}

impl Broadcast for Place {
    fn message(&mut self, pose: &Pose, _now: SimTime) -> Option<Vec<u8>> {
        self.stops_left = self.stops_left.checked_sub(1)?;
        Some(pose.position.x_m.to_be_bytes().to_vec())
    }
}

/// Notes when it hears a message, and the place in it (m).
#[derive(Default)]
struct Ear {
    heard: Vec<(SimTime, f64)>,
    /// The sector of each frame, and its signal-to-noise ratio (dB).
    sectors: Vec<(Option<u8>, f64)>,
    station: Option<u32>,
}

impl Application for Ear {
    fn hears(&self) -> bool {
        true
    }

    fn started(&mut self, port: &mut Port<'_>) {
        self.station = Some(port.station().0);
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        let place = delivery.payload.try_into().map(f64::from_be_bytes).expect("a place");
        self.heard.push((port.now(), place));
        self.sectors.push((delivery.sector, delivery.snr.map_or(0.0, |snr| snr.0)));
    }
}

/// Nodes at 0 and 20 m that send `traffic`, and a robot that drives at 1 m/s from 0 to 4 m and stops there for 1 s.
fn setup(broadcast: Option<Box<dyn Broadcast>>, listening: Listening, traffic: TrafficConfig) -> Setup {
    let places = [Position::new(0.0, 1.0, 0.0), Position::new(20.0, 0.0, 0.0)];
    let robot = network::tour(vec![Position::ORIGIN, Position::new(4.0, 0.0, 0.0)], 0.25, Duration::from_secs(1));
    let body = RobotBody { sweeps_per_stop: 2, listening, ..robot.body };
    let robot = Robot { body, ..robot };
    let robot = match broadcast {
        Some(broadcast) => robot.with_broadcast(broadcast),
        None => robot,
    };
    let link = network::link(10.0, network::prompt());
    let nodes = network::nodes(&places);
    Setup {
        robots: vec![robot],
        ..Setup::of(
            World { nodes, ..World::default() },
            Network { traffic: network::plan(traffic, places.len()), ..link },
            sextant_kernel::Seed(1),
        )
    }
}

const SILENT: TrafficConfig = TrafficConfig::Silent(SilentConfig {});

fn ears() -> Applications<Ear> {
    Applications::of_nodes(vec![Ear::default(), Ear::default()])
}

fn run(stops_left: u32, listening: Listening) -> (Survey, Vec<Ear>) {
    let setup = setup(Some(Box::new(Place { stops_left })), listening, SILENT);
    assert!(setup.surveyed().len() == 1 && !setup.robots[0].is_surveying());
    let (survey, Applications { nodes, .. }) = network::run_own(setup, ears(), &mut Unobserved);
    (survey, nodes)
}

/// The instants of `heard`, in hundredths of a second, and the places.
fn rounded(heard: &[(SimTime, f64)]) -> Vec<(u64, f64)> {
    heard.iter().map(|&(time, place)| (time.as_nanos() / 10_000_000, place)).collect()
}

#[test]
fn a_mobile_anchor_sends_its_place_twice_a_stop_in_equal_intervals_and_logs_no_stop() {
    let (survey, nodes) = run(9, Listening::AtStops);
    // It stops in [0, 1) s and, after 4 m at 1 m/s, in [5, 6) s.
    assert_eq!(rounded(&nodes[0].heard), [(0, 0.0), (50, 0.0), (500, 4.0), (550, 4.0)]);
    assert_eq!(nodes[1].heard, []);
    assert_eq!((nodes[0].station, nodes[1].station), (Some(0), Some(1)));
    let robot = &survey.robots[0];
    assert_eq!((robot.stops, robot.ending, &robot.packets[..]), (2, Some(Ending::Complete), &[0, 0][..]));
    assert_eq!(survey.end, SimTime::ZERO + Duration::from_secs(6));
    assert!(survey.log().stops().is_empty() && survey.logs.iter().count() == 1);
    let sent = survey.networks[0].packets[2];
    assert_eq!((sent.offered, sent.received), (4, 4));
}

#[test]
fn a_broadcast_without_a_message_ends_the_task() {
    let (survey, nodes) = run(1, Listening::AtStops);
    assert_eq!(rounded(&nodes[0].heard), [(0, 0.0), (50, 0.0)]);
    let robot = &survey.robots[0];
    assert_eq!((robot.stops, robot.ending), (1, Some(Ending::Complete)));
    assert_eq!(survey.end, SimTime::ZERO + Duration::from_secs(5));
}

#[test]
fn on_a_drive_the_place_is_that_of_the_mean_instant_of_sending() {
    let (survey, nodes) = run(9, Listening::AlsoWhileDriving);
    // Four slots of 1 s on the drive, whose two frames go at the start and in the middle: a quarter of a metre on.
    let on_the_way = [(100, 0.25), (150, 0.25), (200, 1.25), (250, 1.25), (300, 2.25), (350, 2.25)];
    let expected = [&[(0, 0.0), (50, 0.0)][..], &on_the_way, &[(400, 3.25), (450, 3.25), (500, 4.0), (550, 4.0)]];
    assert_eq!(rounded(&nodes[0].heard), expected.concat());
    assert_eq!(survey.robots[0].stops, 6);
}

#[test]
fn a_broadcast_that_ends_on_a_drive_stops_the_robot_there() {
    let (survey, _) = run(3, Listening::AlsoWhileDriving);
    // A stop, two slots of the drive, and no message for the third.
    assert_eq!(survey.end, SimTime::ZERO + Duration::from_secs(3));
    assert!((survey.robots[0].path_length_m - 2.0).abs() < 1e-9, "{}", survey.robots[0].path_length_m);
}

#[test]
fn traffic_beside_applications_of_nodes_is_refused() {
    let periodic = PeriodicConfig::each(20, 1.0, 0.0);
    let refused = |name: Option<&str>| {
        let mut setup = setup(None, Listening::AtStops, TrafficConfig::Periodic(periodic.clone()));
        setup.networks[0].name = name.map(str::to_owned);
        network::lend(setup, &mut ears()).err().expect("refused").key
    };
    assert_eq!(refused(None), "traffic");
    assert_eq!(refused(Some("ground")), "networks.ground.traffic");
}

#[test]
fn frames_to_a_robot_do_not_go_to_a_mobile_anchor() {
    let acknowledged = PeriodicConfig { acknowledged: true, ..PeriodicConfig::each(20, 1.0, 0.0) };
    let with = |broadcast| {
        let setup = setup(broadcast, Listening::AtStops, TrafficConfig::Periodic(acknowledged.clone()));
        Simulation::new(setup).err().map(|error| error.key)
    };
    assert_eq!(with(None), None);
    let anchor: Box<dyn Broadcast> = Box::new(Place { stops_left: 1 });
    assert_eq!(with(Some(anchor)).as_deref(), Some("traffic.periodic.acknowledged"));
}

#[test]
fn a_mobile_anchor_with_sectors_sends_from_each_of_them_and_the_best_one_points_at_the_node() {
    let mut setup = setup(Some(Box::new(Place { stops_left: 9 })), Listening::AtStops, SILENT);
    setup.networks[0] = broadcasts::link(broadcasts::EIGHT);
    let (survey, Applications { nodes, .. }) = network::run_own(setup, ears(), &mut Unobserved);
    let best_at = |x_m: f64| {
        let frames =
            nodes[0].heard.iter().zip(&nodes[0].sectors).filter(|((_, place), _)| (place - x_m).abs() < 1e-9);
        frames.max_by(|(_, a), (_, b)| a.1.total_cmp(&b.1)).and_then(|(_, frame)| frame.0)
    };
    // Sectors are 45 degrees apart. The node is at 90 degrees from the first stop, at 166 from the second.
    assert_eq!((best_at(0.0), best_at(4.0)), (Some(2), Some(4)));
    let robot = &survey.robots[0];
    assert_eq!((robot.stops, robot.ending), (2, Some(Ending::Complete)));
    assert_eq!(survey.end, SimTime::ZERO + Duration::from_secs(6));
    let sent = survey.networks[0].packets[2];
    // Two stops, two broadcasts each, from all eight sectors.
    assert_eq!((sent.offered, sent.received, sent.transmissions), (4, 4, 4));
    assert!(survey.log().stops().is_empty());
}
