//! Pictures of networks and surveys.

pub(crate) mod crowded_network;
pub(crate) mod network;
pub(crate) mod sectors;
pub(crate) mod trees;
