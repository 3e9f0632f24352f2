//! Neighbour discovery: nodes broadcast hello packets for some time, and all other nodes listen.

use std::collections::BTreeMap;
use std::time::Duration;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sextant_channel::{Channel, Link, NeighbourLog};
use sextant_kernel::{EventQueue, Interrupted, NodeId, Seed, SettingError, SimTime, Watch, Work};
use sextant_mac::csma::{self, Csma};
use sextant_mac::frame::NodeFrame;
use sextant_mac::{EnergySpent, RadioState, RadioStates};

use crate::FrameOutcome;
use crate::air::{Air, AirSettings, Arrival};
use crate::event::Event;
use crate::node::{Network, Node};
use crate::purpose;
use crate::receiver::ReceptionRules;
use crate::simulation::{NEGLECTED_BELOW_NOISE, PAN};
use crate::{BeaconConfig, Setup, Traffic, TrafficConfig};

/// Largest number of packets of a survey. The packets of discovery are numbered from here on, so that no two packets
/// share a draw.
const FIRST_PACKET: u64 = 1 << 40;

/// Neighbour discovery, as written in a scenario. It runs only if a map needs its results.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DiscoveryConfig {
    /// Hello packets that each node broadcasts: 1 to 10000.
    pub packets: u32,
    /// Mean time between two hello packets of a node (s).
    pub interval_s: f64,
    /// Length of a hello packet, header and frame check sequence included (octets): 11 to 127.
    pub mpdu_octets: u8,
    /// Radius within which nodes hear each other's hello packets (m), as if they were sent with less power; that of
    /// the channel if absent or larger. Packets of anchors, which must be heard far away, are limited only by the
    /// channel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range_m: Option<f64>,
}

impl Default for DiscoveryConfig {
    fn default() -> Self {
        Self { packets: 10, interval_s: 1.0, mpdu_octets: 20, range_m: None }
    }
}

/// Neighbour discovery.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Discovery {
    packets: u32,
    traffic: Traffic,
    range_m: Option<f64>,
}

impl TryFrom<DiscoveryConfig> for Discovery {
    type Error = SettingError;

    fn try_from(config: DiscoveryConfig) -> Result<Self, SettingError> {
        let DiscoveryConfig { packets, interval_s, mpdu_octets, range_m } = config;
        if !(1..=10_000).contains(&packets) {
            return Err(SettingError::new("packets", packets, "1 to 10000"));
        }
        if let Some(range_m) = range_m {
            SettingError::positive("range_m", range_m)?;
        }
        let beacon = BeaconConfig { mpdu_octets, interval_s, jitter: 0.5 };
        let traffic = Traffic::try_from(TrafficConfig::Beacon(beacon))
            .map_err(|error| SettingError { key: error.key.trim_start_matches("beacon.").to_owned(), ..error })?;
        Ok(Self { packets, traffic, range_m })
    }
}

/// The nodes that broadcast in a round of discovery.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Round<'a> {
    /// All nodes, within the hop radius of the settings.
    Neighbours,
    /// These nodes, limited only by the channel; all others only listen.
    Beacons(&'a [NodeId]),
}

/// The result of a round of discovery.
#[derive(Clone, Debug)]
pub struct Discovered {
    /// What the nodes heard of each other.
    pub log: NeighbourLog,
    /// Number of packets sent.
    pub sent: u64,
    /// Number of packets that were given up because the channel was busy, or replaced before they were sent.
    pub unsent: u64,
    /// Energy of the radios of all nodes together, receivers always on.
    pub energy: EnergySpent,
    /// End of the last packet.
    pub end: SimTime,
    /// Number of events.
    pub events: u64,
}

