//! How deep fades are: the law of the gain of a link, whose mean as a factor is one.

use sextant_kernel::SettingError;

use super::config::{FadingConfig, FadingLawConfig};
use crate::power::Db;

/// Fading, checked: how deep it is and what it depends on. A [`Fading`](super::process::Fading) makes the draws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FadingLaw {
    pub(super) depth: Depth,
    pub(super) variation: Variation,
}

/// How deep fades are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Depth {
    /// A direct way whose power is `k` times that of the scattered ones; 0 for Rayleigh.
    Rician { k: f64 },
    /// The power is the mean of the squares of so many normal numbers: 2 m.
    Nakagami { squares: u8 },
}

/// What the gain depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Variation {
    /// On the places, on the frequency and, if the Doppler shift is above 0, on time.
    Waves { doppler_hz: f64, delay_spread_s: f64 },
    /// On the number of the block of time and on the channel.
    Blocks { block_s: f64 },
}

/// Delay spread if none is written (ns).
const USUAL_DELAY_SPREAD_NS: f64 = 50.0;

/// Probability that the gain is above [`FadingLaw::greatest_gain`]: that of four standard deviations of shadowing.
const RARE: f64 = 3.167e-5;

impl TryFrom<FadingConfig> for FadingLaw {
    type Error = SettingError;

    fn try_from(config: FadingConfig) -> Result<Self, SettingError> {
        let FadingConfig { law, doppler_hz, delay_spread_ns, block_s } = config;
        let depth = match law {
            FadingLawConfig::Rayleigh => Depth::Rician { k: 0.0 },
            FadingLawConfig::Rician(rician) => {
                let k_db = SettingError::in_range("law.rician.k_db", rician.k_db, -20.0, 25.0)?;
                Depth::Rician { k: Db(k_db).to_factor() }
            }
            FadingLawConfig::Nakagami(nakagami) => {
                let squares = (1..=40).find(|&squares| (nakagami.m - 0.5 * f64::from(squares)).abs() < 1e-9);
                let allowed = "a multiple of 0.5 from 0.5 to 20";
                let squares = squares.ok_or_else(|| SettingError::new("law.nakagami.m", nakagami.m, allowed))?;
                Depth::Nakagami { squares }
            }
        };
        let doppler_hz = SettingError::in_range("doppler_hz", doppler_hz, 0.0, 1e6)?;
        let variation = match block_s {
            None => {
                let spread_ns = delay_spread_ns.unwrap_or(USUAL_DELAY_SPREAD_NS);
                let spread_ns = SettingError::in_range("delay_spread_ns", spread_ns, 0.0, 1e6)?;
                Variation::Waves { doppler_hz, delay_spread_s: 1e-9 * spread_ns }
            }
            Some(block_s) => {
                let other = if delay_spread_ns.is_some() { Some("delay_spread_ns") } else { None };
                let other = if doppler_hz > 0.0 { Some("doppler_hz") } else { other };
                if let Some(other) = other {
                    let remedy = "keep one of the two: blocks are drawn independently, in time and for each channel";
                    return Err(SettingError::conflict("block_s", format!("`{other}`"), remedy));
                }
                Variation::Blocks { block_s: SettingError::in_range("block_s", block_s, 1e-6, 1e9)? }
            }
        };
        Ok(Self { depth, variation })
    }
}

impl FadingLaw {
    /// Whether the gain between two stations that stand changes in time.
    #[must_use]
    pub fn changes_in_time(&self) -> bool {
        match self.variation {
            Variation::Waves { doppler_hz, .. } => doppler_hz > 0.0,
            Variation::Blocks { .. } => true,
        }
    }

    /// Whether the gain is drawn anew in blocks of time.
    #[must_use]
    pub fn is_in_blocks(&self) -> bool {
        matches!(self.variation, Variation::Blocks { .. })
    }

    /// For how long the gain hardly changes between two stations that stand (s): a tenth of the inverse of the Doppler shift,
    /// or a block; infinite if it does not change in time.
    #[must_use]
    pub fn steady_s(&self) -> f64 {
        match self.variation {
            Variation::Waves { doppler_hz, .. } => 0.1 / doppler_hz,
            Variation::Blocks { block_s } => block_s,
        }
    }

    /// In words: `Rayleigh`, `Rician, K 6 dB`, `Nakagami, m 2`.
    #[must_use]
    pub fn name(&self) -> String {
        match self.depth {
            Depth::Rician { k } if k > 0.0 => {
                format!("Rician, K {:.4} dB", Db::from_factor(k).0).replace(".0000", "")
            }
            Depth::Rician { .. } => "Rayleigh".to_owned(),
            Depth::Nakagami { squares } => format!("Nakagami, m {}", 0.5 * f64::from(squares)),
        }
    }

