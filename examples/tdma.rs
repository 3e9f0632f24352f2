//! A program that owns its radio: TDMA, in which each node has a slot of its own, beside its closed forms.
//!
//! `cargo run --release -p sextant --example tdma`

use std::collections::VecDeque;
use std::io::Write;
use std::time::Duration;

use sextant::kernel::SimTime;
use sextant::sim::{Application, Destination, FrameId, NetworkId, Port, RadioEvent, RadioFrame, SendOutcome, Timer};
use sextant::{Programs, Scenario, Unwatched};

const SCENARIO: &str = "name = \"tdma\"\nseed = 1\nduration_s = 200.0\n\
    world.nodes.lattice = { spacing_m = 1.0, count = 20, region.rectangle = { min_m = [0, 0], max_m = [5, 4] } }\n\
    radio = { tx_power_dbm = 0, sensitivity_dbm = -90 }\n\
    channel.path_loss.log_distance.exponent = 2.0\n\
    reception = \"overlap\"\n\
    mac.program = {}\n\
    sinks = [{ name = \"sink\", position_m = [2, 1.4, 0] }]\n";
const NODES: u32 = 20;
const NETWORK: NetworkId = NetworkId(0);
const PAYLOAD: &[u8] = b"a reading";
/// A frame of 20 octets is 832 us on air; the radio turns around for 192 us before.
const AIRTIME_S: f64 = 832e-6;
const TURNAROUND: Duration = Duration::from_micros(192);
const SLOT: Duration = Duration::from_micros(1100);

/// Timer of a new packet.
const ARRIVAL: Timer = Timer(0);
/// Timer of the own slot: the radio must turn around.
const SLOT_DUE: Timer = Timer(1);

/// Sends one packet of its queue in its slot of each round; else its radio is off.
struct Node {
    /// Number of its slot, and of the next round.
    slot: u32,
    round: u32,
    /// Mean time between its packets (s); they arrive at random.
    interval_s: f64,
    queue: VecDeque<FrameId>,
    draws: u64,
}

impl Node {
    fn await_arrival(&mut self, port: &mut Port<'_>) {
        self.draws += 1;
        port.after(Duration::from_secs_f64(-libm::log(port.uniform(self.draws)) * self.interval_s), ARRIVAL);
    }

    /// Sets the timer of the next slot that the radio can still be ready for.
    fn await_slot(&mut self, port: &mut Port<'_>) {
        let start = |round| SimTime::ZERO + SLOT * (self.slot + NODES * round);
        if start(self.round) < port.now() + TURNAROUND {
            self.round += 1;
        }
        port.after(start(self.round) - port.now() - TURNAROUND, SLOT_DUE);
        self.round += 1;
    }
}

impl Application for Node {
    fn started(&mut self, port: &mut Port<'_>) {
        self.await_arrival(port);
        self.await_slot(port);
    }

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        if timer == ARRIVAL {
            let packet = port.radio(NETWORK).and_then(|mut radio| radio.offer(Destination::All, PAYLOAD.len()));
            self.queue.extend(packet.ok());
            return self.await_arrival(port);
        }
        if let (Some(&packet), Ok(mut radio)) = (self.queue.front(), port.radio(NETWORK)) {
            let (to, packet) = (Destination::All, Some(packet));
            // The radio is free: its last frame was out a round ago.
            let _ = radio.transmit(RadioFrame { to, payload: PAYLOAD, acknowledged: false, packet });
        }
        self.await_slot(port);
    }

    fn radio(&mut self, _network: NetworkId, event: &RadioEvent<'_>, port: &mut Port<'_>) {
        if let (RadioEvent::Sent { .. }, Some(packet)) = (event, self.queue.pop_front()) {
            let _ = port.radio(NETWORK).and_then(|mut radio| radio.done(packet, SendOutcome::Sent));
        }
    }
}

/// What a simulation brings, or the closed forms say.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measured {
    /// Share of the packets that were sent and received.
    pub(crate) delivery: f64,
    /// Mean time from arrival to reception (s).
    pub(crate) delay_s: f64,
    /// Share of the time in which the radio of a node is not off.
    pub(crate) duty: f64,
}

/// Time of a round of all slots (s).
fn round_s() -> f64 {
    f64::from(NODES) * SLOT.as_secs_f64()
}

/// With a load of `load` packets a round and node. A queue with one slot a round that packets reach at random waits for
/// F / (2 (1 - load)) on average, with a round of F (Kleinrock 1976, volume 2, section 5.11).
pub(crate) fn closed_form(load: f64) -> Measured {
    let (round_s, turnaround_s) = (round_s(), TURNAROUND.as_secs_f64());
    let delay_s = turnaround_s + round_s / (2.0 * (1.0 - load)) + AIRTIME_S;
    Measured { delivery: 1.0, delay_s, duty: load * (turnaround_s + AIRTIME_S) / round_s }
}

/// The same in a simulation.
pub(crate) fn simulated(load: f64, seed: u64) -> Result<Measured, Box<dyn std::error::Error>> {
    let scenario = Scenario::parse(SCENARIO)?.with("seed", seed)?;
    let mut programs = Programs::default();
    for (slot, node) in (0..).zip(&scenario.world().nodes) {
        let node_program = Node { slot, round: 0, interval_s: round_s() / load, queue: VecDeque::new(), draws: 0 };
        programs = programs.with_node(&node.name, Box::new(node_program));
    }
    let run = sextant::run_with(&scenario, programs, &mut (), &Unwatched)?;
    let survey = run.survey().ok_or("the nodes are simulated")?;
    let (packets, network) = (&survey.packets, &survey.networks[0]);
    let received = packets.received as f64;
    let delays_s = network
        .delays
        .iter()
        .zip(&network.packets)
        .map(|(delays, packets)| delays.mean_s().unwrap_or_default() * packets.received as f64);
    // Off, a CC2420 draws 20 uA at 3 V.
    let asleep_s = survey.energy.sleep_j / 60e-6;
    Ok(Measured {
        delivery: received / packets.sent as f64,
        delay_s: delays_s.sum::<f64>() / received,
        duty: 1.0 - asleep_s / (f64::from(NODES) * survey.end.as_secs_f64()),
    })
}

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut out = std::io::stdout();
    writeln!(out, "packets a round   delivery   delay (ms)   closed form   duty (%)   closed form")?;
    for load in [0.1, 0.5, 0.8] {
        let (found, closed) = (simulated(load, 1)?, closed_form(load));
        let [delay, closed_delay] = [found.delay_s, closed.delay_s].map(|delay_s| 1e3 * delay_s);
        let [duty, closed_duty] = [found.duty, closed.duty].map(|duty| 1e2 * duty);
        let Measured { delivery, .. } = found;
        writeln!(out, "{load:15.1} {delivery:10.4} {delay:12.2} {closed_delay:13.2} {duty:10.3} {closed_duty:13.3}")?;
    }
    Ok(())
}
