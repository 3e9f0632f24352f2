//! Simulations: surveys, studies of traffic and own applications. Every scenario runs as one of these.

mod applications;
pub(crate) mod discovery;
mod futile;
mod mixed;
mod ready;
mod stations;
mod team;
mod traffic;
mod unheard;

use std::time::Duration;

use sextant_channel::{NetworkLog, NetworkLogs};
use sextant_kernel::{RobotId, SettingError};
use sextant_mac::EnergySpent;

use crate::application::Application;
use crate::applications::journey::{Journey, JourneyRecord};
use crate::applications::node_traffic::NodeTraffic;
use crate::applications::robot::RobotTask;
use crate::applications::standard::{Receiver, Standard};
use crate::engine::{Ended, Engine, Extras};
use crate::halo::{AllSimulated, SimulatedPart};
use crate::link::books::Books;
use crate::observer::{Observer, RememberingObserver};
use crate::outcome::{RobotRecord, Survey};
use crate::region::{Reach, SimulatedRegion};
use crate::service::network_id::NetworkId;
use crate::service::packets::{Packets, TooFar};
use crate::setup::Setup;
use crate::station::{Roll, StationKind};
pub use applications::Applications;
pub use ready::{LeftOut, ReadySimulation};
use stations::Stations;
pub use team::Team;
pub use unheard::UnheardInterferer;

/// A simulation that runs once, to its end. Its nodes have applications of the type `N`, and its robots and sinks may.
pub struct Simulation<N: Application = NodeTraffic> {
    engine: Engine<Standard<N>>,
    roll: Roll,
    /// Names of the robots.
    robots: Vec<String>,
    /// The networks that robots survey; the first one if no robot surveys.
    surveyed: Vec<SurveyedNetwork>,
    /// What becomes of packets in each network that only stations far away could hear.
    too_far: Vec<TooFar>,
    /// How far signals reach.
    reach: Reach,
    /// Length of the diagonal of a box round all stations at the start (m).
    extent_m: f64,
    /// Why nodes cannot rest, if they cannot.
    no_rest: Option<AllSimulated>,
    simulated: SimulatedPart,
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
        Self::of_robots(setup, None)
    }

    /// The same with these robots alone, by number, or with all; the others are not there.
    fn of_robots(setup: Setup, present: Option<&[usize]>) -> Result<Self, SettingError> {
        let nodes = traffic::of_nodes(&setup, |_| true)?;
        Self::with_all(setup, Applications::of_nodes(nodes), present)
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
        Self::with_all(setup, applications, None)
    }

    /// The same, with a start that is left out of the counts: packets that are offered before the end of the warm-up, and
    /// the energy that radios use until then. Sector sweeps all count.
    #[must_use]
    pub fn with_warm_up(self, warm_up: Duration) -> Self {
        Self { engine: self.engine.with_warm_up(warm_up), ..self }
    }

    /// The same, where only this part of the nodes' traffic is simulated: what nobody could hear is left out, and counted.
    /// All is simulated if nodes cannot rest, and [`Survey::simulated`] says why.
    ///
    /// # Errors
    /// If the halo is smaller than the reach of a frame.
    pub fn with_region(self, region: SimulatedRegion) -> Result<Self, SettingError> {
        let Some(halo_m) = region.halo_m(self.reach)? else { return Ok(self) };
        let no_rest = (self.no_rest)
            .or_else(|| (halo_m >= self.extent_m).then_some(AllSimulated::AllWithin))
            .or_else(|| region.is_all_of(self.roll.nodes).then_some(AllSimulated::FewNodes));
        Ok(match no_rest {
            Some(reason) => Self { simulated: SimulatedPart::AllBecause(reason), ..self },
            None => Self { engine: self.engine.with_halo(halo_m), ..self },
        })
    }

    fn with_all(mut setup: Setup, own: Applications<N>, present: Option<&[usize]>) -> Result<Self, SettingError> {
        let roll = setup.roll();
        stations::know(&mut setup)?;
        let stations = Stations::of(&setup);
        stations.check_mobile_anchors()?;
        let coordinator = stations.coordinator()?;
        let (reach, extent_m) = (setup.reach(), stations.extent_m());
        let (surveyed, too_far) = (surveyed(&setup), too_far(&setup));
        let names = setup.robots.iter().map(|robot| robot.body.name.clone()).collect();
        let (mut own_robots, mut own_sinks) = (own.robots.into_iter(), own.sinks.into_iter());
        let mut applications: Vec<_> = own.nodes.into_iter().map(Standard::Own).collect();
        for (i, robot) in setup.robots.iter_mut().enumerate() {
            let body = robot.body.clone();
            if present.is_some_and(|present| !present.contains(&i)) {
                applications.push(Standard::Absent);
                continue;
            }
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
        applications
            .extend(setup.sinks.iter().map(|_| own_sinks.next().map_or(Standard::Sink(Receiver), Standard::Own)));
        let extras = Extras { round: 0, channel_seed: setup.seed, coordinator };
        let no_rest = no_rest(&setup, &applications, roll);
        Ok(Self {
            engine: Engine::new(setup, applications, extras)?,
            roll,
            robots: names,
            surveyed,
            too_far,
            reach,
            extent_m,
            no_rest,
            simulated: SimulatedPart::All,
        })
    }

    /// Runs until the tasks of all robots and nodes are done, or the time is over, or the observer ends the simulation.
    pub fn run(self, observer: &mut dyn Observer) -> Survey {
        self.run_own(observer).0
    }

    /// The same, and returns also what is left of the own applications. One engine serves all observers: it is compiled once
    /// for each type of applications, and not wherever an observer is declared.
    pub fn run_own(self, observer: &mut dyn Observer) -> (Survey, Applications<N>) {
        let observer = &mut RememberingObserver::new(observer);
        let Self { engine, roll, robots: names, surveyed, too_far, simulated, .. } = self;
        let ended = engine.run(observer);
        let simulated = ended.halo_m.map_or(simulated, |halo_m| SimulatedPart::NearListeners { halo_m });
        Outcome { roll, names, surveyed, too_far, simulated }.of(ended)
    }
}

