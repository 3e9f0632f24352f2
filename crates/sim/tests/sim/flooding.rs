//! Flooding: a message reaches all nodes of a network, because each node relays it once.

use std::time::Duration;

use proptest::prelude::*;
use sextant_channel::Position;
use sextant_kernel::SimTime;
use sextant_mac::csma::CsmaConfig;
use sextant_sim::{Application, Delivery, Destination, Packets, Payload, Port, Timer};

use crate::network::{self, Ended};
use crate::on_air::OnAir;
use crate::scripted::NETWORK;

/// Nodes that are equally many hops from the origin relay within this span, and those one hop further in the next
/// one. So nobody hears of the message over a detour first.
const ROUND: Duration = Duration::from_secs(100);
/// The rest of a round, in which the last frame of it ends.
const GUARD: Duration = Duration::from_secs(1);

const RELAY: Timer = Timer(0);

/// A message on its way. As octets: the origin (two octets, most significant first), the number of the message, the
/// hops from the origin to the sender.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Message {
    origin: u16,
    number: u8,
    hops: u8,
}

impl Message {
    fn encode(self) -> [u8; 4] {
        let [high, low] = self.origin.to_be_bytes();
        [high, low, self.number, self.hops]
    }

    fn decode(octets: &[u8]) -> Option<Self> {
        let &[high, low, number, hops] = octets else { return None };
        Some(Self { origin: u16::from_be_bytes([high, low]), number, hops })
    }
}

/// A node that relays each message that it has not heard before.
#[derive(Default)]
struct Flooder {
    /// A message of its own.
    starts: Option<Message>,
    /// The first copy that it has heard, as it relays it.
    heard: Option<(SimTime, Message)>,
    duplicates: usize,
    sent: u32,
}

impl Flooder {
    fn relay(&mut self, port: &mut Port<'_>) {
        let message = self.starts.or(self.heard.map(|(_, message)| message)).expect("a message to relay");
        port.send(NETWORK, Destination::All, Payload::Octets(&message.encode())).expect("an idle link takes it");
        self.sent += 1;
    }
}

impl Application for Flooder {
    fn hears(&self) -> bool {
        true
    }

    fn started(&mut self, port: &mut Port<'_>) {
        if self.starts.is_some() {
            self.relay(port);
        }
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        let message = Message::decode(delivery.payload).expect("a message");
        if self.starts.or(self.heard.map(|(_, message)| message)).is_some() {
            self.duplicates += 1;
            return;
        }
        let message = Message { hops: message.hops + 1, ..message };
        self.heard = Some((port.now(), message));
        let due = SimTime::ZERO + u32::from(message.hops) * ROUND + (ROUND - GUARD).mul_f64(port.uniform(0));
        port.after(due - port.now(), RELAY);
    }

    fn timed(&mut self, _relay: Timer, port: &mut Port<'_>) {
        self.relay(port);
    }
}

/// A flood from the first of nodes at `places`, and the frames on air.
fn flood(places: &[Position], range_m: f64) -> (Ended<Flooder>, OnAir) {
    let mut nodes: Vec<Flooder> = places.iter().map(|_| Flooder::default()).collect();
    nodes[0].starts = Some(Message { origin: 0, number: 7, hops: 0 });
    let csma = CsmaConfig { rx_on_when_idle: true, ..CsmaConfig::default() };
    let setup = network::engine(places, network::link(range_m, csma), 11);
    let mut on_air = OnAir::default();
    let ended = network::run_watched(setup, nodes, &mut on_air);
    (ended, on_air)
}