/// Runs a round of discovery in the world of `setup`, over its channel, with its radios and its channel access,
/// before any robot moves. A beacon-enabled MAC has no coordinator then, so it contends unslotted. Receivers are
/// always on. Shadowing that depends on places is the same as in the survey.
///
/// # Errors
/// If the packets are too small for the addresses, or `watch` ends the work.
pub fn discover(
    setup: &Setup,
    discovery: &Discovery,
    round: Round<'_>,
    watch: &dyn Watch,
) -> Result<Discovered, DiscoveryError> {
    let mut run = Run::new(setup, discovery, round)?;
    watch.begin(run.work());
    run.begin();
    while let Some((now, event)) = run.network.queue.pop() {
        run.network.now = now;
        run.events += 1;
        watch.check()?;
        if let Event::FrameDue(_) = event {
            watch.advance(1);
        }
        match event {
            Event::FrameDue(node) => run.offer(node),
            Event::Mac(node, event) => run.handle_mac(node, event),
            Event::CcaEnded(node) => {
                let busy = run.network.senses_busy(node);
                run.handle_mac(node, csma::Event::CcaEnded { busy });
            }
            // No robot takes part, and there is no coordinator.
            Event::Robot(..) | Event::Tracking(..) => {}
        }
    }
    Ok(run.finish(&setup.radio_states, setup))
}

/// Why there is no result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DiscoveryError {
    /// The packets have no room for the addresses.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// Whoever watches ended the work.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

/// A round under way.
struct Run {
    network: Network,
    macs: Vec<Csma>,
    sends: Vec<bool>,
    traffic: Traffic,
    packets: u64,
    /// Number of packets that each node has sent.
    sent: Vec<u32>,
    unsent: u64,
    /// Number of packets that each node has received from each other node, and the sum of their powers (dBm).
    heard: Vec<BTreeMap<NodeId, (u32, f64)>>,
    arrivals: Vec<Arrival>,
    events: u64,
}

impl Run {
    fn new(setup: &Setup, discovery: &Discovery, round: Round<'_>) -> Result<Self, SettingError> {
        let Setup { world, radio, reception, phy, mac, seed, .. } = setup;
        let nodes = world.nodes.len();
        let last = NodeId::from_index(nodes.saturating_sub(1));
        NodeFrame::broadcast(PAN, last, discovery.traffic.mpdu_octets())
            .map_err(|error| error.within("discovery"))?;
        let mut law = setup.channel;
        let (number, sends) = match round {
            Round::Neighbours => {
                law = discovery.range_m.map_or(law, |range_m| law.within_m(range_m));
                (0, vec![true; nodes])
            }
            Round::Beacons(senders) => {
                let mut sends = vec![false; nodes];
                for sender in senders {
                    sends[sender.index()] = true;
                }
                (1, sends)
            }
        };
        let channel = Channel::new(law, world.obstacles.clone(), *seed);
        let seed = Seed(seed.bits(purpose::DISCOVERY, [number, 0, 0]));
        let csma = mac.csma().with_receiver_on();
        let places = || world.nodes.iter().map(|node| node.position);
        let air = Air::new(
            AirSettings {
                channel,
                power: radio.tx_power(),
                floor: radio.noise_floor() - NEGLECTED_BELOW_NOISE,
                rules: ReceptionRules {
                    model: *reception,
                    sensitivity: radio.sensitivity().to_milliwatts(),
                    noise: radio.noise_floor().to_milliwatts(),
                    preamble: phy.synchronisation_header() - phy.octet(),
                    bit_rate_hz: phy.bit_rate_per_s(),
                },
                sensing: phy.cca(),
                first_packet: FIRST_PACKET * (number + 1),
                seed,
            },
            places(),
            nodes,
            0,
        );
        let network = Network {
            acknowledgements: Vec::new(),
            beacon: None,
            now: SimTime::ZERO,
            queue: EventQueue::new(),
            nodes: places().map(|place| Node::new(place, RadioState::Receive, 0)).collect(),
            air,
            phy: *phy,
            seed,
            cca_threshold: radio.cca_threshold().to_milliwatts(),
            hears_always: true,
        };
        Ok(Self {
            network,
            macs: vec![Csma::new(csma, *phy); nodes],
            sends,
            traffic: discovery.traffic,
            packets: discovery.packets.into(),
            sent: vec![0; nodes],
            unsent: 0,
            heard: vec![BTreeMap::new(); nodes],
            arrivals: Vec::new(),
            events: 0,
        })
    }

    /// What is to be done: each packet reaches all nodes, at most.
    fn work(&self) -> Work {
        let senders = self.sends.iter().filter(|&&sends| sends).count() as u64;
        let steps = senders * self.packets;
        #[expect(clippy::cast_precision_loss, reason = "numbers for people")]
        let operations = steps as f64 * self.sends.len() as f64;
        Work { name: "discovery", unit: "packet", steps, operations }
    }

