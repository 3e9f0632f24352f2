//! Setups of the tests: a network in a suburban area, and a robot that drives to places and listens there.

use std::time::Duration;

use sextant_channel::{ChannelConfig, Environment, LogDistanceConfig, PathLossConfig, Position};
use sextant_kernel::{Seed, SettingError};
use sextant_mac::csma::{CsmaConfig, CsmaSettings};
use sextant_mac::{Phy, RadioStates};
use sextant_sim::layout::PlacedNode;
use sextant_sim::{
    Application, Applications, CommandOutcome, Controller, Ending, Ieee802154, Listening, Mac, Network, NetworkId,
    Observer, Odometry, OwnFrame, Packets, Radio, RadioConfig, ReceptionModel, Robot, RobotBody, RobotCommand,
    RobotTask, Setup, Simulation, Situation, Survey, Technology, Traffic, TrafficConfig, TrafficPlan, Unobserved,
    World,
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
    Robot { body, task: RobotTask::Survey(Box::new(Tour { places, next: 0 })) }
}

/// A robot at the origin that drives at 1 m/s.
pub(crate) fn surveyor_body() -> RobotBody {
    RobotBody {
        name: "surveyor".into(),
        start: Position::ORIGIN,
        believed_start: None,
        speed_m_per_s: 1.0,
        radius_m: 0.25,
        listen: Duration::from_secs(1),
        listening: Listening::AtStops,
        odometry: Odometry::default(),
        frame: OwnFrame::default(),
        networks: vec![NetworkId::default()],
        sweeps_per_stop: 1,
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
        clock_ppm: 0.0,
        groups: Vec::new(),
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
    let network = Network::of(
        channel.try_into().expect("good settings"),
        Technology::Ieee802154(Ieee802154 {
            radio: radios(radio(tx_power_dbm)),
            mac: Mac::CsmaUnslotted(CsmaSettings::default()),
        }),
        RadioStates::cc2420(),
        plan(traffic, places.len()),
    );
    Setup::of(World { nodes: nodes(places), ..World::default() }, network, Seed(seed))
}

/// The same traffic for all of `nodes` nodes.
pub(crate) fn plan(traffic: TrafficConfig, nodes: usize) -> TrafficPlan {
    TrafficPlan::all(Traffic::try_from(traffic).expect("good settings"), nodes)
}

/// The same with changes to its network.
pub(crate) fn with(mut setup: Setup, change: impl FnOnce(&mut Network)) -> Setup {
    change(&mut setup.networks[0]);
    setup
}

/// The settings of IEEE 802.15.4 of a network.
pub(crate) fn ieee802154(link: &mut Network) -> &mut Ieee802154 {
    let Technology::Ieee802154(settings) = &mut link.technology else { panic!("a network of IEEE 802.15.4") };
    settings
}

/// Radios at which two signals that overlap destroy each other.
pub(crate) fn radios(config: RadioConfig) -> Radio {
    Radio::try_from(config).expect("good settings").with_reception(ReceptionModel::Overlap)
}

/// Frames are received by this rule.
pub(crate) fn receive_by(link: &mut Network, rule: ReceptionModel) {
    let links = ieee802154(link);
    links.radio = links.radio.clone().with_reception(rule);
}

/// Number of packets over all outcomes; must equal the number offered.
pub(crate) fn ended(packets: &Packets) -> u64 {
    let Packets { lost_channel_access, lost_queue, pending, received, .. } = packets;
    let Packets { lost_collision, lost_signal, out_of_range, not_listened, .. } = packets;
    lost_channel_access + lost_queue + pending + received + lost_collision + lost_signal + out_of_range + not_listened
}

/// Channel access whose instants are known while nobody disturbs: no backoff before the first assessment, receivers
/// always on.
pub(crate) fn prompt() -> CsmaConfig {
    CsmaConfig { min_be: 0, rx_on_when_idle: true, ..CsmaConfig::default() }
}

/// Free space: 6 dB less at each doubling of the distance, without shadowing.
pub(crate) fn free_space() -> ChannelConfig {
    let law = LogDistanceConfig { exponent: Some(2.0), ..LogDistanceConfig::default() };
    ChannelConfig { environment: None, path_loss: Some(PathLossConfig::LogDistance(law)), ..ChannelConfig::default() }
}

/// A suburban area in which stations hear each other up to `range_m`.
pub(crate) fn suburb(range_m: f64) -> ChannelConfig {
    ChannelConfig { environment: Some(Environment::Suburban), max_range_m: Some(range_m), ..ChannelConfig::default() }
}

/// A network in which stations within `range_m` of each other hear each other, without shadowing, and others do not.
/// Overlapping frames are lost. Its nodes send nothing by themselves.
pub(crate) fn link(range_m: f64, csma: CsmaConfig) -> Network {
    let channel = ChannelConfig { max_range_m: Some(range_m), ..free_space() };
    Network::of(
        channel.try_into().expect("good settings"),
        Technology::Ieee802154(Ieee802154 {
            radio: radios(radio(0.0)),
            mac: Mac::CsmaUnslotted(csma.try_into().expect("good settings")),
        }),
        RadioStates::cc2420(),
        TrafficPlan::silent(0),
    )
}

/// Nodes at `places`, without obstacles, robots and sinks, in one network, until nothing is left to happen.
pub(crate) fn engine(places: &[Position], link: Network, seed: u64) -> Setup {
    Setup::of(World { nodes: nodes(places), ..World::default() }, link, Seed(seed))
}

/// The body of a robot that starts at `start`.
pub(crate) fn body(name: &str, start: Position) -> RobotBody {
    RobotBody { name: name.into(), start, speed_m_per_s: 0.5, radius_m: 0.2, ..surveyor_body() }
}

/// `columns` times `rows` places one metre apart, row by row.
pub(crate) fn grid(columns: usize, rows: usize) -> Vec<Position> {
    (0..columns * rows).map(|i| Position::new((i % columns) as f64, (i / columns) as f64, 0.0)).collect()
}

/// Robots with these bodies and applications of their own.
pub(crate) fn own_robots(bodies: impl IntoIterator<Item = RobotBody>) -> Vec<Robot> {
    bodies.into_iter().map(|body| Robot { body, task: RobotTask::Own }).collect()
}

/// What a simulation leaves behind, with the applications of all stations in one list.
pub(crate) struct Ended<A> {
    pub(crate) applications: Vec<A>,
    pub(crate) survey: Survey,
}

impl<A> std::ops::Deref for Ended<A> {
    type Target = Survey;

    fn deref(&self) -> &Survey {
        &self.survey
    }
}

/// A simulation with applications of any types: its engine is compiled once for all tests.
pub(crate) type AnySimulation<'a> = Simulation<&'a mut dyn Application>;

/// A simulation with these applications of the stations, which are lent to it.
pub(crate) fn lend<A: Application>(
    setup: Setup,
    own: &mut Applications<A>,
) -> Result<AnySimulation<'_>, SettingError> {
    let Applications { nodes, robots, sinks } = own;
    let [nodes, robots, sinks] =
        [nodes, robots, sinks].map(|stations| stations.iter_mut().map(|own| own as &mut dyn Application).collect());
    Simulation::with(setup, Applications { nodes, robots, sinks })
}

