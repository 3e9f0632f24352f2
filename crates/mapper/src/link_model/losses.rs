//! How many packets of a link arrive: what power decides, and what it does not.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::LazyLock;

use sextant_kernel::maths::{exp_each, ln, ln_each};

use super::links::{HeardLink, PlaceLinks};
use super::tables::TABLES;
use crate::numerics::normal::{below, densities, density};

/// More packets than this say no more of a margin than so many of the same share.
const MOST_PACKETS: u32 = 48;
/// Probabilities keep this far from 0 and 1.
const LEAST_SHARE: f64 = 1e-9;

/// Losses that power does not cause.
///
/// Of the packets of a link with the margin m, the share `(1 − λ) Φ(m)` arrives: a receiver that scans in windows, or that
/// misses a scan, loses packets of near nodes too. λ differs from link to link: its logit is normally distributed round that of
/// `lapse`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Losses {
    /// Share of the packets of a usual link that are lost at any strength, 0 to 1.
    pub lapse: f64,
    /// Standard deviation of the logit of that share over the links.
    pub scatter: f64,
}

impl Losses {
    /// Every loss is one of power.
    pub(super) const NONE: Self = Self { lapse: 0.0, scatter: 0.0 };

    /// How packets arrive under these losses.
    pub(super) fn arrivals(&self) -> Arrivals {
        let RuleOfMean { deviations, weights } = &*RULE;
        let odds = self.lapse / (1.0 - self.lapse);
        let mut shares = deviations.map(|deviations| self.scatter * deviations);
        exp_each(&mut shares);
        shares = shares.map(|factor| 1.0 / (1.0 + odds * factor));
        let mean = shares.iter().zip(weights).map(|(share, weight)| weight * share).sum();
        let are_scattered = self.scatter > 0.0 && self.lapse > 0.0;
        Arrivals { shares, mean, are_scattered }
    }

    /// The share of all packets that do not lapse.
    pub(super) fn kept(&self) -> f64 {
        self.arrivals().mean
    }

    /// The probability of the packets of a link if its margin is normally distributed, unless it is dead.
    pub(super) fn probability(&self, link: &HeardLink, mean: f64, deviation: f64) -> f64 {
        const POINTS: u32 = 48;
        let (received, sent) = (f64::from(link.received), f64::from(link.sent));
        let ways = libm::lgamma(sent + 1.0) - libm::lgamma(received + 1.0) - libm::lgamma(sent - received + 1.0);
        let at: [f64; POINTS as usize + 1] =
            std::array::from_fn(|point| 8.0 * point as f64 / f64::from(POINTS) - 4.0);
        let reached = at.map(|at| below(mean + deviation * at));
        let mut likelihoods = self.arrivals().log_likelihoods(link.received, link.sent, &reached);
        likelihoods.iter_mut().for_each(|log| *log += ways);
        exp_each(&mut likelihoods);
        let weights = densities(at);
        let total: f64 = weights.iter().sum();
        let sum: f64 = likelihoods.iter().zip(&weights).map(|(likelihood, weight)| weight * likelihood).sum();
        let alive = (sum / total).min(1.0);
        if link.received == 0 { link.outage + (1.0 - link.outage) * alive } else { (1.0 - link.outage) * alive }
    }
}

/// How packets arrive that are strong enough.
#[derive(Clone, Debug)]
pub(super) struct Arrivals {
    /// Shares of packets that do not lapse, at the points of the rule.
    shares: [f64; POINTS],
    mean: f64,
    /// Whether the shares differ.
    are_scattered: bool,
}

impl Arrivals {
    /// Logarithms of the probability that these `received` of `sent` packets arrive if each of the shares `reached` of them is
    /// strong enough, without the number of ways to choose them.
    pub(super) fn log_likelihoods(&self, received: u32, sent: u32, reached: &[f64]) -> Vec<f64> {
        let lost = sent - received;
        let within = |share: f64| share.clamp(LEAST_SHARE, 1.0 - LEAST_SHARE);
        if !self.are_scattered || sent < 2 {
            let shares: Vec<f64> = reached.iter().map(|reached| within(self.mean * reached)).collect();
            let mut arrived = shares.clone();
            let mut missed: Vec<f64> = shares.iter().map(|share| 1.0 - share).collect();
            ln_each(&mut arrived);
            ln_each(&mut missed);
            let (received, lost) = (f64::from(received), f64::from(lost));
            return arrived.iter().zip(&missed).map(|(arrived, missed)| received * arrived + lost * missed).collect();
        }
        let each = |reached: &f64| {
            let shares = self.shares.map(|share| within(share * reached));
            if sent <= MOST_FACTORS { product(&shares, received, lost) } else { sum_of_logs(&shares, received, lost) }
        };
        let mut logs: Vec<f64> = reached.iter().map(each).collect();
        if sent <= MOST_FACTORS {
            ln_each(&mut logs);
        }
        logs
    }
}

/// Up to so many packets the product of their probabilities is a number.
const MOST_FACTORS: u32 = 512;
/// A product is at least this.
const LEAST_PRODUCT: f64 = 1e-290;

