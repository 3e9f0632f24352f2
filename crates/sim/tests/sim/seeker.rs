//! A robot that drives to the strongest node that it hears, without knowing where it is.

use std::collections::BTreeMap;
use std::time::Duration;

use proptest::prelude::*;
use sextant_channel::{BoxConfig, Dbm, Obstacle, ObstacleConfig, ObstacleField, Position, Reception, ShapeConfig};
use sextant_kernel::{NodeId, SimTime};
use sextant_sim::{
    Application, Delivery, Destination, DriveEnd, Driving, NetworkId, Payload, Port, Setup, Timer, World,
};

use crate::network::{self, Ended};
use crate::scripted::NETWORK;

const STEP_M: f64 = 1.0;
const LISTEN: Duration = Duration::from_millis(600);
/// Nodes send this often, so that each is heard at each stop.
const INTERVAL: Duration = Duration::from_millis(200);

const CALL: Timer = Timer(0);

/// "Here I am", the letter H and the number of the node (two octets, most significant first).
fn encode(node: u16) -> [u8; 3] {
    let [high, low] = node.to_be_bytes();
    [b'H', high, low]
}

fn decode(octets: &[u8]) -> Option<u16> {
    match *octets {
        [b'H', high, low] => Some(u16::from_be_bytes([high, low])),
        _ => None,
    }
}

/// A robot that tries steps in four directions, and keeps those after which it hears the strongest node better. It
/// has finished when no direction is better.
#[derive(Default)]
struct Seeker {
    /// Sum of powers (dBm) and number of frames of each node at this stop.
    heard: BTreeMap<u16, (f64, u32)>,
    listening_since: SimTime,
    stops: u32,
    /// The strongest node at the best stop so far.
    best: Option<(u16, Dbm)>,
    /// Where the best stop was.
    base: Position,
    direction: usize,
    failures: u32,
    goes_back: bool,
}

/// The four directions, counterclockwise.
const DIRECTIONS: [[f64; 3]; 4] = [[STEP_M, 0.0, 0.0], [0.0, STEP_M, 0.0], [-STEP_M, 0.0, 0.0], [0.0, -STEP_M, 0.0]];

impl Seeker {
    fn listen(&mut self, port: &mut Port<'_>) {
        self.listening_since = port.now();
        port.listen(NETWORK, LISTEN);
    }

    fn try_next(&mut self, port: &mut Port<'_>) {
        if self.failures == 4 {
            port.finish();
            return;
        }
        match port.drive(self.base + Position::from(DIRECTIONS[self.direction])) {
            Driving::UnderWay => {}
            Driving::Over(end) => self.arrive(end, port),
        }
    }

    fn fail(&mut self, port: &mut Port<'_>) {
        self.failures += 1;
        self.direction = (self.direction + 1) % 4;
        self.goes_back = true;
        match port.drive(self.base) {
            Driving::UnderWay => {}
            Driving::Over(end) => self.arrive(end, port),
        }
    }

    fn arrive(&mut self, end: DriveEnd, port: &mut Port<'_>) {
        match end {
            _ if std::mem::take(&mut self.goes_back) => self.try_next(port),
            DriveEnd::Arrived => self.listen(port),
            DriveEnd::Blocked(_) => self.fail(port),
        }
    }
}

impl Seeker {
    fn choose(&mut self, port: &mut Port<'_>) {
        self.stops += 1;
        let heard = std::mem::take(&mut self.heard);
        let mean = |(&node, &(sum_dbm, frames)): (&u16, &(f64, u32))| (node, Dbm(sum_dbm / f64::from(frames)));
        let receptions = heard.iter().map(|(&node, &(sum_dbm, frames))| Reception {
            rssi_dbm: Some(sum_dbm / f64::from(frames)),
            ..Reception::heard(NodeId(node.into()), 0, frames, frames)
        });
        port.log_stop(NetworkId(0), self.listening_since, port.pose().position, receptions.collect::<Vec<_>>());
        let strongest = heard.iter().map(mean).max_by(|a, b| a.1.0.total_cmp(&b.1.0));
        // Means of equal powers differ by rounding.
        let is_better = match (strongest, self.best) {
            (Some((_, rssi)), Some((_, best))) => rssi.0 > best.0 + 1e-6,
            (strongest, _) => strongest.is_some(),
        };
        if is_better {
            self.best = strongest;
            self.base = port.pose().position;
            self.failures = 0;
            self.try_next(port);
        } else {
            self.fail(port);
        }
    }
}

/// A node that calls, or the robot.
enum Station {
    Caller,
    Seeker(Seeker),
}

impl Application for Station {
    fn hears(&self) -> bool {
        matches!(self, Self::Seeker(_))
    }

    fn has_task(&self) -> bool {
        matches!(self, Self::Seeker(_))
    }

