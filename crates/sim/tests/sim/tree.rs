//! A collection tree: beacons tell the nodes how far the sink is, and readings go up the tree, hop by hop, in
//! acknowledged frames.

use std::collections::VecDeque;
use std::time::Duration;

use proptest::prelude::*;
use sextant_channel::{Dbm, Position};
use sextant_kernel::{SimTime, StationId};
use sextant_mac::csma::CsmaConfig;
use sextant_sim::{
    Application, Delivery, Destination, NetworkId, Packets, Payload, Port, SendOutcome, SendReport, Setup, Sink,
    Timer,
};

use crate::network::{self, Ended};
use crate::scripted::NETWORK;

/// Beacons of stations that are equally many hops from the sink fall into one round.
const ROUND: Duration = Duration::from_secs(100);
const GUARD: Duration = Duration::from_secs(1);
/// When each node knows its parent: the trees of these tests have fewer rounds.
const BUILT: Duration = Duration::from_secs(2000);

const BEACON: Timer = Timer(0);
const READ: Timer = Timer(1);

/// What the stations of a tree say to each other. The first octet tells what it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Message {
    /// 0xB1, then the hops from the sender to the sink.
    Beacon { hops: u8 },
    /// 0xB2, the node (two octets, most significant first), the value, the hops from the node to the sender.
    Reading { node: u16, value: u8, hops: u8 },
}

impl Message {
    fn encode(self) -> Vec<u8> {
        match self {
            Self::Beacon { hops } => vec![0xB1, hops],
            Self::Reading { node, value, hops } => {
                let [high, low] = node.to_be_bytes();
                vec![0xB2, high, low, value, hops]
            }
        }
    }

    fn decode(octets: &[u8]) -> Option<Self> {
        match *octets {
            [0xB1, hops] => Some(Self::Beacon { hops }),
            [0xB2, high, low, value, hops] => {
                Some(Self::Reading { node: u16::from_be_bytes([high, low]), value, hops })
            }
            _ => None,
        }
    }
}

/// Whom a node sends its readings to.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Parent {
    station: StationId,
    hops: u8,
    rssi: Dbm,
}

/// A node of a tree.
#[derive(Default)]
struct Branch {
    /// When it takes its reading, after the tree is built.
    reads_after: Duration,
    parent: Option<Parent>,
    /// Readings that the parent has not acknowledged; the first one is under way.
    outbox: VecDeque<Message>,
    /// Frames that were given up, and sent again as new frames.
    given_up: u32,
}

impl Branch {
    fn put(&mut self, reading: Message, port: &mut Port<'_>) {
        self.outbox.push_back(reading);
        if self.outbox.len() == 1 {
            self.send_first(port);
        }
    }

    fn send_first(&mut self, port: &mut Port<'_>) {
        if let (Some(reading), Some(parent)) = (self.outbox.front(), self.parent) {
            let to = Destination::Station(parent.station);
            port.send(NETWORK, to, Payload::Octets(&reading.encode())).expect("the link is idle");
        }
    }

    fn hear_beacon(&mut self, hops: u8, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        let is_better =
            self.parent.is_none_or(|parent| hops < parent.hops || hops == parent.hops && delivery.rssi > parent.rssi);
        if !is_better {
            return;
        }
        if self.parent.is_none() {
            let round = SimTime::ZERO + u32::from(hops + 1) * ROUND;
            let due = round + (ROUND - GUARD).mul_f64(port.uniform(0));
            port.after(due - port.now(), BEACON);
        }
        self.parent = Some(Parent { station: delivery.from, hops, rssi: delivery.rssi });
    }
}

/// A station of a tree.
enum Station {
    Branch(Branch),
    /// The sink, with the readings that have arrived: node, value, hops.
    Root(Vec<(u16, u8, u8)>),
}

impl Application for Station {
    fn hears(&self) -> bool {
        true
    }

