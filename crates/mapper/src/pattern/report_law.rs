//! How likely what a node reports of a sector is, given the gain of that sector towards the node.
//!
//! A report is a mixture. The signal of a sector comes by the straight way; to its power others may add, by ways that nobody
//! knows: reflections and leaks. Their power relative to the straight way without gain is normal in decibels, and broad, because
//! neither their direction nor their loss is known. Power that is added is never negative, so that a sector may be much stronger
//! than its gain says, and hardly weaker. A sector that is absent was too weak, or its frame was lost. And the straight way of
//! some reports is blocked: these tell nothing of the direction.

use std::sync::OnceLock;

use sextant_kernel::maths::{exp, ln};

use super::report_views::{ReportView, ReportViews};
use crate::numerics::normal::{below, density};

/// Residuals in a table, from the least to the greatest (dB), and their number in a decibel.
const RESIDUALS_DB: [f64; 2] = [-24.0, 56.0];
const PER_DB: f64 = 8.0;
/// Gains in a table, from the least to the greatest (dBi), and the step between them (dB).
const GAINS_DBI: [f64; 2] = [-60.0, 40.0];
const GAIN_STEP_DB: f64 = 2.0;
/// Scores in the table of absent sectors, on both sides, and their number in a decibel.
const ABSENT_DB: f64 = 40.0;
/// An addition that is weaker than the straight way by this or more is not seen (dB).
pub(super) const UNSEEN_DB: f64 = -6.0;
/// With more noise the level is found in one step (dB).
const ROUGH_DB: f64 = 1.5;
/// How often the strength of a sector is any, over so many decibels.
const ODD: f64 = 0.01;
const ODD_WIDTH_DB: f64 = 60.0;
/// The strength of the straight way that the strongest sector tells counts as so many sectors.
const FIRM: f64 = 0.01;

/// The law of what nodes report of sectors, beside the noise and the ripple of the antenna.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReportLaw {
    /// Share of the sectors to which the power of other ways is added.
    pub added_share: f64,
    /// Power of the other ways relative to the straight one without gain: mean (dB).
    pub added_db: f64,
    /// The same: standard deviation (dB).
    pub added_sigma_db: f64,
    /// Share of the sectors that are absent though they were strong enough.
    pub lost_share: f64,
    /// Share of the reports whose straight way is blocked.
    pub blocked_share: f64,
    /// Standard deviation of what known reflections are stronger or weaker than computed (dB).
    pub known_sigma_db: f64,
}

impl ReportLaw {
    /// A law to begin with.
    pub(super) fn guess() -> Self {
        Self {
            added_share: 0.15,
            added_db: -4.0,
            added_sigma_db: 8.0,
            lost_share: 0.03,
            blocked_share: 0.05,
            known_sigma_db: 3.0,
        }
    }

    /// The standard deviation of a sector of which a share came by known reflections (dB), where strengths have this noise.
    pub(super) fn noise_db(&self, noise_db: f64, reflected: f64) -> f64 {
        if reflected > 0.0 { libm::hypot(noise_db, reflected * self.known_sigma_db) } else { noise_db }
    }

    /// The probability that an addition is not seen beside a straight way of this gain.
    pub(super) fn unseen(&self, gain_db: f64) -> f64 {
        below((gain_db + UNSEEN_DB - self.added_db) / self.added_sigma_db)
    }

    /// The log-likelihood of a report that fits like this, whose straight way may be blocked, and the probability that it is not.
    pub(super) fn mixed(&self, ln_open: f64, ln_blocked: f64) -> [f64; 2] {
        let open = ln(1.0 - self.blocked_share) + ln_open;
        let blocked = ln(self.blocked_share) + ln_blocked;
        let smaller = exp(-(open - blocked).abs());
        let share = if open > blocked { 1.0 } else { smaller } / (1.0 + smaller);
        [open.max(blocked) + ln(1.0 + smaller), share]
    }

    /// The densities of a residual (per dB): without an addition that is seen, with one, and of any strength. The noise has this
    /// standard deviation.
    pub(super) fn densities(&self, residual_db: f64, gain_db: f64, noise_db: f64) -> [f64; 3] {
        self.densities_of(&Residual::of(residual_db, noise_db), gain_db, self.unseen(gain_db))
    }

