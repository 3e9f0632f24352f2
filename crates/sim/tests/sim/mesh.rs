//! A busy mesh: nodes send to random neighbours and acknowledge what they receive, while they contend themselves.

use std::collections::BTreeMap;
use std::time::Duration;

use proptest::prelude::*;
use sextant_channel::Position;
use sextant_kernel::{Purpose, Seed, SimTime, StationId};
use sextant_mac::csma::CsmaConfig;
use sextant_sim::{
    Application, Delivery, Destination, FrameId, NetworkId, Observer, Packets, Payload, Port, ReceptionConfig,
    ReceptionModel, SendError, SendOutcome, SendReport, ThresholdConfig, Timer, Unobserved,
};

use crate::network::{self, Ended};
use crate::on_air::{OnAir, Span};
use crate::scripted::NETWORK;

const NODES: u64 = 20;
const RANGE_M: f64 = 1.5;
const FRAMES: u8 = 10;
/// The frames of all nodes fall into this span, which is about half of what the channel could carry.
const SPAN: Duration = Duration::from_millis(300);

const DUE: Timer = Timer(0);

/// The sender (two octets, most significant first) and the number of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Letter {
    sender: u16,
    number: u8,
}

impl Letter {
    fn encode(self) -> [u8; 3] {
        let [high, low] = self.sender.to_be_bytes();
        [high, low, self.number]
    }

    fn decode(octets: &[u8]) -> Option<Self> {
        let &[high, low, number] = octets else { return None };
        Some(Self { sender: u16::from_be_bytes([high, low]), number })
    }
}

/// A node that sends letters to random neighbours.
#[derive(Clone, Debug, PartialEq)]
struct Writer {
    neighbours: Vec<StationId>,
    written: u8,
    under_way: BTreeMap<FrameId, (StationId, Letter)>,
    refused: u64,
    /// When and how each letter ended.
    ended: Vec<(SimTime, StationId, Letter, SendOutcome)>,
    received: Vec<(StationId, Letter)>,
}

impl Application for Writer {
    fn hears(&self) -> bool {
        true
    }

    fn started(&mut self, port: &mut Port<'_>) {
        for number in 0..FRAMES {
            port.after(SPAN.mul_f64(port.uniform(number.into())), DUE);
        }
    }

    fn timed(&mut self, _due: Timer, port: &mut Port<'_>) {
        if self.neighbours.is_empty() {
            return;
        }
        let letter =
            Letter { sender: u16::try_from(port.station().0).expect("a small network"), number: self.written };
        self.written += 1;
        let to = self.neighbours[port.choice(letter.number.into(), self.neighbours.len())];
        match port.send(NETWORK, Destination::Station(to), Payload::Octets(&letter.encode())) {
            Ok(frame) => {
                self.under_way.insert(frame, (to, letter));
            }
            Err(SendError::QueueFull(_)) => self.refused += 1,
            Err(error) => panic!("{error}"),
        }
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, _port: &mut Port<'_>) {
        let letter = Letter::decode(delivery.payload).expect("a letter");
        assert_eq!(delivery.from, StationId(letter.sender.into()));
        self.received.push((delivery.from, letter));
    }

    fn sent(&mut self, _network: NetworkId, report: &SendReport, port: &mut Port<'_>) {
        let (to, letter) = self.under_way.remove(&report.frame).expect("a report of a frame under way");
        assert_eq!(report.to, Destination::Station(to));
        self.ended.push((port.now(), to, letter, report.outcome));
    }
}

/// A mesh of nodes at random places.
fn mesh(reception: ReceptionModel, seed: u64, observer: &mut impl Observer) -> Ended<Writer> {
    let draw = |node, axis| 3.0 * Seed(seed).uniform(Purpose::new(u64::MAX), [node, axis, 0]);
    let places: Vec<Position> = (0..NODES).map(|node| Position::new(draw(node, 0), draw(node, 1), 0.0)).collect();
    let neighbours = |node: usize| {
        let is_near = |&other: &usize| other != node && places[other].distance_m(places[node]) <= RANGE_M;
        (0..places.len()).filter(is_near).map(StationId::from_index).collect()
    };
    let writer = |node| Writer {
        neighbours: neighbours(node),
        written: 0,
        under_way: BTreeMap::new(),
        refused: 0,
        ended: Vec::new(),
        received: Vec::new(),
    };
    let csma = CsmaConfig { rx_on_when_idle: true, queue_frames: 2, ..CsmaConfig::default() };
    let writers = (0..places.len()).map(writer).collect();
    let mut link = network::link(RANGE_M, csma);
    network::receive_by(&mut link, reception);
    network::run_watched(network::engine(&places, link, seed), writers, observer)
}

