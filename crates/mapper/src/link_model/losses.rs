//! How many packets of a link arrive: what power decides, and what it does not.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use super::links::{HeardLink, PlaceLinks};
use super::tables::TABLES;
use crate::numerics::normal::{below, density};

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
        let odds = self.lapse / (1.0 - self.lapse);
        let shares =
            RULE.map(|(deviations, weight)| (1.0 / (1.0 + odds * libm::exp(self.scatter * deviations)), weight));
        let mean = shares.iter().map(|(share, weight)| weight * share).sum();
        Arrivals { shares, mean, are_scattered: self.scatter > 0.0 && self.lapse > 0.0 }
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
        let arrivals = self.arrivals();
        let (mut sum, mut total) = (0.0, 0.0);
        for point in 0..=POINTS {
            let at = 8.0 * f64::from(point) / f64::from(POINTS) - 4.0;
            let log = arrivals.log_probability(link.received, link.sent, below(mean + deviation * at));
            let weight = density(at);
            total += weight;
            sum += weight * libm::exp(ways + log);
        }
        let alive = (sum / total).min(1.0);
        if link.received == 0 { link.outage + (1.0 - link.outage) * alive } else { (1.0 - link.outage) * alive }
    }
}

/// How packets arrive that are strong enough.
#[derive(Clone, Debug)]
pub(super) struct Arrivals {
    /// Shares of packets that do not lapse, and their weights.
    shares: [(f64, f64); POINTS],
    mean: f64,
    /// Whether the shares differ.
    are_scattered: bool,
}

impl Arrivals {
    /// Logarithm of the probability that these `received` of `sent` packets arrive if the share `reached` of them is strong
    /// enough, without the number of ways to choose them.
    pub(super) fn log_probability(&self, received: u32, sent: u32, reached: f64) -> f64 {
        let (received, lost) = (f64::from(received), f64::from(sent - received));
        let log = |share: f64| {
            let share = (share * reached).clamp(LEAST_SHARE, 1.0 - LEAST_SHARE);
            received * libm::log(share) + lost * libm::log(1.0 - share)
        };
        if !self.are_scattered || received + lost < 1.5 {
            return log(self.mean);
        }
        let logs = self.shares.map(|(share, weight)| (log(share), weight));
        let highest = logs.iter().map(|(log, _)| *log).fold(f64::NEG_INFINITY, f64::max);
        highest + libm::log(logs.iter().map(|(log, weight)| weight * libm::exp(log - highest)).sum())
    }
}

/// A rule for the mean over a standard normal variable: points that are near enough to each other for the sharp likelihood
/// of many packets, and their weights.
static RULE: LazyLock<[(f64, f64); POINTS]> = LazyLock::new(|| {
    let at: [f64; POINTS] = std::array::from_fn(|point| FARTHEST * (2.0 * point as f64 / (POINTS - 1) as f64 - 1.0));
    let total: f64 = at.iter().map(|&deviations| density(deviations)).sum();
    at.map(|deviations| (deviations, density(deviations) / total))
});
/// Number of points of the rule, and the farthest of them in standard deviations.
const POINTS: usize = 29;
const FARTHEST: f64 = 3.8;

/// The likelihoods of numbers of packets at each margin of the tables, under [`Losses`].
#[derive(Clone, Debug)]
pub(super) struct CountTables {
    losses: Losses,
    tables: BTreeMap<(u32, u32), Vec<f64>>,
}

impl CountTables {
    /// Without tables: they are made when they are asked for.
    pub(super) fn new(losses: Losses) -> Self {
        Self { losses, tables: BTreeMap::new() }
    }

    /// The tables of all numbers of packets in `links`.
    pub(super) fn of(links: &PlaceLinks, losses: Losses) -> Self {
        let mut tables = Self::new(losses);
        for link in links.nodes.iter().flat_map(|node| &node.links) {
            let (received, sent) = counts(link);
            // What silence says of outages asks for none of the packets of each link.
            for counts in [(received, sent), (0, sent)] {
                tables.tables.entry(counts).or_insert_with(|| table(losses, counts, 1));
            }
        }
        tables
    }

    /// Logarithms of the likelihood of the packets of `link` at each margin.
    pub(super) fn log_likelihoods(&self, link: &HeardLink) -> std::borrow::Cow<'_, [f64]> {
        let counts = counts(link);
        match self.tables.get(&counts) {
            Some(table) => table.into(),
            None => table(self.losses, counts, 1).into(),
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

/// Logarithms of the likelihood of counts at every `step`th margin.
pub(super) fn table(losses: Losses, (received, sent): (u32, u32), step: usize) -> Vec<f64> {
    let arrivals = losses.arrivals();
    let at = |margin: &f64| arrivals.log_probability(received, sent, below(*margin));
    TABLES.margin.iter().step_by(step).map(at).collect()
}
