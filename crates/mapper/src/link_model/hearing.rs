//! How margins become packets and strengths, estimated from the links that were heard.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Range;

use rayon::prelude::*;
use sextant_channel::Position;
use sextant_kernel::maths::ln_each;

use super::links::{HeardLink, NodeLinks, PlaceLinks};
use super::losses::{CountTables, Losses, counts};
use super::receiver::{Receiver, StrengthTable};
use super::receiver_trial::{DEVIATIONS, LEAST_PROBABILITY, MEANS, PacketTable, ReceiverTrial, USUAL_OUTAGE, dot};
use super::tables::TABLES;
use crate::log_facts::reach::median;

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
        self.counts.par_iter().map(|&counts| PacketTable::of(&arrivals, counts)).collect()
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
