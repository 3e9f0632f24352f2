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

/// What an estimator predicted of each node: the sum of the logarithms of the probabilities, and their number.
#[derive(Clone, Debug)]
pub(super) struct Predicted {
    by_node: Vec<(f64, usize)>,
}

/// Each number of packets has at least this probability, shared by all numbers: an estimator that is sure of what does not
/// happen is wrong, but not infinitely so.
const SURPRISE: f64 = 1e-3;

/// Unexpected strengths are anywhere in this range (dB).
const WIDTH_DB: f64 = 80.0;

impl Predicted {
    pub(super) fn new(nodes: usize) -> Self {
        Self { by_node: vec![(0.0, 0); nodes] }
    }

    /// Takes the `probability` of what was heard of `node` when `sent` packets were sent, and the `density` of its strength
    /// (1/dB), if it has one.
    pub(super) fn take(&mut self, node: usize, probability: f64, sent: u32, density: Option<f64>) {
        let probability = (1.0 - SURPRISE) * probability + SURPRISE / (f64::from(sent) + 1.0);
        self.by_node[node].0 += libm::log(probability) + density.map_or(0.0, ln_density);
        self.by_node[node].1 += 1;
    }

    fn pairs(&self) -> usize {
        self.by_node.iter().map(|&(_, pairs)| pairs).sum()
    }

    fn mean(&self) -> f64 {
        self.by_node.iter().map(|&(log, _)| log).sum::<f64>() / self.pairs().max(1) as f64
    }
}

/// The logarithm of the `density` of a strength (1/dB). One that nobody expected costs a bounded amount.
pub(super) fn ln_density(density: f64) -> f64 {
    libm::log((1.0 - SURPRISE) * density + SURPRISE / WIDTH_DB)
}

/// The scores of estimators with these names.
pub(super) fn scores(names: impl Iterator<Item = &'static str>, predicted: &[Predicted]) -> Vec<Score> {
    let highest =
        (0..predicted.len()).max_by(|&a, &b| predicted[a].mean().total_cmp(&predicted[b].mean()).then(b.cmp(&a)));
    let highest = highest.unwrap_or(0);
    let score = |(estimator, own): (&'static str, &Predicted)| {
        let error = error(own, &predicted[highest]);
        Score { estimator, log_probability: own.mean(), error, pairs: own.pairs() }
    };
    names.zip(predicted).map(score).collect()
}

/// Standard error of the difference of two means. Nodes are independent of each other; their pairs are not.
fn error(own: &Predicted, other: &Predicted) -> f64 {
    let nodes = own.by_node.len().max(1) as f64;
    let differences = || own.by_node.iter().zip(&other.by_node).map(|(a, b)| a.0 - b.0);
    let mean = differences().sum::<f64>() / nodes;
    let squares: f64 = differences().map(|difference| (difference - mean) * (difference - mean)).sum();
    squares.sqrt() / own.pairs().max(1) as f64
}

/// The number of the estimator of independent packets that is as good as that of links (`links`), if one is. Of the
/// `independent`, in the order of trust, a later one must be better than those before it by two standard errors.
///
/// Estimators of independent packets are taken if they predict as well as the link model does, within a standard error: where
/// packets are independent, they place nodes better than it; where they are not, they are refuted.
pub(super) fn as_good(predicted: &[Predicted], links: usize, independent: &[usize]) -> Option<usize> {
    let gain = |number: usize, over: usize| predicted[number].mean() - predicted[over].mean();
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
    fn a_prediction_that_never_comes_true_costs_a_bounded_amount() {
        let sure = predicted(&[0.0]);
        assert!((sure.mean() - libm::log(SURPRISE / 2.0)).abs() < 1e-12);
    }
}
