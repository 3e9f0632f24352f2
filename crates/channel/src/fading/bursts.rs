//! Bursts of loss: the model of Gilbert and Elliott in continuous time.

use sextant_kernel::{Seed, SettingError, SimTime, StationId};

use super::{PairDraws, pair};
use crate::power::Db;
use crate::purpose;

/// Bursts of loss as written in a scenario (Gilbert 1960, Elliott 1963): each link is good or bad for a while, in both
/// directions, and independently of all others.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BurstsConfig {
    /// Mean time for which a link is good (s); the times have an exponential law.
    pub good_s: f64,
    /// Mean time for which it is bad (s).
    pub bad_s: f64,
    /// Loss of power while it is bad (dB), 0 to 200: somebody stands in the way.
    #[cfg_attr(feature = "config", serde(default))]
    pub bad_loss_db: f64,
    /// Share of the frames, received otherwise, that arrive while it is good: 1 if absent.
    #[cfg_attr(feature = "config", serde(default = "all"))]
    pub good_success: f64,
    /// The same while it is bad.
    #[cfg_attr(feature = "config", serde(default = "all"))]
    pub bad_success: f64,
}

#[cfg(feature = "config")]
fn all() -> f64 {
    1.0
}

/// Bursts of loss, checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BurstsLaw {
    /// Share of time for which a link is bad.
    bad_share: f64,
    /// Rate of the instants at which the state is drawn anew (1/s).
    rate_per_s: f64,
    bad_loss: Db,
    good_success: f64,
    bad_success: f64,
}

impl TryFrom<BurstsConfig> for BurstsLaw {
    type Error = SettingError;

    fn try_from(config: BurstsConfig) -> Result<Self, SettingError> {
        let BurstsConfig { good_s, bad_s, bad_loss_db, good_success, bad_success } = config;
        let good_s = SettingError::in_range("good_s", good_s, 1e-6, 1e9)?;
        let bad_s = SettingError::in_range("bad_s", bad_s, 1e-6, 1e9)?;
        let law = Self {
            bad_share: bad_s / (good_s + bad_s),
            rate_per_s: 1.0 / good_s + 1.0 / bad_s,
            bad_loss: Db(SettingError::in_range("bad_loss_db", bad_loss_db, 0.0, 200.0)?),
            good_success: SettingError::in_range("good_success", good_success, 0.0, 1.0)?,
            bad_success: SettingError::in_range("bad_success", bad_success, 0.0, 1.0)?,
        };
        if law.bad_loss.0 <= 0.0 && (law.good_success - law.bad_success).abs() < 1e-12 {
            let needed =
                "a number above 0, or a `bad_success` below `good_success`: the two states are alike without";
            return Err(SettingError::missing("bad_loss_db", needed));
        }
        Ok(law)
    }
}

impl BurstsLaw {
    /// Share of time for which a link is bad.
    #[must_use]
    pub fn bad_share(&self) -> f64 {
        self.bad_share
    }

    /// Loss of power while it is bad.
    #[must_use]
    pub fn bad_loss(&self) -> Db {
        self.bad_loss
    }

    /// Share of the frames, received otherwise, that arrive in a state.
    #[must_use]
    pub fn success(&self, state: LinkState) -> f64 {
        match state {
            LinkState::Good => self.good_success,
            LinkState::Bad => self.bad_success,
        }
    }

    /// Mean of `of`, which depends on the loss of power, over the two states.
    #[must_use]
    pub fn mean_over(&self, of: impl Fn(Db) -> f64) -> f64 {
        (1.0 - self.bad_share) * of(Db(0.0)) + self.bad_share * of(self.bad_loss)
    }

    /// Share of the frames that arrive, if `of_power` is the share by their power at this loss.
    #[must_use]
    pub fn share(&self, of_power: impl Fn(Db) -> f64) -> f64 {
        (1.0 - self.bad_share) * self.good_success * of_power(Db(0.0))
            + self.bad_share * self.bad_success * of_power(self.bad_loss)
    }
}

/// What a link is now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkState {
    /// Usual.
    Good,
    /// In a burst of loss.
    Bad,
}

/// The bursts of loss of all links.
///
/// The state of a link is drawn anew at the points of a Poisson process whose rate is the sum of both rates of change, bad
/// with its share of time, whatever the state was: that is the Markov chain of two states exactly, made uniform (Jensen
/// 1953). So the state at a time is the draw at the last point before. The points of each piece of time are drawn at the
/// address of the piece.
#[derive(Clone, Copy, Debug)]
pub struct Bursts {
    law: BurstsLaw,
    seed: Seed,
}

/// Mean number of points in a piece of time.
const POINTS: f64 = 2.0;

impl Bursts {
    /// Bursts by `law`, with draws from `seed`.
    #[must_use]
    pub fn new(law: BurstsLaw, seed: Seed) -> Self {
        Self { law, seed }
    }

    /// The law.
    #[must_use]
    pub fn law(&self) -> &BurstsLaw {
        &self.law
    }

    /// The state of the link between two stations at `now`.
    #[must_use]
    pub fn state(&self, a: StationId, b: StationId, now: SimTime) -> LinkState {
        let draws = PairDraws { seed: self.seed, purpose: purpose::BURSTS, pair: pair(a, b) };
        let position = now.as_secs_f64() * self.law.rate_per_s / POINTS;
        let (mut piece, mut until) = (position.floor(), position.fract());
        loop {
            if let Some(state) = self.last(draws, piece, until) {
                return state;
            }
            (piece, until) = (piece - 1.0, 1.0);
        }
    }

