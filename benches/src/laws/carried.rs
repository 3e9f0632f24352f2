//! A person carries the receiver, and is in the way of what comes from behind.

use sextant_kernel::Seed;

use super::independent_shadowing::usual_dbm;
use super::survey::{Listening, none_lost, survey};
use super::{LawError, ReceptionLogAt, Site};

/// The name of the law.
pub(super) const NAME: &str = "carried";

/// What the body takes from a link straight behind (dB).
const BEHIND_DB: f64 = 12.0;

/// The body takes `BEHIND_DB (1 - cos θ) / 2` from what comes at the angle θ from the way ahead.
pub(super) fn log(seed: Seed) -> Result<ReceptionLogAt, LawError> {
    let site = Site::hall(seed, 16);
    let strength = |node: usize, stop: usize| {
        let (before, after) = (stop.saturating_sub(1), (stop + 1).min(site.stops.len() - 1));
        let ahead = site.stops[after] - site.stops[before];
        let apart = site.nodes[node] - site.stops[stop];
        let along = ahead.x_m * apart.x_m + ahead.y_m * apart.y_m;
        let cosine = along / (ahead.length_m() * apart.length_m()).max(1e-9);
        usual_dbm(&site, node, stop) - BEHIND_DB * 0.5 * (1.0 - cosine)
    };
    Ok((survey(&site, Listening::default(), &strength, &none_lost)?, site.nodes))
}
