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
//! [`Fading`], [`Bursts`] and a [`LinkTrace`] change links in time.
//! Lengths inside obstacles are exact. All results are reciprocal, bit for bit, and pure functions of their arguments
//! and the seed.
//!
//! ```
//! use sextant_channel::{
//!     BoxConfig, Channel, ChannelConfig, Dbm, Environment, Obstacle, ObstacleConfig, ObstacleField, Position,
//!     ShapeConfig, };
//! use sextant_kernel::Seed;
//!
//! let wall = BoxConfig::new(Position::new(5.0, 0.0, 0.0), [0.5, 8.0, 3.0]);
//! let wall = ObstacleConfig::of(ShapeConfig::Box(wall), "concrete");
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
#[cfg(feature = "obstacles")]
mod channel;
mod fading;
mod geometry;
mod neighbour;
#[cfg(feature = "obstacles")]
mod obstacles;
mod power;
mod propagation;
mod purpose;
mod ranging;
mod reception;

pub use antenna::sector::{EvenSectorsConfig, SectorConfig, SectorDirections, Wedge};
pub use antenna::sector_gains::{ListenerAntennaConfig, SectorGains};
pub use antenna::sector_table::SectorTable;
pub use antenna::{
    Antenna, AntennaConfig, AntennaSectorsConfig, CodeBookConfig, EllipticalConfig, FlatBeam, FlatTopConfig, Gaps,
    Ieee802153cConfig, LobeEdge, OmnidirectionalConfig, Orientation, OrientationConfig, PatternConfig, SectorAddress,
    SectorEdge, SectorGainsConfig, Tr38901Config, Vertical, look_like_factors,
};
#[cfg(feature = "obstacles")]
pub use channel::Channel;
pub use fading::bursts::{Bursts, BurstsConfig, BurstsLaw, LinkState};
pub use fading::config::{FadingConfig, FadingLawConfig, NakagamiConfig, RicianConfig};
pub use fading::law::FadingLaw;
pub use fading::process::{Fading, FadingBand, FadingEnd};
pub use fading::trace::{LinkTrace, OtherLinks, Traced, TracedLink};
pub use geometry::bounds::Bounds;
pub use geometry::cell_grid::CellGrid;
pub use geometry::cell_index::CellIndex;
pub use geometry::polygon::{Polygon, nearest_on_line};
pub use geometry::position::Position;
#[cfg(feature = "obstacles")]
pub use geometry::shape::{BoxConfig, ConvexConfig, CylinderConfig, MeshConfig, PrismConfig, Shape, ShapeConfig};
pub use neighbour::{Anchor, Link, NeighbourError, NeighbourLog};
#[cfg(feature = "obstacles")]
pub use obstacles::crossing::Crossing;
pub use obstacles::field::ObstacleField;
#[cfg(feature = "obstacles")]
pub use obstacles::obstacle::{Obstacle, ObstacleConfig};
#[cfg(feature = "obstacles")]
pub use obstacles::storey::{SlabConfig, StoreyConfig, Storeys};
#[cfg(feature = "obstacles")]
pub use obstacles::wall::{OpeningConfig, USUAL_HEIGHT_M, USUAL_THICKNESS_M, WallConfig};
pub use power::{Db, Dbm, Milliwatts};
pub use propagation::environment::Environment;
pub use propagation::gas::GasConfig;
pub use propagation::law::{ChannelConfig, ChannelLaw};
pub use propagation::material::{Material, MaterialName};
#[cfg(feature = "obstacles")]
pub use propagation::path_budget::{ObstacleLoss, PathBudget};
pub use propagation::path_loss::{CloseInConfig, DistanceLoss, LogDistance, LogDistanceConfig, PathLossConfig};
pub use propagation::reflection::{Polarisation, Ray, ReflectionsConfig, angles_rad};
pub use propagation::screen::{Screen, ScreenConfig};
pub use propagation::shadowing::{CorrelationConfig, Shadowing, ShadowingConfig, ShadowingLaw, SpatialConfig};
pub use ranging::device::{IdealExchangeConfig, RangeExchangeConfig, RangeTry, RangingDevice, RangingDeviceConfig};
pub use ranging::law::{PreparedRangeErrorLaw, RangeErrorDensity, RangeErrorLaw, RangeErrorShares};
pub use reception::{
    Contact, Drive, HeardAtStop, LogError, Mounting, NetworkLog, NetworkLogs, RangeSample, Reception, ReceptionLog,
    ReceptionLogBuilder, Receptions, ReceptionsIter, SectorReport, SectorSnr, Stop, StopLog,
};