    /// The same of a residual, where an addition beside this gain is not seen with the probability `unseen`.
    fn densities_of(&self, residual: &Residual, gain_db: f64, unseen: f64) -> [f64; 3] {
        let core = (1.0 - self.added_share + self.added_share * unseen) * (1.0 - ODD) * residual.density;
        let seen = if residual.added_db > UNSEEN_DB {
            let off = (residual.added_db - (self.added_db - gain_db)) / self.added_sigma_db;
            self.added_share * (1.0 - ODD) * density(off) / self.added_sigma_db * residual.slope
        } else {
            0.0
        };
        [core, seen, ODD / ODD_WIDTH_DB]
    }
}

/// By how much the strength of a sector is more than the pattern and the straight way say.
struct Residual {
    /// How likely it is without an addition (per dB).
    density: f64,
    /// The addition that makes it, relative to what the straight way brings by this sector (dB).
    added_db: f64,
    /// By how much the addition grows with the residual.
    slope: f64,
}

impl Residual {
    fn of(residual_db: f64, noise_db: f64) -> Self {
        let factor = libm::pow(10.0, 0.1 * residual_db.max(0.0));
        Self {
            density: density(residual_db / noise_db) / noise_db,
            added_db: 10.0 * libm::log10((factor - 1.0).max(1e-9)),
            slope: factor / (factor - 1.0),
        }
    }
}

/// The law in tables.
#[derive(Clone, Debug)]
pub(super) struct ReportTables {
    law: ReportLaw,
    noise_db: f64,
    residuals: usize,
    /// By gain, then by residual: the logarithm of the density, and the share of it that is without additions.
    values: Vec<[f32; 2]>,
    /// By how far the threshold is above the straight way: the logarithm of the probability that a sector is absent.
    absent: Vec<f32>,
    /// The same with more and more noise, up to that of known reflections.
    rougher: Vec<OnceLock<Self>>,
}

/// By how much the noise of each of these tables is more than that of the one before.
const ROUGHER: f64 = 1.6;

/// What a node reported of all sectors.
#[derive(Clone, Debug)]
pub(super) struct Report {
    /// The sectors by the order of identities, each with its strength (dB).
    pub(super) present: Vec<(usize, f64)>,
    pub(super) absent: Vec<usize>,
    /// Sectors of less strength are absent (dB).
    pub(super) least_db: f64,
    /// The log-likelihood if the straight way is blocked: each sector is present or absent by chance, with any strength.
    pub(super) ln_blocked: f64,
    pub(super) views: ReportViews,
}

impl Report {
    /// Sectors of less than `least_db` are absent.
    pub(super) fn new(present: Vec<(usize, f64)>, absent: Vec<usize>, least_db: f64) -> Self {
        let [of_present, of_absent] = [present.len() as f64, absent.len() as f64];
        let share = (of_present + 0.5) / (of_present + of_absent + 1.0);
        let ln_blocked = of_present * libm::log(share / 30.0) + of_absent * libm::log(1.0 - share);
        Self { present, absent, least_db, ln_blocked, views: ReportViews::default() }
    }
}

fn count(from: f64, to: f64, step: f64) -> usize {
    crate::numerics::whole(((to - from) / step).round()) + 1
}

impl ReportTables {
    /// The tables of a law whose strengths have this noise (dB).
    pub(super) fn new(law: &ReportLaw, noise_db: f64) -> Self {
        let residuals: Vec<Residual> = (0..count(RESIDUALS_DB[0], RESIDUALS_DB[1], 1.0 / PER_DB))
            .map(|at| Residual::of(RESIDUALS_DB[0] + at as f64 / PER_DB, noise_db))
            .collect();
        let gains = count(GAINS_DBI[0], GAINS_DBI[1], GAIN_STEP_DB);
        let mut values = Vec::with_capacity(residuals.len() * gains);
        for gain in 0..gains {
            let gain_db = GAINS_DBI[0] + GAIN_STEP_DB * gain as f64;
            let unseen = law.unseen(gain_db);
            for residual in &residuals {
                let densities = law.densities_of(residual, gain_db, unseen);
                let sum: f64 = densities.iter().sum();
                values.push([single(ln(sum)), single(densities[0] / sum)]);
            }
        }
        let absent = (0..count(-ABSENT_DB, ABSENT_DB, 1.0 / PER_DB)).map(|at| {
            let over_db = at as f64 / PER_DB - ABSENT_DB;
            single(libm::log(law.lost_share + (1.0 - law.lost_share) * below(over_db / noise_db)))
        });
        let (absent, rougher) = (absent.collect(), Vec::new());
        Self { law: *law, noise_db, residuals: residuals.len(), values, absent, rougher }
    }

