//! What a radio link does to power, and what a listener heard.
//!
//! Goes in: places of transmitter and receiver, obstacles, an environment. Comes out: received power.
//! The crate also holds the nouns that pass from simulation to mapping: [`Reception`], [`ReceptionLog`].

mod bounds;
mod channel;
mod environment;
mod field;
mod glam;
mod material;
mod obstacle;
mod path_loss;
mod position;
mod power;
mod reception;
mod shadowing;
mod shape;
mod span;
mod tree;

pub use bounds::Bounds;
pub use channel::{Channel, ChannelConfig};
pub use environment::Environment;
pub use field::{Crossing, ObstacleField};
pub use material::Material;
pub use obstacle::{Obstacle, ObstacleConfig};
pub use path_loss::{LogDistance, LogDistanceConfig, PathLossConfig};
pub use position::Position;
pub use power::{Db, Dbm, Milliwatts};
pub use reception::{Contact, LogError, Reception, ReceptionLog, Stop};
pub use shadowing::{CorrelationConfig, Shadowing, ShadowingConfig, SpatialConfig};
pub use shape::{
    BoxConfig, ConvexConfig, CylinderConfig, MeshConfig, PrismConfig, Shape, ShapeConfig,
};
