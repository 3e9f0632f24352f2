//! How far the errors of a log are from being independent: along the way, and by direction.

use std::f64::consts::{FRAC_PI_4, PI};

use nalgebra::{DMatrix, DVector, Matrix3, Matrix4, Vector4};

use super::error_law::{self, centred};
use super::problem::{Point, Problem, Residual};

/// Directions from a node, and the least number of groups of one that has a mean.
const DIRECTIONS: usize = 8;
const LEAST_GROUPS: usize = 3;

/// The errors of the groups of a node from their median (m), and the direction from the robot to the node of each (rad).
fn errors(problem: &Problem<'_>, point: &Point, number: usize) -> (Vec<f64>, Vec<f64>) {
    let groups = problem.groups.of_node(number);
    let residuals = groups.iter().map(|group| Residual::of(group, &point.nodes[number], &point.shared));
    let with_direction =
        residuals.map(|residual| (residual.error_m, libm::atan2(residual.apart[1], residual.apart[0])));
    let (mut errors, directions): (Vec<f64>, Vec<f64>) = with_direction.unzip();
    centred(&mut errors);
    (errors, directions)
}

/// How many groups have the information of one independent one: the autocorrelation time of the errors, at least 1.
pub(super) fn autocorrelation_time(problem: &Problem<'_>, point: &Point) -> f64 {
    let series: Vec<Vec<f64>> = (0..point.nodes.len()).map(|number| errors(problem, point, number).0).collect();
    error_law::autocorrelation_time(series.iter().map(Vec::as_slice))
}

/// How errors by direction move places. What stands behind a node in some direction lengthens all ranges from there, and a place that
/// moves explains most of that: what is left over shows a part of it only.
pub(super) struct ByDirection {
    /// Variance of the mean error over directions from a node that is left (m²): each place is unsure by as much.
    pub(super) left: f64,
    /// What else the places are unsure by (m²), node by node.
    moved: Vec<Matrix3<f64>>,
}

/// Harmonics of an error by direction.
const HARMONICS: usize = 6;
/// A place and a bias take so many away beside them; nodes with fewer groups than twice as many as both tell nothing of harmonics.
const COORDINATES: f64 = 3.0;
const LEAST_FOR_HARMONICS: usize = 30;

/// The variance of both parts of a harmonic, as a share of that of the first: errors have bends and steps by direction.
fn share_of(harmonic: usize) -> f64 {
    (harmonic as f64).powi(-3)
}

/// How a node answers to errors of its ranges: place and bias that are fitted to them.
struct Answer {
    /// How much longer the range of each group is expected with the state of the node.
    by_state: Vec<Vector4<f64>>,
    /// Covariance of the state for ranges of unit weight.
    covariance: Matrix4<f64>,
    /// Directions from the robot (rad): round the vertical, and above the level unless heights are given.
    directions: Vec<f64>,
    elevations: Option<Vec<f64>>,
}

impl Answer {
    fn of(problem: &Problem<'_>, point: &Point, number: usize) -> Option<Self> {
        let (node, shared) = (&point.nodes[number], &point.shared);
        let weight = problem.worth / point.errors().noise_m().powi(2);
        let mut curvature = Matrix4::from_diagonal(&(problem.node_precision() / weight));
        let (mut by_state, mut directions, mut elevations) = (Vec::new(), Vec::new(), Vec::new());
        for group in problem.groups.of_node(number) {
            let Residual { apart, distance_m, .. } = Residual::of(group, node, shared);
            let longer = (1.0 + point.scale()) / distance_m;
            let up = if problem.heights.is_given() { 0.0 } else { apart[2] };
            let by = Vector4::new(longer * apart[0], longer * apart[1], longer * up, 1.0);
            curvature += by * by.transpose();
            by_state.push(by);
            directions.push(libm::atan2(apart[1], apart[0]));
            elevations.push(libm::atan2(apart[2], libm::hypot(apart[0], apart[1])));
        }
        if problem.heights.is_given() {
            curvature[(2, 2)] = 1.0;
        }
        let elevations = (!problem.heights.is_given()).then_some(elevations);
        Some(Self { by_state, covariance: curvature.try_inverse()?, directions, elevations })
    }

    /// The state that is fitted to these errors.
    fn state(&self, errors: &[f64]) -> Vector4<f64> {
        let sum = self.by_state.iter().zip(errors).fold(Vector4::zeros(), |sum, (by, error)| sum + by * *error);
        self.covariance * sum
    }

    /// The harmonics of an error by direction, as its values at each group, with their shares of the variance.
    fn harmonics(&self) -> impl Iterator<Item = (f64, Vec<f64>)> {
        std::iter::once(&self.directions).chain(&self.elevations).flat_map(|angles| {
            (1..=HARMONICS).flat_map(move |harmonic| {
                [0.0, 0.5 * PI].map(|phase| {
                    let value = |angle: &f64| libm::cos(harmonic as f64 * angle - phase);
                    (share_of(harmonic), angles.iter().map(value).collect())
                })
            })
        })
    }

    /// What is left of these errors beside the state that is fitted to them.
    fn left(&self, errors: &[f64]) -> Vec<f64> {
        let state = self.state(errors);
        let mut left: Vec<f64> = self.by_state.iter().zip(errors).map(|(by, error)| error - by.dot(&state)).collect();
        let mean = left.iter().sum::<f64>() / left.len().max(1) as f64;
        left.iter_mut().for_each(|error| *error -= mean);
        left
    }
}

