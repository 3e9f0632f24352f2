//! Channel access written as a program equals that of the simulator, and reference values.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::{Seed, StationId};
use sextant_mac::Phy;
use sextant_mac::csma::CsmaConfig;
use sextant_mac::program::ProgramConfig;
use sextant_sim::{
    Application, Destination, FrameId, Network, NetworkId, Payload, Port, RadioEvent, RadioFrame, SendOutcome,
    SendReport, Setup, Sink, Timer,
};

use super::NETWORK;
use crate::network;
use crate::on_air::Frames;

const PHY: Phy = Phy::Oqpsk2450;

/// When each sends its first frame.
const START: Duration = Duration::from_millis(1);

/// Unslotted CSMA-CA (IEEE 802.15.4-2006, figure 69) of a number of frames, one after the other, without acknowledgements. The
/// one is a program that commands its radio, the other gives its frames to the channel access of the simulator.
struct Sender {
    octets: usize,
    frames: u32,
    backoffs: u32,
    packet: Option<FrameId>,
    /// The end of the spacing after a frame.
    failures: u32,
    access: Access,
}

#[derive(Clone, Copy, PartialEq)]
enum Access {
    Program,
    Simulator,
}

impl Sender {
    fn new(octets: usize, frames: u32, access: Access) -> Self {
        Self { octets, frames, backoffs: 0, packet: None, failures: 0, access }
    }

    fn begin(&mut self, port: &mut Port<'_>) {
        if self.frames == 0 {
            return;
        }
        self.frames -= 1;
        if self.access == Access::Simulator {
            port.send(NETWORK, Destination::All, Payload::Octets(&vec![7; self.octets])).expect("it is free");
            return;
        }
        self.backoffs = 0;
        self.packet = port.radio(NETWORK).and_then(|mut radio| radio.offer(Destination::All, self.octets)).ok();
        self.back_off(port);
    }

    fn back_off(&mut self, port: &mut Port<'_>) {
        let most = (1 << (3 + self.backoffs).min(5)) - 1;
        let periods = port.radio(NETWORK).map(|radio| radio.backoff_periods(most)).expect("its radio");
        port.after(PHY.backoff_period() * periods, Timer(1));
    }

    fn end(&mut self, outcome: SendOutcome, spacing: Duration, port: &mut Port<'_>) {
        let packet = self.packet.take().expect("a packet is open");
        port.radio(NETWORK).and_then(|mut radio| radio.done(packet, outcome)).expect("a packet is open");
        port.after(spacing, Timer(2));
    }
}

impl Application for Sender {
    fn started(&mut self, port: &mut Port<'_>) {
        if let Ok(mut radio) = port.radio(NETWORK) {
            radio.receive();
        }
        port.after(START, Timer(0));
    }

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        match timer {
            Timer(1) => {
                port.radio(NETWORK).and_then(|mut radio| radio.assess()).expect("its receiver is on");
            }
            _ => self.begin(port),
        }
    }

    fn radio(&mut self, _network: NetworkId, event: &RadioEvent<'_>, port: &mut Port<'_>) {
        match event {
            RadioEvent::Assessed { busy: false, .. } => {
                let payload = vec![7; self.octets];
                let frame =
                    RadioFrame { to: Destination::All, payload: &payload, acknowledged: false, packet: self.packet };
                let mut radio = port.radio(NETWORK).expect("its radio");
                if radio.transmit(frame).is_err() {
                    // It has locked on to a frame in the very window that was idle on average: the standard sends all the
                    // same.
                    radio.idle();
                    radio.transmit(frame).expect("it is free");
                    radio.receive();
                }
            }
            RadioEvent::Assessed { busy: true, .. } if self.backoffs == 4 => {
                self.failures += 1;
                self.end(SendOutcome::ChannelAccessFailure, Duration::ZERO, port);
            }
            RadioEvent::Assessed { busy: true, .. } => {
                self.backoffs += 1;
                self.back_off(port);
            }
            RadioEvent::Sent { .. } => self.end(SendOutcome::Sent, Duration::from_millis(3), port),
            _ => {}
        }
    }

    fn sent(&mut self, _network: NetworkId, report: &SendReport, port: &mut Port<'_>) {
        let failed = report.outcome == SendOutcome::ChannelAccessFailure;
        self.failures += u32::from(failed);
        port.after(if failed { Duration::ZERO } else { Duration::from_millis(3) }, Timer(2));
    }
}

fn run(nodes: usize, octets: usize, frames: u32, seed: u64, access: Access) -> (Vec<(u64, StationId, bool)>, u32) {
    let link: Network = match access {
        Access::Program => super::link(ProgramConfig::default()),
        Access::Simulator => {
            let csma = CsmaConfig { rx_on_when_idle: true, ..CsmaConfig::default() };
            network::link(10.0, csma)
        }
    };
    let sink = Sink { name: "sink".into(), position: Position::ORIGIN, networks: None };
    let setup = Setup {
        sinks: vec![sink],
        seed: Seed(seed),
        duration: Some(Duration::from_secs(10)),
        ..network::engine(&network::cluster(nodes), link, seed)
    };
    let senders = (0..nodes).map(|_| Sender::new(octets, frames, access)).collect();
    let mut seen = Frames::kept(|frame| (frame.start.as_nanos(), frame.source, !frame.heard.is_empty()));
    let stations = sextant_sim::Applications::of_nodes(senders);
    let (_, stations) = network::run_own(setup, stations, &mut seen);
    (seen.0, stations.nodes.iter().map(|sender| sender.failures).sum())
}

#[test]
fn csma_ca_as_a_program_sends_the_same_frames_at_the_same_instants() {
    let (mut frames, mut collisions, mut failures) = (0, 0, 0);
    for (nodes, octets) in [(1, 9), (2, 33), (5, 9), (5, 116), (10, 34)] {
        for seed in 0..8 {
            let program = run(nodes, octets, 6, seed, Access::Program);
            assert_eq!(program, run(nodes, octets, 6, seed, Access::Simulator), "{nodes} {octets} {seed}");
            frames += program.0.len();
            collisions += program.0.iter().filter(|(_, _, is_received)| !is_received).count();
            failures += program.1;
        }
    }
    assert!(frames > 800 && collisions > 100 && failures > 20, "{frames} {collisions} {failures}");
}

#[test]
fn two_programs_of_csma_ca_collide_in_one_of_eight_rounds() {
    // The exact probability that a frame of 44 octets is received (enumeration of all draws). Both frames of a round collide
    // together. Four deviations: a false alarm in 16 000 runs.
    let exact = 7_339_941.0 / 8_388_608.0;
    let rounds = 3000;
    let received = |seed| run(2, 33, 1, seed, Access::Program).0.iter().filter(|frame| frame.2).count();
    let all: usize = (0..rounds).map(received).sum();
    let found = all as f64 / (2.0 * rounds as f64);
    let deviation = (exact * (1.0_f64 - exact) / rounds as f64).sqrt();
    assert!((found - exact).abs() < 4.0 * deviation, "{found}, not {exact}");
}
