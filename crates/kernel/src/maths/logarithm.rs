//! The natural logarithm.

use super::{LN_2, with_widest_vectors};

/// The bits of the root of one half, without the lower half of them.
const ROOT_OF_HALF: u64 = 0x3fe6_a09e_0000_0000;
/// The bits of 1.
const ONE: u64 = 0x3ff0_0000_0000_0000;
/// The bits of the fraction.
const FRACTION: u64 = (1 << 52) - 1;
/// 2⁵², whose last bits are those of an integer that is added, and the same with what the exponent of 1 is.
const INTEGERS: u64 = 0x4330_0000_0000_0000;
const BIAS: f64 = 4_503_599_627_371_519.0;
/// What makes a number normal that has fewer digits than others, and its binary logarithm.
const ENLARGED: [f64; 2] = [18_014_398_509_481_984.0, 54.0];
/// `ln((1 + s) / (1 - s)) / s`, without its first term 2, as a polynomial of s².
const SERIES: [f64; 7] = [
    6.666_666_666_666_735e-1,
    3.999_999_999_940_942e-1,
    2.857_142_874_366_239e-1,
    2.222_219_843_214_978_4e-1,
    1.818_357_216_161_805e-1,
    1.531_383_769_920_937_3e-1,
    1.479_819_860_511_658_6e-1,
];

/// `ln x`, within one unit in the last place: -infinity for 0, NaN below 0 and for NaN, infinity for infinity.
#[inline]
#[must_use]
pub fn ln(x: f64) -> f64 {
    let is_small = x < f64::MIN_POSITIVE;
    let normal = if is_small { x * ENLARGED[0] } else { x };
    // The power of two for which the rest is between the root of one half and that of two.
    let moved = normal.to_bits().wrapping_add(ONE - ROOT_OF_HALF);
    let k = f64::from_bits((moved >> 52) | INTEGERS) - BIAS - if is_small { ENLARGED[1] } else { 0.0 };
    let f = f64::from_bits((moved & FRACTION).wrapping_add(ROOT_OF_HALF)) - 1.0;
    let half_square = 0.5 * f * f;
    let s = f / (2.0 + f);
    let z = s * s;
    let w = z * z;
    let even = w * (SERIES[1] + w * (SERIES[3] + w * SERIES[5]));
    let odd = z * (SERIES[0] + w * (SERIES[2] + w * (SERIES[4] + w * SERIES[6])));
    let value = s * (half_square + (odd + even)) + k * LN_2[1] - half_square + f + k * LN_2[0];
    let value = if x < f64::INFINITY { value } else { x };
    let value = if x < 0.0 { f64::NAN } else { value };
    if x == 0.0 { f64::NEG_INFINITY } else { value }
}

/// [`ln`] of each number, in its place.
#[inline]
pub fn ln_each(values: &mut [f64]) {
    with_widest_vectors(|| values.iter_mut().for_each(|value| *value = ln(*value)));
}

/// The bits of the root of one half and of 1 in single precision, and the bits of its fraction.
const SINGLE_ROOT_OF_HALF: u32 = 0x3f35_04f3;
const SINGLE_ONE: u32 = 0x3f80_0000;
const SINGLE_FRACTION: u32 = (1 << 23) - 1;
/// The logarithm of 2 in two parts, as in [`LN_2`], and the series in single precision.
const SINGLE_LN_2: [f32; 2] = [f32::from_bits(0x3f31_7180), f32::from_bits(0x3717_f7d1)];
const SINGLE_SERIES: [f32; 4] = [0.666_666_6, 0.400_009_7, 0.284_987_87, 0.242_790_79];

/// `ln x` of a number that is not subnormal, within one unit in the last place of single precision.
#[inline]
fn ln_single(x: f32) -> f32 {
    let moved = x.to_bits().wrapping_add(SINGLE_ONE - SINGLE_ROOT_OF_HALF);
    let k = ((moved >> 23).cast_signed() - 127) as f32;
    let f = f32::from_bits((moved & SINGLE_FRACTION).wrapping_add(SINGLE_ROOT_OF_HALF)) - 1.0;
    let half_square = 0.5 * f * f;
    let s = f / (2.0 + f);
    let z = s * s;
    let w = z * z;
    let even = w * (SINGLE_SERIES[1] + w * SINGLE_SERIES[3]);
    let odd = z * (SINGLE_SERIES[0] + w * SINGLE_SERIES[2]);
    s * (half_square + (odd + even)) + k * SINGLE_LN_2[1] - half_square + f + k * SINGLE_LN_2[0]
}

