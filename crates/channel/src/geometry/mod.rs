//! Places, boxes, grids of cells, and the shapes of obstacles.

pub(crate) mod bounds;
pub(crate) mod cell_grid;
pub(crate) mod cell_index;
#[cfg(feature = "obstacles")]
pub(crate) mod glam;
pub(crate) mod polygon;
pub(crate) mod position;
#[cfg(feature = "obstacles")]
pub(crate) mod shape;
#[cfg(feature = "obstacles")]
pub(crate) mod span;
#[cfg(feature = "obstacles")]
pub(crate) mod tree;
