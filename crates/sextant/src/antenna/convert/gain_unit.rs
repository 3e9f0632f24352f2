//! The unit of measured gains.

/// The unit of measured gains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GainUnit {
    /// Decibels over an isotropic antenna.
    Dbi,
    /// Decibels in relative units: signal-to-noise ratios, powers.
    Relative,
    /// Power as a factor.
    Linear,
}

impl GainUnit {
    /// The word for it.
    pub(super) const fn word(self) -> &'static str {
        match self {
            Self::Dbi => "dbi",
            Self::Relative => "db",
            Self::Linear => "linear",
        }
    }

    /// Whether a code book may have this gain, which is a number.
    pub(super) fn has(self, gain: f64) -> bool {
        match self {
            Self::Dbi | Self::Relative => (-200.0..=200.0).contains(&gain),
            Self::Linear => (0.0..=1e10).contains(&gain),
        }
    }

    /// The gains that a code book may have, in words.
    pub(super) const fn allowed(self) -> &'static str {
        match self {
            Self::Dbi | Self::Relative => "-200 to 200 dB, or `nan` for a gap",
            Self::Linear => "factors from 0 to 1e10, or `nan` for a gap",
        }
    }

    /// The column of a code book with gains of this unit.
    #[must_use]
    pub fn column(self) -> &'static str {
        match self {
            Self::Dbi => "gain_dbi",
            Self::Relative => "gain_db",
            Self::Linear => "gain_linear",
        }
    }
}
