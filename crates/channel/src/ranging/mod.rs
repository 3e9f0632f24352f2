//! Distances that devices measure, by how long signals take: ultra-wideband, Wi-Fi round-trip times.

pub(crate) mod device;
pub(crate) mod law;
