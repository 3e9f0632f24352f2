//! Setups of the tests: a network in a suburban area, and a robot that drives to places and listens there.

use std::time::Duration;

use sextant_channel::{ChannelConfig, ObstacleField, Position};
use sextant_kernel::Seed;
use sextant_mac::csma::CsmaSettings;
use sextant_mac::{Phy, RadioStates};
use sextant_sim::layout::PlacedNode;
use sextant_sim::{
    BusyNetwork, CommandOutcome, Controller, Ending, Listening, Mac, NetworkSetup, Odometry, Packets, Radio,
    RadioConfig, ReceptionModel, Robot, RobotBody, RobotCommand, Setup, Situation, Traffic, TrafficConfig, World,
};

/// Drives to each place and listens there, or in front of the obstacle that blocks it.
#[derive(Clone)]
struct Tour {
    places: Vec<Position>,
    next: usize,
}

impl Controller for Tour {
    fn decide(&mut self, situation: &Situation<'_>) -> RobotCommand {
        match situation.outcome {
            CommandOutcome::Started | CommandOutcome::Listened(_) => {
                self.next += 1;
                match self.places.get(self.next - 1) {
                    Some(&place) if place == situation.position => RobotCommand::Listen,
                    Some(&place) => RobotCommand::Drive(place),
                    None => RobotCommand::Finish(Ending::Complete),
                }
            }
            CommandOutcome::Arrived | CommandOutcome::Blocked(_) => RobotCommand::Listen,
        }
    }
}

/// A robot that starts at the origin and listens at each of `places`.
pub(crate) fn tour(places: Vec<Position>, radius_m: f64, listen: Duration) -> Robot {
    let body = RobotBody { radius_m, listen, ..surveyor_body() };
    Robot { body, controller: Box::new(Tour { places, next: 0 }) }
}

/// A robot at the origin that drives at 1 m/s.
pub(crate) fn surveyor_body() -> RobotBody {
    RobotBody {
        name: "surveyor".into(),
        start: Position::ORIGIN,
        speed_m_per_s: 1.0,
        radius_m: 0.25,
        listen: Duration::from_secs(1),
        listening: Listening::AtStops,
        odometry: Odometry::default(),
    }
}

/// Nodes called `n0`, `n1`, ... at `places`.
pub(crate) fn nodes(places: &[Position]) -> Vec<PlacedNode> {
    let node = |(i, &position): (usize, &Position)| PlacedNode { name: format!("n{i}"), position };
    places.iter().enumerate().map(node).collect()
}

/// This many places near the origin, all within reach of each other.
pub(crate) fn cluster(count: usize) -> Vec<Position> {
    (0..count).map(|i| Position::new(1.0 + 0.01 * i as f64, 0.0, 0.0)).collect()
}

/// Radios that send with `tx_power_dbm`.
pub(crate) fn radio(tx_power_dbm: f64) -> RadioConfig {
    RadioConfig {
        phy: Phy::Oqpsk2450,
        channel: None,
        tx_power_dbm,
        sensitivity_dbm: -90.0,
        cca_threshold_dbm: None,
        noise_floor_dbm: None,
    }
}

/// Nodes at `places` without obstacles that send with `tx_power_dbm` by unslotted CSMA-CA over `channel`. Overlapping
/// frames are lost. No robot listens.
pub(crate) fn setup(
    places: &[Position],
    tx_power_dbm: f64,
    channel: ChannelConfig,
    traffic: TrafficConfig,
    seed: u64,
) -> Setup {
    let link = NetworkSetup {
        channel: channel.try_into().expect("good settings"),
        radio: Radio::try_from(radio(tx_power_dbm)).expect("good settings"),
        reception: ReceptionModel::Overlap,
        mac: Mac::CsmaUnslotted(CsmaSettings::default()),
        radio_states: RadioStates::cc2420(),
    };
    Setup {
        world: World { nodes: nodes(places), obstacles: ObstacleField::default() },
        networks: vec![BusyNetwork { link, traffic: Traffic::try_from(traffic).expect("good settings") }],
        robots: Vec::new(),
        sinks: Vec::new(),
        duration: None,
        seed: Seed(seed),
    }
}

/// The same with changes to its network.
pub(crate) fn with(mut setup: Setup, change: impl FnOnce(&mut BusyNetwork)) -> Setup {
    change(&mut setup.networks[0]);
    setup
}

/// Number of packets over all outcomes; must equal the number offered.
pub(crate) fn ended(packets: &Packets) -> u64 {
    let Packets { lost_channel_access, lost_queue, pending, received, .. } = packets;
    let Packets { lost_collision, lost_signal, out_of_range, not_listened, .. } = packets;
    lost_channel_access + lost_queue + pending + received + lost_collision + lost_signal + out_of_range + not_listened
}
