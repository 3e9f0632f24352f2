//! Packets of programs are counted and traced as those of other links.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::StationId;
use sextant_mac::frame::{Address, Frame, FrameBody};
use sextant_mac::program::ProgramConfig;
use sextant_sim::{
    Application, DeathsConfig, Destination, FaultsConfig, FrameId, FrameOnAir, FrameOutcome, NetworkId, Observer,
    PacketEnd, PacketFate, PacketTrace, Port, RadioEvent, RadioFrame, SendOutcome, Setup, Sink, Timer,
};

use super::{NETWORK, us};
use crate::network;

/// Sends a packet to the sink up to three times, until that acknowledges it.
struct Sender {
    sink: StationId,
    at: Duration,
    packet: Option<FrameId>,
    tries: u32,
}

impl Sender {
    fn new(sink: u32, at_us: u64) -> Self {
        Self { sink: StationId(sink), at: Duration::from_micros(at_us), packet: None, tries: 0 }
    }

    fn transmit(&mut self, port: &mut Port<'_>) {
        self.tries += 1;
        let frame = RadioFrame {
            to: Destination::Station(self.sink),
            payload: b"twelve words",
            acknowledged: true,
            packet: self.packet,
        };
        port.radio(NETWORK).and_then(|mut radio| radio.transmit(frame)).expect("it is free");
    }

    fn done(&mut self, outcome: SendOutcome, port: &mut Port<'_>) {
        let packet = self.packet.take().expect("a packet is open");
        port.radio(NETWORK).and_then(|mut radio| radio.done(packet, outcome)).expect("a packet is open");
    }
}

impl Application for Sender {
    fn started(&mut self, port: &mut Port<'_>) {
        port.after(self.at, Timer(0));
    }

    fn timed(&mut self, _timer: Timer, port: &mut Port<'_>) {
        let to = Destination::Station(self.sink);
        self.packet = port.radio(NETWORK).and_then(|mut radio| radio.offer(to, 12)).ok();
        self.transmit(port);
    }

    fn radio(&mut self, _network: NetworkId, event: &RadioEvent<'_>, port: &mut Port<'_>) {
        match event {
            RadioEvent::Acknowledged { .. } => self.done(SendOutcome::Acknowledged, port),
            RadioEvent::Unacknowledged if self.tries < 3 => self.transmit(port),
            RadioEvent::Unacknowledged => self.done(SendOutcome::NoAcknowledgement, port),
            _ => {}
        }
    }
}

/// Keeps traces and frames.
#[derive(Default)]
struct Watched {
    packets: Vec<PacketTrace>,
    frames: Vec<(u64, StationId, FrameOutcome)>,
    mpdus: Vec<Vec<u8>>,
}

impl Observer for Watched {
    fn wants_frames(&self) -> bool {
        true
    }

    fn framed(&mut self, frame: FrameOnAir<'_>) {
        self.frames.push((frame.start.as_nanos() / 1000, frame.source, frame.outcome));
        self.mpdus.push(frame.bytes.to_vec());
    }

    fn wants_packets(&self) -> bool {
        true
    }

    fn traced(&mut self, packet: &PacketTrace) {
        self.packets.push(packet.clone());
    }
}

fn star(nodes: usize) -> Setup {
    let places: Vec<f64> = (0..nodes).map(|node| 1.0 + node as f64).collect();
    let sink = Sink { name: "sink".into(), position: Position::ORIGIN, networks: None };
    Setup { sinks: vec![sink], ..super::setup(&places, ProgramConfig::default()) }
}

fn simulate(setup: Setup, senders: Vec<Sender>) -> (sextant_sim::Survey, Watched) {
    let mut watched = Watched::default();
    let stations = sextant_sim::Applications::of_nodes(senders);
    let (survey, _) = network::run_own(setup, stations, &mut watched);
    (survey, watched)
}

