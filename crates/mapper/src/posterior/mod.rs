//! Where a node is, with which probability: the posterior of one node, its mean, covariance and region, and why its place
//! is not reliable.

#[cfg(feature = "obstacles")]
mod bound;
mod cell;
mod concern;
mod covariance;
mod estimate;
mod estimate_kind;
mod local;
mod node_evidence;
mod prior;
mod range_bound;
mod region;
mod verdict;

#[cfg(feature = "obstacles")]
pub use bound::{TrueModel, posterior_bound_m};
pub(crate) use cell::Cell;
pub use concern::Concern;
pub(crate) use covariance::covariance;
pub use estimate::Estimate;
pub(crate) use estimate::{POINTS, points};
pub use estimate_kind::{EstimateKind, TieRule};
pub(crate) use local::{LocalPosterior, local_posterior};
pub(crate) use node_evidence::NodeEvidence;
pub use prior::{Area, PlacePrior};
pub use range_bound::{TrueRanges, range_bound_m};
pub use region::Region;
pub(crate) use verdict::{FitState, LIKELY, Verdict};
