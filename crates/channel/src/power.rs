//! Powers and ratios: decibels for gains and losses, milliwatts for sums of powers.

use std::iter::Sum;
use std::ops::{Add, AddAssign, Neg, Sub, SubAssign};

/// A power level (dBm). Two levels do not add: sum [`Milliwatts`] instead.
///
/// ```compile_fail
/// use sextant_channel::Dbm;
/// let _ = Dbm(-50.0) + Dbm(-60.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(transparent))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Dbm(pub f64);

/// A power ratio (dB): a gain if positive, a loss where a name says so.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(transparent))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Db(pub f64);

/// A power (mW), not negative.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Milliwatts(pub f64);

impl Dbm {
    /// No power at all.
    pub const SILENCE: Self = Self(f64::NEG_INFINITY);

    /// The power of this level.
    #[must_use]
    #[inline]
    pub fn to_milliwatts(self) -> Milliwatts {
        Milliwatts(libm::exp(self.0 * (std::f64::consts::LN_10 / 10.0)))
    }
}

impl Db {
    /// The ratio as a factor.
    #[must_use]
    pub fn to_factor(self) -> f64 {
        libm::exp(self.0 * (std::f64::consts::LN_10 / 10.0))
    }

    /// The ratio `factor` in decibels.
    #[must_use]
    pub fn from_factor(factor: f64) -> Self {
        Self(10.0 * libm::log10(factor))
    }
}

impl Milliwatts {
    /// No power at all.
    pub const ZERO: Self = Self(0.0);

    /// The level of this power; [`Dbm::SILENCE`] for zero.
    #[must_use]
    #[inline]
    pub fn to_dbm(self) -> Dbm {
        Dbm(10.0 * libm::log10(self.0))
    }

    /// The ratio to `other`, both as factors.
    #[must_use]
    #[inline]
    pub fn ratio(self, other: Self) -> f64 {
        self.0 / other.0
    }
}

impl Add<Db> for Dbm {
    type Output = Self;
    #[inline]
    fn add(self, gain: Db) -> Self {
        Self(self.0 + gain.0)
    }
}

impl Sub<Db> for Dbm {
    type Output = Self;
    #[inline]
    fn sub(self, loss: Db) -> Self {
        Self(self.0 - loss.0)
    }
}

impl Sub for Dbm {
    type Output = Db;
    #[inline]
    fn sub(self, other: Self) -> Db {
        Db(self.0 - other.0)
    }
}

impl Add for Db {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Sub for Db {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

impl Neg for Db {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Add for Milliwatts {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl AddAssign for Milliwatts {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        self.0 += other.0;
    }
}

impl SubAssign for Milliwatts {
    /// Subtracts a power that was added before; rounding never gives a negative power.
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        self.0 = (self.0 - other.0).max(0.0);
    }
}

impl Sum for Milliwatts {
    fn sum<I: Iterator<Item = Self>>(powers: I) -> Self {
        powers.fold(Self::ZERO, Add::add)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sum_of_two_equal_powers_is_three_decibels_higher() {
        let one = Dbm(-60.0).to_milliwatts();
        let gain = (one + one).to_dbm() - Dbm(-60.0);
        assert!((gain.0 - 3.010_299_956_639_812).abs() < 1e-12);
        assert_eq!(Milliwatts::ZERO.to_dbm(), Dbm::SILENCE);
        assert_eq!(Dbm::SILENCE.to_milliwatts(), Milliwatts::ZERO);
        assert!((Db::from_factor(Db(-7.25).to_factor()).0 + 7.25).abs() < 1e-12);
    }
}
