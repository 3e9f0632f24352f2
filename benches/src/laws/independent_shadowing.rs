//! Each link has its shadowing, independent of the others.

use sextant_kernel::Seed;

use super::survey::{Listening, SHADOWING, SHADOWING_DB, none_lost, survey};
use super::{LawError, ReceptionLogAt, Site};

/// The name of the law.
pub(super) const NAME: &str = "independent-shadowing";

/// Eight decibels of shadowing for each link, independent of all others.
pub(super) fn log(seed: Seed) -> Result<ReceptionLogAt, LawError> {
    let site = Site::hall(seed, 16);
    let strength = |node, stop| site.mean_dbm(node, stop) + 8.0 * site.normal(SHADOWING, node, stop);
    Ok((survey(&site, Listening::default(), &strength, &none_lost)?, site.nodes))
}

/// The strength of a link under the usual shadowing (dBm).
pub(super) fn usual_dbm(site: &Site, node: usize, stop: usize) -> f64 {
    site.mean_dbm(node, stop) + SHADOWING_DB * site.normal(SHADOWING, node, stop)
}
