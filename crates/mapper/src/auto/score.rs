//! How well estimators predict what was heard at stops that they did not use.

/// The score of an estimator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Score {
    /// Name of the estimator.
    pub estimator: &'static str,
    /// Mean logarithm of the probability that it gave to what was heard of a node at a stop that was left out (nats): of the
    /// number of packets, times the density of their strength (1/dB) if they have one.
    pub log_probability: f64,
    /// Standard error of its difference to the highest score; 0 for the highest.
    pub error: f64,
    /// Number of pairs of node and stop.
    pub pairs: usize,
}

/// What an estimator predicted of the nodes, fold by fold.
#[derive(Clone, Debug)]
pub(super) struct Predicted {
    nodes: usize,
    /// For each fold and node the sum of the logarithms of the probabilities, and their number.
    folds: Vec<Vec<(f64, usize)>>,
}

/// Each number of packets has at least this probability, shared by all numbers: an estimator that is sure of what does not
/// happen is wrong, but not infinitely so.
const SURPRISE: f64 = 1e-3;

/// Unexpected strengths are anywhere in this range (dB).
const WIDTH_DB: f64 = 80.0;

impl Predicted {
    pub(super) fn new(nodes: usize) -> Self {
        Self { nodes, folds: Vec::new() }
    }

    /// What follows is of another fold.
    pub(super) fn begin_fold(&mut self) {
        self.folds.push(vec![(0.0, 0); self.nodes]);
    }

    /// Takes the `probability` of what was heard of `node` when `sent` packets were sent, and the `density` of its strength
    /// (1/dB), if it has one.
    pub(super) fn take(&mut self, node: usize, probability: f64, sent: u32, density: Option<f64>) {
        let probability = (1.0 - SURPRISE) * probability + SURPRISE / (f64::from(sent) + 1.0);
        let (sum, pairs) = &mut self.folds.last_mut().expect("a fold was begun")[node];
        *sum += libm::log(probability) + density.map_or(0.0, ln_density);
        *pairs += 1;
    }

    fn pairs(&self, folds: usize) -> usize {
        self.folds[..folds].iter().flatten().map(|&(_, pairs)| pairs).sum()
    }

    /// The sum of a node over the first folds.
    fn of_node(&self, node: usize, folds: usize) -> f64 {
        self.folds[..folds].iter().map(|fold| fold[node].0).sum()
    }

    fn mean(&self, folds: usize) -> f64 {
        (0..self.nodes).map(|node| self.of_node(node, folds)).sum::<f64>() / self.pairs(folds).max(1) as f64
    }
}

/// The folds that two estimators have in common.
fn common_folds(own: &Predicted, other: &Predicted) -> usize {
    own.folds.len().min(other.folds.len())
}

/// How much more probable one estimator finds what was left out than another one does (nats a pair).
fn gain(own: &Predicted, over: &Predicted) -> f64 {
    let folds = common_folds(own, over);
    own.mean(folds) - over.mean(folds)
}

/// An estimator that is behind by so many standard errors, and by so many nats a pair, is not tried further.
const HOPELESS_ERRORS: f64 = 6.0;
const HOPELESS_NATS: f64 = 0.2;

/// Whether an estimator is so far behind that of links that other folds would not bring it back.
pub(super) fn is_hopeless(own: &Predicted, links: &Predicted) -> bool {
    -gain(own, links) > (HOPELESS_ERRORS * error(own, links)).max(HOPELESS_NATS)
}

/// The logarithm of the `density` of a strength (1/dB). One that nobody expected costs a bounded amount.
pub(super) fn ln_density(density: f64) -> f64 {
    libm::log((1.0 - SURPRISE) * density + SURPRISE / WIDTH_DB)
}

/// The scores of estimators with these names.
pub(super) fn scores(names: impl Iterator<Item = &'static str>, predicted: &[Predicted]) -> Vec<Score> {
    let is_higher = |a: usize, b: usize| gain(&predicted[a], &predicted[b]) > 0.0;
    let highest = (0..predicted.len()).reduce(|best, next| if is_higher(next, best) { next } else { best });
    let highest = highest.unwrap_or(0);
    let score = |(estimator, own): (&'static str, &Predicted)| {
        let error = error(own, &predicted[highest]);
        let folds = own.folds.len();
        Score { estimator, log_probability: own.mean(folds), error, pairs: own.pairs(folds) }
    };
    names.zip(predicted).map(score).collect()
}