/// What the result of a simulation needs besides what an engine leaves behind.
struct Outcome {
    roll: Roll,
    /// Names of the robots.
    names: Vec<String>,
    surveyed: Vec<SurveyedNetwork>,
    /// What becomes of packets in each network that only stations far away could hear.
    too_far: Vec<TooFar>,
    simulated: SimulatedPart,
}

impl Outcome {
    /// The result, and what is left of the own applications.
    fn of<N: Application>(self, ended: Ended<Standard<N>>) -> (Survey, Applications<N>) {
        let Self { roll, names, surveyed, too_far, simulated } = self;
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
            batteries,
            interrupted,
            ..
        } = ended;
        let networks: Vec<_> = networks.into_iter().map(Books::close).collect();
        let in_logs = |robot| JourneyRecord::in_logs(RobotId::from_index(robot), &logs, roll.nodes);
        let mut own = Applications::of_nodes(Vec::with_capacity(roll.nodes));
        let mut journeys = Vec::new();
        for (station, application) in roll.stations().zip(applications) {
            match (application, roll.kind(station)) {
                (Standard::Own(node), StationKind::Node(_)) => own.nodes.push(node),
                (Standard::Own(application), StationKind::Robot(robot)) => {
                    own.robots.push(application);
                    journeys.push(in_logs(robot));
                }
                (Standard::Own(sink), StationKind::Sink(_)) => own.sinks.push(sink),
                (Standard::Robot(journey), _) => journeys.push(journey.into_record()),
                (Standard::Sink(_) | Standard::Absent, _) => {}
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
        for (network, too_far) in networks.iter().zip(too_far) {
            network.energy[..roll.nodes].iter().for_each(|&spent| energy += spent);
            packets += network.packets[..roll.nodes].iter().copied().sum::<Packets>().with_estimates(too_far);
        }
        let mut logs: Vec<_> = logs.into_iter().map(Some).collect();
        let mut surveyed = surveyed.into_iter().map(|SurveyedNetwork { id, name }| NetworkLog {
            network: name,
            log: logs[id.index()].take().expect("each network is surveyed once"),
        });
        let first = surveyed.next().expect("a network is surveyed");
        let logs = NetworkLogs::new(first, surveyed.collect());
        let survey = Survey {
            logs,
            robots,
            packets,
            energy,
            networks,
            sensed,
            deaths,
            batteries,
            end,
            events,
            simulated,
            interrupted,
        };
        (survey, own)
    }
}

/// The networks that the robots of `setup` survey; the first one if no robot surveys.
fn surveyed(setup: &Setup) -> Vec<SurveyedNetwork> {
    let name = |id: NetworkId| setup.networks.get(id.index()).and_then(|network| network.name.clone());
    setup.surveyed().into_iter().map(|id| SurveyedNetwork { id, name: name(id) }).collect()
}

/// What becomes of packets in each network of `setup` that only stations far away could hear.
fn too_far(setup: &Setup) -> Vec<TooFar> {
    setup.networks.iter().map(|network| TooFar::beyond(network.channel.max_range_m())).collect()
}

/// Why the nodes of `setup` cannot rest, if they cannot.
fn no_rest<N: Application>(setup: &Setup, applications: &[Standard<N>], roll: Roll) -> Option<AllSimulated> {
    let (nodes, others) = applications.split_at(roll.nodes);
    let of_nodes = (nodes.iter().any(Application::hears) || !nodes.iter().all(Application::may_rest))
        .then_some(AllSimulated::NodeApplications);
    setup
        .needs_all()
        .or(of_nodes)
        .or_else(|| (!others.iter().any(Application::hears)).then_some(AllSimulated::NoListener))
}

/// The error of a robot that nothing drives.
fn without_application(robot: usize) -> SettingError {
    let found = "a robot without a controller, among nodes that have applications alone";
    SettingError::new(format!("robots[{robot}]"), found, "a controller, or an own application")
}
