//! The channel, estimated from the log itself.

use rayon::prelude::*;
use sextant_channel::Position;
use sextant_kernel::{Interrupted, Watch, Work};

use super::distance_bins::{BINS, DISTANCE_BINS, DistanceBins};
use super::evidence::{HeardByStops, LEAST_M, StrengthEvidence, below};
use super::fitted_channel::FittedChannel;
use super::silent_field::SilentField;
use super::zoom::{PosteriorDetail, WeighedPlaces};
use crate::log_facts::SoughtHeights;
use crate::log_facts::search_box::SearchBox;
use crate::numerics::normal::density;
use crate::numerics::whole;
use crate::ranging::RangingConfig;

/// The stops of a log, and the grids on which its nodes are searched for.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurveyGrid<'a> {
    pub(super) stops: &'a [Position],
    pub(super) heights: SoughtHeights,
    /// The finest step (m).
    pub(super) step_m: f64,
    /// No place of a node is farther from a stop (m).
    pub(super) longest_m: f64,
}

impl<'a> SurveyGrid<'a> {
    /// The silence of all stops under a channel.
    pub(super) fn silence(&self, evidence: &'a StrengthEvidence) -> SilentField<'a> {
        SilentField::new(evidence, self.stops, self.step_m, self.heights)
    }
}

/// The values that are given; the others are estimated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Given {
    pub(super) ranging: RangingConfig,
    pub(super) sensitivity_dbm: Option<f64>,
}

/// Exponents of real places, from corridors that guide waves to thick walls.
const EXPONENTS: [f64; 2] = [1.2, 6.0];
/// The exponent if the log has all its strengths over one distance.
const USUAL_EXPONENT: f64 = 2.5;
/// Bounds of the standard deviation (dB).
const SIGMAS_DB: [f64; 2] = [1.0, 20.0];
/// Bounds of the loss.
const LOSSES: [f64; 2] = [0.005, 0.5];
/// Share of the strengths that may be below the sensitivity: outliers, and those of receivers that are better than others.
const FAINTEST: f64 = 0.01;
/// Number of nodes from which the channel is estimated.
const ENOUGH_NODES: usize = 64;
/// Maximum number of rounds of places and channel.
const MOST_ROUNDS: u32 = 40;
/// The channel has settled if a round changes the exponent by less, and the power and the deviation (dB).
const TOLERANCES: [f64; 3] = [0.003, 0.05, 0.02];
/// Rounds of the regression with censored strengths for one round of places.
const INNER_ROUNDS: usize = 100;

/// Sums for the regression of strengths on the logarithm of distance.
#[derive(Clone, Debug)]
struct RegressionSums {
    /// Weights, x, x², y, xy, y², with x the common logarithm of the distance over the reference, and y the strength.
    heard: [f64; 6],
    /// Weight of silent links by x.
    silent: Vec<f64>,
    /// Weight of links that were heard.
    links: f64,
}

impl RegressionSums {
    fn new() -> Self {
        Self { heard: [0.0; 6], silent: vec![0.0; BINS], links: 0.0 }
    }

    /// Adds a node whose place has these probabilities, of a log with these stops.
    fn take(&mut self, links: &HeardByStops, stops: &[Position], places: &[(Position, f64)], reference_m: f64) {
        let bins = &*DISTANCE_BINS;
        for &(place, weight) in places {
            for &stop in stops {
                self.silent[bins.of(place, stop)] += weight;
            }
            for (stop, share) in links.not_silent() {
                self.silent[bins.of(place, stop)] -= weight * share;
            }
            for &(stop, y, share) in &links.heard {
                let x = libm::log10(place.distance_m(stop).max(LEAST_M) / reference_m);
                for (sum, term) in self.heard.iter_mut().zip([1.0, x, x * x, y, x * y, y * y]) {
                    *sum += weight * share * term;
                }
            }
            let heard = links.heard.iter().map(|&(_, _, share)| share);
            self.links += weight * heard.chain(links.unmeasured.iter().map(|&(_, share)| share)).sum::<f64>();
        }
    }

    fn add(mut self, other: &Self) -> Self {
        self.heard.iter_mut().zip(other.heard).for_each(|(sum, term)| *sum += term);
        self.silent.iter_mut().zip(&other.silent).for_each(|(sum, term)| *sum += term);
        self.links += other.links;
        self
    }
}

impl FittedChannel {
    /// The channel of a log with these stops, from the nodes with these links and boxes. `None` if no strength was measured.
    pub(super) fn fit(
        survey: &SurveyGrid<'_>,
        nodes: &[(HeardByStops, SearchBox)],
        given: &Given,
        watch: &dyn Watch,
    ) -> Result<Option<Self>, Interrupted> {
        let stride = nodes.len().div_ceil(ENOUGH_NODES).max(1);
        let sample: Vec<&(HeardByStops, SearchBox)> =
            nodes.iter().filter(|(links, _)| !links.heard.is_empty()).step_by(stride).collect();
        let Some(mut channel) = Self::first(survey.stops, &sample, given) else { return Ok(None) };
        let operations = sample.len() as f64 * survey.stops.len() as f64 * 2e3 * f64::from(MOST_ROUNDS);
        watch.begin(Work { name: "fitted channel", unit: "round", steps: MOST_ROUNDS.into(), operations });
        while channel.rounds < MOST_ROUNDS && !channel.converged {
            let evidence = StrengthEvidence::new(channel, survey.longest_m);
            let field = survey.silence(&evidence);
            let tallies: Result<Vec<RegressionSums>, Interrupted> = sample
                .par_iter()
                .map(|(links, within)| {
                    watch.check()?;
                    let posterior = WeighedPlaces::of(links, &field, within, PosteriorDetail::Coarse);
                    let mut sums = RegressionSums::new();
                    sums.take(links, survey.stops, &posterior.places, channel.reference_distance_m);
                    Ok(sums)
                })
                .collect();
            watch.check()?;
            let sums = tallies?.iter().fold(RegressionSums::new(), RegressionSums::add);
            let next = channel.updated(&sums, given);
            let changes = [
                next.exponent - channel.exponent,
                next.tx_power_dbm - channel.tx_power_dbm,
                next.sigma_db - channel.sigma_db,
            ];
            let converged = changes.iter().zip(TOLERANCES).all(|(change, tolerance)| change.abs() < tolerance);
            channel = Self { rounds: channel.rounds + 1, converged, ..next };
            watch.advance(1);
        }
        Ok(Some(channel))
    }

