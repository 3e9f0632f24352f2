//! A program that owns its radio: ALOHA, pure and slotted, beside its closed forms.
//!
//! `cargo run --release -p sextant --example aloha`

use std::io::Write;
use std::time::Duration;

use sextant::kernel::SimTime;
use sextant::sim::{Application, Destination, FrameId, NetworkId, Port, RadioEvent, RadioFrame, SendOutcome, Timer};
use sextant::{Programs, Scenario, Unwatched};

const SCENARIO: &str = "name = \"aloha\"\nseed = 1\nduration_s = 100.0\n\
    world.nodes.lattice = { spacing_m = 1.0, count = 50, region.rectangle = { min_m = [0, 0], max_m = [10, 5] } }\n\
    radio = { tx_power_dbm = 0, sensitivity_dbm = -90 }\n\
    channel.path_loss.log_distance.exponent = 2.0\n\
    reception = \"overlap\"\n\
    mac.program = {}\n\
    sinks = [{ name = \"sink\", position_m = [5, 2.4, 0] }]\n";
const NODES: i32 = 50;
const NETWORK: NetworkId = NetworkId(0);
/// A frame of 20 octets is 832 us on air; the radio turns around for 192 us before.
const AIRTIME_S: f64 = 832e-6;
const TURNAROUND_S: f64 = 192e-6;
const SLOT: Duration = Duration::from_micros(1100);

/// When a node sends.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Aloha {
    /// After a random pause with this mean (s), exponentially distributed.
    Pure { pause_s: f64 },
    /// In each slot with this probability.
    Slotted { probability: f64 },
}

/// Sends without looking at the channel.
struct Node {
    aloha: Aloha,
    draws: u64,
    packet: Option<FrameId>,
}

impl Node {
    /// Waits until the radio must turn around for the next frame.
    fn wait(&mut self, port: &mut Port<'_>) {
        self.draws += 1;
        let exponential = -libm::log(port.uniform(self.draws));
        let wait = match self.aloha {
            Aloha::Pure { pause_s } => Duration::from_secs_f64(exponential * pause_s),
            Aloha::Slotted { probability } => {
                // The number of slots until the next one in which it sends is geometrically distributed.
                let now = port.now().saturating_since(SimTime::ZERO);
                let slots = (exponential / -libm::log(1.0 - probability)).ceil();
                let next = (now.as_secs_f64() / SLOT.as_secs_f64()).floor() + slots;
                SLOT.mul_f64(next).saturating_sub(now + Duration::from_secs_f64(TURNAROUND_S))
            }
        };
        port.after(wait, Timer(0));
    }
}

impl Application for Node {
    fn started(&mut self, port: &mut Port<'_>) {
        self.wait(port);
    }

    fn timed(&mut self, _timer: Timer, port: &mut Port<'_>) {
        let Ok(mut radio) = port.radio(NETWORK) else { return };
        self.packet = radio.offer(Destination::All, 9).ok();
        let frame =
            RadioFrame { to: Destination::All, payload: b"a reading", acknowledged: false, packet: self.packet };
        // The radio is free: its last frame is out.
        let _ = radio.transmit(frame);
    }

    fn radio(&mut self, _network: NetworkId, event: &RadioEvent<'_>, port: &mut Port<'_>) {
        if let (RadioEvent::Sent { .. }, Some(packet)) = (event, self.packet.take()) {
            let _ = port.radio(NETWORK).and_then(|mut radio| radio.done(packet, SendOutcome::Sent));
            self.wait(port);
        }
    }
}

impl Aloha {
    /// Load G: frames offered in the time of one, or in a slot.
    pub(crate) fn load(self) -> f64 {
        match self {
            Self::Pure { pause_s } => f64::from(NODES) * AIRTIME_S / (AIRTIME_S + TURNAROUND_S + pause_s),
            Self::Slotted { probability } => f64::from(NODES) * probability,
        }
    }

    /// Throughput S of so many nodes. A frame gets through if no other node sends while it is on air, or begins before it
    /// and is still on air; with ever more nodes that is G exp(-2 G), and G exp(-G) with slots (Abramson 1970, Roberts 1975).
    pub(crate) fn closed_form(self) -> f64 {
        let alone = match self {
            Self::Pure { pause_s } => {
                let (airtime, turnaround) = (AIRTIME_S / pause_s, TURNAROUND_S / pause_s);
                libm::exp(turnaround - airtime) / (1.0 + turnaround + airtime)
            }
            Self::Slotted { probability } => 1.0 - probability,
        };
        self.load() * libm::pow(alone, f64::from(NODES - 1))
    }

    /// Throughput S in a simulation.
    pub(crate) fn simulated(self, seed: u64) -> Result<f64, Box<dyn std::error::Error>> {
        let scenario = Scenario::parse(SCENARIO)?.with("seed", seed)?;
        let mut programs = Programs::default();
        for node in &scenario.world().nodes {
            programs = programs.with_node(&node.name, Box::new(Node { aloha: self, draws: 0, packet: None }));
        }
        let run = sextant::run_with(&scenario, programs, &mut (), &Unwatched)?;
        let survey = run.survey().ok_or("the nodes are simulated")?;
        let frame_s = if let Self::Slotted { .. } = self { SLOT.as_secs_f64() } else { AIRTIME_S };
        Ok(survey.packets.received as f64 * frame_s / survey.end.as_secs_f64())
    }
}

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut out = std::io::stdout();
    writeln!(out, "              G   simulated   closed form   without end")?;
    for load in [0.1, 0.5, 1.0, 2.0] {
        let pause_s = f64::from(NODES) * AIRTIME_S / load - AIRTIME_S - TURNAROUND_S;
        for aloha in [Aloha::Pure { pause_s }, Aloha::Slotted { probability: load / f64::from(NODES) }] {
            let (name, exponent) = if let Aloha::Pure { .. } = aloha { ("pure", 2.0) } else { ("slotted", 1.0) };
            let (simulated, closed) = (aloha.simulated(1)?, aloha.closed_form());
            let limit = load * libm::exp(-exponent * load);
            writeln!(out, "{name:8} {load:6.1} {simulated:11.4} {closed:13.4} {limit:13.4}")?;
        }
    }
    Ok(())
}