/// The mean of some errors in each eighth of the circle of their directions, and how many these are.
fn means(errors: &[f64], directions: &[f64]) -> [(f64, usize); DIRECTIONS] {
    let mut means = [(0.0, 0_usize); DIRECTIONS];
    for (error_m, direction) in errors.iter().zip(directions) {
        let eighth = crate::numerics::whole((direction + PI) / FRAC_PI_4) % DIRECTIONS;
        means[eighth].0 += error_m;
        means[eighth].1 += 1;
    }
    means.map(|(total, count)| (total / count.max(1) as f64, count))
}

/// What the errors of a node tell of harmonics of the direction.
struct Told {
    /// Errors along independent sums of harmonics (m), and how large the variance of each is for harmonics of variance 1.
    parts: Vec<(f64, f64)>,
    /// What no harmonic explains (m).
    rest: Vec<f64>,
}

impl Told {
    /// Of `errors` of a node, beside what its place takes away.
    fn of(answer: &Answer, errors: &[f64]) -> Self {
        let columns: Vec<DVector<f64>> = answer
            .harmonics()
            .map(|(share, values)| DVector::from_vec(answer.left(&values)) * share.sqrt())
            .collect();
        let left = DMatrix::from_columns(&columns);
        let errors = DVector::from_column_slice(errors);
        let by_harmonic = left.tr_mul(&errors);
        let gram = left.tr_mul(&left).symmetric_eigen();
        let least = 1e-6 * gram.eigenvalues.max().max(f64::MIN_POSITIVE);
        let (mut parts, mut rest) = (Vec::new(), errors);
        for (&size, vector) in gram.eigenvalues.iter().zip(gram.eigenvectors.column_iter()) {
            if size > least {
                let along = vector.dot(&by_harmonic) / size.sqrt();
                rest -= &left * vector * (along / size.sqrt());
                parts.push((along, size));
            }
        }
        Self { parts, rest: rest.iter().copied().collect() }
    }
}

/// The variance of errors by direction (m²): its mean over deviations from half a centimetre to some metres, each as likely as the
/// last before the log is seen. The noise is what no harmonic explains.
fn variance_of(told: &[Told]) -> f64 {
    /// The least deviation that is tried (m), and how many, each larger by a factor of the root of 2.
    const LEAST_M: f64 = 0.005;
    const TRIED: u32 = 18;
    let freedom: f64 = told.iter().map(|told| told.rest.len() as f64 - told.parts.len() as f64 - COORDINATES).sum();
    if told.is_empty() || freedom <= 0.0 {
        return 0.0;
    }
    let alike = error_law::autocorrelation_time(told.iter().map(|told| told.rest.as_slice()));
    let squares: f64 = told.iter().flat_map(|told| &told.rest).map(|error_m| error_m * error_m).sum();
    let noise = squares / freedom * alike + 1e-12;
    let tried: Vec<(f64, f64)> = (0..TRIED)
        .map(|step| {
            let variance = (LEAST_M * libm::pow(2.0, 0.5 * f64::from(step))).powi(2);
            let of_part = |&(along, size): &(f64, f64)| {
                let expected = noise + variance * size;
                -0.5 * (libm::log(expected) + along * along / expected)
            };
            (variance, told.iter().flat_map(|told| &told.parts).map(of_part).sum())
        })
        .collect();
    let most = tried.iter().map(|&(_, log)| log).fold(f64::NEG_INFINITY, f64::max);
    let weighed = tried.into_iter().map(|(variance, log): (f64, f64)| (variance, libm::exp(log - most)));
    let (sum, weights) =
        weighed.fold((0.0, 0.0), |(sum, weights), (variance, weight)| (sum + variance * weight, weights + weight));
    sum / weights
}

impl ByDirection {
    /// Of the errors at `point`. The error by direction is a sum of harmonics, whose variance is estimated from what a place and a bias
    /// that are fitted leave of each.
    pub(super) fn of(problem: &Problem<'_>, point: &Point) -> Self {
        let (mut left, mut count, mut told) = (0.0, 0.0_f64, Vec::new());
        let answers: Vec<Option<Answer>> =
            (0..point.nodes.len()).map(|number| Answer::of(problem, point, number)).collect();
        for (number, answer) in answers.iter().enumerate() {
            let (errors, directions) = errors(problem, point, number);
            for (mean_m, groups) in means(&errors, &directions) {
                if groups >= LEAST_GROUPS {
                    left += mean_m * mean_m;
                    count += 1.0;
                }
            }
            let is_enough = errors.len() >= LEAST_FOR_HARMONICS;
            told.extend(answer.as_ref().filter(|_| is_enough).map(|answer| Told::of(answer, &errors)));
        }
        let variance = variance_of(&told);
        let moved = |answer: &Option<Answer>| {
            let Some(answer) = answer else { return Matrix3::zeros() };
            answer.harmonics().fold(Matrix3::zeros(), |sum, (share, values)| {
                let by = answer.state(&values).fixed_rows::<3>(0).into_owned();
                sum + by * by.transpose() * (variance * share)
            })
        };
        Self { left: left / count.max(1.0), moved: answers.iter().map(moved).collect() }
    }

    /// What the place of a node is unsure by (m²).
    pub(super) fn covariance(&self, number: usize) -> Matrix3<f64> {
        Matrix3::from_diagonal_element(self.left) + self.moved[number]
    }

    /// By how much errors by direction usually move a place along an axis beyond what is left of them (m).
    pub(super) fn moved_m(&self) -> f64 {
        let plane = self.moved.iter().map(|moved| 0.5 * (moved[(0, 0)] + moved[(1, 1)]));
        crate::numerics::median(&mut plane.collect::<Vec<_>>()).sqrt()
    }
}
