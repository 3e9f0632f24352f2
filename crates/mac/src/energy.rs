//! Energy of a radio: a current for each of its states.

use serde::{Deserialize, Serialize};
use sextant_channel::Dbm;
use sextant_kernel::SettingError;

use crate::timing::{Band, Phy};

/// State of a radio.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RadioState {
    /// Off, except for the part that wakes it up.
    Sleep,
    /// Oscillator on, neither receiving nor transmitting.
    Idle,
    /// Receiver on: listening, sensing the channel, receiving.
    Receive,
    /// Transmitting.
    Transmit,
    /// Changing between receiving and transmitting: deaf, with the current of the receiver.
    Turnaround,
}

impl RadioState {
    /// Its name: `sleep`, `idle`, `receive`, `transmit`, `turnaround`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sleep => "sleep",
            Self::Idle => "idle",
            Self::Receive => "receive",
            Self::Transmit => "transmit",
            Self::Turnaround => "turnaround",
        }
    }
}

/// The radio whose energy is counted, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum EnergyConfig {
    /// Texas Instruments CC2420 at 3 V, for the 2.4 GHz band.
    Cc2420,
    /// Microchip AT86RF233 at 3 V, for the 2.4 GHz band.
    At86rf233,
    /// Nordic nRF52840 at 3 V with its converter, for the 2.4 GHz band: the whole chip. Its idle current is
    /// assumed.
    Nrf52840,
    /// Texas Instruments CC2538 at 3 V, for the 2.4 GHz band: the whole chip. Typical currents, not checked against the data
    /// sheet.
    Cc2538,
    /// Microchip AT86RF212B at 3 V, for the bands at 868 and 915 MHz. It has BPSK and O-QPSK; with ASK its currents stand
    /// for a chip of these bands.
    At86rf212b,
    /// A 60 GHz radio with phased arrays: assumed powers, of no data sheet.
    #[serde(rename = "mmwave_60_ghz")]
    Mmwave60Ghz,
    /// Any other radio.
    Custom(CustomRadioConfig),
}

/// Currents of a radio, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct CustomRadioConfig {
    /// Supply voltage (V).
    pub supply_v: f64,
    /// Current while transmitting (mA), at any power.
    pub tx_ma: f64,
    /// Current while receiving or listening (mA).
    pub rx_ma: f64,
    /// Current while idle, oscillator on (mA).
    pub idle_ma: f64,
    /// Current while asleep (mA).
    pub sleep_ma: f64,
}

/// Current at a transmit power.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TxLevel {
    power: Dbm,
    current_a: f64,
}

/// Supply voltage and current of each state of a radio.
#[derive(Clone, Debug, PartialEq)]
pub struct RadioStates {
    supply_v: f64,
    /// Never empty; in order of rising power.
    tx: Vec<TxLevel>,
    rx_a: f64,
    idle_a: f64,
    sleep_a: f64,
}

impl EnergyConfig {
    /// The chip that is counted with this physical layer if none is named: one of its band.
    #[must_use]
    pub const fn usual(phy: Phy) -> Self {
        match phy.band() {
            Band::Mhz2450 => Self::Cc2420,
            Band::Mhz868 | Band::Mhz915 => Self::At86rf212b,
        }
    }

