//! Settings of CSMA-CA.

use serde::{Deserialize, Serialize};
use sextant_kernel::SettingError;

use crate::RadioState;

/// Longest transmit queue (frames).
const MAX_QUEUE_FRAMES: u16 = 10_000;

/// Unslotted CSMA-CA of IEEE 802.15.4, as written in a scenario. Defaults are the standard's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct CsmaConfig {
    /// First backoff exponent (macMinBE): 0 to max_be.
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 8)))]
    pub min_be: u8,
    /// Largest backoff exponent (macMaxBE): 3 to 8.
    #[cfg_attr(feature = "schema", schemars(range(min = 3, max = 8)))]
    pub max_be: u8,
    /// Further backoffs after the first busy channel, before the frame is given up (macMaxCSMABackoffs): 0 to 5.
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 5)))]
    pub max_backoffs: u8,
    /// Further transmissions of a frame without acknowledgement (macMaxFrameRetries): 0 to 7.
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 7)))]
    pub max_retries: u8,
    /// Whether the receiver stays on between frames and during backoff (macRxOnWhenIdle).
    pub rx_on_when_idle: bool,
    /// Frames that wait while another one is under way; one more is lost: 0 to 10000.
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 10000)))]
    pub queue_frames: u16,
    /// Whether the way from idle to receiving takes one turnaround (12 symbols) before each assessment of the channel and
    /// the way back as long, in time and in energy. Otherwise the radio turns around in the last part of its backoff, which
    /// takes energy and no time, and is idle again at once. Without effect with `rx_on_when_idle`.
    pub idle_turnarounds: bool,
    /// Whether the radio sleeps as long as there is no frame to send; otherwise it is idle then. Waking up takes no time.
    /// Not with `rx_on_when_idle`.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub sleep_between_frames: bool,
}

impl Default for CsmaConfig {
    fn default() -> Self {
        Self {
            min_be: 3,
            max_be: 5,
            max_backoffs: 4,
            max_retries: 3,
            rx_on_when_idle: false,
            queue_frames: 0,
            idle_turnarounds: false,
            sleep_between_frames: false,
        }
    }
}

/// Unslotted CSMA-CA, settings checked (IEEE 802.15.4-2006, table 86).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CsmaSettings {
    min_be: u8,
    max_be: u8,
    max_backoffs: u8,
    max_retries: u8,
    rest: Rest,
    queue_frames: u16,
    idle_turnarounds: bool,
}

/// What the radio does while the channel access does nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Rest {
    /// Its receiver is on.
    Listening,
    /// It is idle.
    Idle,
    /// It is idle during backoff, and sleeps without a frame.
    Asleep,
}

impl CsmaSettings {
    /// First backoff exponent.
    #[must_use]
    pub const fn min_be(&self) -> u8 {
        self.min_be
    }

    /// Largest backoff exponent.
    #[must_use]
    pub const fn max_be(&self) -> u8 {
        self.max_be
    }

    /// Number of busy channels that are tolerated; one more ends the frame.
    #[must_use]
    pub const fn max_backoffs(&self) -> u8 {
        self.max_backoffs
    }

    /// Number of transmissions after the first.
    #[must_use]
    pub const fn max_retries(&self) -> u8 {
        self.max_retries
    }

    /// Number of frames that wait while another one is under way.
    #[must_use]
    pub const fn queue_frames(&self) -> u16 {
        self.queue_frames
    }

    /// Whether the radio takes one turnaround from idle to receiving, and back.
    #[must_use]
    pub const fn has_idle_turnarounds(&self) -> bool {
        self.idle_turnarounds && !matches!(self.rest, Rest::Listening)
    }

    /// The same, with the receiver on between frames and during backoff.
    #[must_use]
    pub const fn with_receiver_on(self) -> Self {
        Self { rest: Rest::Listening, ..self }
    }

    /// State of the radio as long as there is no frame to send.
    #[must_use]
    pub const fn state_without_frame(&self) -> RadioState {
        match self.rest {
            Rest::Listening => RadioState::Receive,
            Rest::Idle => RadioState::Idle,
            Rest::Asleep => RadioState::Sleep,
        }
    }

