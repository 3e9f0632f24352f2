//! Access categories of the enhanced distributed channel access (IEEE 802.11-2012, 9.19.2; table 8-106).

use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::timing::{SIFS, SLOT};

/// Access category: how long a station waits for an idle channel before it counts its backoff, and how long that is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum AccessCategory {
    /// AC_BK: AIFS 38 us, contention window 15 to 1023.
    Background,
    /// AC_BE: AIFS 18 us, contention window 15 to 1023.
    #[default]
    BestEffort,
    /// AC_VI: AIFS 13 us, contention window 7 to 15.
    Video,
    /// AC_VO: AIFS 13 us, contention window 3 to 7.
    Voice,
}

impl AccessCategory {
    /// Every category.
    pub const ALL: [Self; 4] = [Self::Background, Self::BestEffort, Self::Video, Self::Voice];

    /// First contention window: the backoff is drawn from 0 to this number of slots.
    #[must_use]
    pub(crate) const fn cw_min(self) -> u32 {
        match self {
            Self::Background | Self::BestEffort => 15,
            Self::Video => 7,
            Self::Voice => 3,
        }
    }

    /// Largest contention window.
    #[must_use]
    pub(crate) const fn cw_max(self) -> u32 {
        match self {
            Self::Background | Self::BestEffort => 1023,
            Self::Video => 15,
            Self::Voice => 7,
        }
    }

    /// The contention window after a failure with window `cw`.
    #[must_use]
    pub fn widened(self, cw: u32) -> u32 {
        (2 * cw + 1).min(self.cw_max())
    }

    /// Arbitration interframe space: SIFS and 2, 3 or 7 slots.
    #[must_use]
    pub(crate) fn aifs(self) -> Duration {
        let slots = match self {
            Self::Background => 7,
            Self::BestEffort => 3,
            Self::Video | Self::Voice => 2,
        };
        SIFS + SLOT * slots
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn categories_have_the_values_of_the_standard() {
        let found = AccessCategory::ALL.map(|ac| (ac.cw_min(), ac.cw_max(), ac.aifs().as_micros()));
        assert_eq!(found, [(15, 1023, 38), (15, 1023, 18), (7, 15, 13), (3, 7, 13)]);
    }

    #[test]
    fn the_contention_window_doubles_up_to_its_maximum() {
        let windows = |ac: AccessCategory| {
            std::iter::successors(Some(ac.cw_min()), |&cw| Some(ac.widened(cw))).take(8).collect::<Vec<_>>()
        };
        assert_eq!(windows(AccessCategory::BestEffort), [15, 31, 63, 127, 255, 511, 1023, 1023]);
        assert_eq!(windows(AccessCategory::Voice)[..3], [3, 7, 7]);
    }
}
