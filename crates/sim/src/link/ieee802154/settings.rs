//! The settings of the links of a network of IEEE 802.15.4.

use std::time::Duration;

use sextant_channel::{Dbm, FadingBand};
use sextant_kernel::{Files, NodeId, Seed, SettingError};
use sextant_mac::RadioState;
use sextant_mac::coordinator::Coordinator;

use super::addressing::{check_frame, frame_octets};
use super::plan::coordinator;
use super::{Mac, Radio};
use crate::air::{ReceptionModel, ReceptionRules};
use crate::link::capture::FrameFormat;
use crate::link::clock::Clock;
use crate::link::config::{LinkConfig, LinkError};
use crate::link::coordinator::Coordination;
use crate::link::settings::{FrameSize, LinkSettings, Spectrum};
use crate::service::network_id::NetworkId;
use crate::world::interferer::Interferer;
use crate::world::layout::PlacedNode;

/// Links of IEEE 802.15.4.
#[derive(Clone, Debug)]
pub struct Ieee802154 {
    /// The radios.
    pub radio: Radio,
    /// The rule that decides whether a frame is received.
    pub reception: ReceptionModel,
    /// Channel access of the nodes.
    pub mac: Mac,
}

impl Ieee802154 {
    /// The settings that a scenario describes.
    pub(in crate::link) fn read(
        config: &LinkConfig<'_>,
        nodes: Option<&[PlacedNode]>,
        _files: &Files,
    ) -> Result<Self, Vec<LinkError>> {
        let mut errors = Vec::new();
        let radio = Radio::read(config, nodes, &mut errors);
        let mac = LinkError::take("mac", Mac::try_from(config.mac.clone()), &mut errors);
        let reception = ReceptionModel::try_from(config.reception.copied().unwrap_or_default());
        let reception = LinkError::take("reception", reception, &mut errors);
        let (Some(radio), Some(mac), Some(reception)) = (radio, mac, reception) else { return Err(errors) };
        let settings = Self { radio, reception, mac };
        settings.check_clocks().map_err(|error| vec![LinkError::Invalid { table: "radio", error }])?;
        Ok(settings)
    }

    /// Whether all nodes listen whenever they do not send.
    #[must_use]
    pub fn hear_at_any_time(&self) -> bool {
        matches!(self.mac, Mac::CsmaUnslotted(csma) if csma.resting_state() == RadioState::Receive)
    }

    /// Refuses clocks that drift where nodes follow beacons, with a key below the radio.
    fn check_clocks(&self) -> Result<(), SettingError> {
        if self.radio.has_drift() && self.has_coordinator() {
            let allowed = "0 with `mac.beacon_enabled`: nodes take over the clock of the coordinator";
            return Err(SettingError::new("clock_ppm", "not 0, for all nodes or a group", allowed));
        }
        Ok(())
    }
}

impl LinkSettings for Ieee802154 {
    fn tx_power(&self) -> Dbm {
        self.radio.tx_power()
    }

    fn greatest_tx_power(&self) -> Dbm {
        self.radio.greatest_tx_power()
    }

    fn tx_power_of(&self, node: NodeId) -> Dbm {
        self.radio.levels(node).tx_power
    }

    fn busy_from(&self, node: Option<NodeId>) -> Dbm {
        node.map_or(self.radio.common_levels(), |node| self.radio.levels(node)).cca_threshold
    }

    fn sensitivity(&self) -> Dbm {
        self.radio.sensitivity()
    }

    fn noise_floor(&self) -> Dbm {
        self.radio.least_noise_floor()
    }

    fn spectrum(&self) -> Spectrum {
        self.radio.spectrum(self.radio.channel())
    }

    fn fading_band(&self, channel: u8) -> FadingBand {
        self.radio.fading_band(channel)
    }

    fn reception_rules(&self) -> Vec<ReceptionRules> {
        self.radio.reception_rules(self.reception)
    }

    fn rule_of(&self, node: NodeId) -> u16 {
        self.radio.level_of(node)
    }

    fn asks_at_ends(&self) -> bool {
        true
    }

    fn carrier_sense(&self) -> Duration {
        self.radio.phy().cca()
    }

    fn power_of(&self, interferer: &Interferer, channel: u8) -> Option<Dbm> {
        self.radio.power_of(interferer, channel)
    }

    fn check(&self) -> Result<(), SettingError> {
        self.radio.check_reception(self.reception)?;
        self.check_clocks().map_err(|error| error.within("radio"))
    }

    fn check_frame(&self, frame: FrameSize) -> Result<(), SettingError> {
        check_frame(frame)
    }

    fn clock(&self, seed: Seed, network: NetworkId, node: NodeId) -> Clock {
        self.radio.clock(seed, network, node)
    }

    fn has_coordinator(&self) -> bool {
        matches!(self.mac, Mac::BeaconEnabled(_))
    }

    fn coordinator(&self, coordination: &Coordination<'_>) -> Result<Option<Coordinator>, SettingError> {
        match &self.mac {
            Mac::CsmaUnslotted(_) => Ok(None),
            Mac::BeaconEnabled(beacons) => coordinator(beacons, self.radio.phy(), coordination).map(Some),
        }
    }

    fn listen_always(&mut self) {
        self.mac = Mac::CsmaUnslotted(self.mac.csma().with_receiver_on());
    }

    fn frame_format(&self) -> FrameFormat {
        self.radio.frame_format()
    }

    fn frame_octets(&self, payload_octets: u16) -> u16 {
        frame_octets(payload_octets)
    }

    fn airtime(&self, frame_octets: u16) -> Option<Duration> {
        Some(self.radio.phy().airtime(u8::try_from(frame_octets).ok()?))
    }
}
