//! A lower bound on the error of maps of simulated ranges.

use nalgebra::{Matrix3, Vector3};
use sextant_channel::{Position, RangeSample, RangingDevice, ReceptionLog};
use sextant_kernel::NodeId;

/// The true model of simulated ranges, from which the bound is computed.
#[derive(Clone, Copy)]
pub struct TrueRanges<'a> {
    /// The device that measured them.
    pub device: &'a RangingDevice,
    /// Whether an obstacle blocks the straight way between two places.
    pub is_blocked: &'a dyn Fn(Position, Position) -> bool,
    /// Where each node is (m).
    pub places: &'a [Position],
    /// Whether the heights of the nodes are known.
    pub heights_are_known: bool,
}

/// The mean distance between a node and the best estimate of its place from its ranges (m), averaged over the nodes with ranges:
/// Cramér's and Rao's bound (Van Trees 1968, section 2.4.2), with the estimate taken to be normal. It knows the law of the errors, which
/// ranges an obstacle blocks, bias and scale; the bias of each node is known by its standard deviation alone.
///
/// `None` if no node has ranges, and infinite if the ranges of a node leave a direction open.
#[must_use]
pub fn range_bound_m(log: &ReceptionLog, model: &TrueRanges<'_>) -> Option<f64> {
    let information = [false, true].map(|is_blocked| model.device.error_law(is_blocked).information_per_m2());
    let (mut sum_m, mut count) = (0.0, 0_u32);
    for (number, &place) in model.places.iter().enumerate() {
        let samples = log.ranges_to(NodeId::from_index(number));
        if !samples.is_empty() {
            let [clear, blocked] = information;
            let of = |sample: &RangeSample| {
                if (model.is_blocked)(sample.position, place) { blocked } else { clear }
            };
            sum_m += node_bound_m(place, samples, model, of);
            count += 1;
        }
    }
    (count > 0).then(|| sum_m / f64::from(count))
}

/// The bound of one node, of whose ranges `information` says how much each tells on its distance (per m²).
fn node_bound_m(
    place: Position,
    samples: &[RangeSample],
    model: &TrueRanges<'_>,
    information: impl Fn(&RangeSample) -> f64,
) -> f64 {
    /// Of the largest eigenvalue: less is no information.
    const LEAST: f64 = 1e-9;
    let mut of_place = Matrix3::zeros();
    let mut mixed = Vector3::zeros();
    let mut of_bias = 0.0;
    for sample in samples {
        let away = place - sample.position;
        let distance_m = away.distance_m(Position::ORIGIN).max(1e-9);
        let slope = Vector3::new(away.x_m, away.y_m, away.z_m) * (model.device.scale() / distance_m);
        let told = information(sample);
        of_place += told * slope * slope.transpose();
        mixed += told * slope;
        of_bias += told;
    }
    let deviation_m = model.device.node_bias_m();
    if deviation_m > 0.0 {
        of_place -= mixed * mixed.transpose() / (of_bias + 1.0 / (deviation_m * deviation_m));
    }
    let dimensions = if model.heights_are_known { 2 } else { 3 };
    let told = of_place.view((0, 0), (dimensions, dimensions)).into_owned().symmetric_eigen();
    let most = told.eigenvalues.max();
    if told.eigenvalues.min() <= LEAST * most {
        return f64::INFINITY;
    }
    let variances: Vec<f64> = told.eigenvalues.iter().map(|told| 1.0 / told).collect();
    mean_length(&variances)
}

