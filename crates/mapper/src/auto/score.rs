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
    /// For each fold and node.
    folds: Vec<Vec<PairSums>>,
}

/// Sums over the pairs of a node.
#[derive(Clone, Copy, Debug, Default)]
struct PairSums {
    pairs: usize,
    strengths: usize,
    /// Of the logarithms of the probabilities of all that was heard.
    log_all: f64,
    /// Of the logarithms of the densities of strengths alone.
    log_strengths: f64,
}

/// Which of what was heard is compared.
type Compared = fn(&PairSums) -> f64;

const ALL: Compared = |sums| sums.log_all;
const STRENGTHS: Compared = |sums| sums.log_strengths;

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
        self.folds.push(vec![PairSums::default(); self.nodes]);
    }

    /// Takes the `probability` of what was heard of `node` when `sent` packets were sent, and the `density` of its strength
    /// (1/dB), if it has one.
    pub(super) fn take(&mut self, node: usize, probability: f64, sent: u32, density: Option<f64>) {
        let probability = (1.0 - SURPRISE) * probability + SURPRISE / (f64::from(sent) + 1.0);
        let sums = &mut self.folds.last_mut().expect("a fold was begun")[node];
        let log_strength = density.map_or(0.0, ln_density);
        sums.log_all += libm::log(probability) + log_strength;
        sums.log_strengths += log_strength;
        sums.pairs += 1;
        sums.strengths += usize::from(density.is_some());
    }

    fn pairs(&self, folds: usize) -> usize {
        self.folds[..folds].iter().flatten().map(|sums| sums.pairs).sum()
    }

    /// The sum of a node over the first folds.
    fn of_node(&self, node: usize, folds: usize, compared: Compared) -> f64 {
        self.folds[..folds].iter().map(|fold| compared(&fold[node])).sum()
    }

    fn mean(&self, folds: usize, compared: Compared) -> f64 {
        let sum: f64 = (0..self.nodes).map(|node| self.of_node(node, folds, compared)).sum();
        sum / self.pairs(folds).max(1) as f64
    }
}

/// The folds that two estimators have in common.
fn common_folds(own: &Predicted, other: &Predicted) -> usize {
    own.folds.len().min(other.folds.len())
}

/// How much more probable one estimator finds what was left out than another one does (nats a pair).
fn gain(own: &Predicted, over: &Predicted, compared: Compared) -> f64 {
    let folds = common_folds(own, over);
    own.mean(folds, compared) - over.mean(folds, compared)
}

/// An estimator that is behind by so many standard errors, and by so many nats a pair, is not tried further.
const HOPELESS_ERRORS: f64 = 6.0;
const HOPELESS_NATS: f64 = 0.2;

/// Whether an estimator is so far behind that of links that other folds would not bring it back.
pub(super) fn is_hopeless(own: &Predicted, links: &Predicted) -> bool {
    -gain(own, links, ALL) > (HOPELESS_ERRORS * error(own, links, ALL)).max(HOPELESS_NATS)
}

/// The logarithm of the `density` of a strength (1/dB). One that nobody expected costs a bounded amount.
pub(super) fn ln_density(density: f64) -> f64 {
    libm::log((1.0 - SURPRISE) * density + SURPRISE / WIDTH_DB)
}

/// The scores of estimators with these names.
pub(super) fn scores(names: impl Iterator<Item = &'static str>, predicted: &[Predicted]) -> Vec<Score> {
    let is_higher = |a: usize, b: usize| gain(&predicted[a], &predicted[b], ALL) > 0.0;
    let highest = (0..predicted.len()).reduce(|best, next| if is_higher(next, best) { next } else { best });
    let highest = highest.unwrap_or(0);
    let score = |(estimator, own): (&'static str, &Predicted)| {
        let error = error(own, &predicted[highest], ALL);
        let folds = own.folds.len();
        Score { estimator, log_probability: own.mean(folds, ALL), error, pairs: own.pairs(folds) }
    };
    names.zip(predicted).map(score).collect()
}

