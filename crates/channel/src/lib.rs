//! Power on radio links, and the log of what a listener heard.
//!
//! Goes in: places of transmitter and receiver, obstacles, an environment. Comes out: received power.
//! The crate also has the types that pass from simulation to mapping: [`Reception`], [`ReceptionLog`],
//! [`NeighbourLog`], [`Anchor`].
//!
//! An [`Antenna`] has a gain for each of its sectors and each direction.
//!
//! A [`Channel`] is path loss with distance ([`LogDistance`]), absorption along the straight line through obstacles
//! ([`ObstacleField`], Lambert-Bouguer law) and shadowing ([`Shadowing`]): equations 3.14 to 3.16 of the thesis.
//! Lengths inside obstacles are exact. All results are reciprocal, bit for bit, and pure functions of their arguments
//! and the seed.
//!
//! ```
//! use sextant_channel::{
//!     BoxConfig, Channel, ChannelConfig, Dbm, Environment, Obstacle, ObstacleConfig, ObstacleField, Position,
//!     ShapeConfig, };
//! use sextant_kernel::Seed;
//!
//! let wall = ObstacleConfig {
//!     name: Some("wall".into()),
//!     shape: ShapeConfig::Box(BoxConfig {
//!         center_m: Position::new(5.0, 0.0, 0.0),
//!         size_m: [0.5, 8.0, 3.0],
//!         yaw_deg: 0.0,
//!     }),
//!     material: Some("concrete".into()),
//!     absorption_per_m: None, loss_db: None, solid: true, reflection_loss_db: None,
//! };
//! let obstacles = ObstacleField::new(vec![Obstacle::try_from(wall)?]);
//! let config = ChannelConfig { environment: Some(Environment::Suburban), ..ChannelConfig::default() };
//! let channel = Channel::new(config.try_into()?, obstacles, Seed(1));
//!
//! let (node, robot) = (Position::ORIGIN, Position::new(10.0, 0.0, 0.0));
//! let power = channel.mean_power(Dbm(-50.0), node, robot).expect("no hard radius");
//! // 27 dB by distance, 10 dB by half a metre of concrete.
//! assert!((power.0 - (-50.0 - 27.0 - 9.989)).abs() < 1e-3);
//! # Ok::<(), sextant_kernel::SettingError>(())
//! ```

#![cfg_attr(test, allow(clippy::disallowed_methods, reason = "oracles may be those of the C library"))]

mod antenna;
mod bounds;
mod cell_grid;
mod cell_index;
#[cfg(feature = "obstacles")]
mod channel;
#[cfg_attr(not(feature = "obstacles"), expect(dead_code, reason = "fields are those of rays among obstacles"))]
mod complex;
#[cfg(feature = "obstacles")]
mod edge;
mod environment;
#[cfg(feature = "obstacles")]
mod field;
#[cfg(feature = "obstacles")]
mod fresnel;
mod gas;
#[cfg(feature = "obstacles")]
mod glam;
mod law;
#[cfg_attr(not(feature = "obstacles"), expect(dead_code, reason = "materials are those of obstacles"))]
mod material;
#[cfg(feature = "obstacles")]
mod mirror;
mod neighbour;
#[cfg(feature = "obstacles")]
mod obstacle;
#[cfg(feature = "obstacles")]
mod path_budget;
mod path_loss;
mod polygon;
mod position;
mod power;
mod purpose;
#[cfg(feature = "obstacles")]
mod rays;
mod reception;
mod reflection;
mod sector;
mod sector_gains;
mod sector_table;
mod shadowing;
#[cfg(feature = "obstacles")]
mod shape;
mod sight;
#[cfg(feature = "obstacles")]
mod span;
#[cfg(feature = "obstacles")]
mod tree;
mod turned_sectors;

pub use antenna::{
    Antenna, AntennaConfig, AntennaSectorsConfig, CodeBookConfig, EllipticalConfig, FlatBeam, FlatTopConfig, Gaps,
    Ieee802153cConfig, LobeEdge, OmnidirectionalConfig, Orientation, OrientationConfig, PatternConfig, SectorAddress,
    SectorEdge, SectorGainsConfig, Tr38901Config, Vertical, look_like_factors,
};
pub use bounds::Bounds;
pub use cell_grid::CellGrid;
pub use cell_index::CellIndex;
#[cfg(feature = "obstacles")]
pub use channel::Channel;
pub use environment::Environment;
#[cfg(feature = "obstacles")]
pub use field::{Crossing, ObstacleField};
pub use gas::GasConfig;
pub use law::{ChannelConfig, ChannelLaw};
pub use material::{Material, MaterialName};
pub use neighbour::{Anchor, Link, NeighbourError, NeighbourLog};
#[cfg(feature = "obstacles")]
pub use obstacle::{Obstacle, ObstacleConfig};
#[cfg(feature = "obstacles")]
pub use path_budget::{ObstacleLoss, PathBudget};
pub use path_loss::{CloseInConfig, DistanceLoss, LogDistance, LogDistanceConfig, PathLossConfig};
pub use polygon::Polygon;
pub use position::Position;
pub use power::{Db, Dbm, Milliwatts};
pub use reception::{
    Contact, Drive, HeardAtStop, LogError, NetworkLog, NetworkLogs, Reception, ReceptionLog, ReceptionLogBuilder,
    Receptions, ReceptionsIter, SectorReport, SectorSnr, Stop, StopLog,
};
pub use reflection::{Polarisation, Ray, ReflectionsConfig, angles_rad};
pub use sector::{EvenSectorsConfig, SectorConfig, SectorDirections, Wedge};
pub use sector_gains::{ListenerAntennaConfig, SectorGains};
pub use sector_table::SectorTable;
pub use shadowing::{CorrelationConfig, Shadowing, ShadowingConfig, ShadowingLaw, SpatialConfig};
#[cfg(feature = "obstacles")]
pub use shape::{BoxConfig, ConvexConfig, CylinderConfig, MeshConfig, PrismConfig, Shape, ShapeConfig};
