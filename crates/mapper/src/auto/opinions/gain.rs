//! What a law of links gains over fields of strengths that know no distance.

use sextant_channel::{Position, ReceptionLog};

use crate::TopologyMap;
use crate::auto::folds::{Fold, Pair};
use crate::auto::score::{SURPRISE, WIDTH_DB};
use crate::comparators::strengths::{Process, strongest_first};
use crate::link_model::{LinkFit, Placed, Predictor};
use crate::log_facts::strengths::Strength;

/// The gain of a law, summed over strengths at stops that were left out.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::auto) struct GainOfLaw {
    nats: f64,
    strengths: f64,
}

/// A field needs so many strengths.
const LEAST_STRENGTHS: usize = 3;
/// Variance of a strength that is rounded and measured once more (dB²).
const ROUNDED_DB2: f64 = 1.0;

impl GainOfLaw {
    /// Takes the strengths of a fold: how much better the law of `fit` explains them, with the nodes where `map` puts them,
    /// than a Gaussian process of the strengths of each node.
    pub(in crate::auto) fn take(&mut self, fold: &Fold<'_>, log: &ReceptionLog, fit: &LinkFit, map: &TopologyMap) {
        let Some(predictor) = Predictor::new(log, fit) else { return };
        for (node, estimate) in map.estimates.iter().enumerate() {
            let Some(estimate) = estimate else { continue };
            let known: Vec<Strength> = fold.others(node).filter_map(|pair| strength(&pair)).collect();
            let known = strongest_first(&known);
            let left_out: Vec<Pair> = fold.pairs(node).filter(|pair| pair.rssi_dbm.is_some()).collect();
            if known.len() < LEAST_STRENGTHS || left_out.is_empty() {
                continue;
            }
            let places: Vec<Position> = left_out.iter().map(|pair| pair.stop.position).collect();
            let placed = Placed { place: estimate.position, covariance: estimate.covariance.unwrap_or_default() };
            let Some(field) = Process::likeliest(&known) else { continue };
            let Some(margins) = predictor.margins(node, &placed, &places) else { continue };
            for (pair, margin) in left_out.iter().zip(&margins) {
                let Some(Strength { place, rssi_dbm }) = strength(pair) else { continue };
                let counts = [pair.received, pair.sent];
                let Some(by_law) = predictor.strength_density(margin, counts, rssi_dbm) else { continue };
                let (mean, variance) = field.predicted(place);
                self.nats += ln_density(by_law) - ln_density(normal(rssi_dbm - mean, variance + ROUNDED_DB2));
                self.strengths += 1.0;
            }
        }
    }

    /// The mean gain (nats a strength); `None` without strengths.
    pub(in crate::auto) fn mean(self) -> Option<f64> {
        (self.strengths > 0.0).then(|| self.nats / self.strengths)
    }
}

fn strength(pair: &Pair) -> Option<Strength> {
    Some(Strength { place: pair.stop.position, rssi_dbm: pair.rssi_dbm? })
}

fn normal(error: f64, variance: f64) -> f64 {
    libm::exp(-0.5 * error * error / variance) / (std::f64::consts::TAU * variance).sqrt()
}

/// A strength that nobody expected costs a bounded amount.
fn ln_density(density: f64) -> f64 {
    libm::log((1.0 - SURPRISE) * density + SURPRISE / WIDTH_DB)
}