/// The natural logarithm of each number in single precision, in its place, within one unit in the last place. The numbers are
/// positive, finite and not subnormal; of others the result is any number.
#[inline]
pub fn ln_each_single(values: &mut [f32]) {
    with_widest_vectors(|| values.iter_mut().for_each(|value| *value = ln_single(*value)));
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::exact::ulps;
    use super::*;

    #[test]
    fn logarithms_in_single_precision_are_exact_to_the_last_place() {
        let mut values: Vec<f32> = (0..4000_i16).map(|i| 1e-12 * 1.013_f32.powi(i32::from(i))).collect();
        values.extend((1..2000_i16).map(|i| 0.5 + f32::from(i) / 1000.0));
        let exact: Vec<f64> = values.iter().map(|&x| libm::log(f64::from(x))).collect();
        ln_each_single(&mut values);
        for (found, exact) in values.iter().zip(exact) {
            // Half a unit is rounding.
            let unit = exact.abs().max(f64::from(f32::MIN_POSITIVE)) * f64::from(f32::EPSILON);
            assert!((f64::from(*found) - exact).abs() <= unit, "{found} instead of {exact}");
        }
    }

    #[test]
    fn logarithms_are_exact_to_the_last_place() {
        for (x, exact) in VALUES {
            assert!(ulps(ln(x), exact) <= 1, "{x:e}: {:e} instead of {exact:e}", ln(x));
        }
    }

    #[test]
    fn special_numbers_have_the_values_of_the_limits() {
        let is = |x: f64, limit: f64| ln(x).to_bits() == limit.to_bits();
        assert!(is(0.0, f64::NEG_INFINITY) && is(-0.0, f64::NEG_INFINITY));
        assert!(is(1.0, 0.0) && is(f64::INFINITY, f64::INFINITY));
        assert!([f64::NAN, -f64::NAN, -1.0, -5e-324, f64::NEG_INFINITY].iter().all(|&x| ln(x).is_nan()));
    }

    proptest! {
        #[test]
        fn numbers_side_by_side_have_the_values_of_each_alone(
            values in prop::collection::vec(prop::num::f64::POSITIVE | prop::num::f64::SUBNORMAL, 0..40),
        ) {
            let values: Vec<f64> = values.into_iter().map(f64::abs).collect();
            let mut together = values.clone();
            ln_each(&mut together);
            prop_assert!(values.iter().zip(&together).all(|(x, y)| ln(*x).to_bits() == y.to_bits()));
            prop_assert!(values.iter().all(|x| ulps(ln(*x), libm::log(*x)) <= 1));
        }
    }

    /// Numbers and their logarithms, computed with 60 digits.
    #[rustfmt::skip]
    #[expect(clippy::approx_constant, reason = "constants are special numbers too")]
    const VALUES: [(f64, f64); 58] = [
        (5e-324, -744.4400719213812),
        (1e-310, -713.8013788281542),
        (2.2250738585072014e-308, -708.3964185322641),
        (1e-300, -690.7755278982137),
        (1e-200, -460.51701859880916),
        (1e-100, -230.25850929940458),
        (1e-50, -115.12925464970229),
        (1e-20, -46.051701859880914),
        (1e-09, -20.72326583694641),
        (1e-05, -11.512925464970229),
        (0.001, -6.907755278982137),
        (0.01, -4.605170185988091),
        (0.1, -2.3025850929940455),
        (0.3, -1.2039728043259361),
        (0.5, -0.6931471805599453),
        (0.6, -0.5108256237659907),
        (0.7, -0.35667494393873245),
        (0.7071067811865475, -0.34657359027997275),
        (0.7071067811865477, -0.3465735902799724),
        (0.75, -0.2876820724517809),
        (0.9, -0.10536051565782628),
        (0.99, -0.01005033585350145),
        (0.999999, -1.000000500029089e-06),
        (0.9999999999999999, -1.1102230246251565e-16),
        (1.0000000000000002, 2.2204460492503128e-16),
        (1.000001, 9.999994999180668e-07),
        (1.01, 0.009950330853168092),
        (1.1, 0.09531017980432493),
        (1.25, 0.22314355131420976),
        (1.4142135623730951, 0.3465735902799727),
        (1.4142135623730954, 0.34657359027997287),
        (1.5, 0.4054651081081644),
        (2.0, 0.6931471805599453),
        (2.5, 0.9162907318741551),
        (3.3, 1.1939224684724346),
        (7.7, 2.0412203288596382),
        (10.0, 2.302585092994046),
        (99.0, 4.59511985013459),
        (1000.0, 6.907755278982137),
        (1000000.0, 13.815510557964274),
        (1000000000000.0, 27.631021115928547),
        (1e+50, 115.12925464970229),
        (1e+100, 230.25850929940458),
        (1e+200, 460.51701859880916),
        (1e+300, 690.7755278982137),
        (1.7976931348623157e+308, 709.782712893384),
        (1.0862457449617613e-150, -345.3050364686984),
        (1.1225360541132054e+69, 158.99396187618484),
        (3.916316765361062e+242, 558.5907441159868),
        (6.005380347437711e+41, 96.1986446047396),
        (1.0372960349538322e-56, -128.90814784668632),
        (1.1500858729952694e+258, 594.2067906042209),
        (2.0607028052299123e-246, -565.7128857843309),
        (1.728087033675645e+194, 447.2485230766688),
        (9.975895198575036e-115, -262.49711399134804),
        (1.7306000586248912e-193, -443.8504547447848),
        (7.928633713088499e-208, -476.8672186153904),
        (1.6792362918441023e-104, -238.95051056951016),
    ];
}
