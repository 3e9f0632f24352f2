//! What is sought, how likely it is, and how that changes: places, biases, scale, delay and the law of errors, all at once.

use nalgebra::{Matrix4, SMatrix, Vector4};
use rayon::prelude::*;
use sextant_channel::RangeErrorLaw;

use super::error_law::bounded;
use super::groups::{RangeGroup, RangeGroups};
use super::shared::DELAY;
use super::shared::Mixed;
pub(super) use super::shared::{BIAS, ERRORS, SCALE, Shared, SharedMatrix};
use super::sums::{ByPlace, NodeSlopes, RangeSums};

/// What is sought of a node: x, y, z (m) and how much longer its ranges are than those of others (m).
pub(super) type NodeState = Vector4<f64>;

/// All that is sought.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Point {
    pub(super) nodes: Vec<NodeState>,
    /// Bias of all ranges (m), scale (the share by which they are too long), how late they are (s), and the parameters of the law
    /// of their errors.
    pub(super) shared: Shared,
}

impl Point {
    pub(super) fn bias_m(&self) -> f64 {
        self.shared[BIAS]
    }

    pub(super) fn scale(&self) -> f64 {
        self.shared[SCALE]
    }

    pub(super) fn delay_s(&self) -> f64 {
        self.shared[DELAY]
    }

    pub(super) fn errors(&self) -> RangeErrorLaw {
        errors(&self.shared)
    }
}

fn errors(shared: &Shared) -> RangeErrorLaw {
    RangeErrorLaw::of([0, 1, 2, 3].map(|at| shared[ERRORS + at]))
}

/// A normal prior of the parameters that all ranges share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SharedPrior {
    pub(super) mean: Shared,
    pub(super) deviation: Shared,
}

/// The heights at which nodes are sought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HeightPrior {
    /// The most likely height (m).
    pub(super) mean_m: f64,
    /// The standard deviation round it (m); 0 if the height is given.
    pub(super) deviation_m: f64,
    /// The lowest and the highest height that settings allow (m).
    pub(super) range_m: Option<[f64; 2]>,
}

impl HeightPrior {
    pub(super) fn is_given(self) -> bool {
        self.deviation_m <= 0.0
    }

    /// The least number of ranges of a node that tell a place: one more than there are coordinates, because of the bias.
    pub(super) fn least(self) -> usize {
        if self.is_given() { 3 } else { 4 }
    }
}

/// The problem: which places and which law explain the ranges.
#[derive(Clone, Copy, Debug)]
pub(super) struct Problem<'a> {
    pub(super) groups: &'a RangeGroups,
    pub(super) prior: SharedPrior,
    pub(super) heights: HeightPrior,
    /// Standard deviation of the biases of nodes (m).
    pub(super) node_bias_m: f64,
    /// How many independent ranges a group is worth, at most 1: errors of neighbouring groups are similar.
    pub(super) worth: f64,
}

/// The least curvature of a range, as a share of that of a law with its stiffness.
const LEAST_CURVATURE: f64 = 0.1;

/// A curvature is no better known than to this share.
pub(super) const ROUNDING: f64 = 1e-9;

/// The slope of the log-posterior by everything that is sought, and its curvature.
#[derive(Clone, Debug)]
pub(super) struct Slopes {
    nodes: Vec<NodeSlopes>,
    shared_slope: Shared,
    shared_curvature: SharedMatrix,
}

/// What of the error of a range is explained.
pub(super) struct Residual {
    /// The range less what is expected of it (m).
    pub(super) error_m: f64,
    /// From the robot to the node (m), and how long that is.
    pub(super) apart: [f64; 3],
    pub(super) distance_m: f64,
}

impl Residual {
    pub(super) fn of(group: &RangeGroup, node: &NodeState, shared: &Shared) -> Self {
        let apart = [0, 1, 2].map(|axis| node[axis] - group.position[axis] + group.velocity[axis] * shared[DELAY]);
        let distance_m = (apart[0] * apart[0] + apart[1] * apart[1] + apart[2] * apart[2] + 1e-12).sqrt();
        let error_m = group.range_m - (1.0 + shared[SCALE]) * distance_m - shared[BIAS] - node[3];
        Self { error_m, apart, distance_m }
    }
}

