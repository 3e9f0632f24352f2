//! Search for moving targets on a map of the nodes (Gunathillake 2018, chapter 6).
//!
//! Nodes detect targets within a radius and keep the times. The first ones tell a sink hop by hop, and the sink tells the
//! robots. A robot then asks the nodes around it for their detections, predicts where the target is, and drives there.
//!
//! The mathematics: [`Sightings`] turns what nodes detected into measured places, [`RobustKalman`] filters them, and
//! [`ParticleFilter`] is its comparator. [`Trajectory`] says where the target will be, [`Pursuit`] where a robot can
//! meet it, [`assign`] which robot goes to which target, and [`CellMap`] how to get there.

mod assignment;
mod config;
mod grid_path;
mod interception;
mod message;
mod particle_filter;
mod robust_kalman;
mod sightings;
mod target_state;
mod trajectory;

pub use assignment::assign;
pub use config::{
    Aim, DetarskConfig, FilterConfig, Informants, OwnPlaceRule, PGConfig, ParticlesConfig, PathRule, Prediction,
    RobustKalmanConfig,
};
pub use grid_path::CellMap;
pub use interception::{Meeting, Pursuit};
pub use message::{Claim, Detection, FirstDetection, GradientMessage, Message};
pub use particle_filter::{ParticleFilter, ParticleFilterSettings, SeenBy, Space};
pub use robust_kalman::{Multiplier, RobustKalman, RobustKalmanSettings, Robustness};
pub use sightings::{NodeSightings, Sighting, Sightings, SightingsSettings};
pub use target_state::{AxisCovariance, Fix, TargetState};
pub use trajectory::{
    AxisForecast, CurveForm, Forecast, Limit, NextTurn, Trajectory, TrajectorySettings, Trust, TurnRule, TurnTimes,
};
