//! How far nodes are heard, from places that stand for their posteriors.

use nalgebra::{Matrix5, Vector5};

use super::law::PatternLaw;
use crate::numerics::normal::{Normal, density};

/// Levels that are off by more standard deviations are gross errors.
const FAR: f64 = 4.0;
/// Most steps of the scoring.
const STEPS: u32 = 12;
/// Before anything is heard: mean and standard deviation of the exponent, of the logarithm of σ (dB) and of the logit of the
/// delivery. They hold the law where a log tells nothing.
const EXPONENT: [f64; 2] = [2.0, 0.5];
const LN_SIGMA: [f64; 2] = [1.4, 0.6];
const LOGIT: [f64; 2] = [1.5, 1.5];

/// Packets of a node at a stop, seen from one of the places that stand for its posterior.
#[derive(Clone, Copy, Debug)]
pub(super) struct PacketTrial {
    /// Greatest gain towards the place (dBi).
    pub(super) gain_db: f64,
    /// Distance (decades of a metre).
    pub(super) decades: f64,
    pub(super) received: f64,
    pub(super) sent: f64,
    /// Probability of the place.
    pub(super) weight: f64,
}

/// The strength of a link of a node at a stop, seen from one of the places that stand for its posterior.
#[derive(Clone, Copy, Debug)]
pub(super) struct LevelTrial {
    /// Strength without antenna gain (dB).
    pub(super) level_db: f64,
    /// Distance (decades of a metre).
    pub(super) decades: f64,
    /// Probability of the place.
    pub(super) weight: f64,
}

/// What tells how far nodes are heard.
#[derive(Clone, Debug, Default)]
pub(super) struct Trials {
    pub(super) packets: Vec<PacketTrial>,
    pub(super) levels: Vec<LevelTrial>,
}

/// The law that is likeliest for `trials`, from `law` on, by Fisher's scoring with halved steps: margin, σ, exponent, delivery
/// and level. Where strengths are known, the margin keeps its distance from the level: then packets of strong links tell the
/// delivery, and missed packets bound the strengths of links that were too weak (Tobin 1958).
pub(super) fn improve(law: &mut PatternLaw, trials: &Trials, normal: &Normal) {
    let mut value = log_likelihood(law, trials, normal);
    for _ in 0..STEPS {
        let Some(step) = step(law, trials, normal) else { return };
        let mut share = 1.0;
        let better = loop {
            let next = moved(law, step * share, trials.margin());
            let of_next = log_likelihood(&next, trials, normal);
            if of_next > value {
                break Some((next, of_next));
            }
            share *= 0.5;
            if share < 0.02 {
                break None;
            }
        };
        let Some((next, of_next)) = better else { return };
        let gain = of_next - value;
        (*law, value) = (next, of_next);
        if gain < 1e-3 {
            return;
        }
    }
}

impl Trials {
    fn margin(&self) -> Margin {
        if self.levels.is_empty() { Margin::Free } else { Margin::OfLevel }
    }
}

/// How the margin changes.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Margin {
    Free,
    OfLevel,
}

fn logit(p: f64) -> f64 {
    libm::log(p / (1.0 - p))
}

/// The law with other values of the margin, the logarithm of σ, the exponent, the logit of the delivery, and the level.
fn moved(law: &PatternLaw, mut step: Vector5<f64>, margin: Margin) -> PatternLaw {
    if margin == Margin::OfLevel {
        step[0] = step[4];
    }
    let limited = |value: f64, most: f64| value.clamp(-most, most);
    let sigma_db = law.sigma_db * libm::exp(limited(step[1], 0.7));
    let logit = logit(law.delivery) + limited(step[3], 2.0);
    PatternLaw {
        margin_db: law.margin_db + limited(step[0], 10.0),
        level_db: law.level_db + limited(step[4], 10.0),
        sigma_db: sigma_db.clamp(0.5, 30.0),
        exponent: (law.exponent + limited(step[2], 0.5)).clamp(0.5, 8.0),
        delivery: (1.0 / (1.0 + libm::exp(-logit))).clamp(0.01, 0.999),
        ..law.clone()
    }
}

/// How far each value that a prior holds is from its mean, in standard deviations, and the standard deviation.
fn apart(law: &PatternLaw) -> [[f64; 2]; 3] {
    let off = |value: f64, [mean, deviation]: [f64; 2]| [(value - mean) / deviation, deviation];
    [off(libm::log(law.sigma_db), LN_SIGMA), off(law.exponent, EXPONENT), off(logit(law.delivery), LOGIT)]
}