    /// The bands of the chip in words, if it is not for this physical layer; `None` if it is, or its bands are not known.
    #[must_use]
    pub const fn other_bands(self, phy: Phy) -> Option<&'static str> {
        match (self, phy.band()) {
            (Self::Cc2420 | Self::At86rf233 | Self::Nrf52840 | Self::Cc2538, Band::Mhz868 | Band::Mhz915) => {
                Some("2.4 GHz")
            }
            (Self::At86rf212b, Band::Mhz2450) => Some("868 and 915 MHz"),
            (Self::Mmwave60Ghz, _) => Some("60 GHz"),
            _ => None,
        }
    }

    /// What the chip has no number for with this physical layer, and what is taken instead; `None` if it has all.
    #[must_use]
    pub const fn gap(self, phy: Phy) -> Option<&'static str> {
        match (self, phy) {
            (Self::At86rf212b, Phy::Ask868 | Phy::Ask915) => {
                Some("has no ASK: its currents with BPSK and O-QPSK are taken")
            }
            (Self::Nrf52840, _) => Some("has no idle current in its data sheet: 0.25 mA is assumed"),
            _ => None,
        }
    }

    /// The most power with which the chip sends, if that is below `power`; `None` if it is not, or not known.
    #[must_use]
    pub fn falls_short_of(self, power: Dbm) -> Option<Dbm> {
        if matches!(self, Self::Mmwave60Ghz | Self::Custom(_)) {
            return None;
        }
        let most = RadioStates::try_from(self).ok()?.tx.last()?.power;
        Some(most).filter(|most| *most < power)
    }

    /// Its name in scenarios.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cc2420 => "cc2420",
            Self::At86rf233 => "at86rf233",
            Self::Nrf52840 => "nrf52840",
            Self::Cc2538 => "cc2538",
            Self::At86rf212b => "at86rf212b",
            Self::Mmwave60Ghz => "mmwave_60_ghz",
            Self::Custom(_) => "custom",
        }
    }
}

impl RadioStates {
    /// Texas Instruments CC2420 (data sheet SWRS041) at 3 V.
    #[must_use]
    pub fn cc2420() -> Self {
        let tx = [
            (-25.0, 8.5),
            (-15.0, 9.9),
            (-10.0, 11.2),
            (-7.0, 12.5),
            (-5.0, 13.9),
            (-3.0, 15.2),
            (-1.0, 16.5),
            (0.0, 17.4),
        ];
        Self::from_milliamperes(3.0, &tx, 18.8, 0.426, 0.020)
    }

    /// Microchip AT86RF233 (data sheet 8351) at 3 V; idle is its state TRX_OFF.
    #[must_use]
    pub(crate) fn at86rf233() -> Self {
        let tx = [(-17.0, 7.2), (-5.0, 9.8), (0.0, 11.8), (4.0, 13.8)];
        Self::from_milliamperes(3.0, &tx, 11.8, 0.3, 0.0002)
    }

    /// Nordic nRF52840 with its DC/DC converter at 3 V: the whole chip, which sends and executes code from RAM (product
    /// specification, electrical specification of the radio: 0 dBm with IEEE 802.15.4, 8 dBm with Bluetooth, receiving).
    /// Asleep, its clock runs. An idle current is not stated there: that of a crystal oscillator is assumed.
    #[must_use]
    pub(crate) fn nrf52840() -> Self {
        Self::from_milliamperes(3.0, &[(0.0, 6.40), (8.0, 16.40)], 6.53, 0.25, 0.0015)
    }

    /// Texas Instruments CC2538 at 3 V: the whole chip (typical currents of data sheet SWRS096, from memory).
    #[must_use]
    pub(crate) fn cc2538() -> Self {
        Self::from_milliamperes(3.0, &[(0.0, 24.0), (7.0, 34.0)], 20.0, 0.6, 0.0013)
    }

    /// Microchip AT86RF212B at 3 V (data sheet 42002, features: transmitting at 5 dBm, receiving, sleeping; idle is its state
    /// TRX_OFF). The current at 10 dBm is that of its predecessor AT86RF212 (data sheet 8168).
    #[must_use]
    pub fn at86rf212b() -> Self {
        Self::from_milliamperes(3.0, &[(5.0, 18.0), (10.0, 25.0)], 9.2, 0.45, 0.0002)
    }

    /// A 60 GHz radio with phased arrays that transmits with 0.6 W, receives with 0.4 W, idles with 50 mW and sleeps
    /// with 1 mW. An assumption: neither a standard nor one data sheet is behind it.
    #[must_use]
    pub fn mmwave_60_ghz() -> Self {
        // At 1 V, currents are powers.
        Self::from_milliamperes(1.0, &[(0.0, 600.0)], 400.0, 50.0, 1.0)
    }

    fn from_milliamperes(supply_v: f64, tx: &[(f64, f64)], rx: f64, idle: f64, sleep: f64) -> Self {
        let level = |&(dbm, ma): &(f64, f64)| TxLevel { power: Dbm(dbm), current_a: ma * 1e-3 };
        Self {
            supply_v,
            tx: tx.iter().map(level).collect(),
            rx_a: rx * 1e-3,
            idle_a: idle * 1e-3,
            sleep_a: sleep * 1e-3,
        }
    }

