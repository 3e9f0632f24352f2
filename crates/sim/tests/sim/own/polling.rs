//! Robots that poll nodes while they drive, and frames to one station over several hops.

use std::collections::BTreeSet;
use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::{SimTime, StationId};
use sextant_sim::{
    Application, Applications, Delivery, Destination, DriveEnd, Driving, NetworkId, Payload, Port, SendOutcome,
    SendReport, Survey, Timer, Unobserved, World,
};

use super::{NETWORK, setup};
use crate::network;

const POLL: Timer = Timer(0);
const ANSWER: Timer = Timer(1);
const TURN: Timer = Timer(2);
const REPORT: Timer = Timer(3);

const POLL_INTERVAL: Duration = Duration::from_millis(500);

/// A station of a network in which robots poll nodes: "?" and the number of the poll; nodes answer with that number
/// after a random delay.
#[derive(Clone, Debug)]
enum Station {
    Node { asked: Vec<(StationId, u8)>, reports: Vec<SendReport> },
    Robot(Driver),
}

#[derive(Clone, Debug, Default)]
struct Driver {
    polls: Vec<(SimTime, Position)>,
    /// The number of the poll and the node of each answer.
    answers: Vec<(u8, StationId)>,
    answered_on_drives: usize,
    reports: Vec<SendReport>,
    drives: u32,
    blocked: u32,
    has_listened: bool,
}

impl Driver {
    /// Turns to the other side every three seconds: straight, an arc, straight, ..
    fn drive_on(&mut self, port: &mut Port<'_>) {
        self.drives += 1;
        let place = port.pose().position;
        let driving = match self.drives % 3 {
            0 => port.drive(place + Position::new(6.0, 0.0, 0.0)),
            1 => port.steer(Duration::from_secs(7), 0.4),
            _ => port.steer(Duration::from_secs(7), -0.4),
        };
        assert_eq!(driving, Driving::UnderWay);
    }
}

impl Application for Station {
    fn hears(&self) -> bool {
        true
    }

    fn started(&mut self, port: &mut Port<'_>) {
        if let Self::Robot(driver) = self {
            port.listen(NETWORK, Duration::from_secs(3600));
            port.after(POLL_INTERVAL, POLL);
            port.after(Duration::from_secs(3), TURN);
            port.after(Duration::from_secs(5), REPORT);
            driver.drive_on(port);
        }
    }

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        match self {
            Self::Node { asked, .. } => {
                assert_eq!(timer, ANSWER);
                let (from, number) = asked.remove(0);
                let answer = Payload::Octets(&[b'!', number]);
                port.send(NETWORK, Destination::Station(from), answer).expect("a free link");
            }
            Self::Robot(driver) => match timer {
                POLL => {
                    let number = u8::try_from(driver.polls.len()).expect("few polls");
                    driver.polls.push((port.now(), port.pose().position));
                    port.send(NETWORK, Destination::All, Payload::Octets(&[b'?', number])).expect("a free link");
                    port.after(POLL_INTERVAL, POLL);
                }
                TURN => {
                    port.halt();
                    driver.drive_on(port);
                    port.after(Duration::from_secs(3), TURN);
                }
                _ => {
                    assert_eq!(timer, REPORT);
                    // The node at the origin of the lattice, which may be out of reach.
                    let to = Destination::Station(StationId(0));
                    port.send(NETWORK, to, Payload::Octets(b"#")).expect("a free link");
                    port.after(Duration::from_secs(5), REPORT);
                }
            },
        }
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        match (self, delivery.payload) {
            (Self::Node { asked, .. }, &[b'?', number]) => {
                asked.push((delivery.from, number));
                let count = u64::from(number);
                // A window of 200 ms; answers of one node keep their order.
                port.after(Duration::from_secs_f64(0.2 * port.uniform(count)), ANSWER);
            }
            (Self::Robot(driver), &[b'!', number]) => {
                driver.answers.push((number, delivery.from));
                driver.answered_on_drives += usize::from(port.drive_ahead().is_some());
            }
            (Self::Node { .. }, b"#") => {}
            (station, payload) => panic!("{payload:?} at {station:?}"),
        }
    }

    fn sent(&mut self, _network: NetworkId, report: &SendReport, _port: &mut Port<'_>) {
        match self {
            Self::Node { reports, .. } => reports.push(*report),
            Self::Robot(driver) => driver.reports.push(*report),
        }
    }

    fn drive_ended(&mut self, end: DriveEnd, _port: &mut Port<'_>) {
        if let (Self::Robot(driver), DriveEnd::Blocked(_)) = (self, end) {
            driver.blocked += 1;
        }
    }

    fn listened(&mut self, _network: NetworkId, _port: &mut Port<'_>) {
        if let Self::Robot(driver) = self {
            driver.has_listened = true;
        }
    }
}

