//! How measured ranges differ from true distances.

use std::f64::consts::PI;

use libm::{cosh, sinh};
use sextant_kernel::maths::{PER_ROOT_OF_TAU, exp, ln, mills_ratio, with_widest_vectors};

/// The law of the error of a range that is left when bias and scale are taken off: a mixture of three.
///
/// - Noise: normal.
/// - Ranges by a way that is longer than the straight one, because this is blocked: the noise and an exponential excess, so that
///   the law has a tail to one side.
/// - Wild values: a Cauchy law, which has no mean.
///
/// Its parameters are free of bounds, so that they can be estimated: logarithms of the widths, and of the shares relative to that of
/// the noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeErrorLaw {
    /// Logarithm of the standard deviation of the noise (m).
    pub log_noise: f64,
    /// Logarithm of the mean excess of ranges by a longer way (m).
    pub log_excess: f64,
    /// Logarithm of the share of these over that of the noise.
    pub log_odds_late: f64,
    /// Logarithm of the share of wild values over that of the noise.
    pub log_odds_wild: f64,
}

/// A value of the law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeErrorDensity {
    /// Natural logarithm of the density (per metre).
    pub log_density: f64,
    /// Its derivative by the error (per metre).
    pub by_error: f64,
    /// Its derivatives by the four parameters of the law, in their order.
    pub by_law: [f64; 4],
    /// One over the variance of the part of which the error is, on average over the parts that it may be of (per m²): above 0, and
    /// what a method of Gauss and Newton takes for the curvature.
    pub stiffness: f64,
}

/// The shares of the three parts of a law, which sum to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeErrorShares {
    /// That of the noise alone.
    pub noise: f64,
    /// That of ranges by a longer way.
    pub late: f64,
    /// That of wild values.
    pub wild: f64,
}

impl RangeErrorLaw {
    /// Half of the wild values are off by less than this (m).
    pub const WILD_M: f64 = 10.0;

    /// The law with these parameters, in the order of its fields.
    #[must_use]
    pub fn of([log_noise, log_excess, log_odds_late, log_odds_wild]: [f64; 4]) -> Self {
        Self { log_noise, log_excess, log_odds_late, log_odds_wild }
    }

    /// Standard deviation of the noise (m).
    #[must_use]
    pub fn noise_m(&self) -> f64 {
        libm::exp(self.log_noise)
    }

    /// Mean excess of ranges by a longer way (m).
    #[must_use]
    pub fn excess_m(&self) -> f64 {
        libm::exp(self.log_excess)
    }

    /// The shares of the three parts.
    #[must_use]
    pub fn shares(&self) -> RangeErrorShares {
        let most = self.log_odds_late.max(self.log_odds_wild).max(0.0);
        let [noise, late, wild] = [0.0, self.log_odds_late, self.log_odds_wild].map(|odds| libm::exp(odds - most));
        let sum = noise + late + wild;
        RangeErrorShares { noise: noise / sum, late: late / sum, wild: wild / sum }
    }

    /// The density of a range that is `error_m` too long, and its derivatives.
    #[must_use]
    pub fn density(&self, error_m: f64) -> RangeErrorDensity {
        self.prepared().density(error_m)
    }

    /// Fisher's information of one range on the distance (per m²): the mean square of the derivative of the logarithm of the density,
    /// integrated over all errors.
    #[must_use]
    pub fn information_per_m2(&self) -> f64 {
        /// Errors are sought at sinh(t) times the noise, at so many values of t up to the last one.
        const STEPS: i32 = 6000;
        const LAST: f64 = 20.0;
        let (law, noise_m) = (self.prepared(), self.noise_m());
        let step = 2.0 * LAST / f64::from(STEPS);
        let of = |at: i32| {
            let t = step * (f64::from(at) + 0.5) - LAST;
            let density = law.density(noise_m * sinh(t));
            density.by_error * density.by_error * exp(density.log_density) * noise_m * cosh(t) * step
        };
        (0..STEPS).map(of).sum()
    }

    /// The same law, ready for the densities of many ranges.
    #[must_use]
    pub fn prepared(&self) -> PreparedRangeErrorLaw {
        let (noise_m, excess_m, shares) = (self.noise_m(), self.excess_m(), self.shares());
        PreparedRangeErrorLaw {
            noise_m,
            ratio: noise_m / excess_m,
            excess_m,
            shares,
            noise: PER_ROOT_OF_TAU * shares.noise / noise_m,
            late: shares.late / excess_m,
            wild: shares.wild / (PI * Self::WILD_M),
        }
    }
}

