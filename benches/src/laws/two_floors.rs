//! Two floors, with a ceiling between them.

use sextant_kernel::Seed;

use super::independent_shadowing::usual_dbm;
use super::survey::{Listening, none_lost, survey};
use super::{LawError, ReceptionLogAt, Site};

/// The name of the law.
pub(super) const NAME: &str = "two-floors";

/// Height of the upper floor (m), and what the ceiling takes (dB).
const UPPER_M: f64 = 3.4;
const CEILING_DB: f64 = 15.0;

/// Every other node is on the upper floor; the robot surveys the lower one, then the upper one.
pub(super) fn log(seed: Seed) -> Result<ReceptionLogAt, LawError> {
    let mut site = Site::hall(seed, 16);
    for node in site.nodes.iter_mut().step_by(2) {
        node.z_m = UPPER_M;
    }
    let mut upper = site.stops.clone();
    upper.iter_mut().for_each(|stop| stop.z_m = UPPER_M);
    // Every other stop of each floor.
    site.stops = site.stops.iter().step_by(2).chain(upper.iter().skip(1).step_by(2)).copied().collect();
    let strength = |node: usize, stop: usize| {
        let is_between = (site.nodes[node].z_m - site.stops[stop].z_m).abs() > 0.5 * UPPER_M;
        usual_dbm(&site, node, stop) - if is_between { CEILING_DB } else { 0.0 }
    };
    Ok((survey(&site, Listening::default(), &strength, &none_lost)?, site.nodes))
}
