//! Self-calibrated maps: what was heard where, and nothing else, tells the reception curve, the efficiency of each
//! stop, what stands in the way, and where the nodes are.
//!
//! The model: a packet sent at distance d is received at stop s with the probability `e_s Φ(z(d) − A)`. Φ is the normal
//! distribution function (shadowing is normal in decibels), z falls with distance in any way, a hard cut included,
//! A is what obstacles absorb along the straight line, in standard deviations of the shadowing, and `e_s` is what
//! collisions and the receiver leave. All are found in turn, again and again, from coarse to fine steps: a posterior of
//! each node on a grid round its last place; the curve by isotonic regression of the counts expected under these
//! posteriors; the efficiency of a stop by what it heard of what was expected; the absorption of cells by penalised
//! maximum likelihood along the straight lines (radio tomography; Wilson and Patwari 2010).
//!
//! Obstacles are upright: a line loses in a cell what its projection on the plane does, times its slant. Where stops have
//! several heights this is no model, and obstacles are not sought; [`Calibration::knowledge`] says so. Nor are they
//! believed in before the absorption that one half of the lines tells explains the other half, so that an open network is
//! mapped as if it were known to be open. Sectors and signal strengths are not used.

mod absorption;
mod algorithm;
mod belief;
mod beliefs;
mod bounds;
mod counts;
mod draft;
mod likelihood;
mod lines;
mod model;
mod normal;
mod posterior;
mod settings;
mod shadows;
mod start;
mod tomography;
mod window;

pub use absorption::AbsorptionMap;
pub use algorithm::{Calibration, SelfCalibrated};
pub use model::CalibratedCurve;
pub use settings::{ObstacleKnowledge, SelfCalibratedConfig};
