//! Stops that are nearly level, with a few high ones.

use sextant_kernel::Seed;

use super::independent_shadowing::usual_dbm;
use super::survey::{Listening, none_lost, survey};
use super::{LawError, ReceptionLogAt, Site};

/// The name of the law.
pub(super) const NAME: &str = "raised-stops";

/// Heights of most stops and of every twelfth (m).
const FLOOR_M: f64 = -0.04;
const RAISED_M: f64 = 3.23;

/// Nodes and most stops are on one floor, and every twelfth stop is more than three metres above it.
pub(super) fn log(seed: Seed) -> Result<ReceptionLogAt, LawError> {
    let mut site = Site::hall(seed, 16);
    for (number, stop) in site.stops.iter_mut().enumerate() {
        stop.z_m = if number % 12 == 5 { RAISED_M } else { FLOOR_M };
    }
    let strength = |node, stop| usual_dbm(&site, node, stop);
    let log = survey(&site, Listening::default(), &strength, &none_lost)?;
    Ok((log, site.nodes))
}
