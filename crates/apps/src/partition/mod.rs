//! The division of an area among robots.

mod area;
mod config;
mod cuts;

pub use area::FreeArea;
pub use config::{BalanceConfig, CutConfig, PartitionConfig};
pub use cuts::{RobotPart, partition};
