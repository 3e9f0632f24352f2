//! Radios and channel access as written in a scenario, for all technologies.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use sextant_kernel::SettingError;
use sextant_mac::Phy;
use sextant_mac::csma::CsmaConfig;
use sextant_mac::dmg::SweepConfig;
use sextant_mac::program::ProgramConfig;
use sextant_mac::sleep::SleepConfig;
use sextant_mac::superframe::BeaconEnabledConfig;
use sextant_mac::tsch::{ScheduleConfig, TschConfig};

use super::antennas::AntennasConfig;
use super::dmg_channel::carrier_hz;
use crate::air::ReceptionConfig;
use crate::world::layout::NodesOfGroup;

/// The radios of all stations, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RadioConfig {
    /// Physical layer of IEEE 802.15.4: band, modulation and bit rate; 2450 MHz, O-QPSK, 250 kb/s if absent. Absent with
    /// sector sweeps.
    #[serde(default, skip_serializing_if = "is_default")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = "oqpsk2450")))]
    pub phy: Phy,
    /// Number of the radio channel: 0 at 868 MHz, 1 to 10 at 915 MHz, 11 to 26 at 2450 MHz, 1 to 4
    /// with sector sweeps; the lowest one if absent.
    /// Networks on one channel disturb each other, those on different channels do not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 26)))]
    pub channel: Option<u8>,
    /// Transmit power (dBm). With a path loss of 0 dB at the reference distance it is the power there.
    pub tx_power_dbm: f64,
    /// A frame with less power is not received (dBm). With thresholds or bit errors in `reception`, one may need more.
    pub sensitivity_dbm: f64,
    /// Mean power over the window of carrier sense at or above which the channel is busy (dBm);
    /// 10 dB above the sensitivity if absent. With sector sweeps: power of a signal, and the sensitivity if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cca_threshold_dbm: Option<f64>,
    /// Noise in the bandwidth of the receiver (dBm); 0.403 dB below the sensitivity if absent;
    /// -71.5 dBm with sector sweeps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise_floor_dbm: Option<f64>,
    /// The clock of each node is fast or slow by up to this many millionths, drawn uniformly for each node: 0 to 1000.
    /// Backoffs, airtimes, waiting times and the intervals of periodic traffic follow it, and slots with `mac.tsch`. The
    /// clocks of robots and sinks are exact. IEEE 802.15.4 allows 40. Only with `mac.csma_unslotted`, `mac.tsch` and
    /// `mac.sleep`: nodes that follow beacons take over the clock of the coordinator, and programs have exact clocks.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = 0.0)))]
    pub clock_ppm: f64,
    /// Groups of nodes whose radios differ from the others. Only with IEEE 802.15.4.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = [])))]
    pub groups: Vec<RadioGroupConfig>,
}

/// Nodes whose radios differ from the others, as written in a scenario. What is absent is as for the others.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RadioGroupConfig {
    /// Which nodes are in it; a node is in one group at most.
    pub nodes: NodesOfGroup,
    /// Transmit power (dBm).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tx_power_dbm: Option<f64>,
    /// A frame with less power is not received (dBm). Threshold of carrier sense and noise follow it as they do
    /// without groups, unless they are set for all or for the group.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensitivity_dbm: Option<f64>,
    /// Mean power over the window of carrier sense at or above which the channel is busy (dBm).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cca_threshold_dbm: Option<f64>,
    /// Noise in the bandwidth of the receiver (dBm).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise_floor_dbm: Option<f64>,
    /// The clock of each node of the group is fast or slow by up to this many millionths.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clock_ppm: Option<f64>,
    /// The clock of each node of the group is fast by exactly so many millionths, or slow if that is negative, instead of by
    /// a random number: -1000 to 1000.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clock_offset_ppm: Option<f64>,
}

impl RadioConfig {
    /// The carrier of its channel (GHz): by IEEE 802.15.4-2006, 6.1.2.1, or by IEEE 802.11ad-2012, annex E, with sector
    /// sweeps. That of the lowest channel if there is no such channel.
    #[must_use]
    pub fn carrier_ghz(&self, mac: &MacConfig) -> f64 {
        if mac.sweeps_sectors() {
            return carrier_hz(self.channel.filter(|number| (1..=4).contains(number)).unwrap_or(1)) / 1e9;
        }
        let numbers = self.phy.channels();
        let number = self.channel.filter(|number| numbers.contains(number)).unwrap_or(*numbers.start());
        self.phy.center_mhz(number) / 1000.0
    }

