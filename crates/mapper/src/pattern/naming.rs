//! What nodes say of sectors: the noise, the ripple and the yaw, from places that stand for their posteriors.

use nalgebra::{DMatrix, DVector};

use super::evidence::{Naming, SectorsHeard};
use super::gain_map::{ANY, GainMap};
use super::law::PatternLaw;
use super::report_sums::{GainRow, ReportSums};
use super::sight::{Sight, Turn};
use super::way_gains::{SeenPlace, WayGains};
use super::ways::KnownWays;
use crate::numerics::golden_section::highest;
use crate::numerics::normal::logistic_scale;

/// Steps of Newton's method for the ripple, in a round.
const STEPS: u32 = 3;
/// Most change of a gain in a step (dB).
const MOST_DB: f64 = 1.5;
/// Least and most noise (dB), and standard deviation of the ripple (dB).
const NOISE_DB: [f64; 2] = [0.5, 8.0];
const RIPPLE_DB: [f64; 2] = [0.1, 6.0];
/// Steps of a search along one value.
const GOLDEN_STEPS: u32 = 14;
/// In a round the antenna turns at most so far (rad).
pub(super) const TURN_RAD: f64 = 0.07;

/// The gains of all sectors for each naming.
struct Gains {
    sectors: usize,
    dbi: Vec<f64>,
    /// How much of them was reflected by known obstacles, as shares; empty if none are known.
    reflected: Vec<f64>,
}

/// The antenna, and the ways to places among known obstacles, if there are any.
#[derive(Clone, Copy)]
pub(super) struct Scenery<'a> {
    pub(super) map: &'a GainMap,
    pub(super) ways: Option<&'a KnownWays>,
}

impl Gains {
    fn of(Scenery { map, ways }: Scenery<'_>, namings: &[Naming<'_>], law: &PatternLaw, yaw_rad: f64) -> Self {
        let turn = Turn::by(yaw_rad);
        let sectors = map.sectors();
        if let Some(ways) = ways {
            let of_ways = WayGains { map, ways, mount: turn, exponent: law.exponent };
            let (mut dbi, mut reflected) = (vec![0.0; namings.len() * sectors], vec![0.0; namings.len() * sectors]);
            for ((naming, dbi), reflected) in
                namings.iter().zip(dbi.chunks_mut(sectors)).zip(reflected.chunks_mut(sectors))
            {
                let &Naming { stop, ref robot, place, .. } = naming;
                of_ways.towards(SeenPlace { stop, robot, place }, dbi, reflected);
            }
            return Self { sectors, dbi, reflected };
        }
        let mut dbi = Vec::with_capacity(namings.len() * sectors);
        for naming in namings {
            let cell = Sight::of(naming.place, &naming.robot, turn, map.directions()).cell;
            dbi.extend((0..sectors).map(|sector| map.gain_dbi(cell, sector)));
        }
        Self { sectors, dbi, reflected: Vec::new() }
    }

    fn rows(&self) -> impl Iterator<Item = GainRow<'_>> {
        self.dbi.chunks(self.sectors).enumerate().map(|(at, dbi)| {
            let reflected = self.reflected.get(at * self.sectors..(at + 1) * self.sectors).unwrap_or_default();
            GainRow { dbi, reflected }
        })
    }
}

/// The probabilities of all sectors of these gains.
fn probabilities(gains: &[f64], ripple_db: &[f64], scale_db: f64, shares: &mut [f64]) {
    let mut top = f64::NEG_INFINITY;
    for ((share, gain), ripple) in shares.iter_mut().zip(gains).zip(ripple_db) {
        *share = (gain + ripple) / scale_db;
        top = top.max(*share);
    }
    let mut sum = 0.0;
    for share in shares.iter_mut() {
        *share = libm::exp((*share - top).max(-40.0));
        sum += *share;
    }
    shares.iter_mut().for_each(|share| *share /= sum);
}