impl Problem<'_> {
    /// The prior precision of a node's state.
    pub(super) fn node_precision(&self) -> Vector4<f64> {
        let height = if self.heights.is_given() { 0.0 } else { self.heights.deviation_m.powi(-2) };
        Vector4::new(0.0, 0.0, height, self.node_bias_m.powi(-2))
    }

    /// The logarithm of the prior of a node's state, up to what is the same for all states.
    fn node_prior(&self, node: &NodeState) -> f64 {
        let precision = self.node_precision();
        -0.5 * (precision[2] * (node[2] - self.heights.mean_m).powi(2) + precision[3] * node[3] * node[3])
    }

    fn shared_prior(&self, shared: &Shared) -> f64 {
        let SharedPrior { mean, deviation } = self.prior;
        -0.5 * (shared - mean).component_div(&deviation).norm_squared() - deviation.map(libm::log).sum()
    }

    /// The mean logarithm of the density of the errors of all groups (per m).
    pub(super) fn mean_log_density(&self, point: &Point) -> f64 {
        let law = point.errors().prepared();
        let of_node = |(number, node): (usize, &NodeState)| -> f64 {
            let error_m = |group: &RangeGroup| Residual::of(group, node, &point.shared).error_m;
            law.log_likelihood(self.groups.of_node(number).iter().map(error_m))
        };
        point.nodes.iter().enumerate().map(of_node).sum::<f64>() / self.groups.len() as f64
    }

    /// The logarithm of the posterior of one node given the rest.
    fn node_value(&self, number: usize, node: &NodeState, shared: &Shared, sample: Sample) -> f64 {
        let law = errors(shared).prepared();
        let groups = sample.of(self.groups.of_node(number));
        let error_m = |group: &RangeGroup| Residual::of(group, node, shared).error_m;
        self.worth * sample.weight() * law.log_likelihood(groups.map(error_m)) + self.node_prior(node)
    }

    /// The number of coordinates that take errors away: of many ranges they take nearly none.
    fn coordinates(&self) -> f64 {
        let of_node = if self.heights.is_given() { 2.0 } else { 3.0 };
        if self.groups.are_few() { self.groups.nodes.len() as f64 * of_node } else { 0.0 }
    }

    /// What integrating over the places adds to the logarithm of the posterior of a law, by Laplace's method: places that are fitted
    /// take as many errors away, so that few ranges fit better than their noise is.
    pub(super) fn of_places(&self, shared: &Shared) -> f64 {
        self.coordinates() * shared[ERRORS]
    }

    /// The logarithm of the posterior, with the places integrated over as far as they shrink the noise.
    pub(super) fn value(&self, point: &Point) -> f64 {
        let values: Vec<f64> = (point.nodes.par_iter().enumerate())
            .map(|(number, node)| self.node_value(number, node, &point.shared, Sample::ALL))
            .collect();
        values.into_iter().sum::<f64>() + self.shared_prior(&point.shared) + self.of_places(&point.shared)
    }

    /// Slopes by the state of one node. The curvature is the sum of the squared slopes of single groups (Berndt et al. 1974),
    /// which needs no second derivative and is never negative. Of few groups, it is mostly that of Gauss and Newton. A range that fits
    /// exactly has no slope, so that each has a least curvature.
    fn node_slopes(
        &self,
        number: usize,
        node: &NodeState,
        shared: &Shared,
        sample: Sample,
        of_law: bool,
    ) -> NodeSlopes {
        let groups: Vec<&RangeGroup> = sample.of(self.groups.of_node(number)).collect();
        let usual = self.groups.usual_slopes(number);
        let residuals: Vec<Residual> = groups.iter().map(|group| Residual::of(group, node, shared)).collect();
        let errors_m: Vec<f64> = residuals.iter().map(|residual| residual.error_m).collect();
        let mut sums = RangeSums::zeros();
        errors(shared).prepared().each_density(&errors_m, |at, density| {
            let Residual { apart, distance_m, .. } = residuals[at];
            let per_metre = -(1.0 + shared[SCALE]) / distance_m;
            let vertical = if self.heights.is_given() { 0.0 } else { per_metre * apart[2] };
            let closing: f64 = apart.iter().zip(&groups[at].velocity).map(|(apart, velocity)| apart * velocity).sum();
            let (x, y) = (per_metre * apart[0], per_metre * apart[1]);
            let by = ByPlace::new(x, y, vertical, -1.0, -distance_m, per_metre * closing);
            let of_slopes = (density.by_error * density.by_error).max(LEAST_CURVATURE * density.stiffness);
            sums.add_place(&density, &by, usual * density.stiffness + (1.0 - usual) * of_slopes);
            if of_law {
                sums.add_law(&density, &by, 1.0 - usual);
            }
        });
        let mut found = sums.slopes();
        let worth = self.worth * sample.weight();
        let precision = self.node_precision();
        let from_mean = Vector4::new(0.0, 0.0, node[2] - self.heights.mean_m, node[3]);
        found.value = worth * found.value + self.node_prior(node);
        found.slope = found.slope * worth - precision.component_mul(&from_mean);
        found.curvature = found.curvature * worth + Matrix4::from_diagonal(&precision);
        if self.heights.is_given() {
            found.curvature[(2, 2)] = 1.0;
        }
        found.mixed *= worth;
        found.shared_slope *= worth;
        found.shared_curvature *= worth;
        found
    }

    /// Slopes by everything.
    pub(super) fn slopes(&self, point: &Point) -> Slopes {
        let nodes: Vec<NodeSlopes> = (point.nodes.par_iter().enumerate())
            .map(|(number, node)| self.node_slopes(number, node, &point.shared, Sample::ALL, true))
            .collect();
        let precision = self.prior.deviation.map(|deviation| deviation.powi(-2));
        let mut shared_slope = -precision.component_mul(&(point.shared - self.prior.mean));
        shared_slope[ERRORS] += self.coordinates();
        let mut shared_curvature = SharedMatrix::from_diagonal(&precision);
        for node in &nodes {
            shared_slope += node.shared_slope;
            shared_curvature += node.shared_curvature;
        }
        Slopes { nodes, shared_slope, shared_curvature }
    }

    /// The likeliest state of one node near `start` with a given law, and the logarithm of the probability of the mode; `None` if
    /// the ranges do not tell a place there.
    pub(super) fn settle_node(
        &self,
        number: usize,
        start: NodeState,
        shared: &Shared,
        effort: Effort,
    ) -> Option<NodeMode> {
        let (steps, least_gain, sample) = match effort {
            Effort::Look => (25, 0.05, Sample::few(self.groups.of_node(number).len())),
            Effort::Settle => (100, 1e-5, Sample::ALL),
        };
        let slopes_at = |state: &NodeState| self.node_slopes(number, state, shared, sample, false);
        let (mut state, mut damping) = (start, 1e-3);
        let mut slopes = slopes_at(&state);
        for _ in 0..steps {
            let damped = damp(slopes.curvature, damping);
            let step = damped.cholesky()?.solve(&slopes.slope);
            let next = state + step;
            let gain = self.node_value(number, &next, shared, sample) - slopes.value;
            if gain > 0.0 {
                (state, slopes) = (next, slopes_at(&next));
                damping = (damping * 0.2).max(1e-9);
                if gain < least_gain {
                    break;
                }
            } else {
                damping *= 5.0;
                if damping > 1e8 {
                    break;
                }
            }
        }
        let factor = slopes.curvature.cholesky().or_else(|| damp(slopes.curvature, ROUNDING).cholesky())?;
        let log_determinant = 2.0 * factor.l().diagonal().map(libm::log).sum();
        let covariance = factor.inverse();
        Some(NodeMode { state, log_evidence: slopes.value - 0.5 * log_determinant, covariance })
    }
}

