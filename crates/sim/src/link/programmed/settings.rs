//! The settings of radios that programs command.

use std::time::Duration;

use sextant_kernel::{Files, SettingError};
use sextant_mac::program::ProgramSettings;

use crate::link::config::{LinkConfig, LinkError, MacConfig};
use crate::link::ieee802154::Radio;
use crate::link::radio_settings::RadioSettings;
use crate::link::settings::{LinkSettings, Spectrum};
use crate::world::layout::PlacedNode;

/// The longest look at the channel (symbols).
const LONGEST_ASSESSMENT_SYMBOLS: u64 = 128;

/// Radios of IEEE 802.15.4 that programs command.
#[derive(Clone, Debug)]
pub struct Programmed {
    /// The radios.
    pub radio: Radio,
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
        let Some(radio) = radio else { return Err(errors) };
        let program = ProgramSettings::new(program.clone(), radio.phy(), radio.channel());
        let program = program.map_err(|error| error.within("program"));
        let Some(program) = LinkError::take("mac", program, &mut errors) else { return Err(errors) };
        let settings = Self { radio, program };
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
    fn radio(&self) -> &dyn RadioSettings {
        &self.radio
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

    fn carrier_sense(&self) -> Duration {
        self.longest_assessment()
    }

    fn always_receives(&self) -> bool {
        // A radio that its program has turned on receives, whatever its application says that it hears.
        true
    }

    fn check(&self) -> Result<(), SettingError> {
        self.radio.check()?;
        self.check_clocks().map_err(|error| error.within("radio"))
    }
}
