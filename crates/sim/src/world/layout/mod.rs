//! Layouts of nodes: from a list, on a lattice, at random, or from a file.
//!
//! Goes in: a [`NodesConfig`] and the obstacles. Comes out: a name and a place for each node. Each place
//! is drawn at its own address, so that more nodes do not move the others.

mod explicit;
mod file;
mod lattice;
mod members;
mod nodes;
mod placed;
mod random;
mod region;
#[cfg(test)]
mod tests;

pub use explicit::ExplicitConfig;
pub use file::CsvConfig;
pub use lattice::LatticeConfig;
pub use members::NodesOfGroup;
pub use nodes::NodesConfig;
pub use placed::PlacedNode;
pub(super) use placed::twin;
pub use random::RandomConfig;
pub use region::{Region, RegionConfig};
