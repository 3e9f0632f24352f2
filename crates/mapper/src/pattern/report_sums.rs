//! The law of reports, from places that stand for the posteriors of nodes: a step of expectation maximisation.

use super::evidence::{Naming, SectorsHeard};
use super::law::PatternLaw;
use super::report_law::{ReportLaw, UNSEEN_DB};
use crate::numerics::normal::{below, density};

/// Additions count as so many that have the mean and the deviation of the guess, and so many sectors as without one.
const USUAL: f64 = 10.0;
/// Least and most deviation of additions (dB).
const ADDED_SIGMA_DB: [f64; 2] = [3.0, 14.0];

/// Sums over the sectors of all reports.
#[derive(Clone, Copy, Debug, Default)]
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
    pub(super) fn of<'a>(law: &PatternLaw, namings: impl Iterator<Item = (&'a [f64], &'a Naming<'a>)>) -> Self {
        let mut sums = Self::default();
        for (row, naming) in namings {
            let SectorsHeard::Reported(report) = naming.heard else { continue };
            sums.reports += naming.whole_weight;
            sums.open += naming.weight;
            let of = &law.reports;
            for &(sector, snr_db) in &report.present {
                let gain_db = row[sector] + law.ripple_db[sector];
                sums.of_present(law, naming.weight, snr_db - naming.level_db - gain_db, gain_db);
            }
            let bound_db = report.least_db - naming.level_db;
            let [quiet, mean, square] = truncated(of.added_db, of.added_sigma_db, bound_db);
            for &sector in &report.absent {
                let weak = below((bound_db - row[sector] - law.ripple_db[sector]) / law.noise_db);
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

    fn of_present(&mut self, law: &PatternLaw, weight: f64, residual_db: f64, gain_db: f64) {
        let of = &law.reports;
        let [core, seen, odd] = of.densities(residual_db, gain_db, law.noise_db);
        let [core, seen] = [core, seen].map(|density| weight * density / (core + seen + odd));
        self.all += weight;
        self.sectors += core + seen;
        self.core[0] += core;
        self.core[1] += core * residual_db * residual_db;
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
        };
    }
}
