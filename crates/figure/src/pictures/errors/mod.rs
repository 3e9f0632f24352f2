//! Pictures of how far maps are from the truth or from the log.

pub(crate) mod displacement;
pub(crate) mod distribution;
pub(crate) mod reception_curve;
pub(crate) mod residuals;
pub(crate) mod scattering;
