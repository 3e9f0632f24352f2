//! What the radios are on the air: their part of the spectrum, the rules of their receivers, their captures.

use sextant_channel::{Db, Dbm, FadingBand};
use sextant_kernel::SettingError;
use sextant_mac::{Band, Phy, oqpsk};

use super::Radio;
use super::radio::Levels;
use crate::air::{ReceptionModel, ReceptionRules};
use crate::link;
use crate::link::capture::FrameFormat;
use crate::link::settings::Spectrum;
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

    /// Where links fade on a channel.
    pub(in crate::link) fn fading_band(&self, channel: u8) -> FadingBand {
        let reference_hz = match self.phy().band() {
            Band::Mhz868 => 868.3e6,
            Band::Mhz915 => 915e6,
            Band::Mhz2450 => 2440e6,
        };
        FadingBand { reference_hz, center_hz: 1e6 * self.phy().center_mhz(channel) }
    }

    /// The rules of the receivers of all groups.
    pub(in crate::link) fn reception_rules(&self, model: ReceptionModel) -> Vec<ReceptionRules> {
        let phy = self.phy();
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

    /// Power of an interferer in a channel, if there is any.
    pub(in crate::link) fn power_of(&self, interferer: &Interferer, channel: u8) -> Option<Dbm> {
        let phy = self.phy();
        interferer.power_in(phy.center_mhz(channel), phy.bandwidth_mhz())
    }

    /// Refuses bit errors where their rate is not known.
    pub(in crate::link) fn check_reception(&self, reception: ReceptionModel) -> Result<(), SettingError> {
        match self.phy() {
            Phy::Oqpsk2450 => Ok(()),
            phy => link::refuse_bit_errors(reception, &format!("a radio with `phy = \"{}\"`", phy.name())),
        }
    }

    /// How frames are written into a capture.
    pub(in crate::link) fn frame_format(&self) -> FrameFormat {
        FrameFormat::Tap { page: self.phy().page(), channel: self.channel(), sensitivity: self.sensitivity() }
    }
}