/// How far a mode is climbed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Effort {
    /// Near enough to tell which mode it is, by some of the ranges if there are many.
    Look,
    /// To its top.
    Settle,
}

/// Every so many of the ranges of a node, each of which stands for all of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample(usize);

impl Sample {
    const ALL: Self = Self(1);

    /// Enough of so many ranges to tell a place roughly.
    pub(super) fn few(ranges: usize) -> Self {
        /// So many are enough.
        const ENOUGH: usize = 100;
        Self((ranges / ENOUGH).max(1))
    }

    pub(super) fn of<T>(self, ranges: &[T]) -> impl Iterator<Item = &T> {
        ranges.iter().step_by(self.0)
    }

    fn weight(self) -> f64 {
        self.0 as f64
    }
}

/// A place of a node that is likelier than those around it.
#[derive(Clone, Copy, Debug)]
pub(super) struct NodeMode {
    pub(super) state: NodeState,
    /// Logarithm of the probability of the mode, by Laplace's method, up to what is the same for all modes of the node.
    pub(super) log_evidence: f64,
    /// The covariance of the state with a given law.
    pub(super) covariance: Matrix4<f64>,
}

fn damp<const N: usize>(mut matrix: SMatrix<f64, N, N>, damping: f64) -> SMatrix<f64, N, N> {
    for at in 0..N {
        matrix[(at, at)] = matrix[(at, at)] * (1.0 + damping) + 1e-12;
    }
    matrix
}

