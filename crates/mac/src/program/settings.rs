//! Settings of radios that programs command.

use std::time::Duration;

use serde::{Deserialize, Serialize};
use sextant_kernel::SettingError;

use crate::timing::Phy;

/// Longest time that a radio may need to wake up (us): one second.
const LONGEST_WAKE_UP_US: f64 = 1e6;

/// Radios that the programs of the stations command themselves, as written in a scenario.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ProgramConfig {
    /// Numbers of further radio channels to which programs may tune; `radio.channel` is the first one, and needs not be
    /// named. None if absent.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = [])))]
    pub channels: Vec<u8>,
    /// Time from off to idle, to receiving or to the first symbol of a frame (us), with the current of the receiver except
    /// on the way to idle; that of a turnaround (12 symbols) if absent, and not less. A CC2420 takes about 860 us.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wake_up_us: Option<f64>,
}

/// Radios that programs command, settings checked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProgramSettings {
    channels: Vec<u8>,
    wake_up: Duration,
}

impl ProgramSettings {
    /// The settings of radios with this physical layer that begin on the channel `first`.
    ///
    /// # Errors
    /// If a channel is not one of the physical layer or is named twice, or the time to wake up is shorter than a turnaround or
    /// longer than a second.
    pub fn new(config: ProgramConfig, phy: Phy, first: u8) -> Result<Self, SettingError> {
        let ProgramConfig { channels, wake_up_us } = config;
        let allowed = phy.channels();
        for (i, &channel) in channels.iter().enumerate() {
            let key = || format!("channels[{i}]");
            if !allowed.contains(&channel) {
                let allowed = format!("{} to {} with this `phy`", allowed.start(), allowed.end());
                return Err(SettingError::new(key(), channel, allowed));
            }
            if channel == first || channels[..i].contains(&channel) {
                let found = format!("{channel}, which is named before");
                return Err(SettingError::new(key(), found, "each channel once; `radio.channel` is one of them"));
            }
        }
        let turnaround_us = phy.turnaround().as_secs_f64() * 1e6;
        let wake_up = match wake_up_us {
            None => phy.turnaround(),
            Some(us) => {
                let us = SettingError::in_range("wake_up_us", us, turnaround_us, LONGEST_WAKE_UP_US)?;
                // Not less than a turnaround by rounding.
                phy.turnaround().max(Duration::from_secs_f64(us * 1e-6))
            }
        };
        let channels = std::iter::once(first).chain(channels).collect();
        Ok(Self { channels, wake_up })
    }

    /// The channels to which programs may tune, the first one first.
    #[must_use]
    pub fn channels(&self) -> &[u8] {
        &self.channels
    }

    /// Time from off to idle, to receiving or to the first symbol of a frame.
    #[must_use]
    pub const fn wake_up(&self) -> Duration {
        self.wake_up
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PHY: Phy = Phy::Oqpsk2450;

    fn settings(channels: &[u8], wake_up_us: Option<f64>) -> Result<ProgramSettings, SettingError> {
        ProgramSettings::new(ProgramConfig { channels: channels.to_vec(), wake_up_us }, PHY, 11)
    }

    #[test]
    fn the_first_channel_is_that_of_the_radio_and_waking_up_takes_a_turnaround() {
        let settings = settings(&[], None).expect("the defaults are good");
        assert_eq!((settings.channels(), settings.wake_up()), (&[11][..], Duration::from_micros(192)));
    }

    #[test]
    fn channels_and_times_are_taken_as_written() {
        let settings = settings(&[26, 15], Some(860.0)).expect("good settings");
        assert_eq!((settings.channels(), settings.wake_up()), (&[11, 26, 15][..], Duration::from_micros(860)));
    }

    #[test]
    fn settings_that_no_radio_has_are_rejected() {
        let key = |channels: &[u8], wake_up_us| settings(channels, wake_up_us).err().map(|error| error.key);
        assert_eq!(key(&[27], None).as_deref(), Some("channels[0]"));
        assert_eq!(key(&[12, 10], None).as_deref(), Some("channels[1]"));
        assert_eq!(key(&[11], None).as_deref(), Some("channels[0]"));
        assert_eq!(key(&[12, 13, 12], None).as_deref(), Some("channels[2]"));
        for bad in [191.9, 1_000_001.0, f64::NAN, -1.0] {
            assert_eq!(key(&[], Some(bad)).as_deref(), Some("wake_up_us"), "{bad}");
        }
        assert_eq!(key(&[12], Some(192.0)), None);
    }
}
