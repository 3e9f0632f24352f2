//! How margins become packets and strengths, estimated from the links that were heard.

use std::collections::BTreeMap;

use rayon::prelude::*;
use sextant_channel::Position;

use super::links::{HeardLink, NodeLinks, PlaceLinks};
use super::losses::{CountTables, Losses, counts, table};
use super::receiver::Receiver;
use super::tables::{STEP, TABLES};
use crate::log_facts::reach::median;
use crate::numerics::normal::density;

/// How margins become packets and strengths.
#[derive(Clone, Debug)]
pub(super) struct Hearing {
    /// How they become strengths, if the log has usable ones.
    pub(super) receiver: Option<Receiver>,
    /// How they become packets.
    pub(super) counts: CountTables,
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
        Self { receiver: trial.and_then(|trial| trial.receiver), counts: CountTables::of(links, losses) }
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
    links: Vec<HeardLink>,
    /// Those that were silent: how many, by packets sent.
    silent: BTreeMap<u32, f64>,
    counts: Vec<(u32, u32)>,
    /// Whether enough links lost packets, of several each.
    tells_losses: bool,
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
        let mut counts: Vec<(u32, u32)> = links.iter().map(counts).collect();
        let tells = links.iter().filter(|link| link.sent > 1 && link.received < link.sent).count();
        counts.extend(silent.keys().map(|&sent| (0, sent)));
        counts.sort_unstable();
        counts.dedup();
        Self { links, silent, counts, tells_losses: tells >= LEAST_LINKS }
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

    /// Logarithms of the probability of each number of packets at every third margin.
    fn tables(&self, losses: Losses) -> PacketTables {
        self.counts
            .par_iter()
            .map(|&counts| (counts, table(losses, counts, EVERY)))
            .collect::<Vec<_>>()
            .into_iter()
            .collect()
    }

    /// Logarithm of the likelihood of a trial, and of its prior density.
    fn score(&self, trial: &ReceiverTrial, tables: &PacketTables) -> f64 {
        let usual = trial.usual();
        let log = |link: &HeardLink| trial.log_probability(link, &tables[&counts(link)], &usual);
        let logs: Vec<f64> = self.links.par_iter().with_min_len(32).map(log).collect();
        let alive = libm::log(1.0 - trial.outage) * logs.len() as f64;
        let silence = |(sent, count): (&u32, &f64)| {
            let lost: f64 =
                tables[&(0, *sent)].iter().zip(&usual).map(|(none, usual)| usual * libm::exp(*none)).sum();
            count * libm::log(trial.outage + (1.0 - trial.outage) * lost)
        };
        let silence: f64 = self.silent.iter().map(silence).sum();
        logs.iter().sum::<f64>() + alive + silence + trial.log_prior()
    }
}

/// Logarithms of the probability of numbers of packets, received and sent, at every third margin.
type PacketTables = BTreeMap<(u32, u32), Vec<f64>>;

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
    fn usual(&self) -> Vec<f64> {
        let margins = TABLES.margin.iter().step_by(EVERY);
        let width = EVERY as f64 * STEP / self.deviation;
        margins.map(|margin| width * density((margin - self.mean) / self.deviation)).collect()
    }

    /// Logarithm of the probability of share and strength of a link whose margin is one of the `usual` ones.
    fn log_probability(&self, link: &HeardLink, counts: &[f64], usual: &[f64]) -> f64 {
        let measured = self.receiver.as_ref().zip(link.rssi_dbm);
        if let Some((receiver, rssi_dbm)) = measured
            && let Some(site) = receiver.strong(link, rssi_dbm)
        {
            let variance = site.variance + self.deviation * self.deviation;
            let error = site.margin - self.mean;
            let log = -0.5 * (error * error / variance + libm::log(variance)) - libm::log(receiver.fading_db);
            return log + counts.last().copied().unwrap_or(0.0);
        }
        let mut sum = 0.0;
        for (third, (count, usual)) in counts.iter().zip(usual).enumerate() {
            if *count > -60.0 && *usual > 1e-12 {
                let strength = measured.map_or(0.0, |(receiver, _)| receiver.log_density(link, EVERY * third));
                sum += usual * libm::exp(count + strength);
            }
        }
        libm::log(sum.max(1e-300))
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
