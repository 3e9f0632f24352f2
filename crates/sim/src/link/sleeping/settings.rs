//! The settings of links whose stations sleep.

use std::time::Duration;

use sextant_kernel::{Files, SettingError};
use sextant_mac::frame::DataFrame;
use sextant_mac::sleep::SleepSettings;

use crate::link::config::{LinkConfig, LinkError, MacConfig};
use crate::link::ieee802154::{Radio, check_frame};
use crate::link::radio_settings::{FrameSize, RadioSettings};
use crate::link::settings::{KnownStations, LinkSettings, Spectrum};
use crate::world::layout::PlacedNode;
use sextant_kernel::StationId;

/// Links of IEEE 802.15.4 whose stations sleep, and look at the channel at each interval.
#[derive(Clone, Debug)]
pub struct Sleeping {
    /// The radios.
    pub radio: Radio,
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
        let Some(radio) = radio else { return Err(errors) };
        let sleep = SleepSettings::new(sleep, radio.phy()).map_err(|error| error.within("sleep"));
        match LinkError::take("mac", sleep, &mut errors) {
            Some(sleep) if errors.is_empty() => Ok(Self { radio, sleep }),
            _ => Err(errors),
        }
    }
}

impl LinkSettings for Sleeping {
    fn radio(&self) -> &dyn RadioSettings {
        &self.radio
    }

    fn spectrum(&self) -> Spectrum {
        self.radio.spectrum(self.radio.channel())
    }

    fn carrier_sense(&self) -> Duration {
        self.radio.phy().cca()
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
}
