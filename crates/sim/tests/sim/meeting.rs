//! Two robots that agree on a place to meet, by acknowledged frames both ways, and drive there.

use std::time::Duration;

use proptest::prelude::*;
use sextant_channel::Position;
use sextant_kernel::{SimTime, StationId};
use sextant_mac::csma::CsmaConfig;
use sextant_sim::{
    Application, Delivery, Destination, DriveEnd, Driving, NetworkId, Payload, Port, SendOutcome, SendReport, Setup,
};

use crate::network::{self, Ended};
use crate::scripted::NETWORK;

const LISTEN: Duration = Duration::from_secs(2);

/// What the robots say to each other. The first octet tells what it is; a place is x and y in centimetres, four octets
/// each, signed, most significant first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Message {
    /// 0xC1: the sender is here.
    Here { x_cm: i32, y_cm: i32 },
    /// 0xC2: let us meet there.
    Meet { x_cm: i32, y_cm: i32 },
}

impl Message {
    fn encode(self) -> [u8; 9] {
        let (kind, x_cm, y_cm) = match self {
            Self::Here { x_cm, y_cm } => (0xC1, x_cm, y_cm),
            Self::Meet { x_cm, y_cm } => (0xC2, x_cm, y_cm),
        };
        let mut octets = [kind; 9];
        octets[1..5].copy_from_slice(&x_cm.to_be_bytes());
        octets[5..].copy_from_slice(&y_cm.to_be_bytes());
        octets
    }

    fn decode(octets: &[u8]) -> Option<Self> {
        let &[kind, a, b, c, d, e, f, g, h] = octets else { return None };
        let (x_cm, y_cm) = (i32::from_be_bytes([a, b, c, d]), i32::from_be_bytes([e, f, g, h]));
        match kind {
            0xC1 => Some(Self::Here { x_cm, y_cm }),
            0xC2 => Some(Self::Meet { x_cm, y_cm }),
            _ => None,
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "a place in a small world")]
fn centimetres(m: f64) -> i32 {
    (100.0 * m).round() as i32
}

fn place(x_cm: i32, y_cm: i32) -> Position {
    Position::new(f64::from(x_cm) / 100.0, f64::from(y_cm) / 100.0, 0.0)
}

/// The first robot says where it is; the second one answers with the place halfway. When their time to listen is over
/// they drive there, and tell each other that they have arrived.
struct Robot {
    other: StationId,
    begins: bool,
    /// Where to meet, once both know it.
    meeting: Option<Position>,
    has_arrived: bool,
    received: Vec<(SimTime, Message)>,
    reports: Vec<(SimTime, SendReport)>,
}

impl Robot {
    fn new(other: u32, begins: bool) -> Self {
        Self {
            other: StationId(other),
            begins,
            meeting: None,
            has_arrived: false,
            received: Vec::new(),
            reports: Vec::new(),
        }
    }

    fn say(&self, message: Message, port: &mut Port<'_>) {
        let to = Destination::Station(self.other);
        port.send(NETWORK, to, Payload::Octets(&message.encode())).expect("the link is idle");
    }

    fn say_place(&self, port: &mut Port<'_>) {
        let here = port.pose().position;
        self.say(Message::Here { x_cm: centimetres(here.x_m), y_cm: centimetres(here.y_m) }, port);
    }

    fn arrive(&mut self, port: &mut Port<'_>) {
        self.has_arrived = true;
        port.listen(NETWORK, LISTEN);
        self.say_place(port);
    }
}

impl Application for Robot {
    fn hears(&self) -> bool {
        true
    }

    fn has_task(&self) -> bool {
        true
    }

    fn started(&mut self, port: &mut Port<'_>) {
        port.listen(NETWORK, LISTEN);
        if self.begins {
            self.say_place(port);
        }
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        assert_eq!(delivery.from, self.other);
        let message = Message::decode(delivery.payload).expect("a message");
        self.received.push((port.now(), message));
        match message {
            Message::Here { x_cm, y_cm } if !self.begins && !self.has_arrived => {
                let here = port.pose().position;
                let halfway = |there, here| (there + centimetres(here)) / 2;
                let (x_cm, y_cm) = (halfway(x_cm, here.x_m), halfway(y_cm, here.y_m));
                self.meeting = Some(place(x_cm, y_cm));
                self.say(Message::Meet { x_cm, y_cm }, port);
            }
            Message::Here { .. } => {}
            Message::Meet { x_cm, y_cm } => self.meeting = Some(place(x_cm, y_cm)),
        }
    }

    fn sent(&mut self, _network: NetworkId, report: &SendReport, port: &mut Port<'_>) {
        self.reports.push((port.now(), *report));
    }

    fn listened(&mut self, _network: NetworkId, port: &mut Port<'_>) {
        match self.meeting {
            Some(meeting) if !self.has_arrived => {
                if let Driving::Over(_) = port.drive(meeting) {
                    self.arrive(port);
                }
            }
            _ => port.finish(),
        }
    }