    /// The same, also with the noise of known reflections.
    pub(super) fn with_reflections(self) -> Self {
        let most = self.law.noise_db(self.noise_db, 1.0) / self.noise_db;
        let levels = crate::numerics::whole((ln(most) / ln(ROUGHER)).round());
        Self { rougher: std::iter::repeat_with(OnceLock::new).take(levels).collect(), ..self }
    }

    /// The tables for a sector of which this share was reflected.
    #[inline]
    fn of_reflected(&self, share: f64) -> &Self {
        let extra = share * self.law.known_sigma_db / self.noise_db;
        let level = (0.5 / ln(ROUGHER) * ln(1.0 + extra * extra)).round();
        if level < 0.5 {
            return self;
        }
        let level = crate::numerics::whole(level).min(self.rougher.len());
        let Some(table) = level.checked_sub(1).map(|at| &self.rougher[at]) else { return self };
        table.get_or_init(|| Self::new(&self.law, self.noise_db * libm::pow(ROUGHER, level as f64)))
    }

    /// The same as [`view`](Self::view), where a share of each sector came by known reflections.
    pub(super) fn view_reflected(
        &self,
        report: &Report,
        gains: &[f64],
        reflected: &[f64],
        variance: f64,
    ) -> ReportView {
        self.viewed(report, gains, |sector| self.of_reflected(reflected[sector]), variance)
    }

    /// The logarithm of the density of a residual, and the share of it that is without additions.
    #[inline]
    fn at(&self, residual_db: f64, gain_db: f64) -> [f64; 2] {
        let row = ((gain_db - GAINS_DBI[0]) / GAIN_STEP_DB + 0.5).clamp(0.0, 50.0);
        let along = ((residual_db - RESIDUALS_DB[0]) * PER_DB).clamp(0.0, (self.residuals - 2) as f64);
        let column = crate::numerics::whole(along);
        let place = crate::numerics::whole(row) * self.residuals + column;
        let (low, high) = (self.values[place], self.values[place + 1]);
        let share = along - column as f64;
        let between = |i: usize| f64::from(low[i]) + share * (f64::from(high[i]) - f64::from(low[i]));
        [between(0), between(1)]
    }

    /// What a report says of a direction with these `gains` of all sectors, with their ripple. The strength of the straight way
    /// has this variance round the expected one (dB²).
    pub(super) fn view(&self, report: &Report, gains: &[f64], variance: f64) -> ReportView {
        self.viewed(report, gains, |_| self, variance)
    }

    #[inline]
    fn viewed<'a>(
        &'a self,
        report: &Report,
        gains: &[f64],
        of: impl Fn(usize) -> &'a Self,
        variance: f64,
    ) -> ReportView {
        let top = report.present.iter().fold((f64::NEG_INFINITY, 0.0), |top, &(sector, snr_db)| {
            if gains[sector] > top.0 { (gains[sector], snr_db - gains[sector]) } else { top }
        });
        let mut level_db = top.1;
        let of_noise = 1.0 / (self.noise_db * self.noise_db);
        let mut precision = 0.0;
        for _ in 0..if self.noise_db > ROUGH_DB { 1 } else { 2 } {
            let (mut sum, mut weight) = (0.0, 0.0);
            for &(sector, snr_db) in &report.present {
                let gain_db = gains[sector];
                let tables = of(sector);
                let [_, core] = tables.at(snr_db - level_db - gain_db, gain_db);
                let finer = self.noise_db / tables.noise_db;
                let core = core * (finer * finer);
                sum += core * (snr_db - gain_db);
                weight += core;
            }
            // The strongest sector alone tells the level where no other one agrees.
            (level_db, precision) = ((sum + FIRM * level_db) / (weight + FIRM), of_noise * (weight + FIRM));
        }
        let mut ln = 0.0;
        for &(sector, snr_db) in &report.present {
            ln += of(sector).at(snr_db - level_db - gains[sector], gains[sector])[0];
        }
        let over_db = report.least_db - level_db;
        for &sector in &report.absent {
            let along = ((over_db - gains[sector] + ABSENT_DB) * PER_DB).clamp(0.0, (self.absent.len() - 1) as f64);
            ln += f64::from(of(sector).absent[crate::numerics::whole(along)]);
        }
        // None of the absent sectors has an addition that would be heard.
        let share = self.law.added_share;
        let quiet = below((over_db - self.law.added_db) / self.law.added_sigma_db);
        ln += report.absent.len() as f64 * libm::log((1.0 - share + share * quiet).max(1e-3));
        ln -= 0.5 * libm::log(1.0 + precision * variance);
        ReportView { ln, level_db, precision: 1.0 / (variance + 1.0 / precision) }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "tables are in single precision")]
