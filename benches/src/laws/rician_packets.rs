//! Packets fade as the envelope of a straight wave and many weak ones.

use sextant_kernel::Seed;

use super::independent_shadowing::usual_dbm;
use super::survey::{Fading, Listening, none_lost, survey};
use super::{LawError, ReceptionLogAt, Site};

/// The name of the law.
pub(super) const NAME: &str = "rician-packets";

/// Power of the straight wave over that of all others.
const RATIO: f64 = 2.0;

/// Rician fading packet by packet: deep fades are usual, and nothing is much stronger than its mean.
pub(super) fn log(seed: Seed) -> Result<ReceptionLogAt, LawError> {
    let site = Site::hall(seed, 16);
    let strength = |node, stop| usual_dbm(&site, node, stop);
    let listening = Listening { fading: Fading::Rician(RATIO), ..Listening::default() };
    Ok((survey(&site, listening, &strength, &none_lost)?, site.nodes))
}
