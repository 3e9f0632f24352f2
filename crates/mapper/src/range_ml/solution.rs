//! The places of all nodes with ranges, and the law of these.

use nalgebra::{Matrix3, Vector3};
use sextant_channel::{Position, RangeErrorLaw};
use sextant_kernel::{Interrupted, NodeId, Watch};

use super::error_law;
use super::fit::{Fitted, fitted};
use super::groups::RangeGroups;
use super::modes::{modes, settled};
use super::problem::{HeightPrior, NodeMode, NodeState, Point, Problem, Shared, SharedPrior};
use super::report::RangeFit;
use super::spread::{autocorrelation_time, variance_over_directions};
use super::{NodeBias, Settings};
use crate::numerics::median;
use crate::posterior::{Concern, Estimate};

/// Standard deviations of the biases of nodes that are tried (m), and the logarithmic prior of it: its middle (m) and its width.
const NODE_BIASES_M: [f64; 7] = [0.02, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6];
const USUAL_NODE_BIAS_M: f64 = 0.3;
const WIDTH_OF_NODE_BIAS: f64 = 1.0;
/// While places are sought, biases of nodes have this standard deviation (m): first wide, because the law is not known.
const FIRST_NODE_BIAS_M: f64 = 1.0;
const NODE_BIAS_M: f64 = 0.1;
/// A term that is left out has this deviation.
const NONE: f64 = 1e-6;
/// A second place is told if its share of the probability is at least that.
const LEAST_SHARE: f64 = 0.05;
/// Rounds in which dependence along the way, and the biases of nodes, are estimated in turn.
const ROUNDS: u32 = 2;

/// The estimates of the nodes, and what was learned; nothing if no node has enough ranges.
pub(super) struct Solution {
    pub(super) estimates: Vec<(NodeId, Estimate)>,
    pub(super) fit: RangeFit,
}

/// A fit with one standard deviation of the biases of nodes.
struct Trial {
    node_bias_m: f64,
    weight: f64,
    fitted: Fitted,
}

pub(super) fn solve(
    settings: &Settings,
    groups: &RangeGroups,
    samples: usize,
    heights: HeightPrior,
    watch: &dyn Watch,
) -> Result<Option<Solution>, Interrupted> {
    if groups.nodes.is_empty() {
        return Ok(None);
    }
    let prior = settings.prior();
    let (first_m, usual_m) = match settings.node_bias {
        NodeBias::Node => (FIRST_NODE_BIAS_M, NODE_BIAS_M),
        NodeBias::Common | NodeBias::None => (NONE, NONE),
    };
    let wide = Problem { groups, prior, heights, node_bias_m: first_m, worth: 1.0 };
    let mut found = Vec::with_capacity(groups.nodes.len());
    for number in 0..groups.nodes.len() {
        watch.check()?;
        found.push(modes(&wide, number, &prior.mean));
    }
    // A node whose ranges tell no place is not on the map.
    let lost: Vec<usize> = (0..found.len()).filter(|&number| found[number].is_empty()).collect();
    if !lost.is_empty() {
        return solve(settings, &groups.without(&lost), samples, heights, watch);
    }
    let mut search = Search { problem: Problem { node_bias_m: usual_m, ..wide }, modes: found, watch };
    let Some(start) = fitted(&wide, in_common(settings, search.best(), prior.mean), watch)? else { return Ok(None) };
    let Some(first) = fitted(&search.problem, start.point, watch)? else { return Ok(None) };
    let Some(mut point) = search.switched(first)?.map(|fitted| fitted.point) else { return Ok(None) };
    let mut trials = Vec::new();
    for _ in 0..ROUNDS {
        search.problem.worth = 1.0 / autocorrelation_time(&search.problem, &point);
        trials = search.trials(settings.node_bias, &point)?;
        let Some(best) = best(&trials) else { return Ok(None) };
        search.problem.node_bias_m = best.node_bias_m;
        point = best.fitted.point.clone();
    }
    // With the law that was found, another of its places may be the best of a node.
    search.modes_again(&point);
    let nodes = search.best();
    let is_other = |(one, other): (&NodeState, &NodeState)| (one - other).fixed_rows::<3>(0).norm() > 1.0;
    if nodes.iter().zip(&point.nodes).any(is_other) {
        trials = search.trials(settings.node_bias, &Point { nodes, shared: point.shared })?;
        let Some(best) = best(&trials) else { return Ok(None) };
        search.problem.node_bias_m = best.node_bias_m;
        point = best.fitted.point.clone();
        search.modes_again(&point);
    }
    Ok(Some(search.solution(&trials, samples)))
}

