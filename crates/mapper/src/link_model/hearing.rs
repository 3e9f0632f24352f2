//! How margins become packets and strengths, estimated from the links that were heard.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::LazyLock;

use rayon::prelude::*;
use sextant_channel::Position;
use sextant_kernel::maths::{exp_each, ln_each};

use super::links::{HeardLink, NodeLinks, PlaceLinks};
use super::losses::{CountTables, Losses, counts};
use super::receiver::{Receiver, StrengthTable};
use super::tables::{MARGINS, STEP, TABLES};
use crate::log_facts::reach::median;
use crate::numerics::normal::densities;

/// How margins become packets and strengths.
#[derive(Clone, Debug)]
pub(super) struct Hearing {
    /// How they become strengths, if the log has usable ones.
    pub(super) receiver: Option<Receiver>,
    /// How they become packets.
    pub(super) counts: CountTables,
    /// What strengths say, by the number of packets received.
    strengths: BTreeMap<u32, StrengthTable>,
}

/// It is estimated from at most so many links.
const ENOUGH_LINKS: usize = 500;
/// Fewer links with a strength than this say nothing of the receiver, fewer that lost packets nothing of lapses.
const LEAST_LINKS: usize = 12;
/// Only every third margin counts: the search needs no more.
const EVERY: usize = 3;
/// Bounds of the fading and of the error of a strength (dB).
const FADINGS_DB: [f64; 2] = [1.0, 10.0];
const ERRORS_DB: [f64; 2] = [0.3, 8.0];
/// Usual values of both, and a factor by which they often differ.
const USUAL_FADING_DB: f64 = 3.5;
const USUAL_ERROR_DB: f64 = 1.2;
const OFTEN: f64 = 2.0;
/// The threshold is about so far from the weakest strengths (dB).
const NEAR_WEAKEST_DB: f64 = 4.0;
/// Bounds of mean and deviation of the margins of links, of which some are heard.
const MEANS: [f64; 2] = [-6.0, 30.0];
const DEVIATIONS: [f64; 2] = [0.7, 10.0];
/// Bounds of lapse and scatter, and the power of 1 − lapse in the prior density: without evidence there is none.
const LAPSES: [f64; 2] = [0.0, 0.9];
const SCATTERS: [f64; 2] = [0.1, 2.5];
const RARELY: f64 = 9.0;
/// Bounds of outages, their usual share, and the number of pairs that it counts for.
const OUTAGES: [f64; 2] = [0.002, 0.6];
const USUAL_OUTAGE: f64 = 0.02;
const USUAL_PAIRS: f64 = 20.0;
/// Usual scatter.
const USUAL_SCATTER: f64 = 0.7;
/// Lapse and scatter at which the search begins.
const STARTS: [[f64; 2]; 4] = [[0.0, 0.7], [0.02, 0.7], [0.1, 0.7], [0.35, 0.7]];

impl Hearing {
    /// What explains shares and strengths of the links best, by the highest likelihood with their margins integrated out.
    /// Strengths are left out if `uses_rssi` says so, if too few links have one, or if all are the same.
    pub(super) fn of(links: &PlaceLinks, uses_rssi: bool) -> Self {
        let heard: Vec<HeardLink> =
            links.nodes.iter().flat_map(|node| &node.links).copied().filter(|link| link.received > 0).collect();
        let has_rssi = |link: &&HeardLink| link.rssi_dbm.is_some_and(f64::is_finite);
        let measured: Vec<HeardLink> = heard.iter().filter(has_rssi).copied().collect();
        let mut strengths: Vec<f64> = measured.iter().filter_map(|link| link.rssi_dbm).collect();
        strengths.sort_by(f64::total_cmp);
        let range_db = strengths.first().zip(strengths.last()).map_or(0.0, |(low, high)| high - low);
        let is_measured = uses_rssi && measured.len() >= LEAST_LINKS && range_db >= 1.0;
        let sample = LinkSample::of(links, is_measured);
        let mut best: Option<(f64, ReceiverTrial)> = None;
        for [lapse, scatter] in STARTS {
            let losses = Losses { lapse, scatter };
            if lapse > 0.0 && !sample.tells_losses {
                break;
            }
            let start = if is_measured {
                sample.with_strengths(losses, &strengths)
            } else {
                ReceiverTrial::without_strengths(losses)
            };
            let found = sample.climb(start, is_measured, 1);
            if best.is_none_or(|(score, _)| found.0 > score) {
                best = Some(found);
            }
        }
        let trial = best.map(|(_, trial)| sample.climb(trial, is_measured, usize::MAX).1);
        let losses = trial.map_or(Losses::NONE, |trial| trial.losses);
        Self::new(links, trial.and_then(|trial| trial.receiver), losses)
    }

