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
