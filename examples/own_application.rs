//! Nodes with an application of their own: a message floods the network, because each node relays it once.
//!
//! `cargo run --release -p sextant --example own_application`

use std::io::Write;
use std::time::Duration;

use sextant::kernel::SimTime;
use sextant::sim::{Application, Delivery, Destination, NetworkId, Payload, Port, Timer};
use sextant::{Programs, Scenario, Unwatched};

const SCENARIO: &str = "name = \"flood\"\nseed = 1\nduration_s = 10.0\n\
    world.nodes.lattice = { spacing_m = 3.0, jitter_m = 0.5, count = 60, \
      region.rectangle = { min_m = [0, 0], max_m = [30, 18] } }\n\
    radio = { tx_power_dbm = -50, sensitivity_dbm = -90 }\n\
    channel = { environment = \"light-tree\", max_range_m = 6.0, path_loss.log_distance.reference_loss_db = 0.0 }\n\
    mac.csma_unslotted = { rx_on_when_idle = true }\n\
    traffic.silent = {}\n\
    sinks = [{ name = \"sink\", position_m = [0, 0, 0] }]\n";

/// Relays the first copy of the message after a random wait of up to a second.
#[derive(Clone, Debug, Default)]
struct Flooder {
    is_origin: bool,
    heard: Option<SimTime>,
}

impl Flooder {
    fn send(port: &mut Port<'_>) {
        // A node whose queue is full relays nothing, and its neighbours hear the message from others.
        let _ = port.send(NetworkId(0), Destination::All, Payload::Octets(b"fire in room 7"));
    }
}

impl Application for Flooder {
    fn hears(&self) -> bool {
        true
    }

    fn started(&mut self, port: &mut Port<'_>) {
        if self.is_origin {
            self.heard = Some(port.now());
            Self::send(port);
        }
    }

    fn delivered(&mut self, _delivery: &Delivery<'_>, port: &mut Port<'_>) {
        if self.heard.is_none() {
            self.heard = Some(port.now());
            port.after(Duration::from_secs(1).mul_f64(port.uniform(0)), Timer(0));
        }
    }

    fn timed(&mut self, _timer: Timer, port: &mut Port<'_>) {
        Self::send(port);
    }
}

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scenario = Scenario::parse(SCENARIO)?;
    let mut flooders = vec![Flooder::default(); scenario.world().nodes.len()];
    flooders[0].is_origin = true;
    let mut programs = Programs::default();
    for (node, flooder) in scenario.world().nodes.iter().zip(&mut flooders) {
        programs = programs.with_node(&node.name, Box::new(flooder));
    }
    let run = sextant::run_with(&scenario, programs, &mut (), &Unwatched)?;
    let sent = run.survey().ok_or("the nodes are simulated")?.packets.sent;
    let heard: Vec<SimTime> = flooders.iter().filter_map(|flooder| flooder.heard).collect();
    let last_s = heard.iter().max().map_or(0.0, |time| time.as_secs_f64());
    let (count, all) = (heard.len(), flooders.len());
    writeln!(std::io::stdout(), "{count} of {all} nodes heard of it within {last_s:.2} s, by {sent} packets")?;
    Ok(())
}
