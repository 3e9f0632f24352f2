//! The places of all nodes with ranges, and the law of these.

use nalgebra::{Matrix3, Vector3};
use sextant_channel::RangeErrorLaw;
use sextant_kernel::{Interrupted, NodeId, Watch};

use super::error_law;
use super::explained::Explained;
use super::fit::{Fitted, fitted};
use super::groups::RangeGroups;
use super::modes::{least_squares, middle, modes, settled};
use super::places::{Place, are_two, estimate, longest_m, places, within};
use super::problem::{BIAS, ERRORS, HeightPrior, NodeMode, NodeState, Point, Problem, Shared, SharedPrior};
use super::report::RangeFit;
use super::spread::{ByDirection, autocorrelation_time};
use super::{NodeBias, Settings};
use crate::numerics::median;
use crate::posterior::{Concern, Estimate, LIKELY};

/// A bias that is no better known than by this factor than before the log was seen is assumed.
const ASSUMED: f64 = 0.9;
/// Standard deviations of the biases of nodes that are tried (m), and the logarithmic prior of it: its middle (m) and its width.
const NODE_BIASES_M: [f64; 7] = [0.02, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6];
const USUAL_NODE_BIAS_M: f64 = 0.3;
const WIDTH_OF_NODE_BIAS: f64 = 1.0;
/// Bias and scale of all ranges are wrong by so much of what is thought possible: those of calibrated devices are right.
const SHARES_OF_ERROR: [f64; 3] = [1.0 / 30.0, 1.0 / 6.0, 1.0];
/// Places are those of the least of these shares whose probability is this part of the best one's or more: a bias that the log does
/// not tell moves no place, and widens its region.
const TOLD: f64 = 0.135;
/// Of many ranges, the bias is told if its standard deviation is at most this share of what was thought possible: then it is estimated.
const NARROWED: f64 = 0.27;
/// What is less probable than the best by so much is not tried (nats).
const HOPELESS: f64 = 10.0;
/// While places are sought, biases of nodes have this standard deviation (m): first wide, because the law is not known.
const FIRST_NODE_BIAS_M: f64 = 1.0;
pub(super) const NODE_BIAS_M: f64 = 0.1;
/// The noise is told by as much at least.
const LEAST_FREEDOM: f64 = 2.0;
/// A term that is left out has this deviation.
const NONE: f64 = 1e-6;
/// Rounds in which dependence along the way, and the biases of nodes, are estimated in turn.
const ROUNDS: u32 = 2;
/// Places of nodes are exchanged for better ones so many times at most.
const SWITCHES: u32 = 4;

/// The estimates of the nodes, and what was learned; nothing if no node has enough ranges.
pub(super) struct Solution {
    pub(super) estimates: Vec<(NodeId, Estimate)>,
    /// The nodes whose ranges leave several places, and these.
    pub(super) ambiguous: Vec<(NodeId, Vec<Place>)>,
    pub(super) fit: RangeFit,
    /// What all ranges share, and how well the bias of a node without many ranges is known (m).
    pub(super) shared: Shared,
    pub(super) bias_deviation_m: f64,
}

/// How much of what is thought possible the bias and the scale of all ranges are wrong by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ErrorShares {
    pub(super) bias: f64,
    pub(super) scale: f64,
}

impl ErrorShares {
    /// All of it.
    pub(super) const ALL: Self = Self { bias: 1.0, scale: 1.0 };
}

