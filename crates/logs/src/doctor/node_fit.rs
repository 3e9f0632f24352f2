//! The place of one node that explains best what was heard of it, by a law of the distance: quick and rough, for checks.
//!
//! What was heard at distance `d` follows `η = a − b ln √(d² + d₀²) + f cos ψ + s sin ψ`: the strength (dBm) itself, or the
//! logarithm of the odds that a packet was heard. ψ is the direction of the node from the heading of the robot, and `f`, `s` are
//! what its body and antenna make of it ([`Pattern`], the same for all nodes). The place, `a` and `b` are found by Levenberg
//! and Marquardt's method; `b` has a broad prior, so that few observations do not run away. Distances are in the plane: heights
//! differ little on most surveys.

use nalgebra::{Matrix2, Matrix4, Matrix4x2, Vector2, Vector4};
use sextant_channel::Position;

use crate::place::distance::plane_m;

/// The distance below which the law is flat (m).
const LEAST_M: f64 = 0.5;
/// Most steps of a search.
const STEPS: u32 = 30;
/// A search ends when a step gains less than this share of the loss.
const GAIN: f64 = 1e-5;

/// By how much η is greater in front of a robot than to its side, and to its left than in front: the first harmonic of its
/// antenna and body.
pub(super) type Pattern = Vector2<f64>;

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
    /// The direction in which the robot drives, of length 1; 0 if it does not.
    pub(super) heading: [f64; 2],
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
    pub(super) fn from(
        start: Vector4<f64>,
        observations: &[Observation],
        law: Law,
        pattern: &Pattern,
    ) -> Option<Self> {
        let mut at = start;
        // Of each observation, at `at` and at the place that is tried.
        let (mut logs, mut tried) = (vec![0.0; observations.len()], vec![0.0; observations.len()]);
        let mut loss = total(&at, observations, law, pattern, &mut logs);
        let mut damping = 1e-2;
        for _ in 0..STEPS {
            let (slope, curvature) = derivatives(&at, observations, law, pattern, &logs);
            let mut improved = false;
            for _ in 0..6 {
                let mut damped = curvature;
                for i in 0..4 {
                    damped[(i, i)] += damping * curvature[(i, i)].max(1e-9);
                }
                let Some(step) = damped.lu().solve(&slope) else { break };
                let next = at - step;
                let found = total(&next, observations, law, pattern, &mut tried);
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
    pub(super) fn of(observations: &[Observation], law: Law, pattern: &Pattern) -> Option<Self> {
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
            let start = Vector4::new(middle.x_m + x, middle.y_m + y, level, slope);
            Self::from(start, observations, law, pattern)
        });
        fits.min_by(|a, b| a.loss.total_cmp(&b.loss))
    }

    /// η of an observation.
    pub(super) fn eta_of(&self, observation: &Observation, pattern: &Pattern) -> f64 {
        let at = &self.parameters;
        eta(at, log_m(at, observation.at)) + pattern.dot(&direction(at, observation))
    }

    /// The loss of one observation.
    pub(super) fn loss_of(&self, observation: &Observation, law: Law, pattern: &Pattern) -> f64 {
        observation.weight * law.loss(self.eta_of(observation, pattern), observation.value)
    }

    /// Slope and curvature over the pattern of the loss of all observations, with the place, `a` and `b` following it.
    pub(super) fn pattern_slopes(
        &self,
        observations: &[Observation],
        law: Law,
        pattern: &Pattern,
    ) -> (Vector2<f64>, Matrix2<f64>) {
        let at = &self.parameters;
        let logs: Vec<f64> = observations.iter().map(|observation| log_m(at, observation.at)).collect();
        let (_, own) = derivatives(at, observations, law, pattern, &logs);
        let (mut slope, mut curvature, mut mixed) = (Vector2::zeros(), Matrix2::zeros(), Matrix4x2::zeros());
        for (observation, &log) in observations.iter().zip(&logs) {
            let along = direction(at, observation);
            let [first, second] = law.slopes(eta(at, log) + pattern.dot(&along), observation.value);
            let by = by_parameters(at, observation, log, pattern);
            slope += along * (first * observation.weight);
            curvature += along * along.transpose() * (second * observation.weight);
            mixed += by * along.transpose() * (second * observation.weight);
        }
        let followed = own.cholesky().map_or_else(Matrix2::zeros, |own| mixed.transpose() * own.solve(&mixed));
        (slope, curvature - followed)
    }
}

/// Cosine and sine of the direction of the node from the heading of the robot; both are 0 where the robot has none.
fn direction(at: &Vector4<f64>, observation: &Observation) -> Vector2<f64> {
    let (dx, dy) = (at.x - observation.at.x_m, at.y - observation.at.y_m);
    let [hx, hy] = observation.heading;
    Vector2::new(hx * dx + hy * dy, hx * dy - hy * dx) / square(at, observation.at).sqrt()
}

