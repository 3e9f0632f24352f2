//! RPL on a station: its timers, its messages, and its packets. The tree itself is
//! [`Dodag`](sextant_mac::routing::rpl::Dodag).

mod config;
mod forwarding;
mod messages;
mod plan;
mod station;

pub use config::{MrhofConfig, ObjectiveConfig, Of0Config, RankErrors, RplConfig, RplMode, StepOfRankConfig};
pub(super) use forwarding::Next;
pub(super) use plan::RplPlan;
pub(super) use station::RplStation;
