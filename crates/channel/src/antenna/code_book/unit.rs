//! The unit of measured gains, and gains that look as if they had another one.

use super::Flaw;

/// The unit of measured gains: the column of a file that has them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Unit {
    /// Decibels over an isotropic antenna.
    #[default]
    Dbi,
    /// Decibels over something that is not known.
    Relative,
    /// Power over that of an isotropic antenna, as a factor.
    Linear,
}

/// Fewer gains than this tell nothing about their unit.
const FEWEST: usize = 16;
/// Antennas of stations have no greater gain (dBi).
const GREATEST_DBI: f64 = 50.0;

impl Unit {
    /// The units by their columns.
    pub(super) const COLUMNS: [(&'static str, Self); 3] =
        [("gain_dbi", Self::Dbi), ("gain_db", Self::Relative), ("gain_linear", Self::Linear)];

    /// The gain in decibels of a number; `None` if it is none of this unit.
    pub(super) fn decibels(self, value: f64) -> Option<f64> {
        match self {
            Self::Dbi | Self::Relative => (-200.0..=200.0).contains(&value).then_some(value),
            // A power of zero is as low as a measurement can be.
            Self::Linear => (0.0..=1e10).contains(&value).then(|| (10.0 * libm::log10(value)).max(LOWEST_DB)),
        }
    }

    /// The numbers that it allows, in words.
    pub(super) const fn allowed(self) -> &'static str {
        match self {
            Self::Dbi | Self::Relative => "decibels from -200 to 200, or `nan` for a gap",
            Self::Linear => "a factor from 0 to 1e10, or `nan` for a gap; decibels stand in `gain_dbi`",
        }
    }
}

/// What a power of zero counts as (dB).
const LOWEST_DB: f64 = -200.0;

/// Whether gains look like factors and not like decibels. A pattern in dBi has negative values: its mean power is at most
/// that of an isotropic antenna. Factors have none: they are all at most 1, or most are below a tenth of the greatest, or one
/// is greater than any antenna's gain in dBi. Gaps (not a number) do not count; a few gains tell nothing.
#[must_use]
pub fn look_like_factors(gains: impl Iterator<Item = f64>) -> bool {
    let mut gains: Vec<f64> = gains.filter(|gain| !gain.is_nan()).collect();
    if gains.len() < FEWEST {
        return false;
    }
    gains.sort_by(f64::total_cmp);
    let (least, median, greatest) = (gains[0], gains[gains.len() / 2], gains[gains.len() - 1]);
    let is_flat = greatest - least < 1e-9;
    least >= 0.0 && !is_flat && (greatest <= 1.0 || median <= 0.1 * greatest || greatest > GREATEST_DBI)
}

/// Refuses gains that are said to be in dBi and look like factors.
///
/// # Errors
/// If they do.
pub(super) fn suspect_factors(gains_dbi: impl Iterator<Item = f64> + Clone) -> Result<(), Flaw> {
    if !look_like_factors(gains_dbi.clone()) {
        return Ok(());
    }
    let (least, greatest) = gains_dbi
        .filter(|gain| !gain.is_nan())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, greatest), gain| (least.min(gain), greatest.max(gain)));
    Err(Flaw {
        found: format!(
            "gains from {least} to {greatest}, most of them small: these look like factors and not like dBi"
        ),
        allowed: "factors in a column `gain_linear`, gains in dBi in `gain_dbi`, or relative decibels in `gain_db` \
                  with the key `boresight_gain_dbi`"
            .into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The gains of a uniform array of 8 elements half a wavelength apart, of 1 in the mean (dBi).
    fn array() -> Vec<f64> {
        (0..360)
            .map(|deg| {
                let phase = std::f64::consts::PI * f64::from(deg).to_radians().sin();
                let sum = |part: fn(f64) -> f64| (0..8).map(|n| part(f64::from(n) * phase)).sum::<f64>();
                let factor = (sum(f64::cos).powi(2) + sum(f64::sin).powi(2)) / 8.0;
                (10.0 * factor.log10()).max(-40.0)
            })
            .collect()
    }

    #[test]
    fn factors_are_told_from_decibels() {
        let dbi = array();
        let factors: Vec<f64> = dbi.iter().map(|dbi| 10.0_f64.powf(dbi / 10.0)).collect();
        let refused = |gains: &[f64]| suspect_factors(gains.iter().copied()).is_err();
        assert!(!refused(&dbi) && refused(&factors));
        let greatest = factors.iter().copied().fold(0.0, f64::max);
        assert!(refused(&factors.iter().map(|factor| factor / greatest).collect::<Vec<_>>()), "normalised");
        assert!(refused(&factors.iter().map(|factor| 1e3 * factor).collect::<Vec<_>>()), "a large antenna");
        // Signal-to-noise ratios in decibels over a floor of 3 dB, and an antenna without sectors.
        assert!(!refused(&dbi.iter().map(|dbi| (dbi + 12.0).max(3.0)).collect::<Vec<_>>()));
        assert!(!refused(&[0.0; 40]) && !refused(&[0.1, 0.2, 5.0]));
    }

    #[test]
    fn numbers_become_decibels_of_their_unit() {
        assert_eq!(Unit::Dbi.decibels(3.0), Some(3.0));
        assert!((Unit::Linear.decibels(100.0).unwrap() - 20.0).abs() < 1e-12);
        assert_eq!(Unit::Linear.decibels(0.0), Some(-200.0));
        assert_eq!((Unit::Linear.decibels(-1.0), Unit::Dbi.decibels(300.0)), (None, None));
    }
}