/// A fit with one standard deviation of the biases of nodes, and one of what all ranges share.
struct Trial {
    error: ErrorShares,
    prior: SharedPrior,
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
    let prior = settings.prior(ErrorShares::ALL);
    let (first_m, usual_m) = match settings.node_bias {
        NodeBias::Node => (FIRST_NODE_BIAS_M, NODE_BIAS_M),
        NodeBias::Common | NodeBias::None => (NONE, NONE),
    };
    let wide = Problem { groups, prior, heights, node_bias_m: first_m, worth: 1.0 };
    let mut found = Vec::with_capacity(groups.nodes.len());
    for number in 0..groups.nodes.len() {
        watch.check()?;
        let mut of_node = modes(&wide, number, &prior.mean);
        if groups.are_few() {
            of_node.extend(modes(&Problem { node_bias_m: usual_m, ..wide }, number, &prior.mean));
        }
        found.push(of_node);
    }
    // A node whose ranges tell no place is not on the map.
    let lost: Vec<usize> = (0..found.len()).filter(|&number| found[number].is_empty()).collect();
    if !lost.is_empty() {
        return solve(settings, &groups.without(&lost), samples, heights, watch);
    }
    let plain = by_least_squares(&wide, prior.mean);
    let problem = Problem { node_bias_m: usual_m, ..wide };
    let mut search = Search { settings, problem, modes: found, plain, watch };
    let Some(start) = fitted(&wide, in_common(settings, search.best(), prior.mean), watch)? else { return Ok(None) };
    let Some(first) = fitted(&search.problem, start.point, watch)? else { return Ok(None) };
    let Some(mut point) = search.switched(first)?.map(|fitted| fitted.point) else { return Ok(None) };
    let mut trials = Vec::new();
    for _ in 0..ROUNDS {
        search.problem.worth = 1.0 / autocorrelation_time(&search.problem, &point);
        trials = search.trials(&point)?;
        let Some(next) = search.take(&trials) else { return Ok(None) };
        point = next;
    }
    // With the law that was found, another of its places may be the best of a node.
    search.modes_again(&point);
    let nodes = search.best();
    let is_other = |(one, other): (&NodeState, &NodeState)| (one - other).fixed_rows::<3>(0).norm() > 1.0;
    if nodes.iter().zip(&point.nodes).any(is_other) {
        trials = search.trials(&Point { nodes, shared: point.shared })?;
        let Some(next) = search.take(&trials) else { return Ok(None) };
        search.modes_again(&next);
    }
    let (mut places, mut better) = search.places(&trials)?;
    for _ in 0..SWITCHES {
        let Some(start) = better else { break };
        trials = search.trials(&start)?;
        let Some(next) = search.take(&trials) else { return Ok(None) };
        search.modes_again(&next);
        (places, better) = search.places(&trials)?;
    }
    Ok(Some(search.solution(&trials, &places, samples)))
}

/// The places of plain least squares, with as much noise as they leave.
pub(super) fn by_least_squares(problem: &Problem<'_>, mut shared: Shared) -> Point {
    let number = 0..problem.groups.nodes.len();
    let of_node = |number| least_squares(problem.groups.of_node(number), problem.heights);
    let (nodes, squares): (Vec<NodeState>, Vec<f64>) = number.map(of_node).unzip();
    shared[ERRORS] = 0.5 * libm::log(squares.iter().sum::<f64>() / problem.groups.len() as f64 + 1e-6);
    Point { nodes, shared }
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

impl Trial {
    /// How much larger the 95 % regions are because the noise was estimated from few errors: by Fisher's law instead of the
    /// chi-squared one, with as many degrees of freedom as the noise is told by.
    fn widened(&self) -> f64 {
        let freedom = (0.5 * self.fitted.curvature.deviations()[ERRORS].powi(-2)).max(LEAST_FREEDOM);
        freedom * (libm::pow(0.05, -2.0 / freedom) - 1.0) / (2.0 * LIKELY)
    }
}

/// The trials whose errors are the least that the log does not rule out: first by bias, then by scale.
fn plainest(trials: &[Trial]) -> Vec<&Trial> {
    let of_bias = least(trials.iter().collect(), |trial| trial.error.bias);
    least(of_bias, |trial| trial.error.scale)
}

/// Those of some trials with the least share that is probable enough.
fn least(trials: Vec<&Trial>, share_of: impl Fn(&Trial) -> f64) -> Vec<&Trial> {
    let is_of = |trial: &Trial, share: f64| share_of(trial).total_cmp(&share).is_eq();
    let weight =
        |share: f64| -> f64 { trials.iter().filter(|trial| is_of(trial, share)).map(|trial| trial.weight).sum() };
    let weights = SHARES_OF_ERROR.map(|share| (share, weight(share)));
    let most = weights.iter().map(|&(_, weight)| weight).fold(0.0, f64::max);
    let least = weights.iter().find(|&&(_, weight)| weight > 0.0 && weight >= TOLD * most).copied();
    least.map_or_else(Vec::new, |(share, _)| trials.iter().copied().filter(|trial| is_of(trial, share)).collect())
}

/// The likeliest of some trials.
fn likeliest<'a>(trials: impl IntoIterator<Item = &'a Trial>) -> Option<&'a Trial> {
    trials.into_iter().max_by(|a, b| a.weight.total_cmp(&b.weight))
}