/// A lattice of 6 by 6 nodes 4 m apart, and a robot that polls them for a minute.
fn poll(seed: u64) -> (Survey, Applications<Station>, Vec<Position>) {
    let places: Vec<Position> = network::grid(6, 6).into_iter().map(|place| place * 4.0).collect();
    let world = World { nodes: network::nodes(&places), ..World::default() };
    let setup = setup(world, &[[3.0, 9.0, 0.0]], &[], 60.2, seed);
    let nodes = vec![Station::Node { asked: Vec::new(), reports: Vec::new() }; places.len()];
    let own = Applications { nodes, robots: vec![Station::Robot(Driver::default())], sinks: Vec::new() };
    let (survey, own) = network::run_own(setup, own, &mut Unobserved);
    (survey, own, places)
}

#[test]
fn a_robot_polls_the_nodes_around_it_while_it_drives() {
    let (survey, own, places) = poll(3);
    let [Station::Robot(driver)] = &own.robots[..] else { panic!("one robot") };
    assert_eq!(driver.polls.len(), 120);
    assert!(!driver.has_listened && driver.blocked == 0);
    // All but the polls of the last 0.2 s, whose answers may come too late.
    let (mut expected, mut certain) = (BTreeSet::new(), 0);
    for (number, &(_, place)) in driver.polls.iter().enumerate().take(119) {
        for (node, at) in places.iter().enumerate() {
            // The robot moves 0.3 m at most from the poll to an answer and its acknowledgement.
            if at.distance_m(place) < 9.7 {
                expected.insert((u8::try_from(number).unwrap(), StationId::from_index(node)));
                certain += 1;
            } else if at.distance_m(place) > 10.3 {
                let pair = (u8::try_from(number).unwrap(), StationId::from_index(node));
                assert!(!driver.answers.contains(&pair), "{pair:?}");
            }
        }
    }
    let answers: BTreeSet<_> = driver.answers.iter().copied().collect();
    assert_eq!(answers.len(), driver.answers.len(), "the MAC drops copies");
    let missing = expected.difference(&answers).count();
    // Stations in reach of the robot are in reach of each other or hidden; retries mend most of it.
    assert!(certain > 700 && missing * 50 < certain, "{missing} of {certain}");
    assert_eq!(driver.answered_on_drives, driver.answers.len());
    // Polls are sent to all; the frames to one node are acknowledged where it is in reach, and nowhere else.
    for report in &driver.reports {
        match (report.to, report.outcome) {
            (Destination::All, outcome) => assert_eq!(outcome, SendOutcome::Sent),
            (Destination::Station(node), outcome) => {
                let place = driver.polls.iter().take_while(|(time, _)| *time <= report.offered).last().unwrap().1;
                let is_near = place.distance_m(places[node.index()]) < 10.0;
                assert_eq!(outcome == SendOutcome::Acknowledged, is_near, "{report:?}");
            }
        }
    }
    assert_eq!(driver.reports.len(), 120 + 12);
    // It drives all the time, at 1 m/s.
    let record = &survey.robots[0];
    assert!((record.path_length_m - 60.2).abs() < 1e-6, "{} m", record.path_length_m);
    assert_eq!((record.stops, record.ending, record.end), (0, None, None));
    assert!(record.name == "robot-0" && record.packets == vec![0; places.len()]);
    assert!(survey.log().stops().is_empty());
}

#[test]
fn the_same_seed_gives_the_same_answers() {
    let answers = |seed| match &poll(seed).1.robots[..] {
        [Station::Robot(driver)] => driver.answers.clone(),
        _ => panic!("one robot"),
    };
    assert_eq!(answers(5), answers(5));
    assert_ne!(answers(5), answers(6));
}

/// A station of a chain, which passes what it receives on to the next one, with acknowledgements.
#[derive(Clone, Debug, Default)]
struct Relay {
    next: Option<StationId>,
    /// What it sends by itself at the start, to its next station or to all.
    sends: Option<&'static [u8]>,
    received: Vec<(StationId, Vec<u8>)>,
    reports: Vec<SendOutcome>,
}