    /// Probability that the gain is below `gain`.
    #[must_use]
    pub fn share_below(&self, gain: Db) -> f64 {
        let factor = gain.to_factor();
        match self.depth {
            Depth::Rician { k } => rician_below(k, factor),
            Depth::Nakagami { squares } => {
                let m = 0.5 * f64::from(squares);
                gamma_below(squares, m * factor)
            }
        }
    }

    /// The gain that is hardly ever passed: as often as four standard deviations of shadowing.
    #[must_use]
    pub fn greatest_gain(&self) -> Db {
        self.quantile(1.0 - RARE)
    }

    /// The gain that a `share` of all draws is below.
    #[must_use]
    pub fn quantile(&self, share: f64) -> Db {
        let (mut low, mut high) = (-200.0, 30.0);
        for _ in 0..60 {
            let middle = f64::midpoint(low, high);
            if self.share_below(Db(middle)) < share { low = middle } else { high = middle }
        }
        Db(high)
    }

    /// Mean of `of` over all gains, in steps of 0.25 dB; fades below -50 dB count as that.
    #[must_use]
    pub fn mean_over(&self, of: impl Fn(Db) -> f64) -> f64 {
        const STEP_DB: f64 = 0.25;
        let (mut sum, mut below) = (0.0, 0.0);
        for step in -200..=60_i32 {
            let gain_db = STEP_DB * f64::from(step);
            let share = if step == 60 { 1.0 } else { self.share_below(Db(gain_db)) };
            if share > below {
                sum += (share - below) * of(Db(gain_db - 0.5 * STEP_DB));
            }
            below = share;
        }
        sum
    }

    /// Mean and standard deviation of the gain in decibels: by the trapezoidal rule from 100 dB below the mean power, where
    /// what is left out changes neither by 0.001 dB (the fades of Nakagami with m 0.5 are the deepest).
    #[must_use]
    pub fn decibels(&self) -> (f64, f64) {
        const STEP_DB: f64 = 0.01;
        let (mut mean, mut square) = (0.0, 0.0);
        let mut below = 0.0;
        for step in -10_000..=2_000_i32 {
            let gain_db = STEP_DB * f64::from(step);
            let share = self.share_below(Db(gain_db));
            let middle_db = gain_db - 0.5 * STEP_DB;
            mean += (share - below) * middle_db;
            square += (share - below) * middle_db * middle_db;
            below = share;
        }
        (mean, (square - mean * mean).max(0.0).sqrt())
    }
}

/// Probability that a Rician power with mean one is below `factor`: the scattered power times K + 1 is a gamma variable of
/// the shape 1 + J, where J has the law of Poisson with the mean K (the series of the non-central chi-square law).
fn rician_below(k: f64, factor: f64) -> f64 {
    let x = (k + 1.0) * factor;
    // The term of the series with J = j has the weight e^-K K^j / j!, and the probability 1 - e^-x sum_{i <= j} x^i / i!.
    let (mut weight, mut weights, mut sum) = (libm::exp(-k), 0.0, 0.0);
    let (mut power, mut powers) = (libm::exp(-x), 0.0);
    let mut j = 0.0;
    loop {
        powers += power;
        weights += weight;
        sum += weight * (1.0 - powers).max(0.0);
        j += 1.0;
        weight *= k / j;
        power *= x / j;
        if 1.0 - weights < 1e-15 || weight < 1e-300 || j > 4000.0 {
            return sum.clamp(0.0, 1.0);
        }
    }
}

