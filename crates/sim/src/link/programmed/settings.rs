//! The settings of radios that programs command.

use std::time::Duration;

use sextant_channel::{Dbm, FadingBand};
use sextant_kernel::{Files, NodeId, SettingError};
use sextant_mac::program::ProgramSettings;

use crate::air::{ReceptionModel, ReceptionRules};
use crate::link::capture::FrameFormat;
use crate::link::config::{LinkConfig, LinkError, MacConfig};
use crate::link::ieee802154::{Radio, check_frame, frame_octets};
use crate::link::settings::{FrameSize, LinkSettings, Spectrum};
use crate::world::interferer::Interferer;
use crate::world::layout::PlacedNode;

/// The longest look at the channel (symbols).
const LONGEST_ASSESSMENT_SYMBOLS: u64 = 128;

/// Radios of IEEE 802.15.4 that programs command.
#[derive(Clone, Debug)]
pub struct Programmed {
    /// The radios.
    pub radio: Radio,
    /// The rule that decides whether a frame is received.
    pub reception: ReceptionModel,
    /// Channels, and how long they take to wake up.
    pub program: ProgramSettings,
}

impl Programmed {
    /// The settings that a scenario describes.
    pub(in crate::link) fn read(
        config: &LinkConfig<'_>,
        nodes: Option<&[PlacedNode]>,
        _files: &Files,
    ) -> Result<Self, Vec<LinkError>> {
        let MacConfig::Program(program) = config.mac else { unreachable!("the channel access chose the technology") };
        let mut errors = Vec::new();
        let radio = Radio::read(config, nodes, &mut errors);
        let reception = ReceptionModel::try_from(config.reception.copied().unwrap_or_default());
        let reception = LinkError::take("reception", reception, &mut errors);
        let (Some(radio), Some(reception)) = (radio, reception) else { return Err(errors) };
        let program = ProgramSettings::new(program.clone(), radio.phy(), radio.channel());
        let program = program.map_err(|error| error.within("program"));
        let Some(program) = LinkError::take("mac", program, &mut errors) else { return Err(errors) };
        let settings = Self { radio, reception, program };
        settings.check_clocks().map_err(|error| vec![LinkError::Invalid { table: "radio", error }])?;
        Ok(settings)
    }

    /// The longest look at the channel.
    pub(super) fn longest_assessment(&self) -> Duration {
        self.radio.phy().symbols(LONGEST_ASSESSMENT_SYMBOLS)
    }

    /// Refuses clocks that drift, with a key below the radio.
    fn check_clocks(&self) -> Result<(), SettingError> {
        if self.radio.has_drift() {
            let allowed = "0 with `mac.program`: a program that studies drift moves its instants itself";
            return Err(SettingError::new("clock_ppm", "not 0, for all nodes or a group", allowed));
        }
        Ok(())
    }
}

impl LinkSettings for Programmed {
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

    fn further_spectra(&self) -> Vec<Spectrum> {
        self.program.channels()[1..].iter().map(|&channel| self.radio.spectrum(channel)).collect()
    }

    fn powers_vary(&self) -> bool {
        true
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

    fn carrier_sense(&self) -> Duration {
        self.longest_assessment()
    }

    fn always_receives(&self) -> bool {
        // A radio that its program has turned on receives, whatever its application says that it hears.
        true
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
