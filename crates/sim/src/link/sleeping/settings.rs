//! The settings of links whose stations sleep.

use std::time::Duration;

use sextant_channel::{Dbm, FadingBand};
use sextant_kernel::{Files, NodeId, Seed, SettingError};
use sextant_mac::frame::DataFrame;
use sextant_mac::sleep::SleepSettings;

use crate::air::{ReceptionModel, ReceptionRules};
use crate::link::capture::FrameFormat;
use crate::link::clock::Clock;
use crate::link::config::{LinkConfig, LinkError, MacConfig};
use crate::link::ieee802154::{Radio, check_frame, frame_octets};
use crate::link::settings::{FrameSize, KnownStations, LinkSettings, Spectrum};
use crate::service::network_id::NetworkId;
use crate::world::interferer::Interferer;
use crate::world::layout::PlacedNode;
use sextant_kernel::StationId;

/// Links of IEEE 802.15.4 whose stations sleep, and look at the channel at each interval.
#[derive(Clone, Debug)]
pub struct Sleeping {
    /// The radios.
    pub radio: Radio,
    /// The rule that decides whether a frame is received.
    pub reception: ReceptionModel,
    /// How stations sleep and are woken.
    pub sleep: SleepSettings,
}

impl Sleeping {
    /// The settings that a scenario describes.
    pub(in crate::link) fn read(
        config: &LinkConfig<'_>,
        nodes: Option<&[PlacedNode]>,
        _files: &Files,
    ) -> Result<Self, Vec<LinkError>> {
        let MacConfig::Sleep(sleep) = config.mac else { unreachable!("the channel access chose the technology") };
        let mut errors = Vec::new();
        let radio = Radio::read(config, nodes, &mut errors);
        let reception = ReceptionModel::try_from(config.reception.copied().unwrap_or_default());
        let reception = LinkError::take("reception", reception, &mut errors);
        let (Some(radio), Some(reception)) = (radio, reception) else { return Err(errors) };
        let sleep = SleepSettings::new(sleep, radio.phy()).map_err(|error| error.within("sleep"));
        match LinkError::take("mac", sleep, &mut errors) {
            Some(sleep) if errors.is_empty() => Ok(Self { radio, reception, sleep }),
            _ => Err(errors),
        }
    }
}

impl LinkSettings for Sleeping {
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

    fn carrier_sense(&self) -> Duration {
        self.radio.phy().cca()
    }

    fn reception_rules(&self) -> Vec<ReceptionRules> {
        self.radio.reception_rules(self.reception)
    }

    fn rule_of(&self, node: NodeId) -> u16 {
        self.radio.level_of(node)
    }

    fn power_of(&self, interferer: &Interferer, channel: u8) -> Option<Dbm> {
        self.radio.power_of(interferer, channel)
    }

    fn check(&self) -> Result<(), SettingError> {
        self.radio.check_reception(self.reception)
    }

    fn check_frame(&self, frame: FrameSize) -> Result<(), SettingError> {
        check_frame(frame)?;
        let least = self.sleep.least_mpdu_octets();
        if frame.mpdu_octets < least {
            let allowed = format!(
                "at least {least} with `mac.sleep.wake_up.repeated_data`: a shorter frame fits between the two looks of a receiver"
            );
            return Err(SettingError::new("mpdu_octets", frame.mpdu_octets, allowed));
        }
        Ok(())
    }

    fn know_stations(&mut self, stations: &KnownStations<'_>) -> Result<(), SettingError> {
        if stations.has_robots() {
            let remedy = "remove the robots, or give them a network of their own: they neither sleep nor wake others";
            return Err(SettingError::conflict("sleep", "robots in the network", remedy).within("mac"));
        }
        // The times of a check are those of short addresses.
        let last = StationId::from_index(stations.count().saturating_sub(1));
        if DataFrame::broadcast(0, last).overhead_octets() > DataFrame::broadcast(0, StationId(0)).overhead_octets() {
            let found = format!("a table, in a network of {} stations", stations.count());
            return Err(
                SettingError::new("sleep", found, "at most 65534 stations, which have short addresses").within("mac")
            );
        }
        Ok(())
    }

    fn clock(&self, seed: Seed, network: NetworkId, node: NodeId) -> Clock {
        self.radio.clock(seed, network, node)
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
