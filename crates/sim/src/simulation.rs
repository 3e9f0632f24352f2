//! Surveys and studies of traffic: every scenario runs as one of these.

pub(crate) mod discovery;
pub(crate) mod setup;
mod stations;

use std::sync::Arc;

use sextant_kernel::{NodeId, SettingError};
use sextant_mac::EnergySpent;

use crate::application::Application;
use crate::applications::journey::Journey;
use crate::applications::node_traffic::NodeTraffic;
use crate::applications::source::Source;
use crate::applications::standard::Standard;
use crate::engine::{Ended, Engine, EngineSetup, Extras};
use crate::observer::{Observer, Told};
use crate::outcome::{RobotRecord, Survey};
use crate::service::network_id::NetworkId;
use crate::service::packets::Packets;
use crate::station::Roll;
use setup::{BusyNetwork, Setup};
use stations::{Stations, too_many};

/// A simulation that runs once, to its end. Its nodes have applications of the type `N`.
pub struct Simulation<N: Application = NodeTraffic> {
    engine: Engine<Standard<N>>,
    nodes: usize,
    /// The networks that robots survey; the first one if no robot surveys.
    surveyed: Vec<NetworkId>,
}

impl Simulation {
    /// A simulation, ready to run, whose nodes send the traffic of their networks.
    ///
    /// # Errors
    /// If the frames are too small for the addresses, there are several robots but frames are sent to one of them,
    /// or the superframes do not fit the world, robots and traffic.
    pub fn new(setup: Setup) -> Result<Self, SettingError> {
        Self::with_applications(setup, |stations, networks| {
            let mut sources: Vec<Vec<Source>> = vec![Vec::new(); stations.roll.nodes];
            for (id, network) in (0..=u8::MAX).map(NetworkId).zip(networks) {
                stations.check_frames(id, network)?;
                for (node, sources) in sources.iter_mut().enumerate() {
                    let node = NodeId::from_index(node);
                    let Some(traffic) = network.traffic.of(node).filter(|_| network.has(node)) else { continue };
                    let to = stations.destination(id, traffic, node)?;
                    sources.push(Source::new(id, Arc::new(traffic.clone()), to));
                }
            }
            Ok(sources.into_iter().map(NodeTraffic::new).collect())
        })
    }

    /// Runs until the last robot has finished, or the time is over, or the observer ends the simulation.
    pub fn run(self, observer: &mut impl Observer) -> Survey {
        self.run_told(observer).0
    }
}

impl<N: Application> Simulation<N> {
    /// A simulation, ready to run, whose nodes have these applications, in the order of the nodes. They send what they
    /// want, so there is no other traffic.
    ///
    /// # Errors
    /// If the traffic of a node is not silent, or the superframes do not fit the world and the robots.
    ///
    /// # Panics
    /// If there is not one application for each node.
    pub fn with_nodes(setup: Setup, nodes: Vec<N>) -> Result<Self, SettingError> {
        assert_eq!(nodes.len(), setup.world.nodes.len(), "one application for each node");
        Self::with_applications(setup, |stations, networks| {
            networks.iter().try_for_each(|network| refuse_traffic(network, stations.roll.nodes))?;
            Ok(nodes)
        })
    }

    /// A simulation with the applications of nodes that `nodes` makes for these stations and networks.
    fn with_applications(
        setup: Setup,
        nodes: impl FnOnce(&Stations<'_>, &[BusyNetwork]) -> Result<Vec<N>, SettingError>,
    ) -> Result<Self, SettingError> {
        let surveyed = setup.surveyed();
        let Setup { world, networks, robots, sinks, duration, faults, seed } = setup;
        let roll = Roll { nodes: world.nodes.len(), robots: robots.len(), sinks: sinks.len() };
        if networks.is_empty() {
            return Err(SettingError::new("networks", "empty", "at least one network"));
        }
        if networks.len() > 256 {
            return Err(too_many(networks.len()));
        }
        let stations = Stations { world: &world, robots: &robots, sinks: &sinks, roll };
        let nodes = nodes(&stations, &networks)?;
        stations.check_mobile_anchors(&networks)?;
        let coordinator = stations.coordinator(&networks, seed)?;
        let links = networks.into_iter().enumerate().map(|(i, network)| stations.joined(i, network)).collect();
        let bodies = robots.iter().map(|robot| robot.body.clone()).collect();
        let applications = (nodes.into_iter().map(Standard::Node))
            .chain(robots.into_iter().map(|robot| Standard::Robot(Box::new(Journey::new(robot, roll.nodes)))))
            .chain(sinks.iter().map(|_| Standard::Sink))
            .collect();
        let setup = EngineSetup { world, robots: bodies, sinks, networks: links, duration, faults, seed };
        let extras = Extras { first_packet: 0, channel_seed: seed, coordinator };
        Ok(Self { engine: Engine::with(setup, applications, extras)?, nodes: roll.nodes, surveyed })
    }

    /// Runs until the tasks of all robots and nodes are done, or the time is over, or the observer ends the simulation.
    /// Returns also what is left of the applications of the nodes.
    pub fn run_nodes(self, observer: &mut impl Observer) -> (Survey, Vec<N>) {
        self.run_told(observer)
    }

    /// The same for any observer: one engine for all, compiled once for each type of applications and not wherever an
    /// observer is declared.
    fn run_told(self, observer: &mut dyn Observer) -> (Survey, Vec<N>) {
        let observer = &mut Told::new(observer);
        let Self { engine, nodes, surveyed } = self;
        let Ended { applications, logs, path_lengths_m, networks, end, events, sensed, deaths, interrupted } =
            engine.run(observer);
        let mut own = Vec::with_capacity(nodes);
        let mut journeys = Vec::new();
        for application in applications {
            match application {
                Standard::Node(node) => own.push(node),
                Standard::Robot(journey) => journeys.push(journey.into_record()),
                Standard::Sink => {}
            }
        }
        let robots = (journeys.into_iter().zip(path_lengths_m))
            .map(|(journey, path_length_m)| RobotRecord {
                name: journey.name,
                stops: journey.stops,
                path_length_m,
                ending: journey.ending.map(|(ending, _)| ending),
                end: journey.ending.map(|(_, end)| end),
                packets: journey.packets,
            })
            .collect();
        let mut energy = EnergySpent::default();
        let mut packets = Packets::default();
        for network in &networks {
            network.energy[..nodes].iter().for_each(|&spent| energy += spent);
            packets += network.packets[..nodes].iter().copied().sum();
        }
        let mut logs = (0..=u8::MAX).map(NetworkId).zip(logs).filter(|(network, _)| surveyed.contains(network));
        let (_, log) = logs.next().expect("a network is surveyed");
        let other_logs = logs.collect();
        let survey =
            Survey { log, other_logs, robots, packets, energy, networks, sensed, deaths, end, events, interrupted };
        (survey, own)
    }
}

/// Refuses traffic of nodes that have applications of their own.
fn refuse_traffic(network: &BusyNetwork, nodes: usize) -> Result<(), SettingError> {
    let members = (0..nodes).map(NodeId::from_index).filter(|&node| network.has(node));
    let Some(traffic) = members.filter_map(|node| network.traffic.of(node)).find(|traffic| !traffic.is_silent())
    else {
        return Ok(());
    };
    let key = network.name.as_ref().map_or_else(|| "traffic".to_owned(), |name| format!("networks.{name}.traffic"));
    let allowed = "`silent = {}`: nodes with applications of their own send what these say";
    Err(SettingError::new(key, format!("`{}`", traffic.key()), allowed))
}