    fn drive_ended(&mut self, end: DriveEnd, port: &mut Port<'_>) {
        assert_eq!(end, DriveEnd::Arrived);
        self.arrive(port);
    }
}

/// Two robots at these places, in a world without nodes.
fn meet(places: [Position; 2], csma: CsmaConfig, seed: u64) -> Ended<Robot> {
    let setup = Setup {
        robots: network::own_robots(
            ["ada", "bob"].into_iter().zip(places).map(|(name, start)| network::body(name, start)),
        ),
        ..network::engine(&[], network::link(20.0, csma), seed)
    };
    network::run(setup, vec![Robot::new(1, true), Robot::new(0, false)])
}

fn micros(at: SimTime) -> u64 {
    at.as_nanos() / 1000
}

#[test]
fn two_robots_agree_on_the_place_halfway_and_meet_there() {
    let ended = meet([Position::ORIGIN, Position::new(6.0, 8.0, 0.0)], CsmaConfig::default(), 8);
    let halfway = Position::new(3.0, 4.0, 0.0);
    for (robot, record) in ended.applications.iter().zip(&ended.robots) {
        assert_eq!(robot.meeting, Some(halfway));
        assert!(robot.has_arrived && (record.path_length_m - 5.0).abs() < 1e-9);
        assert!(robot.reports.iter().all(|(_, report)| report.outcome == SendOutcome::Acknowledged));
    }
    let messages = |robot: &Robot| robot.received.iter().map(|&(_, message)| message).collect::<Vec<_>>();
    let arrived = Message::Here { x_cm: 300, y_cm: 400 };
    assert_eq!(messages(&ended.applications[0]), [Message::Meet { x_cm: 300, y_cm: 400 }, arrived]);
    assert_eq!(messages(&ended.applications[1]), [Message::Here { x_cm: 0, y_cm: 0 }, arrived]);
    // 2 s to listen, 5 m at 0.5 m/s, 2 s to listen.
    assert_eq!(micros(ended.end), 14_000_000);
    for packets in &ended.networks[0].packets {
        assert_eq!((packets.offered, packets.received, packets.unacknowledged), (2, 2, 0));
        assert_eq!(packets.octets_received, 18);
    }
}

#[test]
fn a_robot_that_answers_at_once_finds_the_channel_busy_with_its_own_acknowledgement() {
    let (mut idle_after, mut given_up) = (Vec::new(), 0);
    for seed in 0..40 {
        let ended = meet([Position::ORIGIN, Position::new(10.0, 0.0, 0.0)], network::prompt(), seed);
        let [first, second] = &ended.applications[..] else { panic!("two robots") };
        // 20 octets of MPDU and 6 before it: 832 us on air, from 320 us on; the acknowledgement takes 192 and 352 us.
        let Some(answer) = first.received.first() else {
            // The channel was busy at all five assessments.
            given_up += 1;
            continue;
        };
        let (asked, answered) = (micros(second.received[0].0), micros(answer.0));
        assert_eq!(asked, 320 + 832);
        assert_eq!(micros(first.reports[0].0), asked + 192 + 352);
        // The window of carrier sense that finds the channel idle begins after the acknowledgement.
        let sensed_from = answered - 832 - 192 - 128;
        assert!(sensed_from >= asked + 192 + 352, "seed {seed}: {sensed_from} us");
        // Before it there were up to four busy ones, each followed by a number of backoff periods.
        let whole_periods = |busy: u64| (sensed_from - asked).checked_sub(busy * 128).is_some_and(|us| us % 320 == 0);
        assert!((1..=4).any(whole_periods), "seed {seed}: {sensed_from} us");
        idle_after.push(sensed_from - asked);
    }
    assert!(given_up <= 3, "{given_up} of 40");
    // The earliest one: after two busy ones and one period. One period after a first busy one is too early, because the
    // window begins while the acknowledgement is on air.
    assert_eq!(idle_after.into_iter().min(), Some(2 * 128 + 320));
}

#[test]
fn robots_out_of_range_of_each_other_stay_where_they_are() {
    let ended = meet([Position::ORIGIN, Position::new(30.0, 0.0, 0.0)], network::prompt(), 8);
    let [first, second] = &ended.applications[..] else { panic!("two robots") };
    let [(_, report)] = first.reports[..] else { panic!("one report, not {:?}", first.reports) };
    assert_eq!((report.outcome, report.transmissions), (SendOutcome::NoAcknowledgement, 4));
    assert!(second.received.is_empty() && second.reports.is_empty());
    assert!(ended.robots.iter().all(|robot| robot.path_length_m == 0.0));
    assert_eq!((micros(ended.end), ended.networks[0].packets[0].out_of_range), (2_000_000, 1));
}

proptest! {
    #[test]
    fn messages_are_read_as_they_were_written(x_cm: i32, y_cm: i32) {
        for message in [Message::Here { x_cm, y_cm }, Message::Meet { x_cm, y_cm }] {
            prop_assert_eq!(Message::decode(&message.encode()), Some(message));
            prop_assert_eq!(Message::decode(&message.encode()[..8]), None);
        }
    }
}