    /// State of the radio between commands for a frame, as during backoff.
    #[must_use]
    pub const fn resting_state(&self) -> RadioState {
        match self.rest {
            Rest::Listening => RadioState::Receive,
            Rest::Idle | Rest::Asleep => RadioState::Idle,
        }
    }
}

impl Default for CsmaSettings {
    /// The defaults of the standard, receiver off between frames.
    fn default() -> Self {
        Self {
            min_be: 3,
            max_be: 5,
            max_backoffs: 4,
            max_retries: 3,
            rest: Rest::Idle,
            queue_frames: 0,
            idle_turnarounds: false,
        }
    }
}

impl TryFrom<CsmaConfig> for CsmaSettings {
    type Error = SettingError;

    fn try_from(config: CsmaConfig) -> Result<Self, SettingError> {
        let CsmaConfig { min_be, max_be, max_backoffs, max_retries, rx_on_when_idle, .. } = config;
        let CsmaConfig { queue_frames, idle_turnarounds, sleep_between_frames, .. } = config;
        if sleep_between_frames && rx_on_when_idle {
            let remedy = "set one of them: a receiver that sleeps is not on";
            return Err(SettingError::conflict("sleep_between_frames", "`rx_on_when_idle`", remedy));
        }
        let rest = match (rx_on_when_idle, sleep_between_frames) {
            (true, _) => Rest::Listening,
            (false, true) => Rest::Asleep,
            (false, false) => Rest::Idle,
        };
        if queue_frames > MAX_QUEUE_FRAMES {
            return Err(SettingError::new("queue_frames", queue_frames, format!("0 to {MAX_QUEUE_FRAMES}")));
        }
        let max_be = within("max_be", max_be, 3, 8)?;
        if min_be > max_be {
            return Err(SettingError::new("min_be", min_be, format!("0 to max_be, which is {max_be}")));
        }
        Ok(Self {
            min_be,
            max_be,
            max_backoffs: within("max_backoffs", max_backoffs, 0, 5)?,
            max_retries: within("max_retries", max_retries, 0, 7)?,
            rest,
            queue_frames,
            idle_turnarounds,
        })
    }
}

fn within(key: &str, value: u8, low: u8, high: u8) -> Result<u8, SettingError> {
    if (low..=high).contains(&value) {
        Ok(value)
    } else {
        Err(SettingError::new(key, value, format!("{low} to {high}")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_defaults_as_written_are_the_defaults_as_used() {
        assert_eq!(CsmaSettings::try_from(CsmaConfig::default()), Ok(CsmaSettings::default()));
    }

    #[test]
    fn settings_outside_the_range_of_the_standard_are_rejected() {
        let good = CsmaConfig::default();
        let key = |config: CsmaConfig| CsmaSettings::try_from(config).err().map(|error| error.key);
        assert_eq!(key(CsmaConfig { min_be: 6, ..good }).as_deref(), Some("min_be"));
        assert_eq!(key(CsmaConfig { max_be: 2, ..good }).as_deref(), Some("max_be"));
        assert_eq!(key(CsmaConfig { max_be: 9, ..good }).as_deref(), Some("max_be"));
        assert_eq!(key(CsmaConfig { max_backoffs: 6, ..good }).as_deref(), Some("max_backoffs"));
        assert_eq!(key(CsmaConfig { queue_frames: 10_001, ..good }).as_deref(), Some("queue_frames"));
        assert_eq!(key(CsmaConfig { max_retries: 8, ..good }).as_deref(), Some("max_retries"));
        let sleeping = CsmaConfig { sleep_between_frames: true, ..good };
        assert_eq!(key(sleeping), None);
        assert_eq!(key(CsmaConfig { rx_on_when_idle: true, ..sleeping }).as_deref(), Some("sleep_between_frames"));
        assert_eq!(
            key(CsmaConfig { min_be: 0, max_be: 8, max_backoffs: 5, max_retries: 7, queue_frames: 10_000, ..good }),
            None
        );
    }
}
