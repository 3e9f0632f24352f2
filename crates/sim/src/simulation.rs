//! Surveys, studies of traffic and own applications: every scenario runs as one of these.

pub(crate) mod discovery;
pub(crate) mod own;
pub(crate) mod setup;
mod stations;

use std::sync::Arc;
use std::time::Duration;

use sextant_kernel::{NodeId, SettingError};
use sextant_mac::EnergySpent;

use crate::application::Application;
use crate::applications::journey::{Journey, JourneyRecord};
use crate::applications::node_traffic::NodeTraffic;
use crate::applications::robot::{Robot, RobotTask};
use crate::applications::source::Source;
use crate::applications::standard::Standard;
use crate::engine::{Ended, Engine, EngineSetup, Extras};
use crate::link::ieee802154::Clock;
use crate::observer::{Observer, Told};
use crate::outcome::{RobotRecord, Survey};
use crate::service::network_id::NetworkId;
use crate::service::packets::Packets;
use crate::station::{Kind, RobotBody, Roll};
use own::OwnApplications;
use setup::{BusyNetwork, Setup};
use stations::{Stations, too_many};

/// A simulation that runs once, to its end. Its nodes have applications of the type `N`; its robots and sinks have
/// them too in [`Simulation::with_own`].
pub struct Simulation<N: Application = NodeTraffic> {
    engine: Engine<Standard<N>>,
    roll: Roll,
    /// Names of the robots.
    robots: Vec<String>,
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
        let seed = setup.seed;
        Self::with_applications(setup, Vec::new(), Vec::new(), |stations, networks| {
            let mut sources: Vec<Vec<Source>> = vec![Vec::new(); stations.roll.nodes];
            for (id, network) in (0..=u8::MAX).map(NetworkId).zip(networks) {
                stations.check_frames(id, network)?;
                for (node, sources) in sources.iter_mut().enumerate() {
                    let node = NodeId::from_index(node);
                    let Some(traffic) = network.traffic.of(node).filter(|_| network.has(node)) else { continue };
                    let to = stations.destination(id, traffic, node)?;
                    let clock = match network.link.technology.ieee802154() {
                        Some(settings) => settings.radio.clock(seed, id, node),
                        None => Clock::default(),
                    };
                    sources.push(Source::new(id, Arc::new(traffic.clone()), to).with_clock(clock));
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
    /// The same, with a start that is left out of the counts: see [`Engine::with_warm_up`].
    #[must_use]
    pub fn with_warm_up(self, warm_up: Duration) -> Self {
        Self { engine: self.engine.with_warm_up(warm_up), ..self }
    }

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
        Self::with_applications(setup, Vec::new(), Vec::new(), |stations, networks| {
            networks.iter().try_for_each(|network| refuse_traffic(network, stations.roll.nodes))?;
            Ok(nodes)
        })
    }

    /// A simulation with the applications of nodes that `nodes` makes for these stations and networks, and these own
    /// applications of robots that wait for one, and of sinks, if they have any.
    fn with_applications(
        setup: Setup,
        own_robots: Vec<N>,
        own_sinks: Vec<N>,
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
        let bodies: Vec<RobotBody> = robots.iter().map(|robot| robot.body.clone()).collect();
        let names = bodies.iter().map(|body| body.name.clone()).collect();
        let (mut own_robots, mut own_sinks) = (own_robots.into_iter(), own_sinks.into_iter());
        let mut applications: Vec<_> = nodes.into_iter().map(Standard::Own).collect();
        for (i, Robot { body, task }) in robots.into_iter().enumerate() {
            let journey = match task {
                RobotTask::Survey(controller) => Journey::of_survey(body, controller, roll.nodes),
                RobotTask::MobileAnchor { controller, broadcast } => {
                    Journey::of_mobile_anchor(body, controller, broadcast, roll.nodes)
                }
                RobotTask::Own => {
                    let own = own_robots.next().ok_or_else(|| without_application(i))?;
                    applications.push(Standard::Own(own));
                    continue;
                }
            };
            applications.push(Standard::Robot(Box::new(journey)));
        }
        applications.extend(sinks.iter().map(|_| own_sinks.next().map_or(Standard::Sink, Standard::Own)));
        let setup = EngineSetup { world, robots: bodies, sinks, networks: links, duration, faults, seed };
        let extras = Extras { first_packet: 0, channel_seed: seed, coordinator };
        Ok(Self { engine: Engine::with(setup, applications, extras)?, roll, robots: names, surveyed })
    }

    /// Runs until the tasks of all robots and nodes are done, or the time is over, or the observer ends the simulation.
    /// Returns also what is left of the applications of the nodes.
    pub fn run_nodes(self, observer: &mut impl Observer) -> (Survey, Vec<N>) {
        let (survey, own) = self.run_told(observer);
        (survey, own.nodes)
    }

    /// The same for any observer: one engine for all, compiled once for each type of applications and not wherever an
    /// observer is declared.
    fn run_told(self, observer: &mut dyn Observer) -> (Survey, OwnApplications<N>) {
        let observer = &mut Told::new(observer);
        let Self { engine, roll, robots: names, surveyed } = self;
        let Ended {
            applications,
            logs,
            path_lengths_m,
            end_poses,
            networks,
            end,
            events,
            sensed,
            deaths,
            interrupted,
        } = engine.run(observer);
        let mut own =
            OwnApplications { nodes: Vec::with_capacity(roll.nodes), robots: Vec::new(), sinks: Vec::new() };
        let mut journeys = Vec::new();
        for (station, application) in roll.stations().zip(applications) {
            match (application, roll.kind(station)) {
                (Standard::Own(node), Kind::Node(_)) => own.nodes.push(node),
                (Standard::Own(robot), Kind::Robot(_)) => {
                    own.robots.push(robot);
                    journeys.push(JourneyRecord::none(roll.nodes));
                }
                (Standard::Own(sink), Kind::Sink(_)) => own.sinks.push(sink),
                (Standard::Robot(journey), _) => journeys.push(journey.into_record()),
                (Standard::Sink, _) => {}
            }
        }
        let robots = (names.into_iter().zip(journeys).zip(path_lengths_m).zip(end_poses))
            .map(|(((name, journey), path_length_m), end_pose)| RobotRecord {
                name,
                stops: journey.stops,
                path_length_m,
                ending: journey.ending.map(|(ending, _)| ending),
                end: journey.ending.map(|(_, end)| end),
                packets: journey.packets,
                end_pose,
            })
            .collect();
        let mut energy = EnergySpent::default();
        let mut packets = Packets::default();
        for network in &networks {
            network.energy[..roll.nodes].iter().for_each(|&spent| energy += spent);
            packets += network.packets[..roll.nodes].iter().copied().sum();
        }
        let mut logs = (0..=u8::MAX).map(NetworkId).zip(logs).filter(|(network, _)| surveyed.contains(network));
        let (_, log) = logs.next().expect("a network is surveyed");
        let other_logs = logs.collect();
        let survey =
            Survey { log, other_logs, robots, packets, energy, networks, sensed, deaths, end, events, interrupted };
        (survey, own)
    }
}

/// The error of a robot that nothing drives.
fn without_application(robot: usize) -> SettingError {
    let found = "a robot without a controller, among nodes that have applications alone";
    SettingError::new(format!("robots[{robot}]"), found, "a controller, or an own application")
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
