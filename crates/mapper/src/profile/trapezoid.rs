//! The trapezoid: a constant probability near the node, then a straight line down to 0.

use sextant_kernel::SettingError;

use super::limits::{ProfileLimits, above_0_to_1};

/// The trapezoid as written in a scenario.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TrapezoidConfig {
    /// Reception probability next to the node, above 0, at most 1.
    pub p0: f64,
    /// Distance up to which the probability is `p0` (m), below `range_m`.
    pub plateau_m: f64,
    /// Nothing is received at this distance or beyond (m).
    pub range_m: f64,
    /// Lowest probability of a reception, at any distance; 0 for the literal profile of the thesis.
    #[cfg_attr(feature = "config", serde(default = "super::default_floor"))]
    pub floor: f64,
    /// Highest probability of a reception, at any distance; 1 for the literal profile of the thesis.
    #[cfg_attr(feature = "config", serde(default = "super::default_ceiling"))]
    pub ceiling: f64,
}

impl TrapezoidConfig {
    /// The trapezoid with the floor 10⁻⁶ and the ceiling 1 − 10⁻⁶.
    #[must_use]
    pub fn new(p0: f64, plateau_m: f64, range_m: f64) -> Self {
        Self { p0, plateau_m, range_m, floor: super::default_floor(), ceiling: super::default_ceiling() }
    }

    /// The same trapezoid without floor and ceiling, as the thesis has it.
    #[must_use]
    pub fn literal(self) -> Self {
        Self { floor: 0.0, ceiling: 1.0, ..self }
    }
}

/// S(d) = p0 for d ≤ r, p0 (R − d)/(R − r) for r < d < R, 0 from R on (Gunathillake 2018, eq. 3.2), then
/// clamped to `[floor, ceiling]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Trapezoid {
    p0: f64,
    plateau_m: f64,
    range_m: f64,
    limits: ProfileLimits,
}

impl Trapezoid {
    /// Probability that a packet is received over `distance_m`.
    #[must_use]
    pub fn probability(&self, distance_m: f64) -> f64 {
        let Self { p0, plateau_m: r, range_m: big_r, limits } = *self;
        let s = if distance_m <= r {
            p0
        } else if distance_m >= big_r {
            0.0
        } else {
            p0 * (big_r - distance_m) / (big_r - r)
        };
        limits.clamp(s)
    }

    /// Reception probability next to the node, before the ceiling.
    #[must_use]
    pub fn p0(&self) -> f64 {
        self.p0
    }

    /// The plateau r (m).
    #[must_use]
    pub fn plateau_m(&self) -> f64 {
        self.plateau_m
    }

    /// The range R (m).
    #[must_use]
    pub fn range_m(&self) -> f64 {
        self.range_m
    }

    /// Lowest probability of a reception.
    #[must_use]
    pub fn floor(&self) -> f64 {
        self.limits.floor()
    }

    /// Highest probability of a reception.
    #[must_use]
    pub fn ceiling(&self) -> f64 {
        self.limits.ceiling()
    }
}

impl TryFrom<TrapezoidConfig> for Trapezoid {
    type Error = SettingError;

    fn try_from(config: TrapezoidConfig) -> Result<Self, SettingError> {
        let TrapezoidConfig { p0, plateau_m, range_m, floor, ceiling } = config;
        let p0 = above_0_to_1("p0", p0)?;
        SettingError::positive("range_m", range_m)?;
        SettingError::not_negative("plateau_m", plateau_m)?;
        if plateau_m >= range_m {
            return Err(SettingError::new("plateau_m", plateau_m, format!("0 to below range_m = {range_m}")));
        }
        let limits = ProfileLimits::new(floor, ceiling)?;
        if floor >= p0 {
            return Err(SettingError::new("floor", floor, format!("0 to below p0 = {p0}")));
        }
        Ok(Self { p0, plateau_m, range_m, limits })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::{ProfileConfig, ReceptionProfile};

    fn trapezoid(config: TrapezoidConfig) -> Result<Trapezoid, SettingError> {
        Trapezoid::try_from(config)
    }

    #[test]
    fn the_trapezoid_is_constant_then_linear_then_zero() {
        let s = trapezoid(TrapezoidConfig::new(0.8, 2.0, 10.0).literal()).unwrap();
        for (d, expected) in [(0.0, 0.8), (2.0, 0.8), (6.0, 0.4), (9.0, 0.1), (10.0, 0.0), (50.0, 0.0)] {
            assert!((s.probability(d) - expected).abs() < 1e-15, "S({d}) = {}", s.probability(d));
        }
    }

    #[test]
    fn floor_and_ceiling_bound_the_probability() {
        let s = trapezoid(TrapezoidConfig { floor: 0.01, ceiling: 0.9, ..TrapezoidConfig::new(1.0, 2.0, 10.0) });
        let s = s.unwrap();
        assert!((s.probability(1.0) - 0.9).abs() < 1e-15);
        assert!((s.probability(30.0) - 0.01).abs() < 1e-15);
    }

    #[test]
    fn invalid_settings_are_rejected_with_their_key() {
        let good = TrapezoidConfig::new(0.9, 2.0, 10.0);
        assert!(trapezoid(good.clone()).is_ok());
        let bad = [
            (TrapezoidConfig { p0: 0.0, ..good.clone() }, "p0"),
            (TrapezoidConfig { p0: 1.1, ..good.clone() }, "p0"),
            (TrapezoidConfig { p0: f64::NAN, ..good.clone() }, "p0"),
            (TrapezoidConfig { range_m: -1.0, ..good.clone() }, "range_m"),
            (TrapezoidConfig { range_m: f64::INFINITY, ..good.clone() }, "range_m"),
            (TrapezoidConfig { plateau_m: 10.0, ..good.clone() }, "plateau_m"),
            (TrapezoidConfig { plateau_m: -0.1, ..good.clone() }, "plateau_m"),
            (TrapezoidConfig { floor: 0.95, ..good.clone() }, "floor"),
            (TrapezoidConfig { floor: f64::NAN, ..good.clone() }, "floor"),
            (TrapezoidConfig { ceiling: 0.0, ..good.clone() }, "ceiling"),
            (TrapezoidConfig { ceiling: 1.5, ..good }, "ceiling"),
        ];
        for (config, key) in bad {
            let error = ReceptionProfile::try_from(ProfileConfig::Trapezoid(config.clone())).unwrap_err();
            assert_eq!(error.key, format!("trapezoid.{key}"), "{config:?}");
        }
    }
}