/// The likeliest of the plainest trials.
fn best(trials: &[Trial]) -> Option<&Trial> {
    likeliest(plainest(trials))
}

/// The search for the best places.
struct Search<'a> {
    settings: &'a Settings,
    problem: Problem<'a>,
    /// The places that the ranges of each node may mean, the best first.
    modes: Vec<Vec<NodeMode>>,
    /// The places of plain least squares.
    plain: Point,
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

    /// A fit for each share of error and each standard deviation of the biases of nodes, with its share of the probability: the better
    /// one from `start` and from plain least squares. Many ranges that tell the bias need neither the latter nor other shares.
    fn trials(&self, start: &Point) -> Result<Vec<Trial>, Interrupted> {
        let sought: &[f64] = match self.settings.node_bias {
            NodeBias::Node => &NODE_BIASES_M,
            NodeBias::Common | NodeBias::None => &[NONE],
        };
        let are_few = self.problem.groups.are_few();
        let mut trials: Vec<Trial> = Vec::new();
        let shares = SHARES_OF_ERROR.into_iter().rev();
        for error in shares.clone().flat_map(|bias| shares.clone().map(move |scale| ErrorShares { bias, scale })) {
            let prior = self.settings.prior(error);
            let plain = (are_few || error != ErrorShares::ALL).then_some(&self.plain);
            let (mut last, mut highest): (Option<Point>, _) = (None, f64::NEG_INFINITY);
            for &node_bias_m in sought {
                let problem = Problem { node_bias_m, prior, ..self.problem };
                let mut best: Option<Fitted> = None;
                let firsts = std::iter::once(start).chain(plain).filter(|_| last.is_none());
                for start in last.iter().chain(firsts) {
                    let fitted = fitted(&problem, start.clone(), self.watch)?;
                    best =
                        [best, fitted].into_iter().flatten().max_by(|a, b| a.log_evidence.total_cmp(&b.log_evidence));
                }
                let Some(fitted) = best else { continue };
                last = Some(fitted.point.clone());
                let off = libm::log(node_bias_m / USUAL_NODE_BIAS_M) / WIDTH_OF_NODE_BIAS;
                let weight = fitted.log_evidence - 0.5 * off * off;
                highest = f64::max(highest, weight);
                let is_hopeless = weight < highest - HOPELESS;
                trials.push(Trial { error, prior, node_bias_m, weight, fitted });
                if is_hopeless {
                    break;
                }
            }
            let is_told = |trial: &Trial| trial.fitted.bias_deviation_m() <= NARROWED * prior.deviation[BIAS];
            if error == ErrorShares::ALL && !are_few && likeliest(&trials).is_some_and(is_told) {
                break;
            }
        }
        let most = trials.iter().map(|trial| trial.weight).fold(f64::NEG_INFINITY, f64::max);
        trials.iter_mut().for_each(|trial| trial.weight = libm::exp(trial.weight - most));
        let sum: f64 = trials.iter().map(|trial| trial.weight).sum();
        trials.iter_mut().for_each(|trial| trial.weight /= sum);
        Ok(trials)
    }

    /// Takes what the best of some trials says; its point.
    fn take(&mut self, trials: &[Trial]) -> Option<Point> {
        let best = best(trials)?;
        self.problem.node_bias_m = best.node_bias_m;
        self.problem.prior = best.prior;
        Some(best.fitted.point.clone())
    }

    /// The places that the ranges of each node may mean by the best trial, and the start of a better one.
    fn places(&self, trials: &[Trial]) -> Result<(Vec<Vec<Place>>, Option<Point>), Interrupted> {
        let best = best(trials).expect("there is a trial");
        let (mut all, mut better) = (Vec::with_capacity(self.modes.len()), None);
        for (number, modes) in self.modes.iter().enumerate() {
            let found = places(&self.problem, &best.fitted, number, modes, self.watch)?;
            better = better.or(found.better);
            all.push(found.places);
        }
        Ok((all, better))
    }

    /// The estimates: means over the trials, as wide as these say, and as far as they differ.
    fn solution(&self, trials: &[Trial], places: &[Vec<Place>], samples: usize) -> Solution {
        let best = best(trials).expect("there is a trial");
        let by_direction = ByDirection::of(&self.problem, &best.fitted.point);
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
            bias_is_assumed: deviations[0] > ASSUMED * best.prior.deviation[BIAS],
            scale: point.scale(),
            scale_deviation: deviations[1],
            delay_s: point.delay_s(),
            delay_deviation_s: deviations[2],
            node_bias_m: trials.iter().map(|trial| trial.weight * trial.node_bias_m).sum(),
            errors: law,
            log_density: self.problem.mean_log_density(point),
            worth: self.problem.worth,
            by_direction_m: by_direction.left.sqrt(),
            moved_by_direction_m: by_direction.moved_m(),
            explained: Explained::of(&self.problem, point),
            higher_m: None,
            unexplained: Vec::new(),
            beside: Vec::new(),
            is_beyond_prior: false,
            settled,
            ambiguous: Vec::new(),
            unit: None,
        };
        let is_sure = settled && !fit.is_mostly_wild();
        let estimates = (self.problem.groups.nodes.iter().enumerate())
            .map(|(number, &node)| {
                (node, self.estimate(number, trials, &places[number], by_direction.covariance(number), is_sure))
            })
            .collect();
        let in_two = |(&node, places): (&NodeId, &Vec<Place>)| are_two(places).then(|| (node, places.clone()));
        let ambiguous = self.problem.groups.nodes.iter().zip(places).filter_map(in_two).collect();
        let bias_deviation_m = libm::hypot(fit.node_bias_m, fit.bias_deviation_m);
        Solution { estimates, ambiguous, shared: point.shared, bias_deviation_m, fit }
    }

    fn estimate(
        &self,
        number: usize,
        trials: &[Trial],
        places: &[Place],
        by_direction: Matrix3<f64>,
        is_sure: bool,
    ) -> Estimate {
        // Means are taken over the trials in which the node is at the same of its places.
        let of_trials: Vec<(&Trial, Place)> =
            trials.iter().map(|trial| (trial, Place::of_fit(&trial.fitted, number))).collect();
        let here = |place: &Place| places.iter().all(|other| place.apart_m(&places[0]) <= place.apart_m(other));
        let there = || of_trials.iter().filter(|(_, place)| here(place));
        let best = best(trials).expect("there is a trial");
        let plainest = || there().filter(|(trial, _)| trial.error == best.error);
        let weight: f64 = plainest().map(|(trial, _)| trial.weight).sum();
        let mean: Vector3<f64> = plainest().map(|(trial, place)| place.place * (trial.weight / weight)).sum();
        let weight: f64 = there().map(|(trial, _)| trial.weight).sum();
        let mut covariance = by_direction;
        for (trial, place) in there() {
            let apart = place.place - mean;
            covariance += (place.covariance * trial.widened() + apart * apart.transpose()) * (trial.weight / weight);
        }
        let groups = self.problem.groups.of_node(number);
        let (_, usual_m) = middle(groups);
        let bias_deviation_m = libm::hypot(best.node_bias_m, best.fitted.bias_deviation_m());
        let bounded = within(covariance, longest_m(groups, &best.fitted.point.shared, bias_deviation_m));
        let is_open = bounded != covariance;
        estimate(mean, bounded, &places[1..], self.problem.heights, |covariance| {
            let plane = covariance.fixed_view::<2, 2>(0, 0).into_owned();
            let widest_m = plane.symmetric_eigenvalues().max().max(0.0).sqrt();
            if groups.len() <= self.problem.heights.least() {
                Some(Concern::TooFew)
            } else if !is_sure {
                Some(Concern::Unsettled)
            } else if are_two(places) {
                Some(Concern::TwoPlaces)
            } else {
                (is_open || widest_m > usual_m).then_some(Concern::NoEvidence)
            }
        })
    }
}

impl Settings {
    /// What is known of ranges before a log is seen. Biases of common devices are up to a few metres, scales up to a few percent;
    /// clocks of logs differ by a tenth of a second or two.
    pub(super) fn prior(&self, error: ErrorShares) -> SharedPrior {
        let bias_m = if self.node_bias == NodeBias::None { NONE } else { 3.0 };
        let (mean, deviation) = error_law::prior();
        let of_shared = [
            (bias_m * error.bias).max(NONE),
            (self.scale_error * error.scale).max(NONE),
            self.delay_error_s.max(NONE),
        ];
        SharedPrior {
            mean: Shared::from_iterator([0.0; 3].into_iter().chain(mean)),
            deviation: Shared::from_iterator(of_shared.into_iter().chain(deviation)),
        }
    }
}