    /// The one of this receiver and these losses, with tables for `links`.
    pub(super) fn new(links: &PlaceLinks, receiver: Option<Receiver>, losses: Losses) -> Self {
        let mut strengths = BTreeMap::new();
        if let Some(receiver) = &receiver {
            let measured = links.nodes.iter().flat_map(|node| &node.links).filter(|link| link.rssi_dbm.is_some());
            for link in measured {
                strengths.entry(link.received).or_insert_with(|| receiver.table(link));
            }
        }
        Self { receiver, counts: CountTables::of(links, losses), strengths }
    }

    /// Without tables: they are made when they are asked for.
    #[cfg(test)]
    pub(super) fn without_tables(receiver: Option<Receiver>, losses: Losses) -> Self {
        Self { receiver, counts: CountTables::new(losses), strengths: BTreeMap::new() }
    }

    /// What the strength of `link` says of its margin, if it has one.
    pub(super) fn strength(&self, link: &HeardLink) -> Option<MeasuredStrength<'_>> {
        let (receiver, rssi_dbm) = self.receiver.as_ref().zip(link.rssi_dbm)?;
        let table = match self.strengths.get(&link.received) {
            Some(table) => Cow::Borrowed(table),
            None => Cow::Owned(receiver.table(link)),
        };
        Some(MeasuredStrength { receiver, rssi_dbm, table })
    }
}

/// A strength, and what strengths say.
pub(super) struct MeasuredStrength<'a> {
    receiver: &'a Receiver,
    rssi_dbm: f64,
    table: Cow<'a, StrengthTable>,
}

impl MeasuredStrength<'_> {
    /// The logarithm of its density at each of some margins of the tables is added to `logs`.
    pub(super) fn add_to(&self, logs: &mut [f64], margins: Range<usize>) {
        let table = self.table.precisions[margins.clone()].iter().zip(&self.table.logs[margins.clone()]);
        for ((log, excess), (precision, own)) in logs.iter_mut().zip(&TABLES.excess[margins]).zip(table) {
            let error = self.rssi_dbm - self.receiver.mean_dbm(*excess);
            *log += precision * error * error + own;
        }
    }

    /// The highest logarithm of a density.
    pub(super) fn highest(&self) -> f64 {
        self.table.highest
    }
}

/// The middle of the places that heard a node, weighted by shares and strengths, and the median distance from it of those
/// that heard the node (m).
fn near(node: &NodeLinks, links: &PlaceLinks) -> (Position, f64) {
    let middle = node.middle(&links.places);
    let heard = node.links.iter().filter(|link| link.received > 0);
    let mut distances_m: Vec<f64> = heard.map(|link| links.places[link.place].distance_m(middle)).collect();
    (middle, if distances_m.is_empty() { 0.0 } else { median(&mut distances_m) })
}

/// Receiver and losses on trial, with the normal distribution of the margins of links.
#[derive(Clone, Copy, Debug)]
struct ReceiverTrial {
    receiver: Option<Receiver>,
    losses: Losses,
    mean: f64,
    deviation: f64,
    outage: f64,
    /// Strength of the weakest links (dBm).
    weak_dbm: f64,
}

/// Links between nodes and places that are near to them.
struct LinkSample {
    /// Those that were heard.
    links: Vec<CountedLink>,
    /// Those that were silent.
    silent: Vec<SilentLinks>,
    /// The numbers of packets of all, received and sent.
    counts: Vec<(u32, u32)>,
    /// Whether enough links lost packets, of several each.
    tells_losses: bool,
}

/// A link that was heard, and the number of its packets among those of all links.
struct CountedLink {
    link: HeardLink,
    count: usize,
}

/// How many links were silent whose packets have this number among those of all links.
struct SilentLinks {
    count: usize,
    links: f64,
}