/// Probability that a gamma variable of the shape `squares` / 2 and scale one is below `x`: by the recurrence
/// P(a + 1, x) = P(a, x) - x^a e^-x / Γ(a + 1) from P(1/2, x) = erf √x or P(1, x) = 1 - e^-x.
fn gamma_below(squares: u8, x: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    let is_odd = squares % 2 == 1;
    let mut a = if is_odd { 0.5 } else { 1.0 };
    let mut below = if is_odd { libm::erf(x.sqrt()) } else { -libm::expm1(-x) };
    while a < 0.5 * f64::from(squares) - 0.25 {
        below -= libm::exp(a * libm::log(x) - x - libm::lgamma(a + 1.0));
        a += 1.0;
    }
    below.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::super::config::{NakagamiConfig, RicianConfig};
    use super::*;

    fn rician(k_db: f64) -> FadingLaw {
        let law = FadingLawConfig::Rician(RicianConfig { k_db });
        FadingConfig { law, ..FadingConfig::default() }.try_into().unwrap()
    }

    fn nakagami(m: f64) -> Result<FadingLaw, SettingError> {
        FadingConfig { law: FadingLawConfig::Nakagami(NakagamiConfig { m }), ..FadingConfig::default() }.try_into()
    }

    /// By numerical integration of the density of the amplitude in another program, to the digits that are written.
    #[test]
    fn the_depth_of_fades_is_that_of_rayleigh_and_rice() {
        let rayleigh = FadingLaw::try_from(FadingConfig::default()).unwrap();
        let margins_db = [0.0, 3.0, 6.0, 10.0, 15.0, 20.0];
        let cases = [
            (rayleigh, [0.632, 0.394, 0.222, 0.0952, 0.0311, 0.00995], [-2.50, 5.56]),
            (rician(0.0), [0.606, 0.346, 0.182, 0.0733, 0.0233, 0.00736], [-2.06, 5.10]),
            (rician(3.0), [0.585, 0.291, 0.132, 0.0462, 0.0135, 0.00413], [-1.55, 4.39]),
            (rician(6.0), [0.565, 0.214, 0.0689, 0.0165, 0.00364, 0.00100], [-0.96, 3.28]),
            (rician(10.0), [0.543, 0.0998, 0.0114, 7.4e-4, 5.2e-5, 7.8e-6], [-0.41, 2.00]),
        ];
        for (law, shares, [mean_db, sd_db]) in cases {
            for (margin_db, expected) in margins_db.into_iter().zip(shares) {
                let found = law.share_below(Db(-margin_db));
                assert!((found / expected - 1.0).abs() < 0.008, "{}: {margin_db} dB {found}", law.name());
            }
            let (mean, sd) = law.decibels();
            assert!((mean - mean_db).abs() < 0.011 && (sd - sd_db).abs() < 0.016, "{}: {mean} {sd}", law.name());
        }
        // Closed forms of Rayleigh: -10 γ / ln 10 and 10 π / (√6 ln 10).
        let (mean, sd) = rayleigh.decibels();
        assert!((mean + 2.506_82).abs() < 1e-4 && (sd - 5.570_05).abs() < 1e-3, "{mean} {sd}");
    }

    #[test]
    fn nakagami_with_m_one_is_rayleigh_and_with_a_half_the_square_of_a_normal_number() {
        let rayleigh = FadingLaw::try_from(FadingConfig::default()).unwrap();
        for gain_db in [-30.0, -10.0, -1.0, 3.0, 9.0] {
            let one = nakagami(1.0).unwrap().share_below(Db(gain_db));
            assert!((one - rayleigh.share_below(Db(gain_db))).abs() < 1e-12);
            let half = nakagami(0.5).unwrap().share_below(Db(gain_db));
            let root = Db(gain_db).to_factor().sqrt();
            assert!((half - libm::erf(root / std::f64::consts::SQRT_2)).abs() < 1e-12);
        }
        // Γ(2, 1/2) and Γ(3/2, 2/3) below one, by hand: 1 - 3 e^-2 and erf √1.5 - 2 √(1.5/π) e^-1.5.
        assert!((nakagami(2.0).unwrap().share_below(Db(0.0)) - (1.0 - 3.0 * (-2.0_f64).exp())).abs() < 1e-12);
        let expected = libm::erf(1.5_f64.sqrt()) - 2.0 * (1.5 / std::f64::consts::PI).sqrt() * (-1.5_f64).exp();
        assert!((nakagami(1.5).unwrap().share_below(Db(0.0)) - expected).abs() < 1e-12);
        assert_eq!(
            nakagami(1.2).unwrap_err().to_string(),
            "`law.nakagami.m` is 1.2; allowed: a multiple of 0.5 from 0.5 to 20"
        );
    }

    #[test]
    fn blocks_have_no_doppler_shift_and_no_delays() {
        let blocks = FadingConfig { block_s: Some(0.1), ..FadingConfig::default() };
        assert!(FadingLaw::try_from(blocks).unwrap().changes_in_time());
        for config in
            [FadingConfig { doppler_hz: 1.0, ..blocks }, FadingConfig { delay_spread_ns: Some(30.0), ..blocks }]
        {
            let error = FadingLaw::try_from(config).unwrap_err().to_string();
            assert!(error.contains("block_s") && error.contains("keep one of the two"), "{error}");
        }
        let greatest = FadingLaw::try_from(FadingConfig::default()).unwrap().greatest_gain();
        assert!((greatest.0 - 10.154).abs() < 0.001, "{greatest:?}");
    }
}