fn log_likelihood(law: &PatternLaw, trials: &Trials, normal: &Normal) -> f64 {
    let prior: f64 = apart(law).iter().map(|[off, _]| -0.5 * off * off).sum();
    let of_trial = |trial: &PacketTrial| {
        let s = law.heard(normal, trial.gain_db, trial.decades);
        trial.weight * (trial.received * libm::log(s) + (trial.sent - trial.received) * libm::log(1.0 - s))
    };
    let of_level = |trial: &LevelTrial| {
        let off = off_db(law, trial) / law.sigma_db;
        trial.weight * (-0.5 * off.clamp(-FAR, FAR).powi(2) - libm::log(law.sigma_db))
    };
    let packets: f64 = trials.packets.iter().map(of_trial).sum();
    prior + packets + trials.levels.iter().map(of_level).sum::<f64>()
}

/// By how much a level differs from the law (dB).
fn off_db(law: &PatternLaw, trial: &LevelTrial) -> f64 {
    trial.level_db - law.level_db + 10.0 * law.exponent * trial.decades
}

/// The step of Fisher's scoring; `None` if the trials do not determine one.
fn step(law: &PatternLaw, trials: &Trials, normal: &Normal) -> Option<Vector5<f64>> {
    let is_free = trials.margin() == Margin::Free;
    let mut slope = Vector5::zeros();
    let mut information = Matrix5::zeros();
    for trial in &trials.packets {
        let s = law.heard(normal, trial.gain_db, trial.decades);
        let score = law.score(trial.gain_db, trial.decades);
        let by_score = law.delivery * density(score);
        let by_margin = by_score / law.sigma_db;
        let [by_margin, by_level] = if is_free { [by_margin, 0.0] } else { [0.0, by_margin] };
        let gradient = Vector5::new(
            by_margin,
            -by_score * score,
            -by_score * 10.0 * trial.decades / law.sigma_db,
            normal.below(score) * law.delivery * (1.0 - law.delivery),
            by_level,
        );
        let spread = trial.weight / (s * (1.0 - s));
        slope += gradient * (spread * (trial.received - trial.sent * s));
        information += gradient * gradient.transpose() * (spread * trial.sent);
    }
    for trial in &trials.levels {
        let off = off_db(law, trial) / law.sigma_db;
        if off.abs() > FAR {
            continue;
        }
        let by_exponent = -10.0 * trial.decades / law.sigma_db;
        let by_level = 1.0 / law.sigma_db;
        slope += Vector5::new(0.0, off * off - 1.0, by_exponent * off, 0.0, by_level * off) * trial.weight;
        let gradient = Vector5::new(0.0, 0.0, by_exponent, 0.0, by_level);
        information += gradient * gradient.transpose() * trial.weight;
        information[(1, 1)] += 2.0 * trial.weight;
    }
    for (at, [off, deviation]) in (1..).zip(apart(law)) {
        slope[at] -= off / deviation;
        information[(at, at)] += 1.0 / (deviation * deviation);
    }
    information[(0, 0)] += 1e-6;
    information[(4, 4)] += 1e-6;
    Some(information.cholesky()?.solve(&slope))
}

#[cfg(test)]
mod tests {
    use sextant_kernel::{Purpose, Seed};

    use super::*;

    #[test]
    fn the_law_that_drew_the_packets_is_found() {
        let truth = PatternLaw { margin_db: 12.0, exponent: 2.3, sigma_db: 3.0, ..PatternLaw::guess(0.0, 0.0, 1) };
        let normal = Normal::new();
        let trials: Vec<PacketTrial> = (0..20_000)
            .map(|i| {
                let draw = |at| Seed(5).uniform(Purpose::new(8), [i, at, 0]);
                let (gain_db, decades) = (20.0 * draw(0) - 8.0, libm::log10(0.5 + 14.0 * draw(1)));
                let is_heard = draw(2) < truth.heard(&normal, gain_db, decades);
                PacketTrial { gain_db, decades, received: f64::from(u8::from(is_heard)), sent: 1.0, weight: 1.0 }
            })
            .collect();
        let mut law = PatternLaw::guess(2.0, 0.0, 1);
        improve(&mut law, &Trials { packets: trials, levels: Vec::new() }, &normal);
        assert!((law.margin_db - 12.0).abs() < 0.7 && (law.exponent - 2.3).abs() < 0.1, "{law:?}");
        assert!((law.sigma_db - 3.0).abs() < 0.3 && (law.delivery - 0.8).abs() < 0.02, "{law:?}");
    }
}
