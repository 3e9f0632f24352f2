//! The simulator: stations in a world, the air between them, their links and their applications, and the event loop.
//!
//! A **station** is a node, a robot or a sink. It has a place or a motion, a link to each network that it is in, and
//! one [`Application`]. The **air** of a band carries signals to the receivers in reach. A **link** is the protocol
//! stack of a station: it sends the frames that applications give to it, and delivers what was received. The
//! engine has the only event loop; traffic, neighbour discovery and surveys are applications on it. Robots act on
//! what they believe by their [`Odometry`]; the air, the obstacles and the range sensors know the truth.
//! In the world there may be targets, which move without a radio, and scalar fields: sensors of nodes detect and sample
//! them, and tell their applications.
//!
//! Goes in: a [`Setup`] (world, networks with their channel, radios, channel access and traffic, robots, sinks,
//! seed). Comes out: a [`Survey`]: what the robots heard and where, and the outcomes of the packets. An [`Observer`]
//! watches while it runs. [`discover`] finds what the nodes hear of each other over the same air, before any robot
//! moves. Own applications of nodes, and of robots and sinks, run in [`Simulation::with`].
//!
//! The same setup gives the same survey, because each random number has an address, and events of one instant have a
//! defined order. It is: end of a signal, end of carrier sense, start of a signal, start of carrier sense, timers,
//! application; then by station.
//!
//! An own application: one node asks its neighbour for a reading, and the neighbour answers with two octets.
//!
//! ```
//! use sextant_channel::{ChannelConfig, Position};
//! use sextant_kernel::{Seed, SettingError, StationId};
//! use sextant_mac::{Phy, RadioStates, csma::CsmaSettings};
//! use sextant_sim::{
//!     Application, Applications, Delivery, Destination, Ieee802154, Mac, Network, NetworkId, Payload, Port,
//!     Radio, RadioConfig, ReceptionModel, Setup, Simulation, Technology, TrafficPlan, Unobserved, World, layout::PlacedNode,
//! };
//!
//! enum Station {
//!     Asks(Option<u16>),
//!     Answers(u16),
//! }
//!
//! impl Application for Station {
//!     fn hears(&self) -> bool {
//!         true
//!     }
//!
//!     fn started(&mut self, port: &mut Port<'_>) {
//!         if let Station::Asks(_) = self {
//!             port.send(NetworkId(0), Destination::Station(StationId(1)), Payload::Octets(b"?")).expect("a free link");
//!         }
//!     }
//!
//!     fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
//!         match self {
//!             Station::Asks(reading) => *reading = delivery.payload.try_into().ok().map(u16::from_be_bytes),
//!             Station::Answers(reading) => {
//!                 let answer = reading.to_be_bytes();
//!                 let to = Destination::Station(delivery.from);
//!                 port.send(delivery.network, to, Payload::Octets(&answer)).expect("a free link");
//!             }
//!         }
//!     }
//! }
//!
//! let node = |x_m| PlacedNode { name: format!("node at {x_m} m"), position: Position::new(x_m, 0.0, 0.0) };
//! let radio = RadioConfig {
//!     phy: Phy::Oqpsk2450,
//!     channel: Some(26),
//!     tx_power_dbm: -40.0,
//!     sensitivity_dbm: -95.0,
//!     cca_threshold_dbm: None,
//!     noise_floor_dbm: None,
//!     clock_ppm: 0.0,
//!     groups: Vec::new(),
//! };
//! let links = Ieee802154 {
//!     radio: Radio::try_from(radio)?.with_reception(ReceptionModel::Ber),
//!     mac: Mac::CsmaUnslotted(CsmaSettings::default().with_receiver_on()),
//! };
//! let (law, technology) = (ChannelConfig::default().try_into()?, Technology::Ieee802154(links));
//! let network = Network::of(law, technology, RadioStates::cc2420(), TrafficPlan::silent(2));
//! let world = World { nodes: vec![node(0.0), node(3.0)], ..World::default() };
//! let setup = Setup::of(world, network, Seed(1));
//! let stations = Applications::of_nodes(vec![Station::Asks(None), Station::Answers(451)]);
//! let (survey, stations) = Simulation::with(setup, stations)?.run_own(&mut Unobserved);
//! assert!(matches!(stations.nodes[0], Station::Asks(Some(451))));
//! assert_eq!(survey.networks[0].packets[1].received, 1);
//! # Ok::<(), SettingError>(())
//! ```

#![cfg_attr(test, allow(clippy::disallowed_methods, reason = "oracles may be those of the C library"))]

mod air;
mod application;
mod applications;
mod batteries;
pub mod csv_rows;
mod engine;
mod event;
mod faults;
mod halo;
mod link;
mod link_budget;
mod link_trace;
mod model;
mod network;
mod observer;
mod outcome;
mod purpose;
mod region;
mod scene;
mod sensing;
mod service;
mod setup;
mod simulation;
mod snapshot;
mod station;
mod sum_fields;
mod world;