    fn begin(&mut self) {
        for i in 0..self.macs.len() {
            let node = NodeId::from_index(i);
            self.network.air.listen(SimTime::ZERO, node, self.network.nodes[i].position);
            if self.sends[i] {
                self.schedule(node);
            }
        }
    }

    /// Schedules the next packet of a node, if one is left.
    fn schedule(&mut self, node: NodeId) {
        let count = self.network.nodes[node.index()].frames;
        if count < self.packets
            && let Some(due) = self.traffic.due(self.network.seed, node, count)
        {
            let span = due.saturating_since(self.network.now);
            self.network.after(span, Event::FrameDue(node));
        }
    }

    fn offer(&mut self, node: NodeId) {
        let state = &mut self.network.nodes[node.index()];
        state.frames += 1;
        let mac = &mut self.macs[node.index()];
        if mac.is_busy() {
            self.unsent += 1;
        } else {
            state.sequence = state.sequence.wrapping_add(1);
            let frame = csma::OutgoingFrame {
                mpdu_octets: self.traffic.mpdu_octets(),
                ack_request: false,
                sequence: state.sequence,
            };
            mac.start(frame, &mut self.network.radio(node, false));
        }
        self.schedule(node);
    }

    fn handle_mac(&mut self, node: NodeId, event: csma::Event) {
        if event == csma::Event::TransmissionEnded {
            self.end_packet(node);
        }
        let report = self.macs[node.index()].handle(event, &mut self.network.radio(node, false));
        self.unsent += u64::from(report.is_some_and(|report| report.transmissions == 0));
    }

    /// A packet ends: counts it at the nodes that received it.
    fn end_packet(&mut self, sender: NodeId) {
        let transmission = self.network.nodes[sender.index()].transmission.take();
        let transmission = transmission.expect("only a packet on air ends");
        self.network.air.end(self.network.now, &transmission, &mut self.arrivals);
        self.sent[sender.index()] += 1;
        for arrival in self.arrivals.iter().filter(|arrival| arrival.outcome == FrameOutcome::Received) {
            let (packets, sum_dbm) = self.heard[arrival.station.index()].entry(sender).or_default();
            *packets += 1;
            *sum_dbm += arrival.power.to_dbm().0;
        }
    }

    fn finish(mut self, radio_states: &RadioStates, setup: &Setup) -> Discovered {
        let mut energy = EnergySpent::default();
        for node in &mut self.network.nodes {
            let state = node.meter.state();
            node.meter.enter(state, self.network.now);
            energy += node.meter.spent(radio_states, setup.radio.tx_power());
        }
        let mut links = Vec::new();
        for (listener, heard) in self.heard.iter().enumerate() {
            links.extend(heard.iter().map(|(&sender, &(received, sum_dbm))| Link {
                listener: NodeId::from_index(listener),
                sender,
                received,
                sent: self.sent[sender.index()],
                rssi_dbm: Some(sum_dbm / f64::from(received)),
            }));
        }
        Discovered {
            log: NeighbourLog::new(self.macs.len(), links).expect("each node hears others only, each at most once"),
            sent: self.sent.iter().map(|&sent| u64::from(sent)).sum(),
            unsent: self.unsent,
            energy,
            end: self.network.now,
            events: self.events,
        }
    }
}

impl Discovered {
    /// Duration of the round.
    #[must_use]
    pub fn duration(&self) -> Duration {
        self.end - SimTime::ZERO
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_settings_are_rejected_with_their_key() {
        let good = DiscoveryConfig::default();
        let key = |config: DiscoveryConfig| Discovery::try_from(config).err().map(|error| error.key);
        assert_eq!(key(good), None);
        assert_eq!(key(DiscoveryConfig { packets: 0, ..good }).as_deref(), Some("packets"));
        assert_eq!(key(DiscoveryConfig { interval_s: f64::NAN, ..good }).as_deref(), Some("interval_s"));
        assert_eq!(key(DiscoveryConfig { mpdu_octets: 128, ..good }).as_deref(), Some("mpdu_octets"));
        assert_eq!(key(DiscoveryConfig { range_m: Some(0.0), ..good }).as_deref(), Some("range_m"));
    }
}
