//! Neighbouring stops and neighbouring nodes share their shadowing.

use std::f64::consts::TAU;

use sextant_kernel::Seed;

use super::survey::{Listening, SURROUNDINGS, none_lost, survey};
use super::{LawError, ReceptionLogAt, Site};

/// The name of the law.
pub(super) const NAME: &str = "shared-shadowing";

/// Waves whose sum is the field.
const WAVES: u64 = 96;
/// The correlation of the field falls to `exp(-1/2)` over this distance of stops or of nodes (m).
const LENGTH_M: f64 = 3.0;
/// Standard deviation of the field (dB).
const SIGMA_DB: f64 = 8.0;

/// Shadowing is a Gaussian field over the places of both ends of a link (Agrawal and Patwari 2009), drawn as a sum of plane
/// waves.
pub(super) fn log(seed: Seed) -> Result<ReceptionLogAt, LawError> {
    let site = Site::hall(seed, 16);
    let number = |wave, axis| seed.normal(SURROUNDINGS, [wave, axis, 0]) / LENGTH_M;
    let waves: Vec<[f64; 5]> = (0..WAVES)
        .map(|wave| {
            let phase = TAU * seed.uniform(SURROUNDINGS, [wave, 9, 0]);
            [number(wave, 0), number(wave, 1), number(wave, 2), number(wave, 3), phase]
        })
        .collect();
    let strength = |node: usize, stop: usize| {
        let (a, b) = (site.nodes[node], site.stops[stop]);
        let wave =
            |[ax, ay, bx, by, phase]: &[f64; 5]| libm::cos(ax * a.x_m + ay * a.y_m + bx * b.x_m + by * b.y_m + phase);
        let sum: f64 = waves.iter().map(wave).sum();
        site.mean_dbm(node, stop) + SIGMA_DB * (2.0 / waves.len() as f64).sqrt() * sum
    };
    Ok((survey(&site, Listening::default(), &strength, &none_lost)?, site.nodes))
}