/// The curvature with the nodes eliminated.
pub(super) struct Eliminated {
    /// The inverse of the curvature of each node by itself.
    nodes: Vec<Matrix4<f64>>,
    /// The same times the mixed curvature.
    mixed: Vec<Mixed>,
    /// The inverse of the curvature of the shared parameters, all nodes free.
    shared: SharedMatrix,
    log_determinant: f64,
}

impl Slopes {
    /// Eliminates the nodes, with `damping`; `None` if the curvature is not positive.
    pub(super) fn eliminated(&self, damping: f64) -> Option<Eliminated> {
        let mut shared = damp(self.shared_curvature, damping);
        let (mut nodes, mut mixed) = (Vec::with_capacity(self.nodes.len()), Vec::with_capacity(self.nodes.len()));
        let mut log_determinant = 0.0;
        for node in &self.nodes {
            let factor = damp(node.curvature, damping).cholesky()?;
            log_determinant += 2.0 * factor.l().diagonal().map(libm::log).sum();
            let inverse = factor.inverse();
            let of_mixed = inverse * node.mixed;
            shared -= node.mixed.transpose() * of_mixed;
            nodes.push(inverse);
            mixed.push(of_mixed);
        }
        let factor = shared.cholesky()?;
        log_determinant += 2.0 * factor.l().diagonal().map(libm::log).sum();
        Some(Eliminated { nodes, mixed, shared: factor.inverse(), log_determinant })
    }

    /// The step that a Newton method takes from `point`.
    pub(super) fn moved(&self, point: &Point, eliminated: &Eliminated) -> Point {
        let mut slope = self.shared_slope;
        for (node, mixed) in self.nodes.iter().zip(&eliminated.mixed) {
            slope -= mixed.transpose() * node.slope;
        }
        let step = eliminated.shared * slope;
        let of_node = |number: usize| {
            point.nodes[number] + eliminated.nodes[number] * self.nodes[number].slope
                - eliminated.mixed[number] * step
        };
        let mut shared = point.shared + step;
        let law = bounded([0, 1, 2, 3].map(|at| shared[ERRORS + at]));
        law.into_iter().enumerate().for_each(|(at, value)| shared[ERRORS + at] = value);
        Point { nodes: (0..point.nodes.len()).map(of_node).collect(), shared }
    }
}

impl Eliminated {
    /// Logarithm of the determinant of the curvature.
    pub(super) fn log_determinant(&self) -> f64 {
        self.log_determinant
    }

    /// The covariance of the state of a node.
    pub(super) fn of_node(&self, number: usize) -> Matrix4<f64> {
        let mixed = self.mixed[number];
        self.nodes[number] + mixed * self.shared * mixed.transpose()
    }

    /// The standard deviations of the shared parameters.
    pub(super) fn deviations(&self) -> Shared {
        self.shared.diagonal().map(|variance| variance.max(0.0).sqrt())
    }
}