/// The mean over the rule of the probability that packets arrive, each with the share at a point.
fn product(shares: &[f64; POINTS], received: u32, lost: u32) -> f64 {
    let arrived = raised(*shares, received);
    let missed = raised(shares.map(|share| 1.0 - share), lost);
    let mut products = RULE.weights;
    for ((product, arrived), missed) in products.iter_mut().zip(&arrived).zip(&missed) {
        *product *= arrived * missed;
    }
    products.iter().sum::<f64>().max(LEAST_PRODUCT)
}

/// Each of `values` to the power `times`.
fn raised(mut values: [f64; POINTS], mut times: u32) -> [f64; POINTS] {
    let mut raised = [1.0; POINTS];
    while times > 0 {
        if times % 2 == 1 {
            raised.iter_mut().zip(&values).for_each(|(raised, value)| *raised *= value);
        }
        values.iter_mut().for_each(|value| *value *= *value);
        times /= 2;
    }
    raised
}

/// The logarithm of the same mean where the product of all packets is too small for a number.
fn sum_of_logs(shares: &[f64; POINTS], received: u32, lost: u32) -> f64 {
    let (received, lost) = (f64::from(received), f64::from(lost));
    let mut terms = shares.map(|share| received * ln(share) + lost * ln(1.0 - share));
    let highest = terms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    terms.iter_mut().for_each(|term| *term -= highest);
    exp_each(&mut terms);
    highest + ln(terms.iter().zip(&RULE.weights).map(|(term, weight)| weight * term).sum())
}

/// A rule for the mean over a standard normal variable.
struct RuleOfMean {
    /// Points that are near enough to each other for the sharp likelihood of many packets.
    deviations: [f64; POINTS],
    weights: [f64; POINTS],
}

static RULE: LazyLock<RuleOfMean> = LazyLock::new(|| {
    let deviations: [f64; POINTS] =
        std::array::from_fn(|point| FARTHEST * (2.0 * point as f64 / (POINTS - 1) as f64 - 1.0));
    let total: f64 = deviations.iter().map(|&deviations| density(deviations)).sum();
    RuleOfMean { deviations, weights: deviations.map(|deviations| density(deviations) / total) }
});
/// Number of points of the rule, and the farthest of them in standard deviations.
const POINTS: usize = 29;
const FARTHEST: f64 = 3.8;

/// What a number of packets says of a margin.
#[derive(Clone, Debug)]
pub(super) struct CountTable {
    /// Logarithms of its likelihood at each margin of the tables.
    pub(super) logs: Vec<f64>,
    /// The likelihoods.
    pub(super) likelihoods: Vec<f64>,
    /// The highest of the logarithms.
    pub(super) highest: f64,
}

impl CountTable {
    fn new(arrivals: &Arrivals, (received, sent): (u32, u32)) -> Self {
        let logs = arrivals.log_likelihoods(received, sent, &TABLES.reached);
        let mut likelihoods = logs.clone();
        exp_each(&mut likelihoods);
        let highest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Self { logs, likelihoods, highest }
    }
}

/// The tables of numbers of packets under [`Losses`].
#[derive(Clone, Debug)]
pub(super) struct CountTables {
    losses: Losses,
    tables: BTreeMap<(u32, u32), CountTable>,
}

impl CountTables {
    /// Without tables: they are made when they are asked for.
    #[cfg(test)]
    pub(super) fn new(losses: Losses) -> Self {
        Self { losses, tables: BTreeMap::new() }
    }

    /// The tables of all numbers of packets in `links`.
    pub(super) fn of(links: &PlaceLinks, losses: Losses) -> Self {
        let arrivals = losses.arrivals();
        let mut tables = BTreeMap::new();
        for link in links.nodes.iter().flat_map(|node| &node.links) {
            let (received, sent) = counts(link);
            // What silence says of outages asks for none of the packets of each link.
            for counts in [(received, sent), (0, sent)] {
                tables.entry(counts).or_insert_with(|| CountTable::new(&arrivals, counts));
            }
        }
        Self { losses, tables }
    }

    /// What the packets of `link` say.
    pub(super) fn table(&self, link: &HeardLink) -> Cow<'_, CountTable> {
        self.table_of(counts(link))
    }

    /// What it says of `link` if nothing is heard.
    pub(super) fn silence(&self, link: &HeardLink) -> Cow<'_, CountTable> {
        self.table_of((0, counts(link).1))
    }

    fn table_of(&self, counts: (u32, u32)) -> Cow<'_, CountTable> {
        match self.tables.get(&counts) {
            Some(table) => Cow::Borrowed(table),
            None => Cow::Owned(CountTable::new(&self.losses.arrivals(), counts)),
        }
    }

    /// The losses.
    pub(super) fn losses(&self) -> Losses {
        self.losses
    }
}

/// The packets of `link`, of which there are at most [`MOST_PACKETS`]; a link that was heard stays heard, one that lost
/// packets stays one that did.
pub(super) fn counts(link: &HeardLink) -> (u32, u32) {
    let HeardLink { received, sent, .. } = *link;
    if sent <= MOST_PACKETS {
        return (received, sent);
    }
    let scaled = u64::from(received) * u64::from(MOST_PACKETS) / u64::from(sent);
    let least = u64::from(received.min(1));
    let most = u64::from(if received < sent { MOST_PACKETS - 1 } else { MOST_PACKETS });
    (u32::try_from(scaled.clamp(least, most)).unwrap_or(MOST_PACKETS), MOST_PACKETS)
}