/// Holds a flood to its closed form: each node but the first has heard of the message over as many hops as `hops` says
/// for its number, has sent it once, and has heard it of each neighbour.
fn assert_reaches_all(places: &[Position], range_m: f64, hops: impl Fn(u8) -> u8) {
    let (ended, on_air) = flood(places, range_m);
    let one_frame = Packets {
        offered: 1,
        sent: 1,
        received: 1,
        transmissions: 1,
        assessments: 1,
        octets_received: 4,
        ..Packets::default()
    };
    assert_eq!(ended.networks[0].packets, vec![one_frame; places.len()]);
    for (i, (node, &place)) in (0..).zip(ended.applications.iter().zip(places)) {
        let neighbours = places.iter().filter(|other| other.distance_m(place) <= range_m).count() - 1;
        assert_eq!(node.sent, 1, "node {i}");
        if i == 0 {
            assert_eq!((node.heard, node.duplicates), (None, neighbours));
            continue;
        }
        let (_, message) = node.heard.expect("each node hears of the message");
        assert_eq!(message, Message { origin: 0, number: 7, hops: hops(i) }, "node {i}");
        assert_eq!(node.duplicates, neighbours - 1, "node {i}");
    }
    // Frames that do not overlap cannot collide.
    let ends: Vec<(u64, u64)> = on_air.0.iter().map(|span| (span.from_us, span.to_us)).collect();
    assert_eq!(ends.len(), places.len());
    assert!(ends.windows(2).all(|pair| pair[0].1 <= pair[1].0), "frames overlap");
}

#[test]
fn a_message_reaches_the_other_one_of_two_nodes() {
    assert_reaches_all(&network::grid(2, 1), 1.0, |_| 1);
}

#[test]
fn the_middle_one_of_three_nodes_relays_a_message_to_the_last_one() {
    assert_reaches_all(&network::grid(3, 1), 1.0, |node| node);
    let (ended, _) = flood(&network::grid(3, 1), 1.0);
    let order = ended.applications.iter().map(|node| node.heard.map(|(at, _)| at.as_secs_f64()));
    let [None, Some(middle), Some(last)] = order.collect::<Vec<_>>()[..] else { panic!("two nodes hear of it") };
    assert!(middle < 0.01 && last > 100.0, "{middle} s, {last} s");
}

#[test]
fn a_message_reaches_each_of_100_nodes_over_the_fewest_hops_and_each_sends_once() {
    // Four neighbours: the distance in the grid is the sum of columns and rows. Eight: it is the larger one.
    assert_reaches_all(&network::grid(10, 10), 1.0, |node| node % 10 + node / 10);
    assert_reaches_all(&network::grid(10, 10), 1.5, |node| (node % 10).max(node / 10));
}

#[test]
fn nodes_out_of_range_hear_nothing_of_a_message() {
    let places = [0.0, 1.0, 2.5, 3.5].map(|x| Position::new(x, 0.0, 0.0));
    let (ended, _) = flood(&places, 1.0);
    let sent: Vec<u32> = ended.applications.iter().map(|node| node.sent).collect();
    assert_eq!(sent, [1, 1, 0, 0]);
    let received: Vec<u64> = ended.networks[0].packets.iter().map(|packets| packets.received).collect();
    assert_eq!(received, [1, 1, 0, 0]);
}

#[test]
fn a_frame_to_all_counts_as_out_of_range_if_listeners_are_too_far_and_as_unheard_if_there_are_none() {
    let (ended, _) = flood(&[Position::ORIGIN, Position::new(2.0, 0.0, 0.0)], 1.0);
    let expected =
        Packets { offered: 1, sent: 1, out_of_range: 1, transmissions: 1, assessments: 1, ..Packets::default() };
    assert_eq!(ended.networks[0].packets[0], expected);
    let (ended, _) = flood(&[Position::ORIGIN], 1.0);
    assert_eq!(ended.networks[0].packets[0].not_listened, 1);
    assert_eq!(ended.applications[0].sent, 1);
}

proptest! {
    #[test]
    fn a_message_is_read_as_it_was_written(origin: u16, number: u8, hops: u8) {
        let message = Message { origin, number, hops };
        prop_assert_eq!(Message::decode(&message.encode()), Some(message));
        prop_assert_eq!(Message::decode(&message.encode()[..3]), None);
    }
}
