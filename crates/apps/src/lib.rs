//! What robots and nodes do in a network, on top of the simulator: controllers of robots, maps that are computed in
//! the nodes ([`distributed`]), routing over several hops ([`routing`]), and missions on such maps ([`Mission`]). These share [`navigation`]: robots search targets
//! ([`target_search`]), seek the source of a field ([`source_seeking`]), or keep a link while they drive ([`beam_tracking`]).
//!
//! Goes in: a [`ControllerConfig`] and the [`Surroundings`] of a robot. Comes out: a controller that drives the robot
//! through the simulation. Two controllers need no map: [`AutomatedS`], which turns where it meets an obstacle or
//! hears nothing, in the plane or in layers, and [`RandomWalk`]. The others follow a path that is planned before the
//! start: [`SPath`], [`Spiral`], [`Hilbert`] and [`Waypoints`]. After a survey, [`next_stops`] says where to listen next.
//!
//! Robots of one scenario do not block each other, do not disturb each other's radio, and do not exchange what they
//! heard. Each follows its own path or stays in its own area.
//!
//! ```
//! use sextant_apps::{SPathConfig, ControllerConfig, Surroundings};
//! use sextant_channel::{ObstacleField, Position};
//! use sextant_kernel::Seed;
//! use sextant_sim::layout::RegionConfig;
//!
//! let region = RegionConfig::Disc { center_m: Position::ORIGIN, radius_m: 10.0 };
//! let config = ControllerConfig::SPath(SPathConfig::new(region, 2.5));
//! let obstacles = ObstacleField::default();
//! let surroundings =
//!     Surroundings { obstacles: &obstacles, start: Position::ORIGIN, radius_m: 0.2, seed: Seed(1), robot: 0 };
//! let controller = config.build(&surroundings)?;
//! # Ok::<(), sextant_kernel::SettingError>(())
//! ```

#![cfg_attr(test, allow(clippy::disallowed_methods, reason = "oracles may be those of the C library"))]

mod a_star;
mod area;
mod automated_s;
pub mod beam_tracking;
mod controller;
pub mod distributed;
mod expected_way;
mod height_range;
mod hilbert;
mod itinerary;
mod mission;
mod missions;
pub mod navigation;
pub mod next_stops;
mod octets;
mod partition;
mod planned_path;
mod purpose;
mod random_walk;
mod route;
pub mod routing;
mod s_path;
pub mod source_seeking;
mod spiral;
mod surroundings;
pub mod target_search;
mod waypoints;

pub use automated_s::{AutomatedS, AutomatedSConfig, LayersConfig, Until};
pub use controller::ControllerConfig;
pub use expected_way::ExpectedWay;
pub use hilbert::{Hilbert, HilbertConfig};
pub use mission::{
    LinkRecord, Mission, MissionArrival, MissionGoal, MissionLinks, MissionMedium, MissionOutcome, MissionPlace,
    MissionRobots, MissionSettings, MissionTeam, SoughtField,
};
pub use missions::{AlgorithmConfig, MapSourceConfig, MissionConfig};
pub use octets::MessageError;
pub use partition::{BalanceConfig, CutConfig, FreeArea, PartitionConfig, RobotPart, partition};
pub use planned_path::{PathPart, drive_planned};
pub use random_walk::{RandomWalk, RandomWalkConfig};
pub use s_path::{SPath, SPathConfig};
pub use spiral::{Spiral, SpiralConfig};
pub use surroundings::Surroundings;
pub use waypoints::{Waypoints, WaypointsConfig};