/// The mean length of a normal vector with these two or three variances along its axes: that of its length if all were 1, times the
/// mean deviation over all directions.
fn mean_length(variances: &[f64]) -> f64 {
    use std::f64::consts::{PI, TAU};
    const STEPS: u32 = 256;
    let middle = |step: u32| (f64::from(step) + 0.5) / f64::from(STEPS);
    let circle = |a: f64, b: f64| {
        let of = |step| {
            let (sin, cos) = libm::sincos(TAU * middle(step));
            (a * cos * cos + b * sin * sin).sqrt()
        };
        (0..STEPS).map(of).sum::<f64>() / f64::from(STEPS)
    };
    match *variances {
        [a, b] => (PI / 2.0).sqrt() * circle(a, b),
        [a, b, c] => {
            // Heights on a sphere are uniform.
            let ring = |step| {
                let up = 2.0 * middle(step) - 1.0;
                let flat = 1.0 - up * up;
                let of = |turn| {
                    let (sin, cos) = libm::sincos(TAU * middle(turn));
                    (flat * (a * cos * cos + b * sin * sin) + c * up * up).sqrt()
                };
                (0..STEPS).map(of).sum::<f64>() / f64::from(STEPS)
            };
            2.0 * (2.0 / PI).sqrt() * (0..STEPS).map(ring).sum::<f64>() / f64::from(STEPS)
        }
        _ => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_channel::{RangingDeviceConfig, Stop};
    use sextant_kernel::{Purpose, Seed, SimTime};

    #[test]
    fn mean_lengths_are_those_of_draws() {
        for variances in [&[4.0, 4.0][..], &[9.0, 0.01], &[1.0, 1.0, 1.0], &[0.2, 3.0, 1.0]] {
            let draw = |number: u64, axis: usize| Seed(3).normal(Purpose::new(8), [number, axis as u64, 0]);
            let length = |number| {
                let of = |(axis, variance): (usize, &f64)| variance * draw(number, axis).powi(2);
                variances.iter().enumerate().map(of).sum::<f64>().sqrt()
            };
            let mean = (0..40_000).map(length).sum::<f64>() / 40_000.0;
            assert!((mean / mean_length(variances) - 1.0).abs() < 0.01, "{variances:?}: {mean}");
        }
    }

    /// Ranges from east and north alone: each coordinate has its own ranges.
    #[test]
    fn the_bound_is_that_of_the_mean_of_normal_ranges() {
        let device = RangingDeviceConfig { noise_m: 0.3, ..RangingDeviceConfig::default() };
        let bound = |config: RangingDeviceConfig, corners: &[(f64, f64)]| {
            let device = RangingDevice::try_from(config).unwrap();
            let sample = |(number, &(x_m, y_m)): (usize, &(f64, f64))| RangeSample {
                time: SimTime::from_nanos(number as u64),
                ..RangeSample::of(NodeId(0), Position::new(x_m, y_m, 0.0), 5.0)
            };
            let samples = corners.iter().enumerate().map(sample).collect();
            let stop = Stop::at(Position::ORIGIN);
            let log = ReceptionLog::new(vec!["a".into()], vec![stop], Vec::new(), Vec::new()).unwrap();
            let log = log.with_ranges(samples).unwrap();
            let model = TrueRanges {
                device: &device,
                is_blocked: &|_, _| false,
                places: &[Position::ORIGIN],
                heights_are_known: true,
            };
            range_bound_m(&log, &model).unwrap()
        };
        let cross = [(5.0, 0.0), (-5.0, 0.0), (0.0, 5.0), (0.0, -5.0)];
        let expected = (std::f64::consts::PI / 2.0).sqrt() * 0.3 / 2.0_f64.sqrt();
        assert!((bound(device, &cross) / expected - 1.0).abs() < 1e-6);
        // Opposite ranges see no bias.
        let biased = RangingDeviceConfig { node_bias_m: 1.0, ..device };
        assert!((bound(biased, &cross) / expected - 1.0).abs() < 1e-6);
        // From one side the bias stands for the distance.
        let corner = [(5.0, 0.0), (5.0, 0.0), (0.0, 5.0), (0.0, 5.0)];
        assert!(bound(biased, &corner) > 2.0 * expected);
        assert!(bound(device, &[(5.0, 0.0), (-5.0, 0.0)]).is_infinite());
    }
}