    fn started(&mut self, port: &mut Port<'_>) {
        match self {
            Self::Branch(branch) => {
                port.after(BUILT + branch.reads_after, READ);
            }
            Self::Root(_) => {
                port.after(Duration::ZERO, BEACON);
            }
        }
    }

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        match self {
            Self::Branch(branch) if timer == READ => {
                let node = u16::try_from(port.station().0).expect("a small network");
                branch.put(Message::Reading { node, value: value_of(node), hops: 0 }, port);
            }
            Self::Branch(Branch { parent, .. }) => {
                let hops = parent.expect("a node without parent sends no beacon").hops + 1;
                broadcast(Message::Beacon { hops }, port);
            }
            Self::Root(_) => broadcast(Message::Beacon { hops: 0 }, port),
        }
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        let message = Message::decode(delivery.payload).expect("a message");
        match (self, message) {
            (Self::Branch(branch), Message::Beacon { hops }) => branch.hear_beacon(hops, delivery, port),
            (Self::Branch(branch), Message::Reading { node, value, hops }) => {
                branch.put(Message::Reading { node, value, hops: hops + 1 }, port);
            }
            (Self::Root(readings), Message::Reading { node, value, hops }) => readings.push((node, value, hops + 1)),
            (Self::Root(_), Message::Beacon { .. }) => {}
        }
    }

    fn sent(&mut self, _network: NetworkId, report: &SendReport, port: &mut Port<'_>) {
        let Self::Branch(branch) = self else { return };
        match report.outcome {
            SendOutcome::Sent => {}
            SendOutcome::Acknowledged => {
                branch.outbox.pop_front();
                branch.send_first(port);
            }
            SendOutcome::NoAcknowledgement | SendOutcome::ChannelAccessFailure => {
                branch.given_up += 1;
                branch.send_first(port);
            }
        }
    }
}

fn broadcast(message: Message, port: &mut Port<'_>) {
    port.send(NETWORK, Destination::All, Payload::Octets(&message.encode())).expect("the link is idle");
}

/// What a node reads.
fn value_of(node: u16) -> u8 {
    u8::try_from(3 * node + 5).expect("a small network")
}

/// A tree over nodes at `places` with the sink one metre to the left of the first one; node i reads i `gaps` after the
/// tree is built.
fn collect(places: &[Position], range_m: f64, gap: Duration, seed: u64) -> Ended<Station> {
    let branch = |(_, i): (&Position, u32)| Station::Branch(Branch { reads_after: gap * i, ..Branch::default() });
    let mut stations: Vec<Station> = places.iter().zip(0..).map(branch).collect();
    stations.push(Station::Root(Vec::new()));
    let csma = CsmaConfig { rx_on_when_idle: true, ..CsmaConfig::default() };
    let setup = Setup {
        sinks: vec![Sink { name: "sink".into(), position: Position::new(-1.0, 0.0, 0.0), networks: None }],
        ..network::engine(places, network::link(range_m, csma), seed)
    };
    network::run(setup, stations)
}

/// The readings at the sink, by node.
fn readings(ended: &Ended<Station>) -> Vec<(u16, u8, u8)> {
    let Some(Station::Root(readings)) = ended.applications.last() else { panic!("the sink is the last station") };
    let mut readings = readings.clone();
    readings.sort_unstable();
    readings
}

/// What the sink should hear of `count` nodes, with the hops of each.
fn expected(count: u16, hops: impl Fn(u16) -> u8) -> Vec<(u16, u8, u8)> {
    (0..count).map(|node| (node, value_of(node), hops(node))).collect()
}

fn branches(ended: &Ended<Station>) -> impl Iterator<Item = &Branch> {
    ended.applications.iter().filter_map(|station| match station {
        Station::Branch(branch) => Some(branch),
        Station::Root(_) => None,
    })
}

/// Hops of a node on a line.
fn along_a_line(node: u16) -> u8 {
    u8::try_from(node + 1).expect("a short line")
}

/// Hops of a node in a grid of five columns with diagonal neighbours, from the sink at (-1, 0).
fn across_a_grid(node: u16) -> u8 {
    u8::try_from((node % 5 + 1).max(node / 5)).expect("a small grid")
}

