//! The simulator: stations in a world, the air between them, their links and their applications, and the event loop.
//!
//! A **station** is a node, a robot or a sink. It has a place or a motion, a link to each network that it is in, and
//! one [`Application`]. The **air** of a band carries signals to the receivers in reach. A **link** is the protocol
//! stack of a station: it sends the frames that applications give to it, and delivers what was received. The
//! [`Engine`] has the only event loop; traffic, neighbour discovery and surveys are applications on it.
//! In the world there may be targets, which move without a radio, and scalar fields: sensors of nodes detect and sample
//! them, and tell their applications.
//!
//! Goes in: a [`Setup`] (world, networks with their channel, radios, channel access and traffic, robots, sinks,
//! seed). Comes out: a [`Survey`]: what the robots heard and where, and the outcomes of the packets. An [`Observer`]
//! watches while it runs. [`discover`] finds what the nodes hear of each other over the same air, before any robot
//! moves. Own applications run on an [`Engine`].
//!
//! The same setup gives the same survey: events of one instant have a defined order (end of a signal, end of carrier
//! sense, start of a signal, start of carrier sense, timers, application; then by station), and each random number
//! has an address.

mod air;
mod application;
mod applications;
mod engine;
mod event;
mod link;
mod model;
mod observer;
mod outcome;
mod purpose;
mod scene;
mod sensing;
mod service;
mod simulation;
mod station;
mod world;

pub use air::{FrameOutcome, ReceptionConfig, ReceptionModel, SinrThresholdConfig};
pub use application::{Application, Driving, Port};
pub use applications::controller::{CommandOutcome, Controller, Duplicate, Ending, Heard, RobotCommand, Situation};
pub use applications::survey::Robot;
pub use applications::traffic::{
    GroupConfig, Next, NodesOfGroup, OnceConfig, PeriodicConfig, PoissonConfig, SaturatedConfig, SilentConfig,
    TraceConfig, Traffic, TrafficConfig, TrafficPlan,
};
pub use engine::{Ended, Engine, EngineSetup, NetworkSetup};
pub use event::Timer;
pub use link::ieee802154::{Mac, MacConfig, Radio, RadioConfig};
pub use observer::{FrameOnAir, HeardFrame, Observer, Progress, Unobserved};
pub use outcome::{RobotRecord, Survey};
pub use service::delivery::{Delivery, DriveEnd};
pub use service::network_id::NetworkId;
pub use service::packets::{NetworkRecord, Packets};
pub use service::report::{Destination, FrameId, Payload, SendError, SendOutcome, SendReport};
pub use service::sensed::{FieldId, Sensed, TargetId};
pub use simulation::Simulation;
pub use simulation::discovery::{Discovered, Discovery, DiscoveryConfig, DiscoveryError, Round, discover};
pub use simulation::setup::{BusyNetwork, Setup};
pub use station::{Kind, Pose, RobotBody, RobotConfig, Sink, SinkConfig};
pub use world::anchors::AnchorsConfig;
pub use world::field::{FadeConfig, Field, FieldConfig, Gaussian, GaussianConfig};
pub use world::sensors::{FieldSensor, FieldSensorConfig, Sensors, SensorsConfig, TargetSensor, TargetSensorConfig};
pub use world::target::{
    AtEnd, Course, Leg, RandomWalkConfig, StraightConfig, Target, TargetConfig, TargetMotionConfig, TurnConfig,
    WaypointsConfig,
};
pub use world::{World, WorldConfig, layout};
