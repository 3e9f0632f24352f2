//! The settings of links with time-slotted channel hopping.

use std::time::Duration;

use sextant_channel::{Dbm, FadingBand};
use sextant_kernel::{Files, NodeId, Seed, SettingError, StationId};
use sextant_mac::tsch::{ScheduleKind, TschSettings};

use super::cells::{self, NamedCell};
use super::plan::Plan;
use crate::air::{ReceptionModel, ReceptionRules};
use crate::link::capture::FrameFormat;
use crate::link::clock::Clock;
use crate::link::config::{LinkConfig, LinkError, MacConfig};
use crate::link::ieee802154::{Radio, check_frame, frame_octets};
use crate::link::settings::{FrameSize, KnownStations, LinkSettings, Spectrum};
use crate::service::network_id::NetworkId;
use crate::world::interferer::Interferer;
use crate::world::layout::PlacedNode;

/// Links of IEEE 802.15.4 with time-slotted channel hopping.
#[derive(Clone, Debug)]
pub struct Tsch {
    /// The radios.
    pub radio: Radio,
    /// The rule that decides whether a frame is received.
    pub reception: ReceptionModel,
    /// Slots, channels and schedule.
    pub tsch: TschSettings,
    /// The cells that the scenario lists.
    cells: Vec<NamedCell>,
    /// To whom each station sends, if a tree is known.
    parents: Option<Vec<Option<StationId>>>,
    pub(super) plan: Plan,
}

impl Tsch {
    /// The settings that a scenario describes.
    pub(in crate::link) fn read(
        config: &LinkConfig<'_>,
        nodes: Option<&[PlacedNode]>,
        files: &Files,
    ) -> Result<Self, Vec<LinkError>> {
        let MacConfig::Tsch(tsch) = config.mac else { unreachable!("the channel access chose the technology") };
        let mut errors = Vec::new();
        let radio = Radio::read(config, nodes, &mut errors);
        if config.radio.is_some_and(|radio| radio.channel.is_some()) {
            let remedy = "remove the key: `mac.tsch.hopping` names the channels";
            LinkError::take(
                "radio",
                Err::<(), _>(SettingError::conflict("channel", "`mac.tsch`", remedy)),
                &mut errors,
            );
        }
        let reception = ReceptionModel::try_from(config.reception.copied().unwrap_or_default());
        let reception = LinkError::take("reception", reception, &mut errors);
        let (Some(radio), Some(reception)) = (radio, reception) else { return Err(errors) };
        let tsch = TschSettings::new(tsch.clone(), radio.phy()).map_err(|error| error.within("tsch"));
        let tsch = LinkError::take("mac", tsch, &mut errors);
        let cells = match tsch.as_ref().map(|tsch| &tsch.schedule) {
            Some(ScheduleKind::Own(own)) => {
                let cells = cells::read(own, files).map_err(|error| error.within("tsch.schedule.own"));
                LinkError::take("mac", cells, &mut errors)
            }
            _ => Some(Vec::new()),
        };
        match (tsch, cells) {
            (Some(tsch), Some(cells)) if errors.is_empty() => {
                Ok(Self { radio, reception, tsch, cells, parents: None, plan: Plan::default() })
            }
            _ => Err(errors),
        }
    }
}

impl LinkSettings for Tsch {
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
        self.radio.spectrum(self.tsch.hopping.channels()[0])
    }

    fn further_spectra(&self) -> Vec<Spectrum> {
        self.tsch.hopping.channels()[1..].iter().map(|&channel| self.radio.spectrum(channel)).collect()
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

    fn power_of(&self, interferer: &Interferer, channel: u8) -> Option<Dbm> {
        self.radio.power_of(interferer, channel)
    }

    fn check(&self) -> Result<(), SettingError> {
        self.radio.check_reception(self.reception)
    }

    fn check_frame(&self, frame: FrameSize) -> Result<(), SettingError> {
        check_frame(frame)
    }

    fn clock(&self, seed: Seed, network: NetworkId, node: NodeId) -> Clock {
        self.radio.clock(seed, network, node)
    }

    fn know_parents(&mut self, parents: &[Option<StationId>]) {
        self.parents = Some(parents.to_vec());
    }

    fn know_stations(&mut self, stations: &KnownStations<'_>) -> Result<(), SettingError> {
        if stations.has_robots() {
            let remedy = "remove the robots, or give them a network of their own: they do not follow slots";
            return Err(SettingError::conflict("tsch", "robots in the network", remedy).within("mac"));
        }
        let plan = Plan::new(&self.tsch, &self.cells, stations, self.parents.as_deref());
        self.plan = plan.map_err(|error| error.within("mac.tsch"))?;
        Ok(())
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
