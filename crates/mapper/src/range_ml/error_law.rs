//! The law of errors that some errors have.

use nalgebra::{Matrix4, Vector4};
use sextant_channel::RangeErrorLaw;

use crate::numerics::median;

/// What is known of the law of errors before a log is seen: means and standard deviations of its parameters. The noise of common
/// devices is a few decimetres, one range in five comes by a way that is a metre longer, and one in a hundred is wild.
pub(crate) fn prior() -> ([f64; 4], [f64; 4]) {
    ([0.3, 1.0, 0.2, 0.01].map(libm::log), [1.0, 0.7, 1.5, 1.0])
}

/// Parameters of a law within reason: no device is better than a millimetre, so that ranges that fit exactly have a law.
pub(crate) fn bounded(parameters: [f64; 4]) -> [f64; 4] {
    /// Logarithms of a millimetre, a centimetre and a hundred metres.
    const LIMITS: [[f64; 2]; 4] = [[-6.9, 4.6], [-4.6, 4.6], [-12.0, 6.0], [-12.0, 6.0]];
    [0, 1, 2, 3].map(|at| parameters[at].clamp(LIMITS[at][0], LIMITS[at][1]))
}

/// The most probable law of these errors (m).
pub(crate) fn of_errors(errors_m: &[f64]) -> RangeErrorLaw {
    const STEPS: u32 = 60;
    let (mean, deviation) = prior();
    let (mean, precision) = (Vector4::from(mean), Vector4::from(deviation.map(|deviation| deviation.powi(-2))));
    let law = |at: &Vector4<f64>| RangeErrorLaw::of((*at).into()).prepared();
    let value = |at: &Vector4<f64>| -> f64 {
        let likelihood = law(at).log_likelihood(errors_m.iter().copied());
        likelihood - 0.5 * precision.dot(&(at - mean).component_mul(&(at - mean)))
    };
    let (mut at, mut damping) = (mean, 1e-3);
    let mut reached = value(&at);
    for _ in 0..STEPS {
        let law = law(&at);
        let mut slope = -precision.component_mul(&(at - mean));
        let mut curvature = Matrix4::from_diagonal(&precision);
        for &error_m in errors_m {
            let by_law = Vector4::from(law.density(error_m).by_law);
            slope += by_law;
            curvature += by_law * by_law.transpose();
        }
        let mut gain = 0.0;
        while damping < 1e8 {
            let damped = curvature + Matrix4::from_diagonal(&(curvature.diagonal() * damping));
            let Some(factor) = damped.cholesky() else { break };
            let next = Vector4::from(bounded((at + factor.solve(&slope)).into()));
            let value = value(&next);
            if value > reached {
                gain = value - reached;
                (at, reached) = (next, value);
                damping = (damping * 0.2).max(1e-9);
                break;
            }
            damping *= 5.0;
        }
        if gain < 1e-4 {
            break;
        }
    }
    RangeErrorLaw::of(at.into())
}

/// A law with much noise, whatever the ranges are: from far off, a search under it looks straight ahead.
pub(crate) fn noisy(noise_m: f64) -> RangeErrorLaw {
    RangeErrorLaw::of([noise_m, 1.0, 0.05, 0.01].map(libm::log))
}

/// How many independent errors one is worth, at most 1, of errors in so many series: each with the number of its series, in the order
/// of time.
pub(crate) fn worth(count: usize, errors_m: impl Iterator<Item = (usize, f64)>) -> f64 {
    let mut series = vec![Vec::new(); count];
    errors_m.for_each(|(number, error_m)| series[number].push(error_m));
    series.iter_mut().filter(|errors| !errors.is_empty()).for_each(|errors| centred(errors));
    1.0 / autocorrelation_time(series.iter().map(Vec::as_slice))
}

/// How many of a series of errors have the information of one independent one: their autocorrelation time, at least 1. Each list
/// is one series; errors are from its median, in the order of time.
pub(crate) fn autocorrelation_time<'a>(series: impl Iterator<Item = &'a [f64]>) -> f64 {
    /// Longest lag.
    const LAGS: usize = 40;
    /// A correlation below this one is none.
    const LEAST_CORRELATION: f64 = 0.05;
    let mut sums = [0.0; LAGS];
    for errors in series {
        for (lag, sum) in sums.iter_mut().enumerate().take((errors.len() / 2).max(1)) {
            *sum += errors.iter().zip(&errors[lag..]).map(|(one, other)| one * other).sum::<f64>();
        }
    }
    let of_lags = sums[1..].iter().map(|sum| sum / sums[0].max(f64::MIN_POSITIVE));
    1.0 + of_lags.take_while(|&correlation| correlation >= LEAST_CORRELATION).map(|c| 2.0 * c).sum::<f64>()
}

/// Moves errors to their median, and cuts those that are more than three standard deviations from it: one wild value says nothing of
/// the others.
pub(crate) fn centred(errors_m: &mut [f64]) {
    const CUT: f64 = 3.0;
    let middle = median(&mut errors_m.to_vec());
    let spread = 1.4826 * median(&mut errors_m.iter().map(|error| (error - middle).abs()).collect::<Vec<_>>());
    let most = CUT * spread + 1e-9;
    errors_m.iter_mut().for_each(|error| *error = (*error - middle).clamp(-most, most));
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_kernel::{Purpose, Seed};

    #[test]
    fn the_law_of_many_errors_is_theirs() {
        let draw = |i: u64, which| Seed(5).uniform(Purpose::new(8), [i, which, 0]);
        let normal = |i: u64| Seed(5).normal(Purpose::new(8), [i, 9, 0]);
        // Noise of 0.1 m, and 0.8 m more for three in ten.
        let errors: Vec<f64> = (0..20_000)
            .map(|i| 0.1 * normal(i) - if draw(i, 1) < 0.3 { 0.8 * libm::log(draw(i, 2)) } else { 0.0 })
            .collect();
        let law = of_errors(&errors);
        assert!((law.noise_m() - 0.1).abs() < 0.005, "{}", law.noise_m());
        assert!((law.excess_m() - 0.8).abs() < 0.05, "{}", law.excess_m());
        assert!((law.shares().late - 0.3).abs() < 0.02 && law.shares().wild < 0.002, "{:?}", law.shares());
    }

    #[test]
    fn equal_neighbours_count_once() {
        // Runs of four equal values: 1 + 2 (3/4 + 2/4 + 1/4).
        let normal = |i: u64| Seed(6).normal(Purpose::new(8), [i, 0, 0]);
        let errors: Vec<f64> = (0..40_000).map(|i| normal(i / 4)).collect();
        assert!((autocorrelation_time(std::iter::once(&errors[..])) - 4.0).abs() < 0.2);
        let errors: Vec<f64> = (0..40_000).map(normal).collect();
        assert!((autocorrelation_time(std::iter::once(&errors[..])) - 1.0).abs() < 0.05);
    }
}