impl Relay {
    fn pass_on(&self, payload: &[u8], port: &mut Port<'_>) {
        let to = self.next.map_or(Destination::All, Destination::Station);
        port.send(NETWORK, to, Payload::Octets(payload)).expect("a free link");
    }
}

impl Application for Relay {
    fn hears(&self) -> bool {
        true
    }

    fn started(&mut self, port: &mut Port<'_>) {
        port.listen(NETWORK, Duration::from_secs(60));
        if let Some(payload) = self.sends {
            self.pass_on(payload, port);
        }
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        self.received.push((delivery.from, delivery.payload.to_vec()));
        if self.next.is_some() {
            self.pass_on(delivery.payload, port);
        }
    }

    fn sent(&mut self, _network: NetworkId, report: &SendReport, _port: &mut Port<'_>) {
        self.reports.push(report.outcome);
    }
}

/// Nodes 8 m apart, each in reach of its neighbours alone, between a robot and a sink; stations are numbered as in a
/// simulation.
fn chain(change: impl FnOnce(&mut Applications<Relay>)) -> Applications<Relay> {
    let places: Vec<Position> = (1..5).map(|i| Position::new(8.0 * f64::from(i), 0.0, 0.0)).collect();
    let world = World { nodes: network::nodes(&places), ..World::default() };
    let mut own = Applications {
        nodes: vec![Relay::default(); 4],
        robots: vec![Relay::default()],
        sinks: vec![Relay::default()],
    };
    change(&mut own);
    let setup = setup(world, &[[0.0; 3]], &[[40.0, 0.0, 0.0]], 30.0, 2);
    network::run_own(setup, own, &mut Unobserved).1
}

const ROBOT: StationId = StationId(4);
const SINK: StationId = StationId(5);

#[test]
fn a_frame_goes_hop_by_hop_from_a_robot_to_a_sink_and_back() {
    let there = chain(|own| {
        own.robots[0] = Relay { next: Some(StationId(0)), sends: Some(b"there"), ..Relay::default() };
        for (i, node) in own.nodes.iter_mut().enumerate() {
            node.next = Some(if i == 3 { SINK } else { StationId::from_index(i + 1) });
        }
    });
    assert_eq!(there.sinks[0].received, [(StationId(3), b"there".to_vec())]);
    let back = chain(|own| {
        own.sinks[0] = Relay { next: Some(StationId(3)), sends: Some(b"back"), ..Relay::default() };
        for (i, node) in own.nodes.iter_mut().enumerate() {
            node.next = Some(if i == 0 { ROBOT } else { StationId::from_index(i - 1) });
        }
    });
    assert_eq!(back.robots[0].received, [(StationId(0), b"back".to_vec())]);
    for ended in [&there, &back] {
        for node in &ended.nodes {
            assert_eq!((node.received.len(), &node.reports[..]), (1, &[SendOutcome::Acknowledged][..]));
        }
    }
    assert_eq!(there.robots[0].reports, [SendOutcome::Acknowledged]);
    assert_eq!(back.sinks[0].reports, [SendOutcome::Acknowledged]);
}

#[test]
fn a_sink_and_a_robot_reach_all_stations_in_their_range() {
    let ended = chain(|own| own.sinks[0].sends = Some(b"all"));
    let received: Vec<usize> = ended.nodes.iter().map(|node| node.received.len()).collect();
    assert_eq!(received, [0, 0, 0, 1]);
    assert_eq!(ended.nodes[3].received, [(SINK, b"all".to_vec())]);
    assert_eq!(ended.sinks[0].reports, [SendOutcome::Sent]);
    let ended = chain(|own| own.robots[0].sends = Some(b"all"));
    assert_eq!(ended.nodes[0].received, [(ROBOT, b"all".to_vec())]);
    assert!(ended.nodes[1..].iter().all(|node| node.received.is_empty()));
}

#[test]
fn a_frame_to_a_station_out_of_reach_is_given_up() {
    let ended = chain(|own| own.sinks[0] = Relay { next: Some(ROBOT), sends: Some(b"far"), ..Relay::default() });
    assert_eq!(ended.sinks[0].reports, [SendOutcome::NoAcknowledgement]);
    assert!(ended.robots[0].received.is_empty());
}