    /// A first channel, with each node at the middle of the stops that heard it, weighted by amplitude.
    fn first(stops: &[Position], sample: &[&(HeardByStops, SearchBox)], given: &Given) -> Option<Self> {
        let mut strengths: Vec<f64> =
            sample.iter().flat_map(|(links, _)| links.heard.iter().map(|&(_, rssi_dbm, _)| rssi_dbm)).collect();
        strengths.sort_unstable_by(f64::total_cmp);
        let faintest = strengths.get(whole(FAINTEST * strengths.len() as f64))?;
        let sensitivity_dbm = given.sensitivity_dbm.unwrap_or(*faintest);
        let reference_distance_m = given.ranging.reference_distance_m.unwrap_or(1.0);
        let mut sums = RegressionSums::new();
        for (links, within) in sample {
            let weight = |rssi_dbm: f64| libm::pow(10.0, (rssi_dbm - sensitivity_dbm) / 20.0);
            let total: f64 = links.heard.iter().map(|&(_, rssi_dbm, _)| weight(rssi_dbm)).sum();
            let sum = |sum: Position, &(place, rssi_dbm, _): &(Position, f64, f64)| {
                sum + place * (weight(rssi_dbm) / total)
            };
            let middle = within.nearest(links.heard.iter().fold(Position::ORIGIN, sum));
            sums.take(links, stops, &[(middle, 1.0)], reference_distance_m);
        }
        let guess = Self {
            exponent: given.ranging.exponent.unwrap_or(USUAL_EXPONENT),
            tx_power_dbm: given.ranging.tx_power_dbm.unwrap_or(sensitivity_dbm + 30.0),
            reference_distance_m,
            sigma_db: given.ranging.sigma_db.unwrap_or(6.0),
            sensitivity_dbm,
            loss: 0.05,
            rounds: 0,
            converged: false,
        };
        Some(guess.updated(&sums, given))
    }

    /// The likeliest channel for these sums, in which strengths of silent links are below the sensitivity: regression with
    /// censored values by expectation maximisation (Tobin 1958; Dempster, Laird and Rubin 1977).
    fn updated(&self, sums: &RegressionSums, given: &Given) -> Self {
        let mut channel = *self;
        for _ in 0..INNER_ROUNDS {
            let [mut weight, mut x1, mut x2, mut y1, mut xy, mut y2] = sums.heard;
            let mut lost = 0.0;
            for (bin, &silent) in sums.silent.iter().enumerate().filter(|(_, silent)| **silent > 0.0) {
                let distance_m = DistanceBins::middle_m(bin);
                let x = libm::log10(distance_m / channel.reference_distance_m);
                let mean_dbm = channel.tx_power_dbm - 10.0 * channel.exponent * x;
                let sigma_db = channel.sigma_db;
                let z = (channel.sensitivity_dbm - mean_dbm) / sigma_db;
                let faint = below(z);
                // Silent because too faint, or for another reason.
                let is_faint = faint / (faint + channel.loss * (1.0 - faint));
                let ratio = density(z) / faint.max(1e-300);
                let expected = mean_dbm - sigma_db * ratio;
                let variance = sigma_db * sigma_db * (1.0 - z * ratio - ratio * ratio).max(0.0);
                let w = silent * is_faint;
                weight += w;
                x1 += w * x;
                x2 += w * x * x;
                y1 += w * expected;
                xy += w * x * expected;
                y2 += w * (expected * expected + variance);
                lost += silent - w;
            }
            let slope = match (given.ranging.exponent, given.ranging.tx_power_dbm) {
                (Some(exponent), _) => -10.0 * exponent,
                (None, Some(power_dbm)) => (xy - power_dbm * x1) / x2,
                (None, None) => (xy - x1 * y1 / weight) / (x2 - x1 * x1 / weight),
            };
            let exponent = if slope.is_finite() { -0.1 * slope } else { USUAL_EXPONENT };
            channel.exponent = given.ranging.exponent.unwrap_or(exponent.clamp(EXPONENTS[0], EXPONENTS[1]));
            let slope = -10.0 * channel.exponent;
            let power_dbm = given.ranging.tx_power_dbm.unwrap_or((y1 - slope * x1) / weight);
            channel.tx_power_dbm = power_dbm;
            let squares = y2 - 2.0 * (power_dbm * y1 + slope * xy)
                + power_dbm * power_dbm * weight
                + 2.0 * power_dbm * slope * x1
                + slope * slope * x2;
            let sigma_db = (squares / weight).max(0.0).sqrt().clamp(SIGMAS_DB[0], SIGMAS_DB[1]);
            channel.sigma_db = given.ranging.sigma_db.unwrap_or(sigma_db);
            channel.loss = (lost / (lost + sums.links)).clamp(LOSSES[0], LOSSES[1]);
        }
        channel
    }
}
