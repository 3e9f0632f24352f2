//! Models of how a battery is discharged: linear, Peukert's law, and the kinetic model.

use serde::{Deserialize, Serialize};
use sextant_kernel::SettingError;

use super::{Charge, SECONDS_OF_AN_HOUR};

/// Over this a changing current is averaged, where a model is not linear (s).
const AVERAGED_S: f64 = 1.0;

/// How a battery is discharged, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum DischargeConfig {
    /// All of the capacity can be had at any current.
    #[default]
    Linear,
    /// Less can be had at a great current, by the law of Peukert.
    Peukert(PeukertConfig),
    /// Less can be had at a great current, and a rest gives some of it back: the kinetic battery model of Manwell and McGowan.
    Kibam(KibamConfig),
}

/// The law of Peukert, as written in a scenario. Below the rated current all of the capacity can be had, and not more.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PeukertConfig {
    /// Time in which the capacity was measured (h): the rated current is the capacity over this time.
    pub rated_h: f64,
    /// Exponent of the current, 1 to 2: 1 is linear.
    pub exponent: f64,
}

/// The kinetic battery model, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct KibamConfig {
    /// Share of the capacity that a load can have at once, above 0 and below 1; the rest is bound and follows.
    pub available_share: f64,
    /// Rate at which both come to the same level (1/min): k' = k / (c (1 - c)) of the model.
    pub rate_per_min: f64,
}

/// How a battery is discharged, checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Discharge {
    Linear,
    Peukert {
        rated_s: f64,
        exponent: f64,
    },
    /// `c` and `k'` (1/s) of the model.
    Kibam {
        c: f64,
        k: f64,
    },
}

impl TryFrom<DischargeConfig> for Discharge {
    type Error = SettingError;

    fn try_from(config: DischargeConfig) -> Result<Self, SettingError> {
        match config {
            DischargeConfig::Linear => Ok(Self::Linear),
            DischargeConfig::Peukert(PeukertConfig { rated_h, exponent }) => {
                let within = |error: SettingError| error.within("peukert");
                let rated_h = SettingError::positive("rated_h", rated_h).map_err(within)?;
                let exponent = SettingError::in_range("exponent", exponent, 1.0, 2.0).map_err(within)?;
                Ok(Self::Peukert { rated_s: rated_h * SECONDS_OF_AN_HOUR, exponent })
            }
            DischargeConfig::Kibam(KibamConfig { available_share, rate_per_min }) => {
                let within = |error: SettingError| error.within("kibam");
                if !(available_share > 0.0 && available_share < 1.0) {
                    let error = SettingError::new("available_share", available_share, "above 0 and below 1");
                    return Err(within(error));
                }
                let rate_per_min = SettingError::positive("rate_per_min", rate_per_min).map_err(within)?;
                Ok(Self::Kibam { c: available_share, k: rate_per_min / 60.0 })
            }
        }
    }
}

impl Discharge {
    /// What is in a full battery.
    pub(super) fn full(self, capacity_c: f64) -> Charge {
        match self {
            Self::Linear | Self::Peukert { .. } => Charge::new(capacity_c, 0.0),
            Self::Kibam { c, .. } => Charge::new(c * capacity_c, (1.0 - c) * capacity_c),
        }
    }

    /// Rate at which a current takes charge away (A). By Peukert's law, T = H (C / (I H))^k: C / T = I (I H / C)^(k - 1), but
    /// not less than I.
    pub(super) fn drain_a(self, capacity_c: f64, current_a: f64) -> f64 {
        match self {
            Self::Peukert { rated_s, exponent } if current_a * rated_s > capacity_c => {
                current_a * libm::pow(current_a * rated_s / capacity_c, exponent - 1.0)
            }
            Self::Linear | Self::Peukert { .. } | Self::Kibam { .. } => current_a,
        }
    }

    /// What is left after `span_s` with a constant current.
    pub(super) fn after(
        self,
        capacity_c: f64,
        leak_per_s: f64,
        charge: &Charge,
        current_a: f64,
        span_s: f64,
    ) -> Charge {
        match self {
            Self::Linear | Self::Peukert { .. } => {
                // dq/dt = -I - s q.
                let drain_a = self.drain_a(capacity_c, current_a);
                let lost = -libm::expm1(-leak_per_s * span_s);
                // (1 - exp(-s t)) / s, which is t without self-discharge.
                let effective_s = if leak_per_s > 0.0 { lost / leak_per_s } else { span_s };
                Charge::new(charge.available_c() * (1.0 - lost) - drain_a * effective_s, 0.0)
            }
            Self::Kibam { c, k } => kinetic(charge, c, k, current_a, span_s),
        }
    }

    /// How long a full battery lasts with a constant current above zero (s).
    pub(super) fn lifetime_s(self, capacity_c: f64, leak_per_s: f64, current_a: f64) -> f64 {
        let longest_s = capacity_c / self.drain_a(capacity_c, current_a);
        match self {
            Self::Linear | Self::Peukert { .. } if leak_per_s > 0.0 => {
                libm::log1p(leak_per_s * longest_s) / leak_per_s
            }
            Self::Linear | Self::Peukert { .. } => longest_s,
            Self::Kibam { c, k } => {
                // What is available falls all the time, and is gone at the latest with the whole.
                let full = self.full(capacity_c);
                let (mut low_s, mut high_s) = (0.0, longest_s);
                while high_s - low_s > 1e-12 * longest_s {
                    let middle_s = 0.5 * (low_s + high_s);
                    if kinetic(&full, c, k, current_a, middle_s).is_empty() {
                        high_s = middle_s;
                    } else {
                        low_s = middle_s;
                    }
                }
                0.5 * (low_s + high_s)
            }
        }
    }

    /// The longest time over which a changing current may be averaged (s).
    pub(super) const fn averaged_s(self) -> f64 {
        match self {
            Self::Linear => f64::INFINITY,
            Self::Peukert { .. } | Self::Kibam { .. } => AVERAGED_S,
        }
    }
}

/// The kinetic battery model (Manwell and McGowan 1993; Jongerden and Haverkort 2009, equation 3): y1 available and y2 bound
/// after `t` with a constant current `i`, with k = k'.
fn kinetic(charge: &Charge, c: f64, k: f64, i: f64, t: f64) -> Charge {
    let (y1, y2) = (charge.available_c(), charge.bound_c());
    let y0 = y1 + y2;
    let e = libm::exp(-k * t);
    let gone = -libm::expm1(-k * t);
    // k t - 1 + exp(-k t)
    let ramp = k * t - gone;
    let available_c = y1 * e + (y0 * k * c - i) * gone / k - i * c * ramp / k;
    let bound_c = y2 * e + y0 * (1.0 - c) * gone - i * (1.0 - c) * ramp / k;
    Charge::new(available_c, bound_c)
}
