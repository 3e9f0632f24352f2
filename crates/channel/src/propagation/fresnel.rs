//! Reflection of plane waves off slabs (Recommendation ITU-R P.2040-3, annex 1).

use std::f64::consts::TAU;

use crate::propagation::complex::Complex;
use crate::propagation::path_loss::LIGHT_M_PER_S;

/// A slab of one material with air on both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Slab {
    /// Complex relative permittivity; the imaginary part of a material that absorbs is negative.
    pub(crate) permittivity: Complex,
    /// Thickness (m); infinite for a half space.
    pub(crate) thickness_m: f64,
}

/// Reflection coefficients of the electric field. Both are -1 and 1 for a perfect conductor: the component across the
/// plane of incidence turns its sign, that within it keeps the sign of its part along the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Coefficients {
    /// Field across the plane of incidence (transverse electric).
    pub(crate) te: Complex,
    /// Field within the plane of incidence (transverse magnetic).
    pub(crate) tm: Complex,
}

impl Slab {
    /// The coefficients at a carrier for waves whose direction has the cosine `cos` with the normal, 0 to 1:
    /// `R = R' (1 - e^(-j2q)) / (1 - R'² e^(-j2q))`, `q = (2π d / λ) sqrt(η - sin²θ)`.
    pub(crate) fn reflection(&self, carrier_ghz: f64, cos: f64) -> Coefficients {
        let Self { permittivity: eta, thickness_m } = *self;
        let root = (eta - Complex::real(1.0 - cos * cos)).sqrt();
        let cos = Complex::real(cos);
        // Of one surface.
        let te = (cos - root) / (cos + root);
        let tm = (eta * cos - root) / (eta * cos + root);
        if !thickness_m.is_finite() {
            return Coefficients { te, tm };
        }
        let wavelength_m = LIGHT_M_PER_S / (carrier_ghz * 1e9);
        let q = root * Complex::real(TAU * thickness_m / wavelength_m);
        let through = Complex { re: 2.0 * q.im, im: -2.0 * q.re }.exp();
        let both = |one: Complex| one * (Complex::ONE - through) / (Complex::ONE - one * one * through);
        Coefficients { te: both(te), tm: both(tm) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::propagation::material::Material;

    fn half_space(re: f64, im: f64) -> Slab {
        Slab { permittivity: Complex { re, im }, thickness_m: f64::INFINITY }
    }

    #[test]
    fn at_normal_incidence_both_are_those_of_the_refractive_index() {
        for (re, im) in [(5.24, -0.33), (2.73, -0.1), (1.48, 0.0), (6.31, -0.26)] {
            let index = Complex { re, im }.sqrt();
            let expected = (index - Complex::ONE) / (index + Complex::ONE);
            let Coefficients { te, tm } = half_space(re, im).reflection(60.0, 1.0);
            assert!((te + expected).abs() < 1e-12 && (tm - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn at_the_angle_of_brewster_nothing_is_reflected_within_the_plane_of_incidence() {
        for re in [1.5_f64, 2.0, 5.24, 6.31] {
            // tan θ = sqrt(ε).
            let cos = 1.0 / (1.0 + re).sqrt();
            let Coefficients { te, tm } = half_space(re, 0.0).reflection(60.0, cos);
            assert!(tm.abs() < 1e-12, "{tm:?}");
            // There the other component has (ε - 1) / (ε + 1).
            assert!((te.re + (re - 1.0) / (re + 1.0)).abs() < 1e-12, "{te:?}");
        }
    }

    #[test]
    fn grazing_waves_and_conductors_reflect_all() {
        let Coefficients { te, tm } = half_space(5.24, -0.3).reflection(60.0, 1e-9);
        assert!((te.abs() - 1.0).abs() < 1e-6 && (tm.abs() - 1.0).abs() < 1e-6);
        let metal = Material::named("metal").unwrap().permittivity(60.0).unwrap();
        let metal = Slab { permittivity: metal, thickness_m: 1e-3 };
        for cos in [0.2, 0.7, 1.0] {
            let Coefficients { te, tm } = metal.reflection(60.0, cos);
            assert!((te + Complex::ONE).abs() < 0.02 && (tm - Complex::ONE).abs() < 0.02, "{te:?} {tm:?}");
        }
    }

    #[test]
    fn a_lossless_slab_is_invisible_at_half_a_wavelength_and_brightest_at_a_quarter() {
        let (eta, carrier_ghz) = (4.0_f64, 60.0);
        let wavelength_m = LIGHT_M_PER_S / (carrier_ghz * 1e9) / eta.sqrt();
        let of = |waves: f64| Slab { permittivity: Complex::real(eta), thickness_m: waves * wavelength_m };
        assert!(of(0.5).reflection(carrier_ghz, 1.0).te.abs() < 1e-12);
        // Two surfaces in phase: 2 R / (1 + R²).
        let one = (eta.sqrt() - 1.0) / (eta.sqrt() + 1.0);
        let expected = 2.0 * one / (1.0 + one * one);
        assert!((of(0.25).reflection(carrier_ghz, 1.0).te.abs() - expected).abs() < 1e-12);
        // What comes back from far inside is absorbed: a thick slab is a half space.
        let thick = Slab { permittivity: Complex { re: 4.0, im: -0.1 }, thickness_m: 5.0 };
        let half = half_space(4.0, -0.1).reflection(carrier_ghz, 0.6);
        assert!((thick.reflection(carrier_ghz, 0.6).tm - half.tm).abs() < 1e-12);
    }

    #[test]
    fn concrete_reflects_about_as_a_measured_plate_at_57_ghz() {
        // Refractive index 2.55 - j0.084 of plain concrete, 14 months old, measured at 57.5 GHz (Sato, Manabe, Polivka,
        // Ihara, Kasashima and Yamaki 1996, IEEE Transactions on Antennas and Propagation 44, 35). The numbers are
        // computed from it with complex numbers elsewhere.
        let index = Complex { re: 2.55, im: -0.084 };
        let measured = Slab { permittivity: index * index, thickness_m: f64::INFINITY };
        let listed = Material::named("itu-concrete").unwrap().permittivity(57.5).unwrap();
        let listed = Slab { permittivity: listed, thickness_m: f64::INFINITY };
        let loss_db = |field: Complex| -20.0 * field.abs().log10();
        for (angle_deg, te_db, tm_db) in [(0.0_f64, 7.188, 7.188), (30.0, 6.267, 8.279), (60.0, 3.670, 16.376)] {
            let cos = angle_deg.to_radians().cos();
            let (found, of_itu) = (measured.reflection(57.5, cos), listed.reflection(57.5, cos));
            assert!((loss_db(found.te) - te_db).abs() < 0.01 && (loss_db(found.tm) - tm_db).abs() < 0.01);
            assert!((loss_db(of_itu.te) - loss_db(found.te)).abs() < 1.0);
        }
    }
}
