//! Radios and channel access as written in a scenario, for all technologies.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sextant_mac::Phy;
use sextant_mac::csma::CsmaConfig;
use sextant_mac::dmg::SweepConfig;
use sextant_mac::superframe::BeaconEnabledConfig;

/// The radios of all stations, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RadioConfig {
    /// Physical layer of IEEE 802.15.4: band, modulation and bit rate; 2450 MHz, O-QPSK, 250 kb/s if absent. Absent with
    /// sector sweeps.
    #[serde(default, skip_serializing_if = "is_default")]
    pub phy: Phy,
    /// Number of the radio channel: 0 at 868 MHz, 1 to 10 at 915 MHz, 11 to 26 at 2450 MHz, 1 to 4
    /// with sector sweeps; the lowest one if absent.
    /// Networks on one channel disturb each other, those on different channels do not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub channel: Option<u8>,
    /// Transmit power (dBm). With a path loss of 0 dB at the reference distance it is the power there.
    pub tx_power_dbm: f64,
    /// Minimum power of a frame that can be received (dBm).
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
    /// Backoffs, airtimes, waiting times and the intervals of periodic traffic follow it. The clocks of robots and sinks
    /// are exact. IEEE 802.15.4 allows 40. Only with `mac.csma_unslotted`: nodes that follow beacons take over the
    /// clock of the coordinator.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub clock_ppm: f64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_zero(value: &f64) -> bool {
    value.to_bits() == 0
}

fn is_default(phy: &Phy) -> bool {
    *phy == Phy::default()
}

/// How nodes share the channel, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum MacConfig {
    /// Unslotted CSMA-CA of IEEE 802.15.4 at 2.4 GHz (O-QPSK).
    CsmaUnslotted(CsmaConfig),
    /// The first robot, or the first sink if there is no robot, is the coordinator: it sends beacons, and nodes that heard one answer by slotted CSMA-CA or in
    /// guaranteed slots (IEEE 802.15.4 at 2.4 GHz).
    BeaconEnabled(BeaconEnabledConfig),
    /// Sector sweeps of IEEE 802.11ad: robots sweep their sectors, and the nodes that hear them answer. Needs a table
    /// `antenna`, and no `traffic`.
    SectorSweep(SweepConfig),
}

impl Default for MacConfig {
    fn default() -> Self {
        Self::CsmaUnslotted(CsmaConfig::default())
    }
}