/// Standard error of the difference of two means. Nodes are independent of each other; their pairs are not.
fn error(own: &Predicted, other: &Predicted) -> f64 {
    let folds = common_folds(own, other);
    let differences = || (0..own.nodes).map(|node| own.of_node(node, folds) - other.of_node(node, folds));
    let mean = differences().sum::<f64>() / own.nodes.max(1) as f64;
    let squares: f64 = differences().map(|difference| (difference - mean) * (difference - mean)).sum();
    squares.sqrt() / own.pairs(folds).max(1) as f64
}

/// The number of the estimator of independent packets that is as good as that of links (`links`), if one is. Of the
/// `independent`, in the order of trust, a later one must be better than those before it by two standard errors.
///
/// Estimators of independent packets are taken if they predict as well as the link model does, within a standard error: where
/// packets are independent, they place nodes better than it; where they are not, they are refuted.
pub(super) fn as_good(predicted: &[Predicted], links: usize, independent: &[usize]) -> Option<usize> {
    let gain = |number: usize, over: usize| gain(&predicted[number], &predicted[over]);
    let is_surely_better =
        |number: usize, over: usize| gain(number, over) > 2.0 * error(&predicted[number], &predicted[over]);
    let trusted =
        independent.iter().copied().reduce(|best, next| if is_surely_better(next, best) { next } else { best });
    trusted.filter(|&number| gain(number, links) >= -error(&predicted[number], &predicted[links]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn predicted(probabilities: &[f64]) -> Predicted {
        let mut predicted = Predicted::new(probabilities.len());
        predicted.begin_fold();
        for (node, &probability) in probabilities.iter().enumerate() {
            predicted.take(node, probability, 1, None);
        }
        predicted
    }

    #[test]
    fn independent_packets_are_believed_where_they_predict_as_well_as_the_link_model() {
        let grid = predicted(&[0.5, 0.5, 0.5, 0.5]);
        let surely = predicted(&[0.6, 0.61, 0.6, 0.61]);
        let hardly = predicted(&[0.9, 0.2, 0.9, 0.5]);
        assert_eq!(as_good(&[surely.clone(), grid.clone()], 0, &[1]), None);
        assert_eq!(as_good(&[grid.clone(), grid.clone()], 0, &[1]), Some(1));
        assert_eq!(as_good(&[grid.clone(), surely.clone(), hardly], 0, &[1, 2]), Some(1), "the order of trust");
        assert_eq!(as_good(&[grid.clone(), grid.clone(), surely.clone()], 0, &[1, 2]), Some(2));
        let scores = scores(["a", "b"].into_iter(), &[grid, surely]);
        assert!(scores[1].log_probability > scores[0].log_probability && scores[1].error == 0.0);
        assert_eq!((scores[0].pairs, scores[0].estimator), (4, "a"));
        assert!(scores[0].error > 0.0);
    }

    #[test]
    fn an_estimator_that_is_far_behind_is_hopeless_and_is_compared_over_the_folds_that_it_has() {
        let links = predicted(&[0.5, 0.51, 0.5, 0.52]);
        let near = predicted(&[0.45, 0.47, 0.46, 0.45]);
        let unsure = predicted(&[0.9, 0.01, 0.4, 0.02]);
        let far = predicted(&[0.1, 0.11, 0.12, 0.1]);
        assert!(is_hopeless(&far, &links));
        assert!(!is_hopeless(&near, &links) && !is_hopeless(&unsure, &links) && !is_hopeless(&links, &far));
        // A second fold, in which everything is improbable, does not bring the one back that was given up.
        let mut links = links;
        links.begin_fold();
        (0..4).for_each(|node| links.take(node, 0.01, 1, None));
        assert!(links.mean(2) < far.mean(1));
        let told = scores(["far", "links"].into_iter(), &[far.clone(), links.clone()]);
        assert_eq!((told[0].pairs, told[1].pairs, told[1].error), (4, 8, 0.0));
        assert_eq!(as_good(&[links, far], 0, &[1]), None);
    }

    #[test]
    fn a_prediction_that_never_comes_true_costs_a_bounded_amount() {
        let sure = predicted(&[0.0]);
        assert!((sure.mean(1) - libm::log(SURPRISE / 2.0)).abs() < 1e-12);
    }
}
