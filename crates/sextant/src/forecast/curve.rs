//! The probability of reception over the mean power of a link.

use sextant_channel::{ChannelLaw, Db, Dbm};
use sextant_sim::Technology;

/// Step of powers (dB).
const STEP_DB: f64 = 0.05;

/// Above the sensitivity by this much (dB), a frame is received or never will be.
const WIDTH_DB: f64 = 40.0;

/// Few fades are as deep (dB).
const DEEP_FADE_DB: f64 = 40.0;

/// The probability of reception over the mean power: what the receivers do with each power, averaged over shadowing,
/// fading and bursts of loss.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    /// Powers at which the probability without shadowing rises, and by how much (dBm).
    rises: Vec<(f64, f64)>,
    law: ChannelLaw,
}

impl Curve {
    /// The curve for frames of this size (octets) over a channel with this law.
    pub(super) fn new(technology: &Technology, frame_octets: u16, law: ChannelLaw) -> Self {
        let at = |dbm: f64| technology.reception_probability(Dbm(dbm), frame_octets);
        let start_dbm = technology.sensitivity().0 - STEP_DB;
        let mut rises = Vec::new();
        let (mut below_dbm, mut below) = (start_dbm, at(start_dbm));
        let steps = (WIDTH_DB / STEP_DB).round();
        let mut step = 1.0;
        while step <= steps {
            let above_dbm = start_dbm + step * STEP_DB;
            let above = at(above_dbm);
            if above - below > 0.5 {
                rises.push((jump_dbm(&at, below_dbm, above_dbm), above - below));
            } else if above > below {
                rises.push((f64::midpoint(below_dbm, above_dbm), above - below));
            }
            (below_dbm, below) = (above_dbm, above);
            step += 1.0;
        }
        Self { rises, law }
    }

    /// Probability that a frame is received over a link with this mean power, undisturbed.
    pub(super) fn probability(&self, mean: Dbm) -> f64 {
        self.rises.iter().map(|(dbm, rise)| rise * self.law.share_received(Db(mean.0 - dbm))).sum()
    }

    /// Mean power at which the probability is `share` (dBm); `None` if it is so high nowhere.
    pub(super) fn power_dbm(&self, share: f64) -> Option<f64> {
        let (first, last) = (self.rises.first()?.0, self.rises.last()?.0);
        let shadowing_db = 8.0 * self.law.shadowing().sigma_db() + 1.0;
        let up_db = shadowing_db + self.law.fading().map_or(0.0, |_| DEEP_FADE_DB);
        let up_db = up_db + self.law.bursts().map_or(0.0, |bursts| bursts.bad_loss().0);
        let down_db = shadowing_db + self.law.fading().map_or(0.0, |fading| fading.greatest_gain().0);
        let (mut low, mut high) = (first - down_db, last + up_db);
        if self.probability(Dbm(high)) < share {
            return None;
        }
        for _ in 0..60 {
            let middle = f64::midpoint(low, high);
            if self.probability(Dbm(middle)) < share { low = middle } else { high = middle }
        }
        Some(high)
    }
}

/// Where `at` jumps between two powers (dBm).
fn jump_dbm(at: &impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let middle_value = f64::midpoint(at(low), at(high));
    for _ in 0..40 {
        let middle = f64::midpoint(low, high);
        if at(middle) < middle_value { low = middle } else { high = middle }
    }
    high
}