/// Runs a simulation with these applications to its end, and returns what is left of them.
pub(crate) fn run_own<A: Application>(
    setup: Setup,
    mut own: Applications<A>,
    observer: &mut dyn Observer,
) -> (Survey, Applications<A>) {
    let survey = lend(setup, &mut own).expect("good settings").run(observer);
    (survey, own)
}

/// An application for each station: those of the nodes first, then robots, then sinks.
fn of_stations<A>(setup: &Setup, mut applications: Vec<A>) -> Applications<A> {
    let mut robots = applications.split_off(setup.world.nodes.len());
    let sinks = robots.split_off(setup.robots.len());
    Applications { nodes: applications, robots, sinks }
}

/// What is wrong with a simulation that has an application for each station.
pub(crate) fn refusal<A: Application>(setup: Setup, applications: Vec<A>) -> Option<SettingError> {
    let mut own = of_stations(&setup, applications);
    lend(setup, &mut own).err()
}

/// Runs a simulation to its end.
pub(crate) fn run_watched<A: Application>(
    setup: Setup,
    applications: Vec<A>,
    observer: &mut dyn Observer,
) -> Ended<A> {
    let own = of_stations(&setup, applications);
    let (survey, Applications { nodes, robots, sinks }) = run_own(setup, own, observer);
    Ended { applications: nodes.into_iter().chain(robots).chain(sinks).collect(), survey }
}

/// Runs a simulation to its end, without an observer.
pub(crate) fn run<A: Application>(setup: Setup, applications: Vec<A>) -> Ended<A> {
    run_watched(setup, applications, &mut Unobserved)
}
