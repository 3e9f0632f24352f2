//! One-sided excess loss: a link loses power to what is in its way, and gains none.

use sextant_kernel::Seed;

use super::survey::{Listening, SHADOWING, none_lost, survey};
use super::{LawError, ReceptionLogAt, Site};

/// The name of the law.
pub(super) const NAME: &str = "excess-loss";

/// Mean excess loss of a long link (dB), and the distance over which it grows to that (m).
const MEAN_DB: f64 = 9.0;
const LENGTH_M: f64 = 5.0;

/// Exponential excess loss of each link, whose mean grows with the distance.
pub(super) fn log(seed: Seed) -> Result<ReceptionLogAt, LawError> {
    let site = Site::hall(seed, 16);
    let strength = |node: usize, stop: usize| {
        let distance_m = site.nodes[node].distance_m(site.stops[stop]);
        let mean_db = MEAN_DB * (1.0 - libm::exp(-distance_m / LENGTH_M));
        let share = seed.uniform(SHADOWING, [node as u64, stop as u64, 0]);
        site.mean_dbm(node, stop) + mean_db * libm::log(share)
    };
    Ok((survey(&site, Listening::default(), &strength, &none_lost)?, site.nodes))
}
