//! The tail of the normal distribution.

/// One over the root of 2π, the standard normal density at 0.
pub const PER_ROOT_OF_TAU: f64 = 0.398_942_280_401_432_7;

/// The point whose argument of the polynomial is 0.
const MIDDLE: f64 = 5.0;
/// The ratio times 1 + √2·t as a polynomial of (t − 5)/(t + 5), in the form of Shepherd and Laframboise, "Chebyshev approximation
/// of (1 + 2x) exp(x²) erfc x in 0 ≤ x < ∞" (Mathematics of Computation, 1981), fitted with 40 digits.
const POLYNOMIAL: [f64; 24] = [
    1.556_167_287_834_573,
    -0.175_595_360_687_586_8,
    -0.010_512_067_495_234_655,
    0.119_437_481_760_526_03,
    -0.143_276_488_304_170_97,
    0.111_291_441_167_978_01,
    -0.063_113_277_465_759_68,
    0.025_589_795_554_448_177,
    -0.006_169_476_768_335_838,
    -0.000_111_796_389_622_436_97,
    0.000_709_098_276_123_586_5,
    -0.000_191_032_039_318_964_6,
    -4.197_932_808_639_282_4e-05,
    3.343_497_829_401_408e-05,
    4.510_853_856_906_213_6e-07,
    -4.887_582_863_689_12e-06,
    3.739_931_159_742_334_7e-07,
    7.367_255_485_184_367e-07,
    -8.250_647_678_411_414e-08,
    -1.159_560_203_981_352_4e-07,
    1.139_298_757_842_728e-08,
    1.641_468_462_532_222e-08,
    -8.698_238_846_640_451e-10,
    -1.417_269_707_699_992_4e-09,
];

/// Mills' ratio at t ≥ 0, `(1 - Φ(t)) / φ(t)` of the standard normal law, within 2·10⁻¹⁵ of itself. It has no branches.
#[inline]
#[must_use]
pub fn mills_ratio(t: f64) -> f64 {
    let along = (t - MIDDLE) / (t + MIDDLE);
    let sum = POLYNOMIAL.iter().rev().fold(0.0, |sum, coefficient| sum * along + coefficient);
    sum / (1.0 + std::f64::consts::SQRT_2 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_are_those_of_exact_arithmetic() {
        for (t, exact) in VALUES {
            assert!((mills_ratio(t) / exact - 1.0).abs() < 2e-15, "{t}: {:e} instead of {exact:e}", mills_ratio(t));
        }
    }

    #[test]
    fn the_ratio_is_that_of_the_complementary_error_function() {
        for i in 0..3700_i32 {
            let t = f64::from(i) / 100.0;
            let ratio = (std::f64::consts::PI / 2.0).sqrt()
                * libm::exp(t * t / 2.0)
                * libm::erfc(t / std::f64::consts::SQRT_2);
            assert!((mills_ratio(t) / ratio - 1.0).abs() < 3e-13, "{t}");
        }
    }

    /// Numbers and their ratios, computed with 40 digits.
    const VALUES: [(f64, f64); 18] = [
        (0.0, 1.253_314_137_315_500_3),
        (1e-9, 1.253_314_136_315_500_3),
        (0.01, 1.243_376_471_249_034_7),
        (0.1, 1.159_262_399_618_736_3),
        (0.5, 0.876_364_456_453_692_3),
        (1.0, 0.655_679_542_418_798_4),
        (1.5, 0.515_815_638_217_963_4),
        (2.0, 0.421_369_229_288_054_5),
        (3.0, 0.304_590_298_710_103_3),
        (4.0, 0.236_652_382_913_560_67),
        (5.0, 0.192_808_104_715_315_76),
        (7.5, 0.131_079_355_804_491_76),
        (10.0, 0.099_028_596_471_731_93),
        (20.0, 0.049_875_925_981_836_79),
        (37.0, 0.027_007_327_965_128_336),
        (50.5, 0.019_794_224_593_047_777),
        (200.0, 0.004_999_875_009_373_828),
        (1e4, 9.999_999_900_000_004e-05),
    ];
}
