//! The exponential function.

use super::{LN_2, with_widest_vectors};

/// Below this the result is 0: it would have fewer digits than others.
const LOWEST: f64 = -708.0;
/// Above this the result is infinite.
const HIGHEST: f64 = 709.0;
/// Added to a number, its digits after the point are lost, and the integer is in the last bits.
const ROUND: f64 = 6_755_399_441_055_744.0;
/// `(e^r + 1) r / (e^r - 1)`, without its first term 2, as a polynomial of r².
const RATIO: [f64; 5] = [
    1.666_666_666_666_660_2e-1,
    -2.777_777_777_701_559_3e-3,
    6.613_756_321_437_934e-5,
    -1.653_390_220_546_525_2e-6,
    4.138_136_797_057_238_5e-8,
];

/// `e^x`, within one unit in the last place: 0 below -708, infinity above 709, NaN for NaN.
#[inline]
#[must_use]
pub fn exp(x: f64) -> f64 {
    let near = x.clamp(LOWEST, HIGHEST);
    let rounded = near * std::f64::consts::LOG2_E + ROUND;
    let k = rounded - ROUND;
    let [high, low] = [near - k * LN_2[0], k * LN_2[1]];
    let r = high - low;
    let z = r * r;
    let ratio = RATIO[0] + z * (RATIO[1] + z * (RATIO[2] + z * (RATIO[3] + z * RATIO[4])));
    let c = r - z * ratio;
    let power = 1.0 + (r * c / (2.0 - c) - low + high);
    let scale = f64::from_bits((rounded.to_bits() << 52).wrapping_add(1.0_f64.to_bits()));
    let value = power * scale;
    let value = if x < LOWEST { 0.0 } else { value };
    if x > HIGHEST { f64::INFINITY } else { value }
}

/// [`exp`] of each number, in its place.
#[inline]
pub fn exp_each(values: &mut [f64]) {
    with_widest_vectors(|| values.iter_mut().for_each(|value| *value = exp(*value)));
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::exact::ulps;
    use super::*;

    #[test]
    fn exponentials_are_exact_to_the_last_place() {
        for (x, exact) in VALUES {
            assert!(ulps(exp(x), exact) <= 1, "{x}: {:e} instead of {exact:e}", exp(x));
        }
    }

    #[test]
    fn special_numbers_have_the_values_of_the_limits() {
        let are = |limit: f64, numbers: [f64; 3]| numbers.iter().all(|&x| exp(x).to_bits() == limit.to_bits());
        assert!(are(1.0, [0.0, -0.0, 5e-324]) && are(1.0, [f64::MIN_POSITIVE, -1e-300, 1e-20]));
        assert!(are(0.0, [f64::NEG_INFINITY, -1e300, -708.1]));
        assert!(are(f64::INFINITY, [f64::INFINITY, 1e300, 709.1]));
        assert!(exp(f64::NAN).is_nan() && exp(-f64::NAN).is_nan());
        assert!(exp(LOWEST) >= f64::MIN_POSITIVE && exp(HIGHEST) < f64::MAX);
    }

    proptest! {
        #[test]
        fn numbers_side_by_side_have_the_values_of_each_alone(
            values in prop::collection::vec(-800.0..800.0, 0..40),
        ) {
            let mut together: Vec<f64> = values.clone();
            exp_each(&mut together);
            prop_assert!(values.iter().zip(&together).all(|(x, y)| exp(*x).to_bits() == y.to_bits()));
            prop_assert!(values.iter().all(|x| ulps(exp(*x), libm::exp(*x)) <= 1 || *x < LOWEST || *x > HIGHEST));
        }
    }

    /// Numbers and their exponentials, computed with 60 digits.
    #[rustfmt::skip]
    #[expect(clippy::approx_constant, reason = "constants are special numbers too")]
    const VALUES: [(f64, f64); 60] = [
        (-707.9, 3.655411389615008e-308),
        (-700.25, 7.678723813110872e-305),
        (-500.1, 6.446583320475553e-218),
        (-123.456, 2.4195825412645934e-54),
        (-50.7, 9.577888291887943e-23),
        (-20.3, 1.5269401591266087e-09),
        (-10.1, 4.1079555225300724e-05),
        (-5.55, 0.0038874572434761303),
        (-3.3, 0.036883167401240015),
        (-2.2, 0.11080315836233387),
        (-1.1, 0.33287108369807955),
        (-1.0, 0.36787944117144233),
        (-0.75, 0.4723665527410147),
        (-0.5, 0.6065306597126334),
        (-0.3465735902799727, 0.7071067811865475),
        (-0.346573590279972, 0.707106781186548),
        (-0.3, 0.7408182206817179),
        (-0.1, 0.9048374180359595),
        (-0.01, 0.9900498337491681),
        (-0.001, 0.999000499833375),
        (-1e-06, 0.9999990000005),
        (-1e-10, 0.9999999999),
        (1e-12, 1.000000000001),
        (1e-09, 1.000000001),
        (1e-05, 1.00001000005),
        (0.002, 1.0020020013340003),
        (0.02, 1.0202013400267558),
        (0.2, 1.2214027581601699),
        (0.3465735902799726, 1.414213562373095),
        (0.34657359027997264, 1.414213562373095),
        (0.4, 1.4918246976412703),
        (0.6931471805599453, 2.0),
        (1.0, 2.718281828459045),
        (1.0397207708399179, 2.82842712474619),
        (1.5, 4.4816890703380645),
        (2.5, 12.182493960703473),
        (3.7, 40.4473043600674),
        (7.7, 2208.347991887209),
        (11.3, 80821.6375403136),
        (33.3, 289738526663660.5),
        (77.7, 5.554963937639787e+33),
        (222.2, 3.163981087772365e+96),
        (555.5, 1.780675146961092e+241),
        (700.1, 1.120899771073261e+304),
        (708.9, 7.436322587880697e+307),
        (-246.6341292335727, 7.729628560663668e-108),
        (-488.81115650569734, 5.152429247653761e-213),
        (211.30826225579528, 5.888603032207644e+91),
        (-598.5891986654401, 1.0864608783354944e-260),
        (50.234806029364904, 6.556907515534126e+21),
        (-188.03551632238026, 2.1737663389340062e-82),
        (-618.8015053154105, 1.81100999871526e-269),
        (10.410026465188366, 33190.74879059005),
        (-647.5060781812211, 6.189894501035077e-282),
        (-92.89604287265979, 4.526486086296954e-41),
        (-602.2024069955335, 2.929662910813279e-262),
        (-573.0017813185889, 1.407629152349878e-249),
        (-105.67313520048049, 1.2786170667326085e-46),
        (457.5929745408532, 5.371601677590107e+198),
        (-526.6772543904962, 1.8491607825977385e-229),
    ];
}