/// The derivatives of η by x, y, a and b.
fn by_parameters(at: &Vector4<f64>, observation: &Observation, log: f64, pattern: &Pattern) -> Vector4<f64> {
    let square = square(at, observation.at);
    let (dx, dy) = (at.x - observation.at.x_m, at.y - observation.at.y_m);
    let [hx, hy] = observation.heading;
    let along = direction(at, observation);
    let distance_m = square.sqrt();
    let by_x = Vector2::new(hx, -hy) / distance_m - along * (dx / square);
    let by_y = Vector2::new(hy, hx) / distance_m - along * (dy / square);
    Vector4::new(pattern.dot(&by_x) - at.w * dx / square, pattern.dot(&by_y) - at.w * dy / square, 1.0, -log)
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
fn total(at: &Vector4<f64>, observations: &[Observation], law: Law, pattern: &Pattern, logs: &mut [f64]) -> f64 {
    let [mean, deviation] = law.prior();
    let error = (at.w - mean) / deviation;
    let sum: f64 = observations
        .iter()
        .zip(logs)
        .map(|(observation, log)| {
            *log = log_m(at, observation.at);
            let eta = eta(at, *log) + pattern.dot(&direction(at, observation));
            observation.weight * law.loss(eta, observation.value)
        })
        .sum();
    sum + 0.5 * error * error
}

/// Slope and curvature of the loss. `logs` are the logarithms of the distances.
fn derivatives(
    at: &Vector4<f64>,
    observations: &[Observation],
    law: Law,
    pattern: &Pattern,
    logs: &[f64],
) -> (Vector4<f64>, Matrix4<f64>) {
    let [mean, deviation] = law.prior();
    let mut slope = Vector4::new(0.0, 0.0, 0.0, (at.w - mean) / (deviation * deviation));
    let mut curvature = Matrix4::zeros();
    curvature[(3, 3)] = 1.0 / (deviation * deviation);
    for (observation, &log) in observations.iter().zip(logs) {
        let eta = eta(at, log) + pattern.dot(&direction(at, observation));
        let [first, second] = law.slopes(eta, observation.value);
        let by = by_parameters(at, observation, log, pattern);
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

    /// Where a node is in the plane (m).
    fn place(fit: &NodeFit) -> Position {
        Position::new(fit.parameters.x, fit.parameters.y, 0.0)
    }

    #[test]
    fn strengths_of_the_law_tell_the_place() {
        let node = Position::new(3.0, 4.0, 0.0);
        let strength = |at: Position| -40.0 - 25.0 * libm::log10(plane_m(at, node).hypot(LEAST_M));
        let places = (0..48_u8).map(|i| Position::new(f64::from(i % 8) * 1.5, f64::from(i / 8) * 2.0, 0.0));
        let observation = |at| Observation { at, heading: [0.0; 2], value: strength(at), weight: 1.0 };
        let observations: Vec<_> = places.map(observation).collect();
        let fit = NodeFit::of(&observations, Law::Strengths { scale_db: 3.0 }, &Pattern::zeros()).unwrap();
        assert!(plane_m(place(&fit), node) < 0.05, "{fit:?}");
        assert!((fit.parameters.w - 25.0 / std::f64::consts::LN_10).abs() < 0.2, "{fit:?}");
    }

    #[test]
    fn packets_around_a_place_tell_it() {
        let node = Position::new(6.0, 5.0, 0.0);
        let places = (0..400_u16).map(|i| Position::new(f64::from(i % 20), f64::from(i / 20), 0.0));
        let seen = |at| {
            let value = f64::from(u8::from(plane_m(at, node) < 4.0));
            Observation { at, heading: [0.0; 2], value, weight: 1.0 }
        };
        let fit = NodeFit::of(&places.map(seen).collect::<Vec<_>>(), Law::Presence, &Pattern::zeros()).unwrap();
        assert!(plane_m(place(&fit), node) < 0.3, "{fit:?}");
    }

    #[test]
    fn derivatives_are_those_of_the_loss() {
        let law = Law::Strengths { scale_db: 3.0 };
        let observation = |i: u8| Observation {
            at: Position::new(f64::from(i % 5), f64::from(i / 5), 0.0),
            heading: [0.6, if i.is_multiple_of(2) { 0.8 } else { -0.8 }],
            value: -50.0 - f64::from(i % 7),
            weight: 1.0,
        };
        let observations: Vec<_> = (0..30).map(observation).collect();
        let (at, pattern) = (Vector4::new(2.3, 6.1, -44.0, 9.0), Pattern::new(2.0, -1.0));
        let mut logs = vec![0.0; observations.len()];
        let loss = |at: &Vector4<f64>, pattern: &Pattern| {
            total(at, &observations, law, pattern, &mut vec![0.0; observations.len()])
        };
        total(&at, &observations, law, &pattern, &mut logs);
        let (slope, _) = derivatives(&at, &observations, law, &pattern, &logs);
        for i in 0..4 {
            let mut step = Vector4::zeros();
            step[i] = 1e-5;
            let expected = (loss(&(at + step), &pattern) - loss(&(at - step), &pattern)) / 2e-5;
            assert!((slope[i] - expected).abs() < 1e-5, "{i}: {} {expected}", slope[i]);
        }
        let (of_pattern, _) = NodeFit { parameters: at, loss: 0.0 }.pattern_slopes(&observations, law, &pattern);
        for i in 0..2 {
            let mut step = Pattern::zeros();
            step[i] = 1e-5;
            let expected = (loss(&at, &(pattern + step)) - loss(&at, &(pattern - step))) / 2e-5;
            assert!((of_pattern[i] - expected).abs() < 1e-5, "{i}: {} {expected}", of_pattern[i]);
        }
    }
}
