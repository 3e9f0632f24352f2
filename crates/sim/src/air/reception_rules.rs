//! The rules of receivers.

use std::time::Duration;

use sextant_channel::Milliwatts;

use super::ReceptionModel;

/// Rules of all receivers of a simulation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ReceptionRules {
    pub(crate) model: ReceptionModel,
    pub(crate) sensitivity: Milliwatts,
    pub(crate) noise: Milliwatts,
    pub(crate) preamble: Duration,
    /// Minimum ratio of signal to interference and noise at the end of the preamble, as a factor.
    pub(crate) lock: f64,
    /// When the channel is busy, if the radios say when that changes.
    pub(crate) carrier: Option<CarrierThresholds>,
    /// Bits per second on air.
    pub(crate) bit_rate_hz: f64,
    /// Probability of a bit error by the ratio of signal to interference and noise, as a factor.
    pub(crate) bit_error_rate: fn(f64) -> f64,
}

/// From which power on the channel is busy.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CarrierThresholds {
    /// Power of one signal.
    pub(crate) signal: Milliwatts,
    /// Power of all signals together.
    pub(crate) energy: Milliwatts,
}

impl ReceptionRules {
    /// Least power at which a frame is received that no other signal disturbs; with bit errors, the least at which it may be.
    pub(crate) fn least_power(&self) -> Milliwatts {
        let over_noise = match self.model {
            ReceptionModel::Overlap => return self.sensitivity,
            ReceptionModel::SinrThreshold { least } => least.max(self.lock),
            ReceptionModel::SirThreshold { .. } | ReceptionModel::Ber => self.lock,
        };
        Milliwatts((over_noise * self.noise.0).max(self.sensitivity.0))
    }

    /// Probability that a frame of `airtime` and `power` is received if no other signal disturbs it.
    pub(crate) fn reception_alone(&self, power: Milliwatts, airtime: Duration) -> f64 {
        if power < self.least_power() {
            return 0.0;
        }
        match self.model {
            ReceptionModel::Ber => {
                let bits = airtime.saturating_sub(self.preamble).as_secs_f64() * self.bit_rate_hz;
                libm::exp(bits * libm::log1p(-(self.bit_error_rate)(power.ratio(self.noise))))
            }
            ReceptionModel::Overlap | ReceptionModel::SinrThreshold { .. } | ReceptionModel::SirThreshold { .. } => {
                1.0
            }
        }
    }
}
