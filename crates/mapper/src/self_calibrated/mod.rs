//! Self-calibrated maps: what was heard where, and nothing else, tells the reception curve, the efficiency of each
//! stop, what stands in the way, and where the nodes are.
//!
//! The model: a packet sent at distance d is received at stop s with the probability `e_s Φ(z(d) − A)`. Φ is the normal
//! distribution function (shadowing is normal in decibels), z falls with distance in any way, a hard cut included,
//! A is what obstacles absorb along the straight line, in standard deviations of the shadowing, and `e_s` is what
//! collisions and the receiver leave. All are found by expectation maximisation from coarse to fine: a posterior of each
//! node on a grid round its last place; the curve by isotonic regression of the counts expected under these posteriors;
//! the efficiency of a stop by what it heard of what was expected; the absorption of cells by penalised maximum
//! likelihood along the straight lines (radio tomography; Wilson and Patwari 2010). Obstacles are upright: they absorb
//! alike at all heights, so that a map of three dimensions has a plane of cells too.
//!
//! The map of obstacles is kept only if it explains receptions that it was not estimated from, so that an open network
//! is mapped as if there were none.

mod absorption;
mod algorithm;
mod beliefs;
mod counts;
mod model;
mod normal;
mod posterior;
mod settings;
mod shadows;
mod start;
mod tomography;

pub use absorption::AbsorptionMap;
pub use algorithm::{Calibration, SelfCalibrated};
pub use model::CalibratedCurve;
pub use settings::{ObstacleKnowledge, SelfCalibratedConfig};