#[test]
fn a_packet_that_is_acknowledged_counts_and_is_traced() {
    let (survey, watched) = simulate(star(1), vec![Sender::new(1, 1000)]);
    let packets = survey.networks[0].packets[0];
    assert_eq!((packets.offered, packets.sent, packets.received, packets.transmissions), (1, 1, 1, 1));
    assert_eq!((packets.octets_received, packets.unacknowledged, survey.networks[0].deliveries[1]), (12, 0, 1));
    // 23 octets of MPDU: 928 us from 1192 on.
    let [trace] = &watched.packets[..] else { panic!("one packet") };
    assert_eq!((trace.end, trace.fate), (PacketEnd::Acknowledged, PacketFate::Sent(FrameOutcome::Received)));
    assert_eq!((trace.offered, trace.delay(), trace.octets), (us(1000), Some(Duration::from_micros(192 + 928)), 23));
    assert_eq!(trace.transmissions[0].acknowledged, Some(us(1192 + 928 + 192 + 352)));
    let delays = &survey.networks[0].delays[0];
    assert!((delays.mean_s().expect("one packet") - 1120e-6).abs() < 1e-9);
    let both = [(1192, StationId(0), FrameOutcome::Received), (2312, StationId(1), FrameOutcome::Received)];
    assert_eq!(watched.frames, both);
    let frame = Frame::parse(&watched.mpdus[0]).expect("a good frame");
    assert_eq!((frame.body, frame.ack_request), (FrameBody::Data(b"twelve words"), true));
    assert_eq!(frame.source.map(|source| source.address), Some(Address::of(StationId(0))));
    assert_eq!(
        watched.mpdus[1],
        [2, 0, frame.sequence].into_iter().chain(watched.mpdus[1][3..].iter().copied()).collect::<Vec<_>>()
    );
}

#[test]
fn packets_that_collide_are_retried_and_counted_once() {
    // Both send the same size at the same instants: three collisions each.
    let (survey, watched) = simulate(star(2), vec![Sender::new(2, 1000), Sender::new(2, 1000)]);
    for packets in &survey.networks[0].packets[..2] {
        assert_eq!((packets.offered, packets.lost_collision, packets.transmissions), (1, 1, 3));
        assert_eq!((packets.unacknowledged, network::ended(packets)), (1, 1));
    }
    assert!(watched.packets.iter().all(|trace| trace.end == PacketEnd::NoAcknowledgement));
    assert!(watched.packets.iter().all(|trace| trace.transmissions.len() == 3));
    assert_eq!(watched.packets[0].transmissions[0].collided_with, Some(StationId(1)));
}

#[test]
fn a_packet_under_way_at_the_end_is_pending_unless_it_was_received() {
    for (end_us, pending, received) in [(1500, 1, 0), (2300, 0, 1)] {
        let setup = Setup { duration: Some(Duration::from_micros(end_us)), ..star(1) };
        let (survey, watched) = simulate(setup, vec![Sender::new(1, 1000)]);
        let packets = survey.networks[0].packets[0];
        assert_eq!((packets.pending, packets.received, network::ended(&packets)), (pending, received, 1));
        assert_eq!(watched.packets[0].end, PacketEnd::Pending);
    }
}

#[test]
fn the_frame_of_a_node_that_dies_is_sent_to_its_end() {
    for (dies_us, received) in [(1100, 0), (1300, 1), (5000, 1)] {
        let at_s = f64::from(dies_us) * 1e-6;
        let deaths = Some(DeathsConfig { share: Some(1.0), names: None, from_s: at_s, to_s: at_s });
        let setup = star(1);
        let faults = FaultsConfig { deaths, ..FaultsConfig::default() };
        let faults = faults.build(&setup.world.nodes, setup.seed).expect("good faults");
        let (survey, watched) = simulate(Setup { faults, ..setup }, vec![Sender::new(1, 1000)]);
        assert_eq!(survey.networks[0].packets[0].received, received, "{dies_us}");
        assert_eq!(watched.frames.len(), 2 * usize::try_from(received).expect("0 or 1"), "{dies_us}");
    }
}