impl LinkSample {
    fn of(links: &PlaceLinks, is_measured: bool) -> Self {
        let is_usable = |link: &HeardLink| !is_measured || link.rssi_dbm.is_some_and(f64::is_finite);
        let mut heard = Vec::new();
        let mut silent: BTreeMap<u32, f64> = BTreeMap::new();
        for node in &links.nodes {
            let (middle, near_m) = near(node, links);
            for link in &node.links {
                if link.received > 0 {
                    heard.extend(Some(*link).filter(is_usable));
                } else if links.places[link.place].distance_m(middle) <= near_m {
                    *silent.entry(counts(link).1).or_default() += 1.0;
                }
            }
        }
        let every = (heard.len() / ENOUGH_LINKS).max(1);
        let links: Vec<HeardLink> = heard.iter().copied().step_by(every).collect();
        // Half of the links that were heard are as near as the silent ones that count.
        silent.values_mut().for_each(|count| *count *= 2.0 / every as f64);
        let tells = links.iter().filter(|link| link.sent > 1 && link.received < link.sent).count();
        let heard = links.iter().map(counts);
        let mut all: Vec<(u32, u32)> = heard.chain(silent.keys().map(|&sent| (0, sent))).collect();
        all.sort_unstable();
        all.dedup();
        let number = |counts: (u32, u32)| all.partition_point(|other| *other < counts);
        let links = links.iter().map(|link| CountedLink { link: *link, count: number(counts(link)) }).collect();
        let silent = silent.iter().map(|(&sent, &links)| SilentLinks { count: number((0, sent)), links }).collect();
        Self { links, silent, counts: all, tells_losses: tells >= LEAST_LINKS }
    }

    /// The best of a grid of receivers.
    fn with_strengths(&self, losses: Losses, sorted_dbm: &[f64]) -> ReceiverTrial {
        let count = sorted_dbm.len().max(1) as f64;
        let mean_dbm = sorted_dbm.iter().sum::<f64>() / count;
        let squares: f64 = sorted_dbm.iter().map(|dbm| (dbm - mean_dbm) * (dbm - mean_dbm)).sum();
        let (weak_dbm, deviation_db) = (sorted_dbm[sorted_dbm.len() / 50], (squares / count).sqrt());
        let tables = self.tables(losses);
        let mut best: Option<(f64, ReceiverTrial)> = None;
        for below_db in [6.0, 3.0, 1.0, -1.0, -4.0] {
            for fading_db in [1.0, 2.0, 3.0, 4.5, 6.5] {
                for error_db in [0.5, 1.0, 2.0] {
                    let receiver = Receiver { threshold_dbm: weak_dbm - below_db, fading_db, error_db };
                    let trial = ReceiverTrial {
                        receiver: Some(receiver),
                        losses,
                        mean: ((mean_dbm - receiver.threshold_dbm) / fading_db).clamp(MEANS[0], MEANS[1]),
                        deviation: (deviation_db / fading_db).clamp(DEVIATIONS[0], DEVIATIONS[1]),
                        outage: USUAL_OUTAGE,
                        weak_dbm,
                    };
                    let score = self.score(&trial, &tables);
                    if best.is_none_or(|(highest, _)| score > highest) {
                        best = Some((score, trial));
                    }
                }
            }
        }
        best.map_or_else(|| ReceiverTrial::without_strengths(losses), |(_, trial)| trial)
    }

    /// Moves one parameter after the other as long as the score grows, at most `passes` lengths of steps.
    fn climb(&self, from: ReceiverTrial, is_measured: bool, passes: usize) -> (f64, ReceiverTrial) {
        let mut tables = self.tables(from.losses);
        let mut best = (self.score(&from, &tables), from);
        for step in [1.0, 0.5, 0.25].into_iter().take(passes) {
            for _ in 0..8 {
                let before = best.0;
                for number in 0..8 {
                    let is_used = match number {
                        0..=2 => is_measured,
                        3 | 4 => true,
                        7 => !self.silent.is_empty(),
                        _ => self.tells_losses,
                    };
                    for sign in if is_used { &[1.0, -1.0][..] } else { &[] } {
                        let trial = best.1.moved(number, sign * step);
                        let changed = (number == 5 || number == 6).then(|| self.tables(trial.losses));
                        let score = self.score(&trial, changed.as_ref().unwrap_or(&tables));
                        if score > best.0 + 1e-6 {
                            best = (score, trial);
                            tables = changed.unwrap_or(tables);
                            break;
                        }
                    }
                }
                if best.0 - before < 0.05 {
                    break;
                }
            }
        }
        best
    }

