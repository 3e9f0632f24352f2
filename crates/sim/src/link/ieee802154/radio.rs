//! The radios of the stations: transmit power, sensitivity, threshold of carrier sense, noise.

use sextant_channel::{Db, Dbm};
use sextant_kernel::{NodeId, Seed, SettingError};
use sextant_mac::{Phy, oqpsk};

use super::clock::Clock;
use crate::link::config::RadioConfig;
use crate::purpose;
use crate::service::network_id::NetworkId;

/// Threshold of carrier sense above the sensitivity (IEEE 802.15.4-2006, 6.9.9: at most 10 dB).
const CCA_MARGIN: Db = Db(10.0);

/// Largest deviation of a clock (millionths).
const WORST_CLOCK_PPM: f64 = 1000.0;

/// The radios of all stations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radio {
    phy: Phy,
    channel: u8,
    tx_power: Dbm,
    sensitivity: Dbm,
    cca_threshold: Dbm,
    noise_floor: Dbm,
    clock_ppm: f64,
}

impl TryFrom<RadioConfig> for Radio {
    type Error = SettingError;

    fn try_from(config: RadioConfig) -> Result<Self, SettingError> {
        let (phy, channels) = (config.phy, config.phy.channels());
        let channel = config.channel.unwrap_or(*channels.start());
        if !channels.contains(&channel) {
            let allowed = format!("{} to {} with this `phy`", channels.start(), channels.end());
            return Err(SettingError::new("channel", channel, allowed));
        }
        let level = |key, dbm| SettingError::in_range(key, dbm, -200.0, 100.0).map(Dbm);
        let tx_power = level("tx_power_dbm", config.tx_power_dbm)?;
        let sensitivity = level("sensitivity_dbm", config.sensitivity_dbm)?;
        let cca_threshold = match config.cca_threshold_dbm {
            Some(dbm) => level("cca_threshold_dbm", dbm)?,
            None => sensitivity + CCA_MARGIN,
        };
        let noise_floor = match config.noise_floor_dbm {
            Some(dbm) => level("noise_floor_dbm", dbm)?,
            None => oqpsk::noise_floor(sensitivity),
        };
        let clock_ppm = SettingError::in_range("clock_ppm", config.clock_ppm, 0.0, WORST_CLOCK_PPM)?;
        Ok(Self { phy, channel, tx_power, sensitivity, cca_threshold, noise_floor, clock_ppm })
    }
}

impl Radio {
    /// The physical layer.
    #[must_use]
    pub fn phy(&self) -> Phy {
        self.phy
    }

    /// Number of the radio channel.
    #[must_use]
    pub fn channel(&self) -> u8 {
        self.channel
    }

    /// Transmit power at the reference distance.
    #[must_use]
    pub fn tx_power(&self) -> Dbm {
        self.tx_power
    }

    /// Minimum power of a frame that can be received.
    #[must_use]
    pub fn sensitivity(&self) -> Dbm {
        self.sensitivity
    }

    /// Power at or above which carrier sense finds the channel busy.
    #[must_use]
    pub fn cca_threshold(&self) -> Dbm {
        self.cca_threshold
    }

    /// Noise in the bandwidth of the receiver.
    #[must_use]
    pub fn noise_floor(&self) -> Dbm {
        self.noise_floor
    }

    /// Largest deviation of the clocks of nodes (millionths).
    #[must_use]
    pub fn clock_ppm(&self) -> f64 {
        self.clock_ppm
    }

    /// The clock of a node.
    pub(crate) fn clock(&self, seed: Seed, network: NetworkId, node: NodeId) -> Clock {
        let draw = seed.uniform(purpose::CLOCK, [node.0.into(), network.0.into(), 0]);
        Clock::fast_by(self.clock_ppm * (2.0 * draw - 1.0))
    }
}
