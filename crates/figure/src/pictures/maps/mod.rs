//! Pictures of maps: against the truth, with regions, and the likelihood of one node.

mod claims;
pub(crate) mod crowded_map;
pub(crate) mod estimated;
pub(crate) mod estimated_map;
pub(crate) mod likelihood;
pub(crate) mod map;
pub(crate) mod next_stops;
