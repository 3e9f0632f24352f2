//! Surveys and studies of traffic: every scenario runs as one of these.

pub(crate) mod discovery;
pub(crate) mod setup;

use sextant_kernel::{SettingError, StationId};
use sextant_mac::EnergySpent;
use sextant_mac::coordinator::Coordinator;
use sextant_mac::frame::DataFrame;

use crate::applications::source::Source;
use crate::applications::standard::Standard;
use crate::applications::survey::{Robot, Survey as SurveyOfRobot};
use crate::engine::{Ended, Engine, EngineSetup, Extras};
use crate::link::ieee802154::network::pan;
use crate::link::ieee802154::{self, Demand, Mac, Post};
use crate::observer::Observer;
use crate::outcome::{RobotRecord, Survey};
use crate::service::network_id::NetworkId;
use crate::service::packets::Packets;
use crate::service::report::Destination;
use crate::station::Roll;
use setup::{BusyNetwork, Setup};

/// The network that robots survey.
const SURVEYED: NetworkId = NetworkId(0);

/// A simulation that runs once, to its end.
pub struct Simulation {
    engine: Engine<Standard>,
    nodes: usize,
}

impl Simulation {
    /// A simulation, ready to run.
    ///
    /// # Errors
    /// If the frames are too small for the addresses, there are several robots but frames are sent to one of them,
    /// or the superframes do not fit the world, robots and traffic.
    pub fn new(setup: Setup) -> Result<Self, SettingError> {
        let Setup { world, networks, robots, sinks, duration, seed } = setup;
        let roll = Roll { nodes: world.nodes.len(), robots: robots.len(), sinks: sinks.len() };
        let network =
            networks.first().ok_or_else(|| SettingError::new("networks", "empty", "at least one network"))?;
        check_traffic(network, &roll)?;
        let to = destination(network, &roll);
        let coordinator = coordinator(network, &roll, &robots, |post, demand| {
            let names = world.nodes.iter().map(|node| &*node.name);
            let Mac::BeaconEnabled(settings) = &network.link.mac else { return Ok(None) };
            let phy = network.link.radio.phy();
            ieee802154::coordinator(settings, phy, (SURVEYED, seed), post, names, &[demand]).map(Some)
        })?;
        let bodies = robots.iter().map(|robot| robot.body.clone()).collect();
        let source = Source::new(SURVEYED, network.traffic, to);
        let applications = (0..roll.nodes)
            .map(|_| Standard::Source(source.clone()))
            .chain(robots.into_iter().map(|robot| Standard::Survey(Box::new(SurveyOfRobot::new(robot, roll.nodes)))))
            .chain(sinks.iter().map(|_| Standard::Sink))
            .collect();
        let networks = networks.into_iter().map(|network| network.link).collect();
        let setup = EngineSetup { world, robots: bodies, sinks, networks, duration, seed };
        let extras = Extras { first_packet: 0, channel_seed: seed, coordinator };
        Ok(Self { engine: Engine::with(setup, applications, extras)?, nodes: roll.nodes })
    }

    /// Runs until the last robot has finished, or the time is over, or the observer ends the simulation.
    pub fn run(self, observer: &mut impl Observer) -> Survey {
        let Self { engine, nodes } = self;
        let Ended { applications, log, path_lengths_m, networks, end, events, interrupted } = engine.run(observer);
        let surveys = applications.into_iter().filter_map(|application| match application {
            Standard::Survey(survey) => Some(survey.into_record()),
            Standard::Source(_) | Standard::Sink => None,
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
        Survey { log, robots, packets, energy, end, events, interrupted }
    }
}

/// Refuses frames that are too small for the addresses, and frames to one of several robots.
fn check_traffic(network: &BusyNetwork, roll: &Roll) -> Result<(), SettingError> {
    let traffic = &network.traffic;
    if traffic.is_acknowledged() && roll.robots > 1 {
        let allowed = format!(
            "one robot with `{}`: nodes send to the first robot, and the others do not hear them",
            traffic.key()
        );
        return Err(SettingError::new("robots", format!("a list of {}", roll.robots), allowed));
    }
    let last = StationId::from_index(roll.len().saturating_sub(1));
    let pan = pan(SURVEYED);
    let longest =
        if traffic.is_acknowledged() { DataFrame::unicast(pan, last, last) } else { DataFrame::broadcast(pan, last) };
    longest.filler(traffic.mpdu_octets()).map_err(|error| error.within(traffic.key()))?;
    Ok(())
}

/// To whom the nodes send.
fn destination(network: &BusyNetwork, roll: &Roll) -> Destination {
    if network.traffic.is_acknowledged() && roll.robots + roll.sinks > 0 {
        Destination::Station(roll.robot(0))
    } else {
        Destination::All
    }
}

/// The coordinator of a network with beacons: the first robot, or the first sink if there is no robot.
fn coordinator(
    network: &BusyNetwork,
    roll: &Roll,
    robots: &[Robot],
    make: impl FnOnce(Post, Demand) -> Result<Option<Coordinator>, SettingError>,
) -> Result<Option<(StationId, Coordinator)>, SettingError> {
    if roll.robots + roll.sinks == 0 {
        return Ok(None);
    }
    let post = Post { station: roll.robot(0), listen: robots.first().map(|robot| robot.body.listen) };
    let demand = Demand {
        key: network.traffic.key(),
        mpdu_octets: network.traffic.mpdu_octets(),
        acknowledged: network.traffic.is_acknowledged(),
    };
    Ok(make(post, demand)?.map(|coordinator| (post.station, coordinator)))
}