pub use air::{ReceptionConfig, ReceptionModel, ThresholdConfig};
pub use application::{Application, BoxedApplication, DriveAhead, Driving, Port, RadioPort};
pub use applications::broadcast::{Broadcast, DuplicateBroadcast};
pub use applications::controller::{
    CommandOutcome, Controller, Duplicate, Ending, HeardNode, RobotCommand, Situation, StopsLeftOut,
};
pub use applications::node_traffic::NodeTraffic;
pub use applications::robot::{Robot, RobotTask};
pub use applications::traffic::{
    GroupConfig, Next, OnceConfig, PeriodicConfig, PoissonConfig, SaturatedConfig, SilentConfig, TraceConfig,
    Traffic, TrafficConfig, TrafficPlan,
};
pub use batteries::{Batteries, BatteryConfig, BatteryGroupConfig, BatteryRecord, BatterySupply};
pub use event::Timer;
pub use faults::{Death, DeathsConfig, Faults, FaultsConfig, LyingAnchorsConfig};
pub use halo::{AllSimulated, SimulatedPart};
pub use link::antennas::{Antennas, AntennasConfig, HeadingsConfig, RobotHeadingsConfig};
pub use link::ieee80211ad::DmgRadio;
pub use link::ieee802154::{Mac, Radio};
pub use link::programmed::{Acknowledging, Hearing, Programmed, RadioFrame};
pub use link::settings::{KnownTree, TreeTraffic};
pub use link::{
    CellFault, FrameFormat, Ieee80211ad, Ieee802154, LinkConfig, LinkError, MacConfig, RadioConfig, RadioGroupConfig,
    Sleeping, Technology, Tsch,
};
pub use link_budget::{LinkBudget, LinkBudgets, LinkReception};
pub use link_trace::{LinkTraceConfig, NetworkTrace, OtherLinksConfig, TraceStations};
pub use network::Network;
pub use observer::{FrameOnAir, HeardFrame, Observer, Progress, Unobserved};
pub use outcome::{RobotRecord, Survey};
pub use purpose::program_seed;
pub use region::{MANY_NODES, Reach, SimulatedRegion};
pub use service::delays::{DelayCount, Delays};
pub use service::delivery::{Delivery, DriveEnd};
pub use service::estimate::Estimate;
pub use service::ideal::{IdealReception, SectorPair, SectorPowers};
pub use service::network_id::NetworkId;
pub use service::outcome::{Deafness, FrameOutcome};
pub use service::packet_trace::{AssessmentTrace, PacketEnd, PacketFate, PacketKind, PacketTrace, TransmissionTrace};
pub use service::packets::{LeftPacket, NetworkRecord, Packets};
pub use service::radio_error::RadioError;
pub use service::radio_event::{RadioEvent, ReceivedFrame};
pub use service::report::{Destination, FrameId, Payload, SendError, SendOutcome, SendReport};
pub use service::rhythm::{CellSpan, Rhythm};
pub use service::sensed::{FieldId, Sensations, Sensed, TargetId};
pub use service::sleep::SleepUse;
pub use service::slots::SlotUse;
pub use service::sweep::{Announcement, SweepAnswer, SweepError, SweepKind};
pub use setup::Setup;
pub use simulation::discovery::{Discovered, Discovery, DiscoveryConfig, DiscoveryError, Round, discover};
pub use simulation::{Applications, LeftOut, ReadySimulation, Simulation, Team, UnheardInterferer};
pub use snapshot::{Reached, RobotSnapshot, Snapshot};
pub use station::{
    Listening, Odometry, OdometryConfig, OwnFrame, OwnFrameConfig, Pose, RobotBody, RobotConfig, RobotPose,
    RoleConfig, Sink, SinkConfig, StationKind,
};
pub use world::anchors::{AnchorsConfig, OptimisedAnchorsConfig};
pub use world::field::{FadeConfig, Field, FieldConfig, Gaussian, GaussianConfig};
pub use world::interferer::{Interferer, InterfererConfig};
pub use world::layout::NodesOfGroup;
pub use world::motion::{
    MotionFileConfig, MotionFormat, NodeMotion, NodeMotionConfig, NodeWayConfig, RandomWaypointConfig,
};
pub use world::sensors::{FieldSensor, FieldSensorConfig, Sensors, SensorsConfig, TargetSensor, TargetSensorConfig};
pub use world::target::{
    AtEnd, Course, EvadeConfig, Leg, RandomWalkConfig, StraightConfig, Target, TargetConfig, TargetMotionConfig,
    TurnConfig, WanderConfig, WaypointsConfig,
};
pub use world::{World, WorldConfig, layout};