    /// What each number of packets says at every third margin.
    fn tables(&self, losses: Losses) -> Vec<PacketTable> {
        let arrivals = losses.arrivals();
        let table = |&(received, sent): &(u32, u32)| {
            let mut logs = arrivals.log_likelihoods(received, sent, &THIRDS.reached);
            let highest_margin = logs[THIRDS_COUNT - 1];
            exp_each(&mut logs);
            PacketTable { likelihoods: logs, highest_margin }
        };
        self.counts.par_iter().map(table).collect()
    }

    /// Logarithm of the likelihood of a trial, and of its prior density.
    fn score(&self, trial: &ReceiverTrial, tables: &[PacketTable]) -> f64 {
        let usual = trial.usual();
        let heard = match &trial.receiver {
            Some(receiver) => {
                let log = |counted: &CountedLink| {
                    trial.log_probability(receiver, &counted.link, &tables[counted.count], &usual)
                };
                self.links.par_iter().with_min_len(32).map(log).collect::<Vec<f64>>().iter().sum()
            }
            None => self.log_packets(tables, &usual),
        };
        let alive = libm::log(1.0 - trial.outage) * self.links.len() as f64;
        let silence = |silent: &SilentLinks| {
            let lost = dot(&tables[silent.count].likelihoods, &usual);
            silent.links * libm::log(trial.outage + (1.0 - trial.outage) * lost)
        };
        let silence: f64 = self.silent.iter().map(silence).sum();
        heard + alive + silence + trial.log_prior()
    }

    /// Logarithm of the probability of the packets of all links that were heard, whose margins are the `usual` ones.
    fn log_packets(&self, tables: &[PacketTable], usual: &[f64]) -> f64 {
        let mut logs: Vec<f64> =
            tables.iter().map(|table| dot(&table.likelihoods, usual).max(LEAST_PROBABILITY)).collect();
        ln_each(&mut logs);
        self.links.iter().map(|counted| logs[counted.count]).sum()
    }
}

/// A probability is at least this.
const LEAST_PROBABILITY: f64 = 1e-300;

/// What a number of packets says at every third margin.
struct PacketTable {
    likelihoods: Vec<f64>,
    /// The logarithm of the likelihood at the highest margin.
    highest_margin: f64,
}

/// Number of every third margin.
const THIRDS_COUNT: usize = MARGINS.div_ceil(EVERY);
/// The tables at every third margin.
struct Thirds {
    margin: [f64; THIRDS_COUNT],
    reached: [f64; THIRDS_COUNT],
    excess: [f64; THIRDS_COUNT],
    variance: [f64; THIRDS_COUNT],
}

static THIRDS: LazyLock<Thirds> = LazyLock::new(|| {
    let every = |values: &[f64; MARGINS]| std::array::from_fn(|third| values[EVERY * third]);
    Thirds {
        margin: every(&TABLES.margin),
        reached: every(&TABLES.reached),
        excess: every(&TABLES.excess),
        variance: every(&TABLES.variance),
    }
});

fn dot(first: &[f64], second: &[f64]) -> f64 {
    first.iter().zip(second).map(|(first, second)| first * second).sum()
}

impl ReceiverTrial {
    /// Where the search begins without strengths.
    fn without_strengths(losses: Losses) -> Self {
        Self { receiver: None, losses, mean: 1.0, deviation: 2.0, outage: USUAL_OUTAGE, weak_dbm: 0.0 }
    }