/// Places with biases of their own, as places with a bias in common and what is left.
fn in_common(settings: &Settings, mut nodes: Vec<NodeState>, mut shared: Shared) -> Point {
    if settings.node_bias != NodeBias::None {
        let common_m = median(&mut nodes.iter().map(|node| node[3]).collect::<Vec<_>>());
        nodes.iter_mut().for_each(|node| node[3] -= common_m);
        shared[0] += common_m;
    }
    Point { nodes, shared }
}

/// The likeliest trial.
fn best(trials: &[Trial]) -> Option<&Trial> {
    trials.iter().max_by(|a, b| a.weight.total_cmp(&b.weight))
}

/// The search for the best places.
struct Search<'a> {
    problem: Problem<'a>,
    /// The places that the ranges of each node may mean, the best first.
    modes: Vec<Vec<NodeMode>>,
    watch: &'a dyn Watch,
}

impl Search<'_> {
    /// The best place of each node.
    fn best(&self) -> Vec<NodeState> {
        self.modes.iter().map(|modes| modes[0].state).collect()
    }

    /// Settles the modes of all nodes by the law of `point`, whose places are modes as well. What was a bias of a node may be one of
    /// all ranges now, so the search for each begins with the bias that the node has there.
    fn modes_again(&mut self, point: &Point) {
        for (number, modes) in self.modes.iter_mut().enumerate() {
            let now = point.nodes[number];
            let others = modes.iter().map(|mode| NodeState::new(mode.state[0], mode.state[1], mode.state[2], now[3]));
            let starts: Vec<NodeState> = std::iter::once(now).chain(others).collect();
            let again = settled(&self.problem, number, &point.shared, &starts);
            if !again.is_empty() {
                *modes = again;
            }
        }
    }

    /// Takes the best mode of each node by the law of a fit, and fits again, until no mode changes; the better fit.
    fn switched(&mut self, mut fitted: Fitted) -> Result<Option<Fitted>, Interrupted> {
        const MOST: u32 = 4;
        for _ in 0..MOST {
            self.modes_again(&fitted.point);
            let start = Point { nodes: self.best(), shared: fitted.point.shared };
            let Some(next) = self::fitted(&self.problem, start, self.watch)? else { break };
            if next.log_evidence <= fitted.log_evidence + 1e-3 {
                break;
            }
            fitted = next;
        }
        Ok(Some(fitted))
    }

    /// A fit for each standard deviation of the biases of nodes, with its share of the probability.
    fn trials(&self, bias: NodeBias, point: &Point) -> Result<Vec<Trial>, Interrupted> {
        let sought: &[f64] = match bias {
            NodeBias::Node => &NODE_BIASES_M,
            NodeBias::Common | NodeBias::None => &[NONE],
        };
        let mut trials = Vec::new();
        let mut start = point.clone();
        for &node_bias_m in sought {
            let problem = Problem { node_bias_m, ..self.problem };
            if let Some(fitted) = fitted(&problem, start.clone(), self.watch)? {
                start = fitted.point.clone();
                let off = libm::log(node_bias_m / USUAL_NODE_BIAS_M) / WIDTH_OF_NODE_BIAS;
                trials.push(Trial { node_bias_m, weight: fitted.log_evidence - 0.5 * off * off, fitted });
            }
        }
        let most = trials.iter().map(|trial| trial.weight).fold(f64::NEG_INFINITY, f64::max);
        trials.iter_mut().for_each(|trial| trial.weight = libm::exp(trial.weight - most));
        let sum: f64 = trials.iter().map(|trial| trial.weight).sum();
        trials.iter_mut().for_each(|trial| trial.weight /= sum);
        Ok(trials)
    }

    /// The estimates: means over the trials, as wide as these say, and as far as they differ.
    fn solution(&self, trials: &[Trial], samples: usize) -> Solution {
        let best = best(trials).expect("there is a trial");
        let by_direction = variance_over_directions(&self.problem, &best.fitted.point);
        let settled = trials.iter().all(|trial| trial.fitted.settled || trial.weight < 1e-3);
        let point = &best.fitted.point;
        let deviations = best.fitted.curvature.deviations();
        let law: RangeErrorLaw = point.errors();
        let fit = RangeFit {
            ranges: samples,
            groups: self.problem.groups.len(),
            nodes: self.problem.groups.nodes.len(),
            bias_m: point.bias_m(),
            bias_deviation_m: deviations[0],
            scale: point.scale(),
            scale_deviation: deviations[1],
            delay_s: point.delay_s(),
            delay_deviation_s: deviations[2],
            node_bias_m: trials.iter().map(|trial| trial.weight * trial.node_bias_m).sum(),
            errors: law,
            log_density: self.problem.mean_log_density(point),
            worth: self.problem.worth,
            by_direction_m: by_direction.sqrt(),
            settled,
        };
        let is_sure = settled && !fit.is_mostly_wild();
        let estimates = (self.problem.groups.nodes.iter().enumerate())
            .map(|(number, &node)| (node, self.estimate(number, trials, by_direction, is_sure)))
            .collect();
        Solution { estimates, fit }
    }

    fn estimate(&self, number: usize, trials: &[Trial], by_direction: f64, is_sure: bool) -> Estimate {
        let place = |trial: &Trial| trial.fitted.point.nodes[number].fixed_rows::<3>(0).into_owned();
        let mean: Vector3<f64> = trials.iter().map(|trial| place(trial) * trial.weight).sum();
        let mut covariance = Matrix3::zeros();
        for trial in trials {
            let apart = place(trial) - mean;
            let own = trial.fitted.curvature.of_node(number).fixed_view::<3, 3>(0, 0).into_owned();
            covariance += (own + apart * apart.transpose()) * trial.weight;
        }
        covariance += Matrix3::from_diagonal_element(by_direction);
        // Other places that the ranges may mean are in the region, as far as they are probable.
        let modes = &self.modes[number];
        let mut other_share = 0.0;
        for mode in &modes[1..] {
            let share = 1.0 / (1.0 + libm::exp(modes[0].log_evidence - mode.log_evidence));
            let apart = mode.state.fixed_rows::<3>(0) - modes[0].state.fixed_rows::<3>(0);
            covariance += apart * apart.transpose() * share;
            // Two hills of one region are one place.
            let own = mode.covariance.fixed_view::<3, 3>(0, 0) + modes[0].covariance.fixed_view::<3, 3>(0, 0);
            let deviation_m = (apart.dot(&(own * apart)) / apart.norm_squared().max(f64::MIN_POSITIVE)).sqrt();
            if apart.norm() > 3.0 * deviation_m {
                other_share += share;
            }
        }
        if self.problem.heights.is_given() {
            for at in 0..3 {
                covariance[(at, 2)] = 0.0;
                covariance[(2, at)] = 0.0;
            }
        }
        let groups = self.problem.groups.of_node(number);
        let usual_m = median(&mut groups.iter().map(|group| group.range_m.abs()).collect::<Vec<_>>());
        let widest = covariance.fixed_view::<2, 2>(0, 0).into_owned().symmetric_eigenvalues().max().max(0.0).sqrt();
        let concern = if !is_sure {
            Some(Concern::Unsettled)
        } else if other_share >= LEAST_SHARE {
            Some(Concern::TwoPlaces)
        } else if widest > usual_m {
            Some(Concern::NoEvidence)
        } else {
            None
        };
        let entry = |row: usize| [covariance[(row, 0)], covariance[(row, 1)], covariance[(row, 2)]];
        Estimate {
            position: Position::new(mean[0], mean[1], mean[2]),
            log_likelihood: None,
            ties: 1,
            covariance: Some([entry(0), entry(1), entry(2)]),
            infeasible: false,
            concern,
        }
    }
}

impl Settings {
    /// What is known of ranges before a log is seen. Biases of common devices are up to a few metres, scales up to a few percent;
    /// clocks of logs differ by a tenth of a second or two.
    fn prior(&self) -> SharedPrior {
        let bias_m = if self.node_bias == NodeBias::None { NONE } else { 3.0 };
        let (mean, deviation) = error_law::prior();
        let of_shared = [bias_m, self.scale_error.max(NONE), self.delay_error_s.max(NONE)];
        SharedPrior {
            mean: Shared::from_iterator([0.0; 3].into_iter().chain(mean)),
            deviation: Shared::from_iterator(of_shared.into_iter().chain(deviation)),
        }
    }
}
