//! Programs that command the radios of their stations.

mod access;
mod channels;
mod energy;
mod hearing;
mod packets;
mod refusals;

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::SimTime;
use sextant_mac::csma::CsmaConfig;
use sextant_mac::program::{ProgramConfig, ProgramSettings};
use sextant_sim::{
    Application, Destination, Network, NetworkId, Port, Programmed, RadioError, RadioEvent, RadioFrame, RadioPort,
    Setup, Technology, Timer,
};

use crate::network;

const NETWORK: NetworkId = NetworkId(0);

/// A network in which stations within 10 m of each other hear each other, and programs command the radios.
fn link(config: ProgramConfig) -> Network {
    let radio = network::radios(network::radio(0.0));
    let program = ProgramSettings::new(config, radio.phy(), radio.channel()).expect("good settings");
    let technology = Technology::Programmed(Programmed { radio, program });
    Network { technology, ..network::link(10.0, CsmaConfig::default()) }
}

/// Nodes at these places on a line (m) whose programs command their radios, for a second.
fn setup(places_m: &[f64], config: ProgramConfig) -> Setup {
    let places: Vec<_> = places_m.iter().map(|&x_m| Position::new(x_m, 0.0, 0.0)).collect();
    let setup = network::engine(&places, link(config), 1);
    Setup { duration: Some(Duration::from_secs(1)), ..setup }
}

fn us(us: u64) -> SimTime {
    SimTime::from_nanos(1000 * us)
}

/// A frame to all without a packet.
fn to_all(payload: &[u8]) -> RadioFrame<'_> {
    RadioFrame { to: Destination::All, payload, acknowledged: false, packet: None }
}

/// What a script does with the radio at an instant.
type Step = fn(&mut RadioPort<'_>) -> Result<(), RadioError>;

/// A station that does a list of things at their instants (us), and keeps what its radio says and refuses.
#[derive(Default)]
struct Script {
    steps: Vec<(u64, Step)>,
    /// What the radio said, each with its instant (us), in words.
    log: Vec<(u64, String)>,
    refused: Vec<String>,
}

fn script(steps: &[(u64, Step)]) -> Script {
    Script { steps: steps.to_vec(), ..Script::default() }
}

impl Application for Script {
    fn hears(&self) -> bool {
        true
    }

    fn started(&mut self, port: &mut Port<'_>) {
        for (number, &(at_us, _)) in (0..).zip(&self.steps) {
            port.after(Duration::from_micros(at_us), Timer(number));
        }
    }

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        let (_, step) = self.steps[usize::from(timer.0)];
        let mut radio = port.radio(NETWORK).expect("programs command the radios");
        if let Err(error) = step(&mut radio) {
            self.refused.push(error.to_string());
        }
    }

    fn radio(&mut self, _network: NetworkId, event: &RadioEvent<'_>, port: &mut Port<'_>) {
        let words = match event {
            RadioEvent::Ready => "ready".to_owned(),
            RadioEvent::Assessed { busy, .. } => if *busy { "busy" } else { "idle" }.to_owned(),
            RadioEvent::Began { start } => format!("began {}", start.as_nanos() / 1000),
            RadioEvent::Received(frame) => {
                let words = std::str::from_utf8(frame.delivery.payload).expect("words");
                format!("received {words} from {}", frame.delivery.from.0)
            }
            RadioEvent::Garbled { .. } => "garbled".to_owned(),
            RadioEvent::Ignored { .. } => "ignored".to_owned(),
            RadioEvent::WindowOver => "over".to_owned(),
            RadioEvent::Sent { start } => format!("sent {}", start.as_nanos() / 1000),
            RadioEvent::Acknowledged { .. } => "acknowledged".to_owned(),
            RadioEvent::Unacknowledged => "unacknowledged".to_owned(),
        };
        self.log.push((port.now().as_nanos() / 1000, words));
    }
}

/// Runs scripts at these places (m), and returns them.
fn run(places_m: &[f64], scripts: Vec<Script>) -> Vec<Script> {
    network::run(setup(places_m, ProgramConfig::default()), scripts).applications
}

/// The log as it is written in tests.
fn log(script: &Script) -> Vec<(u64, &str)> {
    script.log.iter().map(|(at_us, words)| (*at_us, words.as_str())).collect()
}
