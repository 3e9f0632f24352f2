//! Measures of how good a map is: position errors, and whether neighbours stay neighbours.

mod connectivity;
mod crlb;
mod ellipse;
mod error;
mod position_error;
mod topology_preservation;

pub use connectivity::{ConnectivityError, NeighbourhoodRule, connectivity_error};
pub use crlb::{RssLinks, rss_crlb_m};
pub use error::MetricError;
pub use position_error::PositionError;
pub use topology_preservation::topology_preservation_error;