/// Standard error of the difference of two means. Nodes are independent of each other; their pairs are not.
fn error(own: &Predicted, other: &Predicted, compared: Compared) -> f64 {
    let folds = common_folds(own, other);
    let of_node = |predicted: &Predicted, node: usize| predicted.of_node(node, folds, compared);
    let differences = || (0..own.nodes).map(|node| of_node(own, node) - of_node(other, node));
    let mean = differences().sum::<f64>() / own.nodes.max(1) as f64;
    let squares: f64 = differences().map(|difference| (difference - mean) * (difference - mean)).sum();
    squares.sqrt() / own.pairs(folds).max(1) as f64
}

/// Whether one estimator predicts better than another one by more than two standard errors.
pub(super) fn is_surely_better(own: &Predicted, over: &Predicted) -> bool {
    gain(own, over, ALL) > 2.0 * error(own, over, ALL)
}

/// The number of the estimator of independent packets that is as good as that of links (`links`), if one is. Of the
/// `independent`, in the order of trust, a later one must be better than those before it by two standard errors.
///
/// Estimators of independent packets are taken if they predict as well as the link model does, within a standard error: where
/// packets are independent, they place nodes better than it; where they are not, they are refuted.
pub(super) fn as_good(predicted: &[Predicted], links: usize, independent: &[usize]) -> Option<usize> {
    let is_better = |number: usize, over: usize| is_surely_better(&predicted[number], &predicted[over]);
    let trusted = independent.iter().copied().reduce(|best, next| if is_better(next, best) { next } else { best });
    let is_as_good = |own: &Predicted| gain(own, &predicted[links], ALL) >= -error(own, &predicted[links], ALL);
    trusted.filter(|&number| is_as_good(&predicted[number]))
}

/// Whether an estimator that does not use strengths predicts them better than the link model, which does, by more than a standard
/// error. What it says of them comes from its places alone, so they are a witness of these. A curve that knows how far packets go
/// may predict packets well and place nodes wrongly. With the `gain_of_links` over fields without distance (nats a strength), it
/// must gain over these too: where no places explain strengths, they are no witness.
pub(super) fn strengths_confirm(own: &Predicted, links: &Predicted, gain_of_links: Option<f64>) -> bool {
    let over_links = gain(own, links, STRENGTHS);
    let folds = common_folds(own, links);
    let strengths: usize = own.folds[..folds].iter().flatten().map(|sums| sums.strengths).sum();
    let over_fields = over_links * own.pairs(folds) as f64 / strengths.max(1) as f64 + gain_of_links.unwrap_or(0.0);
    over_links > error(own, links, STRENGTHS) && over_fields >= 0.0
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
    fn who_predicts_packets_better_may_explain_strengths_worse() {
        let of = |probability: f64, densities: [f64; 4]| {
            let mut predicted = Predicted::new(4);
            predicted.begin_fold();
            for (node, density) in densities.into_iter().enumerate() {
                predicted.take(node, probability, 1, Some(density));
            }
            predicted
        };
        let links = of(0.5, [0.1, 0.11, 0.12, 0.1]);
        let curve = of(0.9, [0.06, 0.07, 0.07, 0.06]);
        assert_eq!(as_good(&[links.clone(), curve.clone()], 0, &[1]), Some(1), "all that was heard");
        assert!(!strengths_confirm(&curve, &links, None));
        assert!(!strengths_confirm(&of(0.9, [0.1, 0.12, 0.11, 0.1]), &links, None), "they are no better predicted");
        let places = of(0.9, [0.2, 0.21, 0.22, 0.2]);
        assert!(strengths_confirm(&places, &links, None) && strengths_confirm(&places, &links, Some(-0.5)));
        assert!(!strengths_confirm(&places, &links, Some(-0.9)), "fields without distance explain them better");
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
        assert!(links.mean(2, ALL) < far.mean(1, ALL));
        let told = scores(["far", "links"].into_iter(), &[far.clone(), links.clone()]);
        assert_eq!((told[0].pairs, told[1].pairs, told[1].error), (4, 8, 0.0));
        assert_eq!(as_good(&[links, far], 0, &[1]), None);
    }

    #[test]
    fn a_prediction_that_never_comes_true_costs_a_bounded_amount() {
        let sure = predicted(&[0.0]);
        assert!((sure.mean(1, ALL) - libm::log(SURPRISE / 2.0)).abs() < 1e-12);
    }
}
