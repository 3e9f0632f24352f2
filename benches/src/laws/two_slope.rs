//! Power falls slowly near a node and fast beyond a break.

use sextant_kernel::Seed;

use super::survey::{Listening, SENSITIVITY_DBM, SHADOWING, SHADOWING_DB, none_lost, survey};
use super::{LawError, ReceptionLogAt, Site};

/// The name of the law.
pub(super) const NAME: &str = "two-slope";

/// Exponents on either side of the break.
const EXPONENTS: [f64; 2] = [1.6, 5.0];

/// The dual-slope law (Feuerstein et al. 1994), its break at half the reach.
pub(super) fn log(seed: Seed) -> Result<ReceptionLogAt, LawError> {
    let site = Site::hall(seed, 16);
    let break_m = 0.5 * site.reach_m;
    let at_break_dbm = SENSITIVITY_DBM + 10.0 * EXPONENTS[1] * libm::log10(site.reach_m / break_m);
    let strength = |node: usize, stop: usize| {
        let distance_m = site.nodes[node].distance_m(site.stops[stop]).max(0.3);
        let exponent = EXPONENTS[usize::from(distance_m > break_m)];
        let shadowing_db = SHADOWING_DB * site.normal(SHADOWING, node, stop);
        at_break_dbm - 10.0 * exponent * libm::log10(distance_m / break_m) + shadowing_db
    };
    Ok((survey(&site, Listening::default(), &strength, &none_lost)?, site.nodes))
}