#[test]
fn readings_of_a_line_of_five_arrive_once_over_as_many_hops_as_there_are() {
    let places = network::grid(5, 1);
    let ended = collect(&places, 1.0, Duration::from_secs(1), 2);
    assert_eq!(readings(&ended), expected(5, along_a_line));
    let parents: Vec<u32> = branches(&ended).map(|branch| branch.parent.unwrap().station.0).collect();
    assert_eq!(parents, [5, 0, 1, 2, 3]);
    // Each node sends its beacon, its own reading and those of the nodes behind it; the sink sends its beacon.
    for (node, packets) in (0..).zip(&ended.networks[0].packets[..5]) {
        let frames = 1 + 5 - node;
        let expected = Packets {
            offered: frames,
            sent: frames,
            received: frames,
            transmissions: frames,
            // A node that forwards at once also finds the channel busy with its own acknowledgement.
            assessments: packets.assessments,
            octets_received: 2 + 5 * (frames - 1),
            ..Packets::default()
        };
        assert_eq!(*packets, expected, "node {node}");
    }
    assert_eq!(ended.networks[0].packets[5].received, 1);
}

#[test]
fn readings_of_a_grid_of_25_arrive_once_over_the_fewest_hops() {
    let places = network::grid(5, 5);
    let ended = collect(&places, 1.5, Duration::from_secs(1), 2);
    assert_eq!(readings(&ended), expected(25, across_a_grid));
    for (node, (branch, &place)) in (0..).zip(branches(&ended).zip(&places)) {
        let parent = branch.parent.unwrap();
        assert_eq!((parent.hops + 1, branch.given_up), (across_a_grid(node), 0));
        // Of the parents with the fewest hops it has the nearest one.
        let at = |station: StationId| places.get(station.index()).copied().unwrap_or(Position::new(-1.0, 0.0, 0.0));
        let hops_of = |StationId(station): StationId| match u16::try_from(station) {
            Ok(node @ ..25) => across_a_grid(node),
            _ => 0,
        };
        let nearest_m = (0..26)
            .map(StationId)
            .filter(|&station| hops_of(station) == parent.hops)
            .map(|station| at(station).distance_m(place))
            .fold(f64::INFINITY, f64::min);
        assert!((at(parent.station).distance_m(place) - nearest_m).abs() < 1e-9);
    }
    // One beacon of each station, and a frame for each hop of each reading.
    let hops: u64 = (0..25).map(|node| u64::from(across_a_grid(node))).sum();
    let packets: Packets = ended.networks[0].packets.iter().copied().sum();
    assert_eq!((packets.offered, packets.received, packets.transmissions), (26 + hops, 26 + hops, 26 + hops));
}

#[test]
fn readings_that_are_all_taken_at_once_arrive_after_retransmissions() {
    let places = network::grid(5, 5);
    for seed in 0..20 {
        let ended = collect(&places, 1.5, Duration::ZERO, seed);
        let mut readings = readings(&ended);
        let arrived = readings.len();
        readings.dedup();
        assert_eq!(readings, expected(25, across_a_grid), "seed {seed}");
        // A frame that was received, but never acknowledged, is sent again as a new one, and arrives twice.
        let given_up: u32 = branches(&ended).map(|branch| branch.given_up).sum();
        assert!(arrived <= 25 + given_up as usize, "seed {seed}: {arrived} readings, {given_up} frames given up");
        let packets: Packets = ended.networks[0].packets.iter().copied().sum();
        assert!(packets.transmissions > packets.sent, "seed {seed}: no retransmission");
        assert_eq!(network::ended(&packets), packets.offered);
    }
}

proptest! {
    #[test]
    fn messages_are_read_as_they_were_written(node: u16, value: u8, hops: u8) {
        for message in [Message::Beacon { hops }, Message::Reading { node, value, hops }] {
            prop_assert_eq!(Message::decode(&message.encode()), Some(message));
            prop_assert_eq!(Message::decode(&message.encode()[1..]), None);
        }
    }
}
