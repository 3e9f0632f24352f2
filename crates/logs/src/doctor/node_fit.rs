//! The place of one node that explains best what was heard of it, by a law of the distance: quick and rough, for checks.
//!
//! What was heard at distance `d` follows `η = a − b ln √(d² + d₀²)`: the strength (dBm) itself, or the logarithm of the odds
//! that a packet was heard. The place, `a` and `b` are found by Levenberg and Marquardt's method; `b` has a broad prior, so
//! that few observations do not run away. Distances are in the plane: heights differ little on most surveys.

use nalgebra::{Matrix4, Vector4};
use sextant_channel::Position;

/// The distance below which the law is flat (m).
const LEAST_M: f64 = 0.5;
/// Most steps of a search.
const STEPS: u32 = 30;
/// A search ends when a step gains less than this share of the loss.
const GAIN: f64 = 1e-5;

/// What one observation says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Law {
    /// Strengths (dBm) with errors of this scale (dB), of Student's law with four degrees of freedom: outliers count little.
    Strengths {
        /// Scale of the errors (dB).
        scale_db: f64,
    },
    /// 1 where a packet was heard, 0 elsewhere.
    Presence,
}

/// Something that was observed at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Observation {
    pub(super) at: Position,
    /// A strength (dBm), or 1 or 0.
    pub(super) value: f64,
    pub(super) weight: f64,
}

/// A place and the law around it: x, y (m), a and b.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NodeFit {
    pub(super) parameters: Vector4<f64>,
    /// Loss of all observations, with the prior.
    pub(super) loss: f64,
}

impl Law {
    /// Mean and standard deviation of the prior of `b`: of strengths a path-loss exponent of 2.5 ± 1.2.
    fn prior(self) -> [f64; 2] {
        match self {
            Self::Strengths { .. } => [2.5, 1.2].map(|exponent| exponent * 10.0 / std::f64::consts::LN_10),
            Self::Presence => [2.5, 1.5],
        }
    }

    /// Loss at η.
    fn loss(self, eta: f64, value: f64) -> f64 {
        match self {
            Self::Strengths { scale_db } => {
                let error = (eta - value) / scale_db;
                2.5 * libm::log(1.0 + error * error / 4.0)
            }
            Self::Presence => {
                let softplus = if eta > 30.0 { eta } else { libm::log1p(libm::exp(eta)) };
                softplus - value * eta
            }
        }
    }

    /// Slope and curvature (above 0) of the loss over η.
    fn slopes(self, eta: f64, value: f64) -> [f64; 2] {
        match self {
            Self::Strengths { scale_db } => {
                let error = (eta - value) / scale_db;
                let heavy = 1.0 + error * error / 4.0;
                [1.25 * error / heavy / scale_db, 1.25 / heavy / (scale_db * scale_db)]
            }
            Self::Presence => {
                let share = 1.0 / (1.0 + libm::exp(-eta));
                [share - value, (share * (1.0 - share)).max(1e-4)]
            }
        }
    }
}

impl NodeFit {
    /// The fit to `observations` that a search from `start` ends at. `None` if it has no finite loss.
    pub(super) fn from(start: Vector4<f64>, observations: &[Observation], law: Law) -> Option<Self> {
        let mut at = start;
        // Of each observation, at `at` and at the place that is tried.
        let (mut logs, mut tried) = (vec![0.0; observations.len()], vec![0.0; observations.len()]);
        let mut loss = total(&at, observations, law, &mut logs);
        let mut damping = 1e-2;
        for _ in 0..STEPS {
            let (slope, curvature) = derivatives(&at, observations, law, &logs);
            let mut improved = false;
            for _ in 0..6 {
                let mut damped = curvature;
                for i in 0..4 {
                    damped[(i, i)] += damping * curvature[(i, i)].max(1e-9);
                }
                let Some(step) = damped.lu().solve(&slope) else { break };
                let next = at - step;
                let found = total(&next, observations, law, &mut tried);
                if found < loss {
                    improved = loss - found > GAIN * loss.abs().max(1e-9);
                    (at, loss) = (next, found);
                    std::mem::swap(&mut logs, &mut tried);
                    damping = (damping * 0.2).max(1e-9);
                    break;
                }
                damping *= 6.0;
            }
            if !improved {
                break;
            }
        }
        loss.is_finite().then_some(Self { parameters: at, loss })
    }

    /// The best fit to `observations` of searches from several places: beside the strongest ones, and their middle.
    pub(super) fn of(observations: &[Observation], law: Law) -> Option<Self> {
        let mut order: Vec<&Observation> = observations.iter().collect();
        order.sort_by(|a, b| b.value.total_cmp(&a.value));
        let heard = match law {
            Law::Strengths { .. } => order.len().div_ceil(8),
            Law::Presence => order.iter().filter(|observation| observation.value > 0.5).count(),
        };
        let best = order.get(..heard).filter(|best| !best.is_empty())?;
        let middle = best.iter().fold(Position::ORIGIN, |sum, one| sum + one.at * (1.0 / best.len() as f64));
        let spread_m = best.iter().map(|one| plane_m(one.at, middle)).fold(0.0, f64::max).max(1.0);
        let [slope, _] = law.prior();
        let level = match law {
            Law::Strengths { .. } => best[0].value + slope * libm::log(0.5 * spread_m + LEAST_M),
            Law::Presence => slope * libm::log(spread_m + LEAST_M),
        };
        let aside = 0.3 * spread_m;
        let starts = [[0.0, 0.0], [aside, 0.0], [-aside, 0.0], [0.0, aside], [0.0, -aside]];
        let fits = starts.iter().filter_map(|[x, y]| {
            Self::from(Vector4::new(middle.x_m + x, middle.y_m + y, level, slope), observations, law)
        });
        fits.min_by(|a, b| a.loss.total_cmp(&b.loss))
    }

