//! The simulator: world, medium, robots, and the event loops of surveys and of neighbour discovery.
//!
//! Goes in: a [`Setup`] (world, channel, radios, channel access, traffic, robots, seed). Comes out: a [`Survey`]:
//! what the robots heard and where, and the outcomes of the packets. An [`Observer`] watches while it runs.
//! [`discover`] finds what the nodes hear of each other over the same medium, before any robot moves.
//!
//! The same setup gives the same survey: events of one instant have a defined order (end of a signal, end of carrier
//! sense, start of a signal, start of carrier sense, timers, application; then by station), and each random number
//! has an address.

mod air;
mod anchors;
mod cells;
mod controller;
mod discovery;
mod event;
mod frame_outcome;
mod mac;
mod medium;
mod node;
mod observer;
mod pilot;
mod purpose;
mod radio;
mod receiver;
mod reception_model;
mod robot;
mod simulation;
mod survey;
mod traffic;
mod world;

pub mod layout;

pub use anchors::AnchorsConfig;
pub use controller::{CommandOutcome, Controller, Duplicate, Ending, Heard, RobotCommand, Situation};
pub use discovery::{Discovered, Discovery, DiscoveryConfig, DiscoveryError, Round, discover};
pub use frame_outcome::FrameOutcome;
pub use mac::{Mac, MacConfig};
pub use observer::{FrameOnAir, HeardFrame, Observer, Progress, Unobserved};
pub use radio::{Radio, RadioConfig};
pub use reception_model::{ReceptionConfig, ReceptionModel, SinrThresholdConfig};
pub use robot::{Robot, RobotBody, RobotConfig};
pub use simulation::{Setup, Simulation};
pub use survey::{Packets, RobotRecord, Survey};
pub use traffic::{BeaconConfig, QueryConfig, Traffic, TrafficConfig};
pub use world::{World, WorldConfig};
