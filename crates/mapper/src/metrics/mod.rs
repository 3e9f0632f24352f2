//! Measures of how good a map is: position errors, and whether neighbours stay neighbours and in their sectors.

mod alignment;
mod connectivity;
mod crlb;
mod ellipse;
mod error;
mod position_error;
mod sector_displacement;
mod topology_preservation;

pub use alignment::{AlignmentError, Reflection, Similarity};
pub use connectivity::{ConnectivityError, NeighbourhoodRule, connectivity_error};
pub use crlb::{RssLinks, rss_crlb_m};
pub use error::MetricError;
pub use position_error::PositionError;
pub use sector_displacement::{
    NodeDisplacement, SectorDisplacement, SectorDisplacementRule, SectorDistance, sector_displacement, sector_of,
};
pub use topology_preservation::topology_preservation_error;
