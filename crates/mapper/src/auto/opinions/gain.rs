//! What a law of links gains over fields of strengths that know no distance.

use crate::auto::folds::{Fold, NodeAndStop};
use crate::auto::score::ln_density;
use crate::comparators::strengths::{Process, strongest_first};
use crate::log_facts::strengths::Strength;
use crate::numerics::normal;

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
    /// Takes the densities (1/dB) that a law gave to strengths of `node` at the stops of a fold: how much higher they are than
    /// those by a Gaussian process of its other strengths.
    pub(in crate::auto) fn take(&mut self, fold: &Fold<'_>, node: usize, by_law: &[(NodeAndStop, f64)]) {
        let strength = |pair: &NodeAndStop| Some(Strength { place: pair.stop.position, rssi_dbm: pair.rssi_dbm? });
        if by_law.is_empty() {
            return;
        }
        let known: Vec<Strength> = fold.others(node).filter_map(|pair| strength(&pair)).collect();
        if known.len() < LEAST_STRENGTHS {
            return;
        }
        let known = strongest_first(&known);
        let Some(field) = Process::likeliest(&known) else { return };
        for (pair, by_law) in by_law {
            let Some(Strength { place, rssi_dbm }) = strength(pair) else { continue };
            let (mean, variance) = field.predicted(place);
            let deviation = (variance + ROUNDED_DB2).sqrt();
            let by_field = normal::density((rssi_dbm - mean) / deviation) / deviation;
            self.nats += ln_density(*by_law) - ln_density(by_field);
            self.strengths += 1.0;
        }
    }

    /// The mean gain (nats a strength); `None` without strengths.
    pub(in crate::auto) fn mean(self) -> Option<f64> {
        (self.strengths > 0.0).then(|| self.nats / self.strengths)
    }
}
