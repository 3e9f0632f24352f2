//! Surveys and studies of traffic: every scenario runs as one of these.

pub(crate) mod discovery;
pub(crate) mod setup;
mod stations;

use std::sync::Arc;

use sextant_kernel::{NodeId, SettingError};
use sextant_mac::EnergySpent;

use crate::applications::source::Source;
use crate::applications::standard::Standard;
use crate::applications::survey::Survey as SurveyOfRobot;
use crate::engine::{Ended, Engine, EngineSetup, Extras};
use crate::observer::{Observer, Told};
use crate::outcome::{RobotRecord, Survey};
use crate::service::network_id::NetworkId;
use crate::service::packets::Packets;
use crate::station::Roll;
use setup::Setup;
use stations::{Stations, too_many};

/// A simulation that runs once, to its end.
pub struct Simulation {
    engine: Engine<Standard>,
    nodes: usize,
    /// The networks that robots survey; the first one if there are no robots.
    surveyed: Vec<NetworkId>,
}

impl Simulation {
    /// A simulation, ready to run.
    ///
    /// # Errors
    /// If the frames are too small for the addresses, there are several robots but frames are sent to one of them,
    /// or the superframes do not fit the world, robots and traffic.
    pub fn new(setup: Setup) -> Result<Self, SettingError> {
        let surveyed = setup.surveyed();
        let Setup { world, networks, robots, sinks, duration, seed } = setup;
        let roll = Roll { nodes: world.nodes.len(), robots: robots.len(), sinks: sinks.len() };
        if networks.is_empty() {
            return Err(SettingError::new("networks", "empty", "at least one network"));
        }
        let stations = Stations { world: &world, robots: &robots, sinks: &sinks, roll };
        let mut sources: Vec<Vec<Source>> = vec![Vec::new(); roll.nodes];
        for (i, network) in networks.iter().enumerate() {
            let id = NetworkId(u8::try_from(i).map_err(|_| too_many(networks.len()))?);
            stations.check_frames(id, network)?;
            for (node, sources) in sources.iter_mut().enumerate() {
                let node = NodeId::from_index(node);
                let Some(traffic) = network.traffic.of(node).filter(|_| network.has(node)) else { continue };
                let to = stations.destination(id, traffic, node)?;
                sources.push(Source::new(id, Arc::new(traffic.clone()), to));
            }
        }
        let coordinator = stations.coordinator(&networks, seed)?;
        let links = networks.into_iter().enumerate().map(|(i, network)| stations.joined(i, network)).collect();
        let bodies = robots.iter().map(|robot| robot.body.clone()).collect();
        let one_or_more = |mut sources: Vec<Source>| match sources.len() {
            1 => Standard::Source(sources.remove(0)),
            _ => Standard::Sources(sources.into()),
        };
        let applications = (sources.into_iter().map(one_or_more))
            .chain(robots.into_iter().map(|robot| Standard::Survey(Box::new(SurveyOfRobot::new(robot, roll.nodes)))))
            .chain(sinks.iter().map(|_| Standard::Sink))
            .collect();
        let setup = EngineSetup { world, robots: bodies, sinks, networks: links, duration, seed };
        let extras = Extras { first_packet: 0, channel_seed: seed, coordinator };
        Ok(Self { engine: Engine::with(setup, applications, extras)?, nodes: roll.nodes, surveyed })
    }

    /// Runs until the last robot has finished, or the time is over, or the observer ends the simulation.
    pub fn run(self, observer: &mut impl Observer) -> Survey {
        self.run_told(observer)
    }

    /// The same for any observer: one engine for all, compiled here and not wherever an observer is declared.
    fn run_told(self, observer: &mut dyn Observer) -> Survey {
        let observer = &mut Told::new(observer);
        let Self { engine, nodes, surveyed } = self;
        let Ended { applications, logs, path_lengths_m, networks, end, events, sensed, interrupted } =
            engine.run(observer);
        let surveys = applications.into_iter().filter_map(|application| match application {
            Standard::Survey(survey) => Some(survey.into_record()),
            Standard::Source(_) | Standard::Sources(_) | Standard::Sink => None,
        });
        let robots = (surveys.zip(path_lengths_m))
            .map(|(survey, path_length_m)| RobotRecord {
                name: survey.name,
                stops: survey.stops,
                path_length_m,
                ending: survey.ending.map(|(ending, _)| ending),
                end: survey.ending.map(|(_, end)| end),
                packets: survey.packets,
            })
            .collect();
        let mut energy = EnergySpent::default();
        let mut packets = Packets::default();
        for network in &networks {
            network.energy[..nodes].iter().for_each(|&spent| energy += spent);
            packets += network.packets[..nodes].iter().copied().sum();
        }
        let mut logs = (0..).map(NetworkId).zip(logs).filter(|(network, _)| surveyed.contains(network));
        let (_, log) = logs.next().expect("a network is surveyed");
        let other_logs = logs.collect();
        Survey { log, other_logs, robots, packets, energy, networks, sensed, end, events, interrupted }
    }
}
