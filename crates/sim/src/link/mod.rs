//! Links: how stations of a network send to each other. Each technology is a folder; the rest of the simulator knows
//! what all have in common.

mod collectors;
mod config;
pub(crate) mod ieee80211ad;
pub(crate) mod ieee802154;
pub(crate) mod network;
mod payloads;
mod technology;

pub use config::{MacConfig, RadioConfig, RadioGroupConfig};
pub use ieee80211ad::Ieee80211ad;
pub use technology::{Ieee802154, Technology};
