//! The ground reflects: power rises and falls with distance before it falls for good.

use std::f64::consts::TAU;

use sextant_kernel::Seed;

use super::survey::{Listening, SENSITIVITY_DBM, none_lost, survey};
use super::{LawError, ReceptionLogAt, Site, shared_shadowing};

/// The name of the law.
pub(super) const NAME: &str = "two-ray";

/// Heights of nodes and of the receiver above the ground (m), and the wavelength of 2.45 GHz (m).
const HEIGHTS_M: [f64; 2] = [0.9, 0.4];
const WAVELENGTH_M: f64 = 0.1224;
/// Relative permittivity of dry concrete (ITU-R P.2040, table 3).
const PERMITTIVITY: f64 = 5.24;
/// What the shadowing is of that of the law of shared shadowing.
const SHADOWING: f64 = 0.5;

/// A straight wave and one by the ground, polarised vertically, with shadowing that neighbouring places share.
pub(super) fn log(seed: Seed) -> Result<ReceptionLogAt, LawError> {
    let site = Site::hall(seed, 16);
    let shadowing = shared_shadowing::Field::new(seed);
    let at_reach_db = gain_db(site.reach_m);
    let strength = |node: usize, stop: usize| {
        let (from, to) = (site.nodes[node], site.stops[stop]);
        let above_db = gain_db(from.distance_m(to).max(0.3)) - at_reach_db;
        SENSITIVITY_DBM + above_db + SHADOWING * shadowing.at_db(from, to)
    };
    Ok((survey(&site, Listening::default(), &strength, &none_lost)?, site.nodes))
}

/// The gain of both waves together over a distance along the ground (dB), but for a constant.
fn gain_db(distance_m: f64) -> f64 {
    let [high_m, low_m] = HEIGHTS_M;
    let straight_m = libm::hypot(distance_m, high_m - low_m);
    let bent_m = libm::hypot(distance_m, high_m + low_m);
    // Reflection off a dielectric (Fresnel), by the angle with the ground.
    let sine = (high_m + low_m) / bent_m;
    let root = (PERMITTIVITY - 1.0 + sine * sine).sqrt();
    let reflected = (PERMITTIVITY * sine - root) / (PERMITTIVITY * sine + root);
    let phase = TAU * (bent_m - straight_m) / WAVELENGTH_M;
    let real = 1.0 / straight_m + reflected * libm::cos(phase) / bent_m;
    let imaginary = reflected * libm::sin(phase) / bent_m;
    10.0 * libm::log10(real * real + imaginary * imaginary)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn far_away_power_falls_with_the_fourth_power_of_the_distance() {
        let fall_db = gain_db(2_000.0) - gain_db(4_000.0);
        assert!((fall_db - 12.04).abs() < 0.1, "{fall_db}");
    }
}
