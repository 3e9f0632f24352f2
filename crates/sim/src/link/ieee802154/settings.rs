//! The settings of the links of a network of IEEE 802.15.4.

use std::time::Duration;

use sextant_kernel::{Files, SettingError};
use sextant_mac::RadioState;
use sextant_mac::coordinator::Coordinator;

use super::plan::coordinator;
use super::{Mac, Radio};
use crate::link::config::{LinkConfig, LinkError};
use crate::link::coordinator::Coordination;
use crate::link::radio_settings::RadioSettings;
use crate::link::settings::{LinkSettings, Spectrum};
use crate::world::layout::PlacedNode;

/// Links of IEEE 802.15.4.
#[derive(Clone, Debug)]
pub struct Ieee802154 {
    /// The radios.
    pub radio: Radio,
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
        let (Some(radio), Some(mac)) = (radio, mac) else { return Err(errors) };
        let settings = Self { radio, mac };
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
    fn radio(&self) -> &dyn RadioSettings {
        &self.radio
    }

    fn spectrum(&self) -> Spectrum {
        self.radio.spectrum(self.radio.channel())
    }

    fn asks_at_ends(&self) -> bool {
        true
    }

    fn carrier_sense(&self) -> Duration {
        self.radio.phy().cca()
    }

    fn check(&self) -> Result<(), SettingError> {
        self.radio.check()?;
        self.check_clocks().map_err(|error| error.within("radio"))
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
}