    /// Power drawn in `state` (W). Transmitting at `tx_power` uses the lowest level of the radio that
    /// reaches it, or else its highest.
    #[must_use]
    pub fn power_w(&self, state: RadioState, tx_power: Dbm) -> f64 {
        self.supply_v
            * match state {
                RadioState::Sleep => self.sleep_a,
                RadioState::Idle => self.idle_a,
                RadioState::Receive | RadioState::Turnaround => self.rx_a,
                RadioState::Transmit => self.tx_a(tx_power),
            }
    }

    /// The most that it draws in any state, transmitting at up to `tx_power` (W).
    #[must_use]
    pub fn most_w(&self, tx_power: Dbm) -> f64 {
        let tx_a = self.tx_a(tx_power);
        let lower = self.tx.iter().filter(|level| level.power <= tx_power).map(|level| level.current_a);
        self.supply_v * lower.chain([tx_a, self.rx_a, self.idle_a]).fold(self.sleep_a, f64::max)
    }

    fn tx_a(&self, power: Dbm) -> f64 {
        let level = self.tx.iter().find(|level| level.power >= power).or(self.tx.last());
        level.expect("a radio has a transmit level").current_a
    }
}

impl TryFrom<EnergyConfig> for RadioStates {
    type Error = SettingError;

    fn try_from(config: EnergyConfig) -> Result<Self, SettingError> {
        Ok(match config {
            EnergyConfig::Cc2420 => Self::cc2420(),
            EnergyConfig::At86rf233 => Self::at86rf233(),
            EnergyConfig::Nrf52840 => Self::nrf52840(),
            EnergyConfig::Cc2538 => Self::cc2538(),
            EnergyConfig::At86rf212b => Self::at86rf212b(),
            EnergyConfig::Mmwave60Ghz => Self::mmwave_60_ghz(),
            EnergyConfig::Custom(custom) => Self::try_from(custom).map_err(|error| error.within("custom"))?,
        })
    }
}

impl TryFrom<CustomRadioConfig> for RadioStates {
    type Error = SettingError;

    fn try_from(config: CustomRadioConfig) -> Result<Self, SettingError> {
        Ok(Self::from_milliamperes(
            SettingError::positive("supply_v", config.supply_v)?,
            &[(0.0, SettingError::not_negative("tx_ma", config.tx_ma)?)],
            SettingError::not_negative("rx_ma", config.rx_ma)?,
            SettingError::not_negative("idle_ma", config.idle_ma)?,
            SettingError::not_negative("sleep_ma", config.sleep_ma)?,
        ))
    }
}

/// Energy that a radio used, by activity (J).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EnergySpent {
    /// Transmitting (J).
    pub tx_j: f64,
    /// Receiving, listening, sensing, turning around (J).
    pub rx_j: f64,
    /// Idle (J).
    pub idle_j: f64,
    /// Asleep (J).
    pub sleep_j: f64,
}

impl EnergySpent {
    /// Total energy (J).
    #[must_use]
    pub fn total_j(&self) -> f64 {
        self.tx_j + self.rx_j + self.idle_j + self.sleep_j
    }
}

/// What one radio used more than another one.
impl std::ops::Sub for EnergySpent {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self {
            tx_j: self.tx_j - other.tx_j,
            rx_j: self.rx_j - other.rx_j,
            idle_j: self.idle_j - other.idle_j,
            sleep_j: self.sleep_j - other.sleep_j,
        }
    }
}

impl std::ops::Mul<f64> for EnergySpent {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self {
            tx_j: self.tx_j * factor,
            rx_j: self.rx_j * factor,
            idle_j: self.idle_j * factor,
            sleep_j: self.sleep_j * factor,
        }
    }
}

impl std::ops::AddAssign for EnergySpent {
    fn add_assign(&mut self, other: Self) {
        self.tx_j += other.tx_j;
        self.rx_j += other.rx_j;
        self.idle_j += other.idle_j;
        self.sleep_j += other.sleep_j;
    }
}

#[cfg(test)]
mod tests;
