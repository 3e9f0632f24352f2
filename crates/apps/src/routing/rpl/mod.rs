//! RPL on a station: its settings, and what it knows. The tree itself is [`Dodag`](sextant_mac::routing::rpl::Dodag).

mod config;
mod plan;
mod station;

pub use config::{MrhofConfig, ObjectiveConfig, Of0Config, RankErrors, RplConfig, RplMode, StepOfRankConfig};
pub(super) use plan::RplPlan;
pub(super) use station::{DIO, Next, RplStation};
