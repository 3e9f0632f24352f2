//! Simulations: surveys, studies of traffic and own applications. Every scenario runs as one of these.

mod applications;
pub(crate) mod discovery;
mod stations;

use std::sync::Arc;
use std::time::Duration;

use sextant_channel::{NetworkLog, NetworkLogs};
use sextant_kernel::{NodeId, SettingError};
use sextant_mac::EnergySpent;

use crate::application::Application;
use crate::applications::journey::{Journey, JourneyRecord};
use crate::applications::node_traffic::NodeTraffic;
use crate::applications::robot::RobotTask;
use crate::applications::source::Source;
use crate::applications::standard::Standard;
use crate::engine::{Ended, Engine, Extras};
use crate::observer::{Observer, RememberingObserver};
use crate::outcome::{RobotRecord, Survey};
use crate::service::network_id::NetworkId;
use crate::service::packets::Packets;
use crate::setup::Setup;
use crate::station::{Kind, Roll};
pub use applications::Applications;
use stations::Stations;

/// A simulation that runs once, to its end. Its nodes have applications of the type `N`, and its robots and sinks may.
pub struct Simulation<N: Application = NodeTraffic> {
    engine: Engine<Standard<N>>,
    roll: Roll,
    /// Names of the robots.
    robots: Vec<String>,
    /// The networks that robots survey; the first one if no robot surveys.
    surveyed: Vec<SurveyedNetwork>,
}

/// A network that robots survey.
struct SurveyedNetwork {
    id: NetworkId,
    name: Option<String>,
}

impl Simulation {
    /// A simulation, ready to run, whose nodes send the traffic of their networks.
    ///
    /// # Errors
    /// If the frames are too small for the addresses, there are several robots but frames are sent to one of them,
    /// or the superframes do not fit the world, robots and traffic.
    pub fn new(setup: Setup) -> Result<Self, SettingError> {
        let stations = Stations::of(&setup);
        let mut sources: Vec<Vec<Source>> = vec![Vec::new(); stations.roll.nodes];
        for (id, network) in (0..=u8::MAX).map(NetworkId).zip(&setup.networks) {
            stations.check_frames(id, network)?;
            for (node, sources) in sources.iter_mut().enumerate() {
                let node = NodeId::from_index(node);
                let Some(traffic) = network.traffic.of(node).filter(|_| network.has(node)) else { continue };
                let to = stations.destination(id, traffic, node)?;
                let clock = network.technology.settings().clock(setup.seed, id, node);
                sources.push(Source::new(id, Arc::new(traffic.clone()), to).with_clock(clock));
            }
        }
        let nodes = sources.into_iter().map(NodeTraffic::new).collect();
        Self::with_all(setup, Applications::of_nodes(nodes))
    }
}

impl<N: Application> Simulation<N> {
    /// A simulation, ready to run, whose nodes have these applications, and its robots and sinks if they are there: one for
    /// each robot whose task is [`RobotTask::Own`], and one for each sink or none. They send what they want, so there is
    /// no other traffic.
    ///
    /// # Errors
    /// If the traffic of a node is not silent, or a network has superframes in which an own application of a robot or a
    /// sink could not send, or the superframes do not fit the world and the robots.
    ///
    /// # Panics
    /// If there is not one application for each of these stations.
    pub fn with(setup: Setup, applications: Applications<N>) -> Result<Self, SettingError> {
        applications.check(&setup)?;
        Self::with_all(setup, applications)
    }

    /// The same, with a start that is left out of the counts: packets that are offered before the end of the warm-up, and
    /// the energy that radios use until then. Sector sweeps all count.
    #[must_use]
    pub fn with_warm_up(self, warm_up: Duration) -> Self {
        Self { engine: self.engine.with_warm_up(warm_up), ..self }
    }

    fn with_all(mut setup: Setup, own: Applications<N>) -> Result<Self, SettingError> {
        let roll = setup.roll();
        let stations = Stations::of(&setup);
        stations.check_mobile_anchors()?;
        let coordinator = stations.coordinator()?;
        let name = |id: NetworkId| setup.networks.get(id.index()).and_then(|network| network.name.clone());
        let surveyed = setup.surveyed().into_iter().map(|id| SurveyedNetwork { id, name: name(id) }).collect();
        let names = setup.robots.iter().map(|robot| robot.body.name.clone()).collect();
        let (mut own_robots, mut own_sinks) = (own.robots.into_iter(), own.sinks.into_iter());
        let mut applications: Vec<_> = own.nodes.into_iter().map(Standard::Own).collect();
        for (i, robot) in setup.robots.iter_mut().enumerate() {
            let body = robot.body.clone();
            applications.push(match std::mem::replace(&mut robot.task, RobotTask::Own) {
                RobotTask::Survey(controller) => {
                    Standard::Robot(Box::new(Journey::of_survey(body, controller, roll.nodes)))
                }
                RobotTask::MobileAnchor { controller, broadcast } => {
                    Standard::Robot(Box::new(Journey::of_mobile_anchor(body, controller, broadcast, roll.nodes)))
                }
                RobotTask::Own => Standard::Own(own_robots.next().ok_or_else(|| without_application(i))?),
            });
        }
        applications.extend(setup.sinks.iter().map(|_| own_sinks.next().map_or(Standard::Sink, Standard::Own)));
        let extras = Extras { first_packet: 0, channel_seed: setup.seed, coordinator };
        Ok(Self { engine: Engine::new(setup, applications, extras)?, roll, robots: names, surveyed })
    }

    /// Runs until the tasks of all robots and nodes are done, or the time is over, or the observer ends the simulation.
    pub fn run(self, observer: &mut impl Observer) -> Survey {
        self.run_told(observer).0
    }

    /// The same, and returns also what is left of the own applications.
    pub fn run_own(self, observer: &mut impl Observer) -> (Survey, Applications<N>) {
        self.run_told(observer)
    }

    /// The same for any observer: one engine for all, compiled once for each type of applications and not wherever an
    /// observer is declared.
    fn run_told(self, observer: &mut dyn Observer) -> (Survey, Applications<N>) {
        let observer = &mut RememberingObserver::new(observer);
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
        let mut own = Applications::of_nodes(Vec::with_capacity(roll.nodes));
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
                left_out: journey.left_out,
                end_pose,
            })
            .collect();
        let mut energy = EnergySpent::default();
        let mut packets = Packets::default();
        for network in &networks {
            network.energy[..roll.nodes].iter().for_each(|&spent| energy += spent);
            packets += network.packets[..roll.nodes].iter().copied().sum();
        }
        let mut logs: Vec<_> = logs.into_iter().map(Some).collect();
        let mut surveyed = surveyed.into_iter().map(|SurveyedNetwork { id, name }| NetworkLog {
            network: name,
            log: logs[id.index()].take().expect("each network is surveyed once"),
        });
        let first = surveyed.next().expect("a network is surveyed");
        let logs = NetworkLogs::new(first, surveyed.collect());
        let survey = Survey { logs, robots, packets, energy, networks, sensed, deaths, end, events, interrupted };
        (survey, own)
    }
}

/// The error of a robot that nothing drives.
fn without_application(robot: usize) -> SettingError {
    let found = "a robot without a controller, among nodes that have applications alone";
    SettingError::new(format!("robots[{robot}]"), found, "a controller, or an own application")
}
