//! A receiver and losses on trial, in the search for those that explain links best.

use std::sync::LazyLock;

use sextant_kernel::maths::exp_each;

use super::links::HeardLink;
use super::losses::{Arrivals, Losses};
use super::receiver::Receiver;
use super::tables::{MARGINS, STEP, TABLES};
use crate::numerics::normal::densities;

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
pub(super) const MEANS: [f64; 2] = [-6.0, 30.0];
pub(super) const DEVIATIONS: [f64; 2] = [0.7, 10.0];
/// Bounds of lapse and scatter, and the power of 1 − lapse in the prior density: without evidence there is none.
const LAPSES: [f64; 2] = [0.0, 0.9];
const SCATTERS: [f64; 2] = [0.1, 2.5];
const RARELY: f64 = 9.0;
/// Bounds of outages, their usual share, and the number of pairs that it counts for.
const OUTAGES: [f64; 2] = [0.002, 0.6];
pub(super) const USUAL_OUTAGE: f64 = 0.02;
const USUAL_PAIRS: f64 = 20.0;
/// Usual scatter.
const USUAL_SCATTER: f64 = 0.7;

/// Receiver and losses on trial, with the normal distribution of the margins of links.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReceiverTrial {
    pub(super) receiver: Option<Receiver>,
    pub(super) losses: Losses,
    pub(super) mean: f64,
    pub(super) deviation: f64,
    pub(super) outage: f64,
    /// Strength of the weakest links (dBm).
    pub(super) weak_dbm: f64,
}

/// A probability is at least this.
pub(super) const LEAST_PROBABILITY: f64 = 1e-300;

/// What a number of packets says at every third margin.
pub(super) struct PacketTable {
    pub(super) likelihoods: Vec<f64>,
    /// The logarithm of the likelihood at the highest margin.
    highest_margin: f64,
}

impl PacketTable {
    /// The table of these packets, received and sent.
    pub(super) fn of(arrivals: &Arrivals, (received, sent): (u32, u32)) -> Self {
        let mut logs = arrivals.log_likelihoods(received, sent, &THIRDS.reached);
        let highest_margin = logs[THIRDS_COUNT - 1];
        exp_each(&mut logs);
        Self { likelihoods: logs, highest_margin }
    }
}

/// Number of every third margin.
pub(super) const THIRDS_COUNT: usize = MARGINS.div_ceil(EVERY);
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

/// The product of two vectors.
pub(super) fn dot(first: &[f64], second: &[f64]) -> f64 {
    first.iter().zip(second).map(|(first, second)| first * second).sum()
}

impl ReceiverTrial {
    /// Where the search begins without strengths.
    pub(super) fn without_strengths(losses: Losses) -> Self {
        Self { receiver: None, losses, mean: 1.0, deviation: 2.0, outage: USUAL_OUTAGE, weak_dbm: 0.0 }
    }

    /// The trial with parameter `number` moved by `step`.
    pub(super) fn moved(&self, number: usize, step: f64) -> Self {
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
    pub(super) fn usual(&self) -> [f64; THIRDS_COUNT] {
        let width = EVERY as f64 * STEP / self.deviation;
        densities(THIRDS.margin.map(|margin| (margin - self.mean) / self.deviation)).map(|density| width * density)
    }

    /// Logarithm of the probability of share and strength of a link that has a strength, and whose margin is one of the `usual`
    /// ones.
    pub(super) fn log_probability(
        &self,
        receiver: &Receiver,
        link: &HeardLink,
        packets: &PacketTable,
        usual: &[f64],
    ) -> f64 {
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

    pub(super) fn log_prior(&self) -> f64 {
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
