//! What robots do in a network: controllers on top of the simulator.
//!
//! Goes in: a [`ControllerConfig`] and the [`Surroundings`] of a robot. Comes out: a controller that drives the robot
//! through the simulation. The survey robots are [`AutomatedS`], which knows no map and turns where it meets an
//! obstacle or hears nobody, and two that follow a path laid out beforehand: [`SPath`] and [`Waypoints`].
//!
//! ```
//! use sextant_apps::{SPathConfig, ControllerConfig, Surroundings};
//! use sextant_channel::{ObstacleField, Position};
//! use sextant_sim::layout::RegionConfig;
//!
//! let region = RegionConfig::Disc { center_m: Position::ORIGIN, radius_m: 10.0 };
//! let config = ControllerConfig::SPath(SPathConfig::new(region, 2.5));
//! let surroundings = Surroundings { obstacles: &ObstacleField::default(), start: Position::ORIGIN, radius_m: 0.2 };
//! let controller = config.build(&surroundings)?;
//! # Ok::<(), sextant_kernel::SettingError>(())
//! ```

mod automated_s;
mod controller;
mod itinerary;
mod route;
mod s_path;
mod waypoints;

pub use automated_s::{AutomatedS, AutomatedSConfig, Until};
pub use controller::{ControllerConfig, Surroundings};
pub use s_path::{SPath, SPathConfig};
pub use waypoints::{Waypoints, WaypointsConfig};