    /// The radios of a group.
    pub(crate) fn of_group(&self, group: &RadioGroupConfig) -> Self {
        Self {
            tx_power_dbm: group.tx_power_dbm.unwrap_or(self.tx_power_dbm),
            sensitivity_dbm: group.sensitivity_dbm.unwrap_or(self.sensitivity_dbm),
            cca_threshold_dbm: group.cca_threshold_dbm.or(self.cca_threshold_dbm),
            noise_floor_dbm: group.noise_floor_dbm.or(self.noise_floor_dbm),
            clock_ppm: group.clock_ppm.unwrap_or(self.clock_ppm),
            phy: self.phy,
            channel: self.channel,
            groups: Vec::new(),
        }
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_zero(value: &f64) -> bool {
    value.to_bits() == 0
}

fn is_default(phy: &Phy) -> bool {
    *phy == Phy::default()
}

/// How nodes share the channel, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum MacConfig {
    /// Unslotted CSMA-CA of IEEE 802.15.4, in symbols of the physical layer of the radios (`radio.phy`).
    CsmaUnslotted(CsmaConfig),
    /// The first robot, or the first sink if there is no robot, is the coordinator: it sends beacons, and nodes that heard one answer by slotted CSMA-CA or in
    /// guaranteed slots (IEEE 802.15.4), in symbols of the physical layer of the radios (`radio.phy`).
    BeaconEnabled(BeaconEnabledConfig),
    /// Time-slotted channel hopping (TSCH) of IEEE 802.15.4: stations send and listen in slots, by a schedule, on one radio
    /// channel after the other. Robots take no part.
    Tsch(TschConfig),
    /// Stations sleep, and look at the channel at each interval; senders wake them: X-MAC, ContikiMAC, CSL. Robots take no part.
    Sleep(SleepConfig),
    /// No channel access: programs of the stations, given by the library or in Python, command the radios of IEEE 802.15.4
    /// themselves. Stations without a program are off, but for sinks, which listen. No `traffic` but `silent`.
    Program(ProgramConfig),
    /// Sector sweeps of IEEE 802.11ad: robots sweep their sectors, and the nodes that hear them answer. Needs a table
    /// `antenna`, and no `traffic`.
    SectorSweep(SweepConfig),
}

impl Default for MacConfig {
    fn default() -> Self {
        Self::CsmaUnslotted(CsmaConfig::default())
    }
}

impl MacConfig {
    /// Its key in the table `mac`: `csma_unslotted`.
    #[must_use]
    pub fn key(&self) -> &'static str {
        match self {
            Self::CsmaUnslotted(_) => "csma_unslotted",
            Self::BeaconEnabled(_) => "beacon_enabled",
            Self::Tsch(_) => "tsch",
            Self::Sleep(_) => "sleep",
            Self::Program(_) => "program",
            Self::SectorSweep(_) => "sector_sweep",
        }
    }

    /// The files that it names, each with its key below the table.
    pub fn files_mut(&mut self) -> impl Iterator<Item = (&'static str, &mut PathBuf)> {
        let own = match self {
            Self::Tsch(TschConfig { schedule: ScheduleConfig::Own(own), .. }) => own.file.as_mut(),
            _ => None,
        };
        own.into_iter().map(|file| ("tsch.schedule.own.file", file))
    }

    /// Whether programs command the radios.
    #[must_use]
    pub fn is_programmed(&self) -> bool {
        matches!(self, Self::Program(_))
    }

    /// Whether stations send and listen in slots, on one channel after the other.
    #[must_use]
    pub fn has_slots(&self) -> bool {
        matches!(self, Self::Tsch(_))
    }

    /// Whether stations sleep between checks of the channel.
    #[must_use]
    pub fn sleeps(&self) -> bool {
        matches!(self, Self::Sleep(_))
    }

    /// Whether the links sweep sectors. They have antennas then, and nodes send no traffic.
    #[must_use]
    pub fn sweeps_sectors(&self) -> bool {
        matches!(self, Self::SectorSweep(_))
    }
}

/// The tables of a scenario about the links of a network.
#[derive(Clone, Copy, Debug)]
pub struct LinkConfig<'a> {
    /// The radios.
    pub radio: Option<&'a RadioConfig>,
    /// How nodes share the channel.
    pub mac: &'a MacConfig,
    /// When a frame that arrives is received.
    pub reception: Option<&'a ReceptionConfig>,
    /// The antennas, with sector sweeps.
    pub antenna: Option<&'a AntennasConfig>,
}

/// What is wrong with a table of [`LinkConfig`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LinkError {
    /// A table is missing.
    #[error("the table `[{0}]` is missing")]
    Missing(&'static str),
    /// A setting is invalid.
    #[error("[{table}]: {error}")]
    Invalid {
        /// The table.
        table: &'static str,
        /// What is wrong, with a key below the table.
        error: SettingError,
    },
}

impl LinkError {
    /// The value; an error is noted as one in `table`.
    pub(super) fn take<T>(table: &'static str, result: Result<T, SettingError>, errors: &mut Vec<Self>) -> Option<T> {
        result.map_err(|error| errors.push(Self::Invalid { table, error })).ok()
    }

    /// Notes that `table` is missing.
    pub(super) fn missing<T>(table: &'static str, errors: &mut Vec<Self>) -> Option<T> {
        errors.push(Self::Missing(table));
        None
    }
}