/// A law of errors with what is the same for all ranges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PreparedRangeErrorLaw {
    noise_m: f64,
    excess_m: f64,
    /// The noise over the excess.
    ratio: f64,
    shares: RangeErrorShares,
    /// What the densities of the three parts begin with (per metre).
    noise: f64,
    late: f64,
    wild: f64,
}

/// The densities of the three parts at an error, each times its share (per metre).
struct Parts {
    noise: f64,
    late: f64,
    wild: f64,
    /// The slope that the late part has because it begins at the straight way, times the noise.
    rise: f64,
}

impl Parts {
    #[inline(always)]
    fn sum(&self) -> f64 {
        self.noise + self.late + self.wild
    }
}

impl PreparedRangeErrorLaw {
    /// The noise with an exponential excess is `exp(r²/2 - zr) Φ(z - r)` over the mean excess, with the error z in standard deviations of
    /// the noise and the ratio r of noise and excess. By Mills' ratio it needs no number that is too large.
    #[inline(always)]
    fn parts(&self, error_m: f64) -> Parts {
        let z = error_m / self.noise_m;
        let x = z - self.ratio;
        let normal = exp(-0.5 * z * z);
        let rise = PER_ROOT_OF_TAU * normal;
        let tail = rise * mills_ratio(x.abs());
        let whole = exp(self.ratio * (0.5 * self.ratio - z));
        let below = if x < 0.0 { tail } else { whole - tail };
        let wild = error_m / RangeErrorLaw::WILD_M;
        Parts {
            noise: self.noise * normal,
            late: self.late * below,
            wild: self.wild / (1.0 + wild * wild),
            rise: self.late * rise,
        }
    }

    /// The sum of the natural logarithms of the densities (per metre) of ranges that are so much too long.
    #[must_use]
    pub fn log_likelihood(&self, errors_m: impl IntoIterator<Item = f64>) -> f64 {
        /// So many ranges are worked on together.
        const TOGETHER: usize = 64;
        let mut errors_m = errors_m.into_iter();
        let mut values = [0.0; TOGETHER];
        let mut sum = 0.0;
        loop {
            let mut count = 0;
            for (value, error_m) in values.iter_mut().zip(&mut errors_m) {
                *value = error_m;
                count += 1;
            }
            let values = &mut values[..count];
            with_widest_vectors(
                #[inline(always)]
                || values.iter_mut().for_each(|value| *value = ln(self.parts(*value).sum())),
            );
            sum += values.iter().sum::<f64>();
            if count < TOGETHER {
                return sum;
            }
        }
    }

    /// Calls `with` for each of some ranges that are so much too long: with its number, its density and the derivatives.
    pub fn each_density(&self, errors_m: &[f64], mut with: impl FnMut(usize, RangeErrorDensity)) {
        /// So many ranges are worked on together.
        const TOGETHER: usize = 16;
        let (mut errors, mut columns) = ([0.0; TOGETHER], [[0.0; TOGETHER]; 7]);
        for (first, block) in (0..).step_by(TOGETHER).zip(errors_m.chunks(TOGETHER)) {
            errors[..block.len()].copy_from_slice(block);
            with_widest_vectors(
                #[inline(always)]
                || {
                    let [log_density, by_error, by_noise, by_excess, by_late, by_wild, stiffness] = &mut columns;
                    for at in 0..TOGETHER {
                        let density = self.density(errors[at]);
                        (log_density[at], by_error[at], stiffness[at]) =
                            (density.log_density, density.by_error, density.stiffness);
                        [by_noise[at], by_excess[at], by_late[at], by_wild[at]] = density.by_law;
                    }
                },
            );
            for at in 0..block.len() {
                let [log_density, by_error, noise, excess, late, wild, stiffness] = columns.map(|column| column[at]);
                let by_law = [noise, excess, late, wild];
                with(first + at, RangeErrorDensity { log_density, by_error, by_law, stiffness });
            }
        }
    }

