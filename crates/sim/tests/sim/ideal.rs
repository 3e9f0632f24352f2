//! Ideal channel access: what a station would receive of all nodes at once, and their latest samples.

use std::collections::BTreeMap;
use std::time::Duration;

use sextant_channel::{ChannelConfig, CorrelationConfig, Db, Dbm, Position, ShadowingConfig, SpatialConfig};
use sextant_kernel::{NodeId, SimTime, StationId};
use sextant_mac::csma::CsmaConfig;
use sextant_sim::{
    Application, DeathsConfig, Delivery, Destination, FaultsConfig, Field, FieldConfig, FieldId, FieldSensorConfig,
    IdealReception, Mac, Network, Payload, Port, Sensed, Sensors, SensorsConfig, Setup, Timer, World,
};

use crate::network::{self, Ended, ieee802154};
use crate::scripted::NETWORK;

/// A node that sends one frame to all and keeps its samples, or a robot that polls ideally each second.
#[derive(Debug, Default)]
struct Station {
    sends_at: Option<Duration>,
    polls: bool,
    heard: BTreeMap<StationId, Dbm>,
    sensed: Vec<(SimTime, f64)>,
    received: Vec<(SimTime, Vec<IdealReception>)>,
    samples: Vec<(SimTime, Vec<Option<f64>>)>,
}

impl Application for Station {
    fn hears(&self) -> bool {
        self.polls
    }

    fn senses(&self) -> bool {
        !self.polls
    }

    fn started(&mut self, port: &mut Port<'_>) {
        if let Some(sends_at) = self.sends_at {
            port.after(sends_at, Timer(0));
        }
        if self.polls {
            port.listen(NETWORK, Duration::from_secs(20));
            port.after(Duration::ZERO, Timer(1));
        }
    }

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        if timer == Timer(0) {
            port.send(NETWORK, Destination::All, Payload::Octets(b"here")).expect("a free link");
            return;
        }
        let received = port.ideal_receptions(NETWORK);
        assert_eq!(received, port.ideal_receptions(NETWORK), "nothing changes at an instant");
        self.received.push((port.now(), received));
        let nodes = (0..port.node_count()).map(NodeId::from_index);
        self.samples.push((port.now(), nodes.map(|node| port.latest_sample(node, FieldId(0))).collect()));
        port.after(Duration::from_secs(1), Timer(1));
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, _port: &mut Port<'_>) {
        self.heard.insert(delivery.from, delivery.rssi);
    }

    fn sensed(&mut self, sensed: &Sensed, port: &mut Port<'_>) {
        if let Sensed::Sampled { value, .. } = *sensed {
            self.sensed.push((port.now(), value));
        }
    }
}

/// Nodes in a row, 1.5 m apart, and a robot that stands at the origin.
fn setup(nodes: usize, network: Network) -> Setup {
    let places: Vec<Position> = (1..=nodes).map(|i| Position::new(1.5 * i as f64, 0.0, 0.0)).collect();
    let setup = network::engine(&places, network, 4);
    let gas: FieldConfig =
        toml::from_str("name = \"gas\"\ngaussians = [{ center_m = [0, 0], peak = 10, sigma_m = 5 }]")
            .expect("a field");
    let sensor = FieldSensorConfig { interval_s: 3.0, offset_snr_db: Some(10.0), noise_snr_db: Some(10.0) };
    let sensors = SensorsConfig { targets: None, fields: Some(sensor) };
    Setup {
        world: World {
            fields: vec![Field::try_from(&gas).expect("a good field")],
            sensors: Sensors::try_from(sensors).expect("good sensors"),
            ..setup.world
        },
        robots: network::own_robots([network::body("r", Position::ORIGIN)]),
        duration: Some(Duration::from_secs(10)),
        ..setup
    }
}

