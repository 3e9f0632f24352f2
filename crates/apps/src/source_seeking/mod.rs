//! Seeking the source of a field on a map of the nodes (Gunathillake 2018, chapter 7).
//!
//! Nodes sample a field, such as a concentration, and keep the latest reading. A robot polls the nodes around it, works out
//! the field where it is, and drives to where that has a given value, near the source. Then it may remove the source and
//! go on to the next one. Two ways of guidance:
//!
//! - The **level set** law needs only the value of the field at the robot and its rate of change: it turns left or right
//!   so that the value rises at a chosen rate, and then circles the level. In the plane, or in space along a path with
//!   constant torsion.
//! - The **gradient** of a plane through the readings around the robot is its course.
//!
//! A robot that meets an obstacle goes round it with one hand on it, until that pays no more. One that is stuck, because
//! noise or a maximum below the level holds it, drives to a random place on the map and seeks from there on.

mod arrival;
mod boundary;
mod config;
mod estimate;
mod field_estimate;
mod goal;
mod gradient;
mod level_set;
mod local_fit;
mod message;
mod mission;
mod moving_frame;
mod node;
mod poll;
mod progress;
mod rate;
mod record;
mod robot;
mod settings;
mod source_watch;
mod station;
mod steering;

pub use config::{GradientConfig, LevelSetConfig, PlaneConfig, Preset, SpaceConfig};
pub use estimate::{EstimateConfig, LocalFitConfig, Weights};
pub use goal::{AfterArrival, GoalConfig, GradientGoalConfig};
pub use level_set::HigherField;
pub use poll::PollConfig;
pub use rate::RateConfig;
pub use record::{Arrival, RobotSeekRecord, SeekRecord, SeekState};
pub use settings::SourceSeeking;