    /// The density of a range that is `error_m` too long, and its derivatives.
    #[inline(always)]
    #[must_use]
    pub fn density(&self, error_m: f64) -> RangeErrorDensity {
        let Self { noise_m, excess_m, ratio, shares, .. } = *self;
        let z = error_m / noise_m;
        let parts = self.parts(error_m);
        let sum = parts.sum();
        let [noise, late, wild, rise] = [parts.noise, parts.late, parts.wild, parts.rise].map(|part| part / sum);
        let square = RangeErrorLaw::WILD_M.powi(2);
        let by_error = noise * (-z / noise_m) + rise / noise_m - late / excess_m
            + wild * (-2.0 * error_m / (square + error_m * error_m));
        let by_noise = noise * (z * z - 1.0) + late * ratio * ratio - rise * (z + ratio);
        let by_excess = late * (error_m / excess_m - 1.0 - ratio * ratio) + rise * ratio;
        RangeErrorDensity {
            log_density: ln(sum),
            by_error,
            by_law: [by_noise, by_excess, late - shares.late, wild - shares.wild],
            stiffness: noise / (noise_m * noise_m) + late / (noise_m * noise_m + excess_m * excess_m) + wild / square,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAWS: [[f64; 4]; 3] = [[-1.2, 0.0, -1.6, -4.6], [-2.5, 0.7, 1.0, -3.0], [0.3, -0.9, -0.5, -6.0]];

    #[test]
    fn the_density_integrates_to_its_shares() {
        for law in LAWS.map(RangeErrorLaw::of) {
            let step = 1e-3;
            // Cauchy's law beyond 2 km has 1 − 2/π·arctan(200) of its mass.
            let sum: f64 = (-2_000_000..2_000_000)
                .map(|i| step * exp(law.density(step * (f64::from(i) + 0.5)).log_density))
                .sum();
            let beyond = law.shares().wild * (1.0 - 2.0 / PI * (2000.0 / RangeErrorLaw::WILD_M).atan());
            assert!((sum + beyond - 1.0).abs() < 1e-7, "{sum}");
        }
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        for parameters in LAWS {
            for error_m in [-30.0, -4.0, -0.5, 0.0, 0.2, 1.5, 7.0, 80.0] {
                let value = |parameters, error_m| RangeErrorLaw::of(parameters).density(error_m).log_density;
                let found = RangeErrorLaw::of(parameters).density(error_m);
                let step = 1e-5;
                let by_error = (value(parameters, error_m + step) - value(parameters, error_m - step)) / (2.0 * step);
                assert!(
                    (found.by_error - by_error).abs() < 1e-5 * (1.0 + by_error.abs()),
                    "{parameters:?}, {error_m}"
                );
                for (which, by_law) in found.by_law.into_iter().enumerate() {
                    let (mut more, mut less) = (parameters, parameters);
                    more[which] += step;
                    less[which] -= step;
                    let expected = (value(more, error_m) - value(less, error_m)) / (2.0 * step);
                    assert!((by_law - expected).abs() < 1e-5 * (1.0 + expected.abs()), "{which}, {error_m}");
                }
            }
        }
    }

    #[test]
    fn densities_of_many_ranges_are_those_of_single_ones() {
        let law = RangeErrorLaw::of(LAWS[0]).prepared();
        let errors: Vec<f64> = (0..37).map(|at| 0.3 * f64::from(at) - 5.0).collect();
        let mut found = Vec::new();
        law.each_density(&errors, |at, density| found.push((at, density)));
        let expected: Vec<_> = errors.iter().map(|&error| law.density(error)).enumerate().collect();
        assert_eq!(found, expected);
    }

    #[test]
    fn the_information_is_that_of_the_normal_law_and_of_cauchys() {
        let information = |law| RangeErrorLaw::of(law).information_per_m2();
        let alone = -30.0;
        assert!((information([-1.0, 0.0, alone, alone]) / libm::exp(2.0) - 1.0).abs() < 1e-6);
        // Of Cauchy's law with the scale s it is 1/(2 s²).
        assert!((information([0.0, 0.0, 0.0, 60.0]) * 200.0 - 1.0).abs() < 1e-3);
        // A share of wild values takes away more than its share.
        let clean = information([-1.2, 0.0, -1.6, alone]);
        assert!(information([-1.2, 0.0, -1.6, -2.0]) < 0.9 * clean);
    }
}
