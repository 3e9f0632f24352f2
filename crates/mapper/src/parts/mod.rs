//! Maps of logs that are too large for the memory: part by part, with the same result as in one piece.
//!
//! A part of a log has all stops, and all that was heard of some of the nodes. First an estimator fixes its law for the whole
//! log ([`PartEstimator::fix`]), for which it may read parts as often as it likes. What remains to be done for a node then
//! depends on the law, the stops and what was heard of that node alone ([`FixedLaw`]), so that it is the same in any part.

mod error;
mod fixed_law;
mod log_parts;
mod survey_parts;

pub use error::PartsError;
pub(crate) use fixed_law::map_parts;
pub use fixed_law::{FixedLaw, PartEstimator};
pub use log_parts::LogParts;
pub(crate) use log_parts::{each_part, sample};
