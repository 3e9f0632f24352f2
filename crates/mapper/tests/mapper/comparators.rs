//! Algorithms for comparison, on networks whose maps are known.

mod anchored;
mod hops;
pub(crate) mod network;
mod ranges;
mod reconstructed;
