//! Self-calibrated maps: the reception curve, the efficiency of each stop, the obstacles and the places of the nodes,
//! all estimated from the log alone.
//!
//! The model: a packet sent at distance d is received at stop s with the probability `e_s Φ(z(d) − A)`. Φ is the
//! normal distribution function (shadowing is normal in decibels). z falls with distance in any way, even with a hard
//! cut. A is what obstacles absorb along the straight line, in standard deviations of the shadowing. `e_s` is the
//! share of packets that survive collisions and the receiver. All are estimated in turn, in many rounds, from coarse
//! to fine steps. The posterior of each node is computed on a grid round its last place. The curve follows by
//! isotonic regression of the counts expected under these posteriors. The efficiency of a stop follows from the
//! number of packets that it heard and the number expected. The absorption of cells follows by penalised maximum
//! likelihood along the straight lines (radio tomography; Wilson and Patwari 2010).
//!
//! Obstacles are upright: the loss of a line in a cell is that of its projection on the plane, times its slant. This
//! model does not hold if the stops have several heights. Obstacles are then not searched for, and
//! [`Calibration::knowledge`] says so. Obstacles are used only if the absorption estimated from one half of the lines
//! explains the other half. An open network is therefore mapped as if it were known to be open. Antenna
//! sectors are evidence of directions. Signal strengths are not used.

mod algorithm;
mod belief;
mod beliefs;
mod counts;
mod draft;
mod likelihood;
mod lines;
mod model;
mod posterior;
mod report;
mod settings;
mod shadows;
mod start;
mod tomography;
mod window;

pub(crate) use algorithm::CalibratedShares;
pub use algorithm::{Calibration, SelfCalibrated};
pub use model::CalibratedCurve;
pub use settings::{ObstacleKnowledge, SelfCalibratedConfig};
