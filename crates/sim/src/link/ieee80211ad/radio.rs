//! The radios of IEEE 802.11ad: transmit power, sensitivity, noise, thresholds of carrier sense.

use sextant_channel::{Db, Dbm};
use sextant_kernel::SettingError;
use sextant_mac::Phy;

use crate::link::config::RadioConfig;
use crate::link::dmg_channel::carrier_hz;

/// Noise of 1.76 GHz at 290 K with a noise figure of 10 dB.
const NOISE_FLOOR: Dbm = Dbm(-71.5);

/// Energy of any kind counts as a busy channel at this much above the sensitivity: 20 dB above that of the lowest single
/// carrier rate (-68 dBm), which is 10 dB above that of the control PHY (IEEE 802.11ad-2012, 21.4.3.2 and 21.6.4.2).
const ENERGY_MARGIN: Db = Db(30.0);

/// The radios of all stations of a network of IEEE 802.11ad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DmgRadio {
    channel: u8,
    tx_power: Dbm,
    sensitivity: Dbm,
    cca_threshold: Dbm,
    noise_floor: Dbm,
}

impl TryFrom<RadioConfig> for DmgRadio {
    type Error = SettingError;

    fn try_from(config: RadioConfig) -> Result<Self, SettingError> {
        if config.phy != Phy::default() {
            let remedy = "remove it, because sector sweeps have the control PHY of IEEE 802.11ad";
            return Err(SettingError::conflict("phy", "`mac.sector_sweep`", remedy));
        }
        if config.clock_ppm.abs() > 0.0 || config.clock_ppm.is_nan() {
            let remedy = "remove it, because clocks are exact with sector sweeps";
            return Err(SettingError::conflict("clock_ppm", "`mac.sector_sweep`", remedy));
        }
        if !config.groups.is_empty() {
            let remedy = "remove the table, because all nodes have the same radio with sector sweeps";
            return Err(SettingError::conflict("groups", "`mac.sector_sweep`", remedy));
        }
        let channel = config.channel.unwrap_or(1);
        if !(1..=4).contains(&channel) {
            return Err(SettingError::new("channel", channel, "1 to 4 with sector sweeps"));
        }
        let level = |key, dbm| SettingError::in_range(key, dbm, -200.0, 100.0).map(Dbm);
        let sensitivity = level("sensitivity_dbm", config.sensitivity_dbm)?;
        let or = |key, dbm: Option<f64>, default| dbm.map_or(Ok(default), |dbm| level(key, dbm));
        Ok(Self {
            channel,
            tx_power: level("tx_power_dbm", config.tx_power_dbm)?,
            sensitivity,
            cca_threshold: or("cca_threshold_dbm", config.cca_threshold_dbm, sensitivity)?,
            noise_floor: or("noise_floor_dbm", config.noise_floor_dbm, NOISE_FLOOR)?,
        })
    }
}

impl DmgRadio {
    /// Number of the radio channel, 1 to 4.
    #[must_use]
    pub fn channel(&self) -> u8 {
        self.channel
    }

    /// Carrier frequency (Hz): channels are 2.16 GHz apart (IEEE 802.11ad-2012, annex E).
    #[must_use]
    pub fn carrier_hz(&self) -> f64 {
        carrier_hz(self.channel)
    }

    /// Transmit power, without the antenna.
    #[must_use]
    pub fn tx_power(&self) -> Dbm {
        self.tx_power
    }

    /// Minimum power of a frame that can be received.
    #[must_use]
    pub fn sensitivity(&self) -> Dbm {
        self.sensitivity
    }

    /// Power of a signal from which on the channel is busy.
    #[must_use]
    pub fn cca_threshold(&self) -> Dbm {
        self.cca_threshold
    }

    /// Power of all signals together from which on the channel is busy.
    #[must_use]
    pub(crate) fn energy_threshold(&self) -> Dbm {
        self.sensitivity + ENERGY_MARGIN
    }

    /// Noise in the bandwidth of the receiver.
    #[must_use]
    pub fn noise_floor(&self) -> Dbm {
        self.noise_floor
    }
}