fn log_likelihood(gains: &Gains, namings: &[Naming<'_>], ripple_db: &[f64], noise_db: f64) -> f64 {
    let mut shares = vec![0.0; gains.sectors];
    let mut sum = 0.0;
    for (row, naming) in gains.rows().zip(namings) {
        sum += naming.weight
            * match naming.heard {
                SectorsHeard::Named(sector, _) => {
                    probabilities(row.dbi, ripple_db, logistic_scale(noise_db), &mut shares);
                    libm::log((1.0 - ANY) * shares[*sector] + ANY / gains.sectors as f64)
                }
                SectorsHeard::Nothing | SectorsHeard::Reported(_) => 0.0,
            };
    }
    sum
}

/// Improves noise and ripple of `law`, and how far the antenna is turned if that is estimated. `ripple_sigma_db` is the standard
/// deviation of the ripple, which is estimated as well.
pub(super) fn improve(
    law: &mut PatternLaw,
    scenery: Scenery<'_>,
    namings: &[Naming<'_>],
    turn: TurnOfRound,
    ripple_sigma_db: &mut f64,
) {
    if namings.is_empty() {
        return;
    }
    if turn == TurnOfRound::Improved {
        let turned = |yaw_rad: f64| {
            log_likelihood(&Gains::of(scenery, namings, law, yaw_rad), namings, &law.ripple_db, law.noise_db)
        };
        law.yaw_rad = highest(turned, [law.yaw_rad - TURN_RAD, law.yaw_rad + TURN_RAD], GOLDEN_STEPS);
    }
    let gains = Gains::of(scenery, namings, law, law.yaw_rad);
    let of_reports = ReportSums::of(law, gains.rows().zip(namings));
    if of_reports.are_enough() {
        of_reports.improve(law, NOISE_DB);
    } else {
        let [low, high] = NOISE_DB.map(libm::log);
        let with_noise = |ln: f64| log_likelihood(&gains, namings, &law.ripple_db, libm::exp(ln));
        law.noise_db = libm::exp(highest(with_noise, [low, high], GOLDEN_STEPS));
    }
    if let Some(variances) = improve_ripple(law, &gains, namings, *ripple_sigma_db) {
        let square: f64 = law.ripple_db.iter().map(|b| b * b).sum::<f64>() + variances;
        *ripple_sigma_db = (square / gains.sectors as f64).sqrt().clamp(RIPPLE_DB[0], RIPPLE_DB[1]);
    }
}

/// Whether the antenna may turn in a round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TurnOfRound {
    Kept,
    Improved,
}

/// Newton's method for the ripple, which is normal before anything is heard. Gives the sum of its variances.
fn improve_ripple(law: &mut PatternLaw, gains: &Gains, namings: &[Naming<'_>], sigma_db: f64) -> Option<f64> {
    let sectors = gains.sectors;
    let scale = logistic_scale(law.noise_db);
    let mut variances = None;
    let mut shares = vec![0.0; sectors];
    for _ in 0..STEPS {
        let mut slope = DVector::from_iterator(sectors, law.ripple_db.iter().map(|b| -b / (sigma_db * sigma_db)));
        let mut curvature = DMatrix::identity(sectors, sectors) / (sigma_db * sigma_db);
        for (GainRow { dbi: row, reflected }, naming) in gains.rows().zip(namings) {
            let named = match naming.heard {
                SectorsHeard::Nothing => continue,
                SectorsHeard::Named(sector, _) => *sector,
                SectorsHeard::Reported(report) => {
                    let precision = naming.weight / (law.noise_db * law.noise_db);
                    let entries = report.present.iter().map(|&(sector, snr_db)| {
                        let residual_db = snr_db - naming.level_db - row[sector] - law.ripple_db[sector];
                        let share = reflected.get(sector).copied().unwrap_or(0.0);
                        let noise_db = law.reports.noise_db(law.noise_db, share);
                        let [core, seen, odd] = law.reports.densities(residual_db, row[sector], noise_db);
                        let finer = law.noise_db / noise_db;
                        (sector, residual_db, core / (core + seen + odd) * (finer * finer))
                    });
                    let entries: Vec<(usize, f64, f64)> = entries.filter(|entry| entry.2 > 1e-3).collect();
                    let sum: f64 = entries.iter().map(|entry| entry.2).sum();
                    let mean = entries.iter().map(|entry| entry.1 * entry.2).sum::<f64>() / sum.max(1e-9);
                    for &(sector, residual_db, core) in &entries {
                        slope[sector] += precision * core * (residual_db - mean);
                        curvature[(sector, sector)] += precision * core;
                        for &(other, _, of_other) in &entries {
                            curvature[(sector, other)] -= precision * core * of_other / sum;
                        }
                    }
                    continue;
                }
            };
            probabilities(row, &law.ripple_db, scale, &mut shares);
            // A name that says nothing has no slope.
            let own = (1.0 - ANY) * shares[named];
            let weight = naming.weight * own / (own + ANY / sectors as f64);
            slope[named] += weight / scale;
            let likely: Vec<usize> = (0..sectors).filter(|&sector| shares[sector] > 1e-6).collect();
            for &one in &likely {
                slope[one] -= weight * shares[one] / scale;
                curvature[(one, one)] += weight * shares[one] / (scale * scale);
                for &other in &likely {
                    curvature[(one, other)] -= weight * shares[one] * shares[other] / (scale * scale);
                }
            }
        }
        let decomposed = curvature.cholesky()?;
        let step = decomposed.solve(&slope);
        law.ripple_db.iter_mut().zip(step.iter()).for_each(|(b, step)| *b += step.clamp(-MOST_DB, MOST_DB));
        variances = Some(decomposed.inverse().trace());
    }
    variances
}