fn shadowed(correlation: CorrelationConfig) -> Network {
    let channel = ChannelConfig {
        shadowing: Some(ShadowingConfig { sigma_db: Some(6.0), correlation }),
        max_range_m: Some(20.0),
        ..ChannelConfig::default()
    };
    let mut network = network::link(20.0, CsmaConfig::default());
    network.channel = channel.try_into().expect("good settings");
    let mac = CsmaConfig { rx_on_when_idle: true, ..CsmaConfig::default() };
    ieee802154(&mut network).mac = Mac::CsmaUnslotted(mac.try_into().expect("good settings"));
    ieee802154(&mut network).radio = network::radios(network::radio(-40.0));
    network
}

/// Runs it; each node sends one frame, one after the other.
fn run(setup: Setup) -> Ended<Station> {
    let node = |i: u64| Station { sends_at: Some(Duration::from_millis(100 * i + 50)), ..Station::default() };
    let mut stations: Vec<Station> = (0..setup.world.nodes.len() as u64).map(node).collect();
    stations.push(Station { polls: true, ..Station::default() });
    network::run(setup, stations)
}

#[test]
fn powers_are_those_of_frames_and_nodes_out_of_range_are_left_out() {
    let spatial = CorrelationConfig::Spatial(SpatialConfig { distance_m: 4.0 });
    for correlation in [CorrelationConfig::PerLink, spatial] {
        let ended = run(setup(30, shadowed(correlation)));
        let robot = ended.applications.last().expect("a robot");
        for (time, received) in &robot.received {
            let ideal: BTreeMap<StationId, Dbm> = received.iter().map(|one| (one.node.into(), one.rssi)).collect();
            assert_eq!(ideal, robot.heard, "at {time:?}");
            assert!(received.iter().all(|one| one.tx_power == Dbm(-40.0)));
        }
        // The radius of communication is 20 m, that of 13 nodes.
        assert!((4..=13).contains(&robot.heard.len()), "{} nodes", robot.heard.len());
    }
}

#[test]
fn shadowing_of_each_packet_is_drawn_anew_at_each_instant() {
    let ended = run(setup(6, shadowed(CorrelationConfig::PerPacket)));
    let robot = ended.applications.last().expect("a robot");
    let first = |i: usize| robot.received[i].1.iter().find(|one| one.node == NodeId(0)).expect("it is near").rssi;
    let change = first(0) - first(1);
    assert!(change != Db(0.0) && change.0.abs() < 60.0, "{change:?}");
}

#[test]
fn an_ideal_poll_costs_nothing_and_hears_no_dead_node() {
    let deaths = DeathsConfig { share: None, names: Some(vec!["n1".into()]), from_s: 4.5, to_s: 4.5 };
    let config = FaultsConfig { deaths: Some(deaths), ..FaultsConfig::default() };
    let plain = setup(5, shadowed(CorrelationConfig::PerLink));
    let faults = config.build(&plain.world.nodes, plain.seed).expect("good faults");
    let ended = run(Setup { faults, ..plain });
    let robot = ended.applications.last().expect("a robot");
    for (time, received) in &robot.received {
        let nodes: Vec<u32> = received.iter().map(|one| one.node.0).collect();
        let expected: &[u32] = if time.as_secs_f64() < 4.5 { &[0, 1, 2, 3, 4] } else { &[0, 2, 3, 4] };
        assert_eq!(nodes, expected, "at {time:?}");
    }
    // The frames are those that the nodes sent.
    assert_eq!(ended.networks[0].packets.iter().map(|packets| packets.sent).sum::<u64>(), 5);
}

#[test]
fn the_latest_sample_is_what_the_sensor_said_last() {
    let ended = run(setup(5, shadowed(CorrelationConfig::PerLink)));
    let robot = ended.applications.last().expect("a robot");
    assert_eq!(robot.samples.len(), 10);
    let mut known = 0;
    for (time, samples) in &robot.samples {
        for (node, sample) in samples.iter().enumerate() {
            let said = ended.applications[node].sensed.iter().rev().find(|(sensed, _)| sensed <= time);
            assert_eq!(*sample, said.map(|&(_, value)| value), "node {node} at {time:?}");
            known += usize::from(sample.is_some());
        }
    }
    // Each node samples first within 3 s.
    assert!((35..50).contains(&known), "{known}");
}