    fn started(&mut self, port: &mut Port<'_>) {
        match self {
            Self::Caller => {
                port.after(INTERVAL.mul_f64(port.uniform(0)), CALL);
            }
            Self::Seeker(seeker) => {
                seeker.base = port.pose().position;
                seeker.listen(port);
            }
        }
    }

    fn timed(&mut self, call: Timer, port: &mut Port<'_>) {
        let node = u16::try_from(port.station().0).expect("a small network");
        port.send(NETWORK, Destination::All, Payload::Octets(&encode(node))).expect("the link is idle");
        port.after(INTERVAL, call);
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, _port: &mut Port<'_>) {
        if let Self::Seeker(seeker) = self {
            let node = decode(delivery.payload).expect("a call");
            let (sum_dbm, frames) = seeker.heard.entry(node).or_default();
            *sum_dbm += delivery.rssi.0;
            *frames += 1;
        }
    }

    fn drive_ended(&mut self, end: DriveEnd, port: &mut Port<'_>) {
        if let Self::Seeker(seeker) = self {
            if let DriveEnd::Blocked(place) = end {
                port.log_contact(port.now(), place);
            }
            seeker.arrive(end, port);
        }
    }

    fn listened(&mut self, _network: NetworkId, port: &mut Port<'_>) {
        if let Self::Seeker(seeker) = self {
            seeker.choose(port);
        }
    }
}

/// A search from the origin among nodes at `places`.
fn seek(places: &[Position], obstacles: Vec<Obstacle>) -> (Ended<Station>, Seeker) {
    let link = network::link(50.0, network::prompt());
    let setup = Setup {
        world: World { nodes: network::nodes(places), obstacles: ObstacleField::new(obstacles), ..World::default() },
        robots: network::own_robots([network::body("seeker", Position::ORIGIN)]),
        ..network::engine(&[], link, 4)
    };
    let mut stations: Vec<Station> = places.iter().map(|_| Station::Caller).collect();
    stations.push(Station::Seeker(Seeker::default()));
    let mut ended = network::run(setup, stations);
    let Some(Station::Seeker(seeker)) = ended.applications.pop() else { panic!("the robot is the last station") };
    (ended, seeker)
}

#[test]
fn a_robot_ends_at_the_place_of_its_grid_that_is_nearest_to_a_single_node() {
    let node = Position::new(5.2, 3.1, 0.0);
    let (ended, seeker) = seek(&[node], Vec::new());
    assert_eq!(seeker.base, Position::new(5.0, 3.0, 0.0));
    assert_eq!(seeker.best.map(|(node, _)| node), Some(0));
    // The start, five steps and a sixth in vain, three steps and a fourth in vain, and the other three directions.
    assert_eq!(seeker.stops, 1 + 5 + 1 + 3 + 1 + 3);
    assert_eq!(ended.log().stops().len(), 14);
    // Eight steps, and five in vain there and back.
    assert!((ended.robots[0].path_length_m - (8.0 + 2.0 * 5.0)).abs() < 1e-9);
    // 14 times 0.6 s and 18 m at 0.5 m/s.
    assert!((ended.end.as_secs_f64() - (14.0 * 0.6 + 36.0)).abs() < 1e-6);
}

#[test]
fn a_robot_ends_within_a_step_of_the_node_that_is_nearest_to_it_among_several() {
    let places = [[7.3, 0.4, 0.0], [-2.4, -6.2, 0.0], [3.6, -4.4, 0.0]].map(Position::from);
    let (_, seeker) = seek(&places, Vec::new());
    let (node, _) = seeker.best.expect("it hears nodes");
    let distances_m = places.map(|place| place.distance_m(seeker.base));
    let nearest_m = distances_m.iter().copied().fold(f64::INFINITY, f64::min);
    assert!((distances_m[usize::from(node)] - nearest_m).abs() < 1e-9);
    assert!(nearest_m < STEP_M, "{nearest_m} m");
}

#[test]
fn a_robot_goes_along_a_wall_that_is_in_its_way() {
    let cuboid = BoxConfig::new(Position::new(2.5, 0.0, 0.0), [0.2, 1.0, 2.0]);
    // It absorbs no power.
    let wall = ObstacleConfig::absorbing(ShapeConfig::Box(cuboid), 0.0);
    let (ended, seeker) = seek(&[Position::new(4.2, 4.1, 0.0)], vec![wall.try_into().expect("a wall")]);
    assert_eq!(seeker.base, Position::new(4.0, 4.0, 0.0));
    assert_eq!(ended.log().contacts().len(), 1);
}

proptest! {
    #[test]
    fn a_call_is_read_as_it_was_written(node: u16) {
        prop_assert_eq!(decode(&encode(node)), Some(node));
        prop_assert_eq!(decode(&encode(node)[..2]), None);
    }
}
