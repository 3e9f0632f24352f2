//! Search for moving targets on a map of the nodes (Gunathillake 2018, chapter 6).
//!
//! Nodes detect targets within a radius and keep the times. The first ones tell a sink hop by hop, and the sink tells the
//! robots. A robot then asks the nodes around it for their detections, predicts where the target is, and drives there
//! (DeTarSK); or it follows a pseudo-gradient that the nodes work out again and again (P-G).
//!
//! The mathematics: `Sightings` turns what nodes detected into measured places, `RobustKalman` filters them, and
//! `ParticleFilter` is its comparator. `Trajectory` says where the target will be, `Pursuit` where a robot can
//! meet it, `assign` which robot goes to which target, and `CellMap` how to get there.

mod assignment;
mod config;
mod doubt;
mod driver;
mod geometric_median;
mod gradient_node;
mod gradient_pilot;
mod grid_path;
mod idle;
mod interception;
mod message;
mod mission;
mod node;
mod outbox;
mod particle_filter;
mod prober;
mod record;
mod reports;
mod robot;
mod robust_kalman;
mod route;
mod settings;
mod sightings;
mod sink;
mod station;
mod target_state;
mod team;
mod tracker;
mod trajectory;
mod wayfinder;

pub use config::{
    Aim, BeforeDetection, Belief, DetarskConfig, FilterConfig, GradientSources, Informants, OwnPlaceRule, PGConfig,
    ParticlesConfig, PathRule, PredictionConfig, RobustKalmanConfig, SearchMotion, SearchPreset, WithoutNews,
};
pub use doubt::Doubt;
pub use outbox::MessageCounts;
pub use record::{RobotSearchRecord, SearchStep};
pub use settings::TargetSearch;
pub use station::{SearchRecord, SearchStation};
