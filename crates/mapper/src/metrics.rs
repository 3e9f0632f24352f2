//! How good a map is: distances between places, and whether neighbours stay neighbours.

mod connectivity;
mod ellipse;
mod position_error;

pub use connectivity::{ConnectivityError, MetricError, NeighbourhoodRule, connectivity_error};
pub use position_error::PositionError;
