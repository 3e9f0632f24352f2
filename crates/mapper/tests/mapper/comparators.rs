//! Algorithms to compare with, on networks whose maps are known.

mod anchored;
mod hops;
mod network;
mod ranges;