fn single(value: f64) -> f32 {
    value as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gains of the sectors that were heard (dBi).
    const GAINS_DB: [f64; 5] = [14.0, 9.0, 3.0, 11.0, 6.0];
    const NOISE_DB: f64 = 0.8;

    fn law() -> ReportLaw {
        ReportLaw { added_share: 0.001, lost_share: 0.5, ..ReportLaw::guess() }
    }

    /// A report of strengths that are a level more than the gains, but for small errors.
    fn report(level_db: f64) -> Report {
        let errors_db = [0.5, -0.75, 0.25, 0.0, -0.5];
        let strength = |sector: usize| (sector, level_db + GAINS_DB[sector] + errors_db[sector]);
        Report::new((0..GAINS_DB.len()).map(strength).collect(), Vec::new(), 0.0)
    }

    #[test]
    fn the_strength_of_the_straight_way_is_integrated_round_the_expected_one() {
        let (report, tables) = (report(12.0), ReportTables::new(&law(), NOISE_DB));
        let sigma_db = 2.5;
        let view = tables.view(&report, &GAINS_DB, sigma_db * sigma_db);
        // The same sum over levels, up to a constant.
        let summed = |expected_db: f64| {
            let (mut sum, mut first) = (0.0, 0.0);
            for step in -400..=400 {
                let level_db = 12.0 + 0.01 * f64::from(step);
                let of_sector = |&(sector, snr_db): &(usize, f64)| -> f64 {
                    law().densities(snr_db - level_db - GAINS_DB[sector], GAINS_DB[sector], NOISE_DB).iter().sum()
                };
                let likelihood: f64 = report.present.iter().map(of_sector).product();
                let weight = likelihood * density((level_db - expected_db) / sigma_db);
                sum += weight;
                first += weight * level_db;
            }
            [libm::log(sum), first / sum]
        };
        let [ln_middle, _] = summed(12.0);
        let of_middle = view.fit(12.0, sigma_db * sigma_db).ln_open;
        for expected_db in [4.0, 9.0, 11.0, 15.0, 19.0] {
            let [ln, level_db] = summed(expected_db);
            let fit = view.fit(expected_db, sigma_db * sigma_db);
            let less = (fit.ln_open - of_middle) - (ln - ln_middle);
            assert!(less.abs() < 0.03, "{less} at {expected_db} dB");
            assert!((fit.level_db - level_db).abs() < 0.02, "{} and {level_db} dB", fit.level_db);
        }
    }

    #[test]
    fn a_report_is_as_likely_as_its_two_reasons_together() {
        let law = ReportLaw { blocked_share: 0.2, ..law() };
        for (open, blocked) in [(-3.0, -3.5), (-60.0, -1.0), (-1.0, -90.0)] {
            let [ln, share] = law.mixed(open, blocked);
            let [open, blocked] = [0.8 * libm::exp(open), 0.2 * libm::exp(blocked)];
            assert!(
                (ln - libm::log(open + blocked)).abs() < 1e-12 && (share - open / (open + blocked)).abs() < 1e-12
            );
        }
    }
}
