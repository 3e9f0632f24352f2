//! Nodes beside the area that the robot surveys.

use sextant_kernel::Seed;

use super::independent_shadowing::usual_dbm;
use super::site::HALL_M;
use super::survey::{Listening, NODES, none_lost, survey};
use super::{LawError, ReceptionLogAt, Site};

/// The name of the law.
pub(super) const NAME: &str = "outside";

/// How far beside the hall nodes are (m).
const BESIDE_M: f64 = 4.0;

/// Every third node is up to 4 m north of the hall, where no stop is.
pub(super) fn log(seed: Seed) -> Result<ReceptionLogAt, LawError> {
    let mut site = Site::hall(seed, 18);
    for (number, node) in site.nodes.iter_mut().enumerate().step_by(3) {
        node.y_m = HALL_M[1] + BESIDE_M * seed.uniform(NODES, [number as u64, 2, 0]);
    }
    let strength = |node, stop| usual_dbm(&site, node, stop);
    Ok((survey(&site, Listening::default(), &strength, &none_lost)?, site.nodes))
}
