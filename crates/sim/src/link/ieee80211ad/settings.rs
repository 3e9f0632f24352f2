//! The settings of the links of a network of IEEE 802.11ad.

use std::time::Duration;

use sextant_channel::{Db, Dbm, FadingBand};
use sextant_kernel::{Files, NodeId, SettingError};
use sextant_mac::dmg::timing::{PREAMBLE, control_airtime};
use sextant_mac::dmg::{AnswerSettings, SweepSettings, beacon_octets};

use super::radio::DmgRadio;
use crate::air::{CarrierThresholds, ReceptionConfig, ReceptionModel, ReceptionRules, ThresholdConfig};
use crate::link;
use crate::link::antennas::Antennas;
use crate::link::capture::FrameFormat;
use crate::link::config::{LinkConfig, LinkError, MacConfig};
use crate::link::radio_settings::RadioSettings;
use crate::link::settings::{LinkSettings, Spectrum};
use crate::world::layout::PlacedNode;

/// Minimum ratio of signal to interference and noise at which a radio locks on to a frame of the control PHY: its
/// sensitivity of -78 dBm over a noise of -71.5 dBm.
const LOCK_THRESHOLD: Db = Db(-6.5);

/// Links of IEEE 802.11ad.
#[derive(Clone, Debug)]
pub struct Ieee80211ad {
    /// The radios.
    pub radio: DmgRadio,
    /// The rule that decides whether a frame is received.
    pub reception: ReceptionModel,
    /// Sector sweeps, and how nodes share the channel for their answers.
    pub(super) answers: AnswerSettings,
    /// The antennas.
    pub(super) antennas: Antennas,
}

impl Ieee80211ad {
    /// Links with these settings.
    ///
    /// # Errors
    /// If the sectors of a node do not fit in a slot for answers, with a key below the sector sweep.
    pub fn new(
        radio: DmgRadio,
        reception: ReceptionModel,
        sweep: SweepSettings,
        antennas: Antennas,
    ) -> Result<Self, SettingError> {
        let answers = sweep.answers(antennas.node_layout())?;
        Ok(Self { radio, reception, answers, antennas })
    }

    /// The settings that a scenario describes, with the antenna files in `folder`.
    pub(in crate::link) fn read(
        config: &LinkConfig<'_>,
        _nodes: Option<&[PlacedNode]>,
        files: &Files,
    ) -> Result<Self, Vec<LinkError>> {
        let MacConfig::SectorSweep(sweep) = config.mac else {
            unreachable!("the channel access chose the technology")
        };
        let mut errors = Vec::new();
        let radio = match config.radio {
            Some(radio) => LinkError::take("radio", DmgRadio::try_from(radio.clone()), &mut errors),
            None => LinkError::missing("radio", &mut errors),
        };
        let antennas = match config.antenna {
            Some(antennas) => LinkError::take("antenna", Antennas::read(antennas, files), &mut errors),
            None => LinkError::missing("antenna", &mut errors),
        };
        let within = |error: SettingError| error.within("sector_sweep");
        let sweep = LinkError::take("mac", SweepSettings::try_from(*sweep).map_err(within), &mut errors);
        // Spread signals, whose sensitivity lies below the noise.
        let default = ReceptionConfig::SirThreshold(ThresholdConfig::default());
        let reception = ReceptionModel::try_from(config.reception.copied().unwrap_or(default));
        let reception = LinkError::take("reception", reception, &mut errors);
        let answers = sweep.zip(antennas.as_ref()).and_then(|(sweep, antennas)| {
            LinkError::take("mac", sweep.answers(antennas.node_layout()).map_err(within), &mut errors)
        });
        match (radio, reception, answers, antennas) {
            (Some(radio), Some(reception), Some(answers), Some(antennas)) => {
                Ok(Self { radio, reception, answers, antennas })
            }
            _ => Err(errors),
        }
    }
}

impl RadioSettings for Ieee80211ad {
    fn tx_power(&self) -> Dbm {
        self.radio.tx_power()
    }

    fn busy_from(&self, _node: Option<NodeId>) -> Dbm {
        self.radio.cca_threshold()
    }

    fn sensitivity(&self) -> Dbm {
        self.radio.sensitivity()
    }

    fn noise_floor(&self) -> Dbm {
        self.radio.noise_floor()
    }

    fn fading_band(&self, _channel: u8) -> FadingBand {
        // Between channels 2 and 3.
        FadingBand { reference_hz: 61.56e9, center_hz: self.radio.carrier_hz() }
    }

    fn reception_rules(&self) -> Vec<ReceptionRules> {
        vec![ReceptionRules {
            model: self.reception,
            sensitivity: self.radio.sensitivity().to_milliwatts(),
            noise: self.radio.noise_floor().to_milliwatts(),
            lock: LOCK_THRESHOLD.to_factor(),
            carrier: Some(CarrierThresholds {
                signal: self.radio.cca_threshold().to_milliwatts(),
                energy: self.radio.energy_threshold().to_milliwatts(),
            }),
            preamble: PREAMBLE,
            // No bit errors are worked out: their rate is not known, and such settings are refused.
            bit_rate_hz: 0.0,
            bit_error_rate: |_| 0.0,
        }]
    }

    fn check(&self) -> Result<(), SettingError> {
        link::refuse_bit_errors(self.reception, "sector sweeps")
    }

    fn frame_format(&self) -> FrameFormat {
        FrameFormat::Radiotap { carrier_hz: self.radio.carrier_hz() }
    }

    fn frame_octets(&self, payload_octets: u16) -> u16 {
        beacon_octets(payload_octets)
    }

    fn airtime(&self, frame_octets: u16) -> Option<Duration> {
        Some(control_airtime(frame_octets))
    }
}

impl LinkSettings for Ieee80211ad {
    fn radio(&self) -> &dyn RadioSettings {
        self
    }

    fn spectrum(&self) -> Spectrum {
        Spectrum { band: "60 GHz", channel: self.radio.channel() }
    }

    fn unshared(&self) -> Option<&'static str> {
        Some("sector sweeps")
    }

    fn always_receives(&self) -> bool {
        // Sweeps are for all stations, whatever their applications.
        true
    }

    fn antennas(&self) -> Option<&Antennas> {
        Some(&self.antennas)
    }
}