    /// The trial with parameter `number` moved by `step`.
    fn moved(&self, number: usize, step: f64) -> Self {
        let mut next = *self;
        let scaled = |value: f64, [low, high]: [f64; 2]| (value * libm::exp(0.3 * step)).clamp(low, high);
        let odds = |value: f64, [low, high]: [f64; 2]| {
            let share = value.clamp(1e-3, 0.999);
            let share = 1.0 / (1.0 + (1.0 - share) / share * libm::exp(-step));
            (if share < 2e-3 { 0.0 } else { share }).clamp(low, high)
        };
        match (number, &mut next.receiver) {
            (0, Some(receiver)) => {
                receiver.threshold_dbm += 1.5 * step;
                next.mean = (next.mean - 1.5 * step / receiver.fading_db).clamp(MEANS[0], MEANS[1]);
            }
            (1, Some(receiver)) => {
                let fading_db = scaled(receiver.fading_db, FADINGS_DB);
                let ratio = receiver.fading_db / fading_db;
                receiver.fading_db = fading_db;
                next.mean = (next.mean * ratio).clamp(MEANS[0], MEANS[1]);
                next.deviation = (next.deviation * ratio).clamp(DEVIATIONS[0], DEVIATIONS[1]);
            }
            (2, Some(receiver)) => receiver.error_db = scaled(receiver.error_db, ERRORS_DB),
            (3, _) => next.mean = (next.mean + 0.4 * step).clamp(MEANS[0], MEANS[1]),
            (4, _) => next.deviation = scaled(next.deviation, DEVIATIONS),
            (5, _) => next.losses.lapse = odds(next.losses.lapse, LAPSES),
            (6, _) => next.losses.scatter = scaled(next.losses.scatter, SCATTERS),
            (7, _) => next.outage = odds(next.outage, OUTAGES),
            _ => {}
        }
        next
    }

    /// The density of margins at every third margin.
    fn usual(&self) -> [f64; THIRDS_COUNT] {
        let width = EVERY as f64 * STEP / self.deviation;
        densities(THIRDS.margin.map(|margin| (margin - self.mean) / self.deviation)).map(|density| width * density)
    }

    /// Logarithm of the probability of share and strength of a link that has a strength, and whose margin is one of the `usual`
    /// ones.
    fn log_probability(&self, receiver: &Receiver, link: &HeardLink, packets: &PacketTable, usual: &[f64]) -> f64 {
        let Some(rssi_dbm) = link.rssi_dbm else { return 0.0 };
        if let Some(site) = receiver.strong(link, rssi_dbm) {
            let variance = site.variance + self.deviation * self.deviation;
            let error = site.margin - self.mean;
            let log = -0.5 * (error * error / variance + libm::log(variance)) - libm::log(receiver.fading_db);
            return log + packets.highest_margin;
        }
        let near = receiver.margins_near(link, rssi_dbm, &THIRDS.excess);
        let (excess, share) = (&THIRDS.excess[near.clone()], &THIRDS.variance[near.clone()]);
        let mut terms = [0.0; THIRDS_COUNT];
        let mut factors = [0.0; THIRDS_COUNT];
        let (terms, factors) = (&mut terms[..near.len()], &mut factors[..near.len()]);
        let usual = usual[near.clone()].iter().zip(&packets.likelihoods[near]);
        for ((((term, factor), excess), share), (usual, likelihood)) in
            terms.iter_mut().zip(factors.iter_mut()).zip(excess).zip(share).zip(usual)
        {
            let precision = 1.0 / receiver.variance_db2(link, *share);
            let error = rssi_dbm - receiver.mean_dbm(*excess);
            *term = -0.5 * error * error * precision;
            *factor = usual * likelihood * precision.sqrt();
        }
        exp_each(terms);
        libm::log(dot(terms, factors).max(LEAST_PROBABILITY))
    }

    fn log_prior(&self) -> f64 {
        let Losses { lapse, scatter } = self.losses;
        let scatters = libm::log(scatter / USUAL_SCATTER) / libm::log(OFTEN);
        let outage = USUAL_PAIRS
            * (USUAL_OUTAGE * libm::log(self.outage) + (1.0 - USUAL_OUTAGE) * libm::log(1.0 - self.outage));
        let mut log = outage + RARELY * libm::log(1.0 - lapse) - 0.5 * scatters * scatters;
        if let Some(Receiver { threshold_dbm, fading_db, error_db }) = self.receiver {
            let far = |value: f64, usual: f64| libm::log(value / usual) / libm::log(OFTEN);
            let units = [
                far(fading_db, USUAL_FADING_DB),
                far(error_db, USUAL_ERROR_DB),
                (threshold_dbm - self.weak_dbm) / NEAR_WEAKEST_DB,
            ];
            log -= 0.5 * units.iter().map(|unit| unit * unit).sum::<f64>();
        }
        log
    }
}
