//! What the radios are on the air: their part of the spectrum, the rules of their receivers, their captures.

use std::time::Duration;

use sextant_channel::{Db, Dbm, FadingBand};
use sextant_kernel::{NodeId, Seed, SettingError};
use sextant_mac::{Band, Phy, oqpsk};

use super::Radio;
use super::addressing::{check_frame, frame_octets};
use super::radio::Levels;
use crate::air::ReceptionRules;
use crate::link;
use crate::link::capture::FrameFormat;
use crate::link::clock::Clock;
use crate::link::radio_settings::{FrameSize, RadioSettings};
use crate::link::settings::Spectrum;
use crate::service::network_id::NetworkId;
use crate::world::interferer::Interferer;

/// Minimum ratio of signal to interference and noise at which a radio locks on to a frame.
const LOCK_THRESHOLD: Db = Db(-5.0);

impl Radio {
    /// The part of the spectrum of a channel.
    pub(in crate::link) fn spectrum(&self, channel: u8) -> Spectrum {
        let band = match self.phy().band() {
            Band::Mhz868 => "868 MHz",
            Band::Mhz915 => "915 MHz",
            Band::Mhz2450 => "2450 MHz",
        };
        Spectrum { band, channel }
    }
}

impl RadioSettings for Radio {
    fn tx_power(&self) -> Dbm {
        self.tx_power()
    }

    fn greatest_tx_power(&self) -> Dbm {
        self.greatest_tx_power()
    }

    fn tx_power_of(&self, node: NodeId) -> Dbm {
        self.levels(node).tx_power
    }

    fn busy_from(&self, node: Option<NodeId>) -> Dbm {
        node.map_or(self.common_levels(), |node| self.levels(node)).cca_threshold
    }

    fn sensitivity(&self) -> Dbm {
        self.sensitivity()
    }

    fn noise_floor(&self) -> Dbm {
        self.least_noise_floor()
    }

    fn fading_band(&self, channel: u8) -> FadingBand {
        let reference_hz = match self.phy().band() {
            Band::Mhz868 => 868.3e6,
            Band::Mhz915 => 915e6,
            Band::Mhz2450 => 2440e6,
        };
        FadingBand { reference_hz, center_hz: 1e6 * self.phy().center_mhz(channel) }
    }

    fn reception_rules(&self) -> Vec<ReceptionRules> {
        let (phy, model) = (self.phy(), self.reception());
        let rules = |levels: &Levels| ReceptionRules {
            model,
            sensitivity: levels.sensitivity.to_milliwatts(),
            noise: levels.noise_floor.to_milliwatts(),
            lock: LOCK_THRESHOLD.to_factor(),
            carrier: None,
            preamble: phy.synchronisation_header() - phy.octet(),
            bit_rate_hz: phy.bit_rate_per_s(),
            bit_error_rate: oqpsk::bit_error_rate,
        };
        self.all_levels().map(rules).collect()
    }

    fn rule_of(&self, node: NodeId) -> u16 {
        self.level_of(node)
    }

    fn power_of(&self, interferer: &Interferer, channel: u8) -> Option<Dbm> {
        let phy = self.phy();
        interferer.power_in(phy.center_mhz(channel), phy.bandwidth_mhz())
    }

    fn clock(&self, seed: Seed, network: NetworkId, node: NodeId) -> Clock {
        self.clock(seed, network, node)
    }

    fn check(&self) -> Result<(), SettingError> {
        match self.phy() {
            Phy::Oqpsk2450 => Ok(()),
            phy => link::refuse_bit_errors(self.reception(), &format!("a radio with `phy = \"{}\"`", phy.name())),
        }
    }

    fn check_frame(&self, frame: FrameSize) -> Result<(), SettingError> {
        check_frame(frame)
    }

    fn frame_format(&self) -> FrameFormat {
        FrameFormat::Tap { page: self.phy().page(), channel: self.channel(), sensitivity: self.sensitivity() }
    }

    fn frame_octets(&self, payload_octets: u16) -> u16 {
        frame_octets(payload_octets)
    }

    fn airtime(&self, frame_octets: u16) -> Option<Duration> {
        Some(self.phy().airtime(u8::try_from(frame_octets).ok()?))
    }
}
