//! Neighbour discovery: nodes broadcast hello packets for some time, and all other nodes listen. In a network with
//! sector sweeps, a hello packet is a sweep without answers, and its best frame counts.

use std::sync::Arc;
use std::time::Duration;

use serde::{Deserialize, Serialize};
use sextant_channel::{Link, NeighbourLog};
use sextant_kernel::{Interrupted, NodeId, Seed, SettingError, SimTime, StationId, Watch, Work};
use sextant_mac::EnergySpent;

use crate::applications::hello::{Announcer, HeardHellos, Hello, Says};
use crate::applications::source::Source;
use crate::applications::traffic::{PeriodicConfig, Traffic, TrafficConfig};
use crate::engine::{Ended, Engine, Extras};
use crate::link::radio_settings::FrameSize;
use crate::observer::{Observer, Progress};
use crate::purpose;
use crate::service::network_id::NetworkId;
use crate::service::packets::Packets;
use crate::service::report::Destination;
use crate::setup::Setup;
use crate::world::World;

/// The network whose radios discover each other.
const NETWORK: NetworkId = NetworkId(0);

/// Neighbour discovery, as written in a scenario. It runs only if a map needs its results.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct DiscoveryConfig {
    /// Hello packets that each node broadcasts: 1 to 10000.
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 10000)))]
    pub packets: u32,
    /// Mean time between two hello packets of a node (s).
    pub interval_s: f64,
    /// Length of a hello packet, header and frame check sequence included (octets): 11 to 127.
    #[cfg_attr(feature = "schema", schemars(range(min = 11, max = 127)))]
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
#[derive(Clone, Debug, PartialEq)]
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
        let periodic = PeriodicConfig::each(mpdu_octets, interval_s, 0.5);
        let traffic = Traffic::try_from(TrafficConfig::Periodic(periodic))
            .map_err(|error| SettingError { key: error.key.trim_start_matches("periodic.").to_owned(), ..error })?;
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
    let nodes = setup.world.nodes.len();
    let engine = engine(setup, discovery, round)?;
    let senders = match round {
        Round::Neighbours => nodes,
        Round::Beacons(senders) => senders.len(),
    };
    watch.begin(work(senders, nodes, discovery.packets));
    let mut watched = Watched { watch, advanced: 0 };
    let ended = engine.run(&mut watched);
    if ended.interrupted {
        return Err(DiscoveryError::Interrupted(Interrupted));
    }
    let all = u64::from(discovery.packets) * senders as u64;
    watch.advance(all.saturating_sub(watched.advanced));
    Ok(gathered(ended, nodes))
}

/// What is to be done: each packet reaches all nodes, at most.
fn work(senders: usize, nodes: usize, packets: u32) -> Work {
    let steps = senders as u64 * u64::from(packets);
    #[expect(clippy::cast_precision_loss, reason = "numbers for people")]
    let operations = steps as f64 * nodes as f64;
    Work { name: "discovery", unit: "packet", steps, operations }
}

/// The nodes of `setup` alone, over the channel of the round, with receivers that are always on.
fn engine(setup: &Setup, discovery: &Discovery, round: Round<'_>) -> Result<Engine<Hello>, SettingError> {
    let nodes = setup.world.nodes.len();
    let last = StationId::from_index(nodes.saturating_sub(1));
    let mut network = setup.networks[NETWORK.index()].clone();
    let sweeps = network.technology.antennas().is_some();
    let mpdu_octets = discovery.traffic.mpdu_octets();
    let hello = FrameSize { network: NETWORK, from: last, mpdu_octets, acknowledged: false };
    network.technology.settings().check_frame(hello).map_err(|error| error.within("discovery"))?;
    let (number, sends) = match round {
        Round::Neighbours => {
            network.channel = discovery.range_m.map_or(network.channel, |range_m| network.channel.within_m(range_m));
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
    network.members = None;
    network.technology.settings_mut().listen_always();
    let seed = Seed(setup.seed.bits(purpose::DISCOVERY, [number, 0, 0]));
    let (traffic, limit) = (Arc::new(discovery.traffic.clone()), u64::from(discovery.packets));
    let says = |sends: bool| match (sends, sweeps) {
        (false, _) => Says::Nothing,
        (true, false) => Says::Frames(Source::new(NETWORK, Arc::clone(&traffic), Destination::All).with_limit(limit)),
        (true, true) => Says::Sweeps(Announcer::new(NETWORK, Arc::clone(&traffic), limit)),
    };
    let applications = sends.into_iter().map(|sends| Hello::new(says(sends))).collect();
    let extras = Extras { round: number + 1, channel_seed: setup.seed, coordinator: None };
    let setup = Setup {
        // Targets and fields are there from the start of the survey.
        world: World { targets: Vec::new(), fields: Vec::new(), ..setup.world.clone() },
        robots: Vec::new(),
        sinks: Vec::new(),
        networks: vec![network],
        duration: None,
        faults: setup.faults.without_deaths(),
        batteries: None,
        seed,
    };
    Engine::new(setup, applications, extras)
}

fn gathered(ended: Ended<Hello>, nodes: usize) -> Discovered {
    let Ended { applications, networks, end, events, .. } = ended;
    let network = networks.into_iter().next().expect("discovery has one network").close();
    let mut energy = EnergySpent::default();
    network.energy.iter().for_each(|&spent| energy += spent);
    let packets: Packets = network.packets.iter().copied().sum();
    let mut links = Vec::new();
    for (listener, hello) in applications.iter().enumerate() {
        links.extend(hello.heard.iter().map(|(&sender, &HeardHellos { packets: received, sum_dbm, .. })| Link {
            listener: NodeId::from_index(listener),
            sender,
            received,
            sent: u32::try_from(network.packets[sender.index()].sent).expect("at most 10000 packets"),
            rssi_dbm: Some(sum_dbm / f64::from(received)),
        }));
    }
    Discovered {
        log: NeighbourLog::new(nodes, links).expect("each node hears others only, each at most once"),
        sent: packets.sent,
        unsent: packets.lost_queue + packets.lost_channel_access,
        energy,
        end,
        events,
    }
}

/// Passes progress on to a watch.
struct Watched<'a> {
    watch: &'a dyn Watch,
    advanced: u64,
}

impl Observer for Watched<'_> {
    fn goes_on(&mut self, progress: Progress) -> bool {
        self.watch.advance(progress.packets_offered - self.advanced);
        self.advanced = progress.packets_offered;
        self.watch.check().is_ok()
    }
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