    /// The state drawn at the last point of a piece of time before the part `until` of it, if there is one.
    fn last(&self, draws: PairDraws, piece: f64, until: f64) -> Option<LinkState> {
        // Pieces before the start of time have negative numbers.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an address")]
        let piece = piece as i64 as u64;
        // The number of points by the inverse of the law of Poisson.
        let mut left = draws.uniform(piece, 0) - libm::exp(-POINTS);
        let (mut count, mut weight) = (0_u64, libm::exp(-POINTS));
        while left > 0.0 && count < 40 {
            count += 1;
            weight *= POINTS / count as f64;
            left -= weight;
        }
        let at = |point: u64| draws.uniform(piece, 2 * point + 1);
        let last = (0..count).filter(|&point| at(point) <= until).max_by(|&a, &b| at(a).total_cmp(&at(b)))?;
        let is_bad = draws.uniform(piece, 2 * last + 2) < self.law.bad_share;
        Some(if is_bad { LinkState::Bad } else { LinkState::Good })
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    const CONFIG: BurstsConfig =
        BurstsConfig { good_s: 10.0, bad_s: 2.0, bad_loss_db: 0.0, good_success: 0.99, bad_success: 0.1 };

    /// Frames of the classic chain with p = 0.02 and r = 0.1 a slot: its state at multiples of a time T is that of the chain
    /// in continuous time, if e^-(rates)T = 1 - p - r.
    #[test]
    fn the_chain_of_gilbert_and_elliott_has_its_known_runs_of_losses() {
        let law = BurstsLaw::try_from(CONFIG).unwrap();
        assert!((law.bad_share() - 1.0 / 6.0).abs() < 1e-12);
        assert!((law.share(|_| 1.0) - 0.841_667).abs() < 1e-6);
        let slot_s = -0.88_f64.ln() / law.rate_per_s;
        let (mut runs, mut after_loss, mut after_two) = ([0_u32; 4], 0, 0);
        let trials = 60_000_u32;
        for trial in 0..trials {
            let bursts = Bursts::new(law, Seed(u64::from(trial % 50)));
            let start_s = 700.0 * f64::from(trial / 50);
            let lost = |k: u32| {
                let now = SimTime::ZERO + Duration::from_secs_f64(start_s + slot_s * f64::from(k));
                let luck = Seed(99).uniform(sextant_kernel::Purpose::new(9001), [trial.into(), k.into(), 0]);
                luck >= law.success(bursts.state(StationId(3), StationId(7), now))
            };
            let lost: Vec<bool> = (0..4).map(lost).collect();
            for (k, run) in runs.iter_mut().enumerate() {
                *run += u32::from(lost[..=k].iter().all(|&lost| lost));
            }
            after_loss += u32::from(lost[0]);
            after_two += u32::from(lost[0] && lost[1]);
        }
        // Five standard errors each: a false alarm in 400 000 runs of this test with another seed.
        for (run, expected) in runs.into_iter().zip([0.158_333, 0.121_882, 0.098_665, 0.079_920]) {
            let n = f64::from(trials);
            let found = f64::from(run) / n;
            assert!((found - expected).abs() < 5.0 * (expected * (1.0 - expected) / n).sqrt(), "{found} {expected}");
        }
        let found = f64::from(after_two) / f64::from(after_loss);
        assert!((found - 0.769_78).abs() < 5.0 * (0.177 / f64::from(after_loss)).sqrt(), "{found}");
    }

    #[test]
    fn links_are_bad_for_their_mean_time_and_alike_in_both_directions() {
        let bursts = Bursts::new(CONFIG.try_into().unwrap(), Seed(4));
        let (mut bad, mut runs, mut was_bad) = (0_u32, 0_u32, false);
        let steps = 400_000_u32;
        for step in 0..steps {
            let now = SimTime::ZERO + Duration::from_millis(u64::from(step) * 50);
            let state = bursts.state(StationId(1), StationId(2), now);
            assert_eq!(state, bursts.state(StationId(2), StationId(1), now));
            let is_bad = state == LinkState::Bad;
            bad += u32::from(is_bad);
            runs += u32::from(is_bad && !was_bad);
            was_bad = is_bad;
        }
        // About 1670 runs of 2 s: a standard error of 2.4 % of the share and of the mean, without those that fall between two looks.
        let share = f64::from(bad) / f64::from(steps);
        let mean_s = 0.05 * f64::from(bad) / f64::from(runs);
        assert!((share * 6.0 - 1.0).abs() < 0.12, "{share}");
        assert!((mean_s / 2.0 - 1.0).abs() < 0.12, "{mean_s}");
    }

    #[test]
    fn states_that_are_alike_are_refused() {
        let alike = BurstsConfig { good_success: 1.0, bad_success: 1.0, ..CONFIG };
        let error = BurstsLaw::try_from(alike).unwrap_err().to_string();
        assert!(error.starts_with("`bad_loss_db` is missing"), "{error}");
        assert!(BurstsLaw::try_from(BurstsConfig { bad_loss_db: 10.0, ..alike }).is_ok());
        assert!(BurstsLaw::try_from(BurstsConfig { bad_s: 0.0, ..CONFIG }).is_err());
    }
}
