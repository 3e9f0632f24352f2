//! Nodes send more to one side.

use std::f64::consts::TAU;

use sextant_kernel::Seed;

use super::independent_shadowing::usual_dbm;
use super::survey::{Listening, SURROUNDINGS, none_lost, survey};
use super::{LawError, ReceptionLogAt, Site};

/// The name of the law.
pub(super) const NAME: &str = "directional";

/// Amplitude towards an angle θ from the heading: `(1 + DEPTH cos θ) / (1 + DEPTH)`, 19 dB less to the back.
const DEPTH: f64 = 0.8;

/// Cardioid patterns with random headings.
pub(super) fn log(seed: Seed) -> Result<ReceptionLogAt, LawError> {
    let site = Site::hall(seed, 16);
    let strength = |node: usize, stop: usize| {
        let apart = site.stops[stop] - site.nodes[node];
        let heading = TAU * seed.uniform(SURROUNDINGS, [node as u64, 0, 0]);
        let amplitude = (1.0 + DEPTH * libm::cos(libm::atan2(apart.y_m, apart.x_m) - heading)) / (1.0 + DEPTH);
        usual_dbm(&site, node, stop) + 20.0 * libm::log10(amplitude)
    };
    Ok((survey(&site, Listening::default(), &strength, &none_lost)?, site.nodes))
}