/// Whether the acknowledgement of a frame of another station, with the same sequence number as the frame of `from`, ends
/// at `at`: it has no address, so `from` took it for an answer.
fn is_mistaken(on_air: &OnAir, at: SimTime, from: StationId) -> bool {
    let at_us = at.as_nanos() / 1000;
    let is_of = |span: &&Span| !span.is_acknowledgement && span.source == from && span.to_us < at_us;
    let frame = on_air.0.iter().rev().find(is_of).expect("a frame on air before its answer");
    let is_same = |span: &&Span| span.sequence == frame.sequence;
    let mut answers = on_air.0.iter().filter(|span| span.is_acknowledgement && span.to_us == at_us);
    // An acknowledgement begins one turnaround after the frame and takes 352 us.
    let is_other = |span: &&Span| !span.is_acknowledgement && span.source != from && span.to_us + 544 == at_us;
    answers.any(|answer| is_same(&answer)) && on_air.0.iter().filter(is_other).any(|other| is_same(&other))
}

/// Holds 200 meshes to their laws: each letter has one end, arrives at most once, and has arrived if it was
/// acknowledged by its addressee. Returns the outcomes of all packets, and how often the answer of another station was
/// mistaken.
fn check_200(reception: ReceptionModel) -> (Packets, u32) {
    let (mut all, mut mistaken) = (Packets::default(), 0);
    for seed in 0..200 {
        let mut on_air = OnAir::default();
        let ended = mesh(reception, seed, &mut on_air);
        for (node, (writer, packets)) in ended.applications.iter().zip(&ended.networks[0].packets).enumerate() {
            all += *packets;
            let case = format!("seed {seed}, node {node}");
            assert_eq!(network::ended(packets), packets.offered, "{case}");
            assert_eq!((packets.offered, packets.pending), (writer.written.into(), 0), "{case}");
            assert_eq!((packets.lost_queue, writer.under_way.len()), (writer.refused, 0), "{case}");
            let count = |wanted| writer.ended.iter().filter(|(.., outcome)| *outcome == wanted).count() as u64;
            assert_eq!(count(SendOutcome::NoAcknowledgement), packets.unacknowledged, "{case}");
            assert_eq!(count(SendOutcome::ChannelAccessFailure), packets.channel_access_failures, "{case}");
            assert_eq!(count(SendOutcome::Sent), 0, "{case}");
            let mut arrived = 0;
            for &(at, to, letter, outcome) in &writer.ended {
                let copies = ended.applications[to.index()].received.iter().filter(|(_, l)| *l == letter).count();
                assert!(copies <= 1, "{case}: {letter:?} arrived {copies} times");
                arrived += copies as u64;
                if outcome == SendOutcome::Acknowledged && copies == 0 {
                    assert!(is_mistaken(&on_air, at, StationId::from_index(node)), "{case}: {letter:?}");
                    mistaken += 1;
                }
            }
            assert_eq!(arrived, packets.received, "{case}");
        }
    }
    (all, mistaken)
}

#[test]
fn in_200_busy_meshes_each_letter_has_one_end_and_arrives_once_if_it_was_acknowledged() {
    let (all, mistaken) = check_200(ReceptionModel::Overlap);
    assert_eq!(mistaken, 0);
    // The meshes are busy: there are collisions, lost acknowledgements and full queues.
    let outcomes = [all.offered, all.received, all.lost_collision, all.lost_channel_access, all.lost_queue];
    assert_eq!(outcomes, [39_970, 31_961, 5514, 1554, 837]);
    assert_eq!([all.not_listened, all.unacknowledged, all.transmissions], [104, 4876, 74_656]);
}

#[test]
fn with_capture_more_letters_arrive() {
    let capture = ReceptionConfig::SinrThreshold(ThresholdConfig { threshold_db: 3.0 });
    let (all, mistaken) = check_200(capture.try_into().expect("a good threshold"));
    // An answer to another station with the same sequence number would be mistaken: here there is none.
    assert_eq!(mistaken, 0);
    let outcomes = [all.offered, all.received, all.lost_collision, all.lost_channel_access, all.lost_queue];
    assert_eq!(outcomes, [39_970, 33_977, 3966, 1326, 607]);
    assert_eq!([all.not_listened, all.unacknowledged, all.transmissions], [94, 3570, 67_900]);
}

#[test]
fn the_same_mesh_ends_in_the_same_way() {
    for seed in 0..5 {
        let run = |seed| mesh(ReceptionModel::Overlap, seed, &mut Unobserved);
        let (first, second) = (run(seed), run(seed));
        assert_eq!(first.applications, second.applications);
        assert_eq!(first.networks[0].packets, second.networks[0].packets);
        assert_eq!((first.end, first.events), (second.end, second.events));
        assert_ne!(first.applications, run(seed + 1000).applications);
    }
}

proptest! {
    #[test]
    fn a_letter_is_read_as_it_was_written(sender: u16, number: u8) {
        let letter = Letter { sender, number };
        prop_assert_eq!(Letter::decode(&letter.encode()), Some(letter));
        prop_assert_eq!(Letter::decode(&letter.encode()[..2]), None);
    }
}