    /// Where the node is in the plane (m).
    pub(super) fn place(&self) -> Position {
        Position::new(self.parameters.x, self.parameters.y, 0.0)
    }

    /// η at a place.
    pub(super) fn at(&self, place: Position) -> f64 {
        eta(&self.parameters, log_m(&self.parameters, place))
    }

    /// The loss of one observation.
    pub(super) fn loss_of(&self, observation: &Observation, law: Law) -> f64 {
        observation.weight * law.loss(self.at(observation.at), observation.value)
    }
}

/// Distance in the plane (m).
pub(super) fn plane_m(a: Position, b: Position) -> f64 {
    libm::hypot(a.x_m - b.x_m, a.y_m - b.y_m)
}

/// `d² + d₀²` between a node and a place (m²).
fn square(at: &Vector4<f64>, place: Position) -> f64 {
    let (dx, dy) = (at.x - place.x_m, at.y - place.y_m);
    dx * dx + dy * dy + LEAST_M * LEAST_M
}

/// `ln √(d² + d₀²)` between a node and a place.
fn log_m(at: &Vector4<f64>, place: Position) -> f64 {
    0.5 * libm::log(square(at, place))
}

/// η where the logarithm of the distance is `log`.
fn eta(at: &Vector4<f64>, log: f64) -> f64 {
    at.z - at.w * log
}

/// The loss of all observations, with the prior. `logs` gets the logarithm of the distance of each.
fn total(at: &Vector4<f64>, observations: &[Observation], law: Law, logs: &mut [f64]) -> f64 {
    let [mean, deviation] = law.prior();
    let error = (at.w - mean) / deviation;
    let sum: f64 = observations
        .iter()
        .zip(logs)
        .map(|(observation, log)| {
            *log = log_m(at, observation.at);
            observation.weight * law.loss(eta(at, *log), observation.value)
        })
        .sum();
    sum + 0.5 * error * error
}

/// Slope and curvature of the loss. `logs` are the logarithms of the distances.
fn derivatives(
    at: &Vector4<f64>,
    observations: &[Observation],
    law: Law,
    logs: &[f64],
) -> (Vector4<f64>, Matrix4<f64>) {
    let [mean, deviation] = law.prior();
    let mut slope = Vector4::new(0.0, 0.0, 0.0, (at.w - mean) / (deviation * deviation));
    let mut curvature = Matrix4::zeros();
    curvature[(3, 3)] = 1.0 / (deviation * deviation);
    for (observation, &log) in observations.iter().zip(logs) {
        let [first, second] = law.slopes(eta(at, log), observation.value);
        let square = square(at, observation.at);
        let (dx, dy) = (at.x - observation.at.x_m, at.y - observation.at.y_m);
        // The derivatives of η by x, y, a and b.
        let by = [-at.w * dx / square, -at.w * dy / square, 1.0, -log];
        let (first, second) = (first * observation.weight, second * observation.weight);
        for row in 0..4 {
            slope[row] += by[row] * first;
            for column in 0..=row {
                curvature[(row, column)] += by[row] * by[column] * second;
            }
        }
    }
    curvature.fill_upper_triangle_with_lower_triangle();
    (slope, curvature)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strengths_of_the_law_tell_the_place() {
        let node = Position::new(3.0, 4.0, 0.0);
        let strength = |at: Position| -40.0 - 25.0 * libm::log10(plane_m(at, node).hypot(LEAST_M));
        let places = (0..48_u8).map(|i| Position::new(f64::from(i % 8) * 1.5, f64::from(i / 8) * 2.0, 0.0));
        let observations: Vec<_> = places.map(|at| Observation { at, value: strength(at), weight: 1.0 }).collect();
        let fit = NodeFit::of(&observations, Law::Strengths { scale_db: 3.0 }).unwrap();
        assert!(plane_m(fit.place(), node) < 0.05, "{fit:?}");
        assert!((fit.parameters.w - 25.0 / std::f64::consts::LN_10).abs() < 0.2, "{fit:?}");
    }

    #[test]
    fn packets_around_a_place_tell_it() {
        let node = Position::new(6.0, 5.0, 0.0);
        let places = (0..400_u16).map(|i| Position::new(f64::from(i % 20), f64::from(i / 20), 0.0));
        let seen = |at| Observation { at, value: f64::from(u8::from(plane_m(at, node) < 4.0)), weight: 1.0 };
        let fit = NodeFit::of(&places.map(seen).collect::<Vec<_>>(), Law::Presence).unwrap();
        assert!(plane_m(fit.place(), node) < 0.3, "{fit:?}");
    }
}
