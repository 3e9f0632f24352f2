//! The law of reports, from places that stand for the posteriors of nodes: a step of expectation maximisation.

use super::evidence::{Naming, SectorsHeard};
use super::law::PatternLaw;
use super::report_law::{ReportLaw, UNSEEN_DB};
use crate::numerics::golden_section::highest;
use crate::numerics::normal::{below, density};

/// Additions count as so many that have the mean and the deviation of the guess, and so many sectors as without one.
const USUAL: f64 = 10.0;
/// Least and most deviation of additions (dB).
const ADDED_SIGMA_DB: [f64; 2] = [3.0, 14.0];

/// Least and most deviation of known reflections (dB), and steps of the search for it.
const KNOWN_SIGMA_DB: [f64; 2] = [0.1, 15.0];
const STEPS: u32 = 20;

/// The gains of all sectors for a naming.
#[derive(Clone, Copy)]
pub(super) struct GainRow<'a> {
    pub(super) dbi: &'a [f64],
    /// How much of them was reflected by known obstacles; empty if none are known.
    pub(super) reflected: &'a [f64],
}

/// Sums over the sectors of all reports.
#[derive(Clone, Debug, Default)]
pub(super) struct ReportSums {
    reports: f64,
    open: f64,
    /// Sectors without an addition that is seen: their weight and the squares of their residuals.
    core: [f64; 2],
    sectors: f64,
    /// Additions: their weight, sum and squares (dB).
    added: [f64; 3],
    /// All sectors, and those that were lost.
    all: f64,
    lost: f64,
    /// Sectors with known reflections: their weight, the squares of their residuals, and of the shares that were reflected.
    known: Vec<[f64; 3]>,
}

/// Weight, mean and mean square of a normal value below a bound.
fn truncated(mean: f64, sigma: f64, bound: f64) -> [f64; 3] {
    let score = (bound - mean) / sigma;
    let share = below(score);
    if share < 1e-9 {
        return [0.0, bound, bound * bound];
    }
    let ratio = density(score) / share;
    let of_mean = mean - sigma * ratio;
    let variance = sigma * sigma * (1.0 - score * ratio - ratio * ratio);
    [share, of_mean, variance.max(0.0) + of_mean * of_mean]
}

impl ReportSums {
    /// Those of all reports among `namings`, each with the gains of all sectors.
    pub(super) fn of<'a>(law: &PatternLaw, namings: impl Iterator<Item = (GainRow<'a>, &'a Naming<'a>)>) -> Self {
        let mut sums = Self::default();
        for (GainRow { dbi: row, reflected }, naming) in namings {
            let SectorsHeard::Reported(report) = naming.heard else { continue };
            sums.reports += naming.whole_weight;
            sums.open += naming.weight;
            let of = &law.reports;
            for &(sector, snr_db) in &report.present {
                let gain_db = row[sector] + law.ripple_db[sector];
                let share = reflected.get(sector).copied().unwrap_or(0.0);
                sums.of_present(law, naming.weight, snr_db - naming.level_db - gain_db, (gain_db, share));
            }
            let bound_db = report.least_db - naming.level_db;
            let [quiet, mean, square] = truncated(of.added_db, of.added_sigma_db, bound_db);
            for &sector in &report.absent {
                let noise_db = of.noise_db(law.noise_db, reflected.get(sector).copied().unwrap_or(0.0));
                let weak = below((bound_db - row[sector] - law.ripple_db[sector]) / noise_db);
                let heard = 1.0 - of.added_share + of.added_share * quiet;
                let weak = (1.0 - of.lost_share) * weak * heard;
                sums.all += naming.weight;
                sums.lost += naming.weight * of.lost_share / (of.lost_share + weak);
                let weight = naming.weight * weak / (of.lost_share + weak);
                sums.sectors += weight;
                sums.add(weight * of.added_share * quiet / heard, mean, square);
            }
        }
        sums
    }

    fn add(&mut self, weight: f64, mean: f64, square: f64) {
        self.added[0] += weight;
        self.added[1] += weight * mean;
        self.added[2] += weight * square;
    }

    fn of_present(&mut self, law: &PatternLaw, weight: f64, residual_db: f64, (gain_db, reflected): (f64, f64)) {
        let of = &law.reports;
        let [core, seen, odd] = of.densities(residual_db, gain_db, of.noise_db(law.noise_db, reflected));
        let [core, seen] = [core, seen].map(|density| weight * density / (core + seen + odd));
        self.all += weight;
        self.sectors += core + seen;
        self.core[0] += core;
        self.core[1] += if reflected > 0.0 {
            // Of the residual, this share is noise, and the rest is of the reflections.
            let of_known = reflected * of.known_sigma_db;
            let noise = law.noise_db * law.noise_db;
            let share = noise / (noise + of_known * of_known);
            self.known.push([core, residual_db * residual_db, reflected * reflected]);
            core * (share * share * residual_db * residual_db + noise * (1.0 - share))
        } else {
            core * residual_db * residual_db
        };
        let [unseen, mean, square] = truncated(of.added_db, of.added_sigma_db, gain_db + UNSEEN_DB);
        self.add(core * of.added_share * unseen / (1.0 - of.added_share + of.added_share * unseen), mean, square);
        if seen > 0.0 {
            let added_db = gain_db + 10.0 * libm::log10(libm::pow(10.0, 0.1 * residual_db) - 1.0);
            self.add(seen, added_db, added_db * added_db);
        }
    }

    /// Whether there are reports enough for a law.
    pub(super) fn are_enough(&self) -> bool {
        self.core[0] > 3.0
    }

    /// Improves the noise and the law of reports.
    pub(super) fn improve(&self, law: &mut PatternLaw, [least_db, most_db]: [f64; 2]) {
        let guess = ReportLaw::guess();
        law.noise_db = (self.core[1] / (self.core[0] - self.open).max(1.0)).sqrt().clamp(least_db, most_db);
        let weight = self.added[0] + USUAL;
        let mean = (self.added[1] + USUAL * guess.added_db) / weight;
        let of_guess = guess.added_sigma_db * guess.added_sigma_db + guess.added_db * guess.added_db;
        let square = (self.added[2] + USUAL * of_guess) / weight - mean * mean;
        law.reports = ReportLaw {
            added_share: (self.added[0] / (self.sectors + USUAL)).clamp(0.001, 0.99),
            added_db: mean,
            added_sigma_db: square.max(0.0).sqrt().clamp(ADDED_SIGMA_DB[0], ADDED_SIGMA_DB[1]),
            lost_share: ((self.lost + 0.5) / (self.all + USUAL)).clamp(0.005, 0.5),
            blocked_share: ((self.reports - self.open + 0.5) / (self.reports + USUAL)).clamp(0.01, 0.6),
            known_sigma_db: self.known_sigma_db(law.noise_db).unwrap_or(law.reports.known_sigma_db),
        };
    }

    /// The likeliest deviation of known reflections; `None` if there are none.
    fn known_sigma_db(&self, noise_db: f64) -> Option<f64> {
        if self.known.is_empty() {
            return None;
        }
        let value = |ln: f64| -> f64 {
            let square = libm::exp(2.0 * ln);
            let of_sector = |[weight, residual, share]: &[f64; 3]| {
                let variance = noise_db * noise_db + share * square;
                -0.5 * weight * (residual / variance + libm::log(variance))
            };
            self.known.iter().map(of_sector).sum()
        };
        Some(libm::exp(highest(value, KNOWN_SIGMA_DB.map(libm::log), STEPS)))
    }
}
