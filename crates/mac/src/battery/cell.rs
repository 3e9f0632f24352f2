//! Cells by name.

use serde::{Deserialize, Serialize};

/// A cell, or a pair of cells, as written in a scenario. Typical numbers, from memory and not checked against data sheets: give
/// your own if you have them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Cell {
    /// Two alkaline cells of size AA in series: 2500 mAh at 3 V.
    AaAlkalinePair,
    /// A coin cell CR2032: 225 mAh at 3 V.
    Cr2032,
    /// A lithium thionyl chloride cell of size AA: 2400 mAh at 3.6 V, with 1 % of self-discharge a year.
    AaLithiumThionyl,
}

impl Cell {
    pub(super) const fn capacity_mah(self) -> f64 {
        match self {
            Self::AaAlkalinePair => 2500.0,
            Self::Cr2032 => 225.0,
            Self::AaLithiumThionyl => 2400.0,
        }
    }

    pub(super) const fn voltage_v(self) -> f64 {
        match self {
            Self::AaAlkalinePair | Self::Cr2032 => 3.0,
            Self::AaLithiumThionyl => 3.6,
        }
    }

    pub(super) const fn self_discharge_per_year(self) -> f64 {
        match self {
            Self::AaAlkalinePair | Self::Cr2032 => 0.0,
            Self::AaLithiumThionyl => 0.01,
        }
    }
}
