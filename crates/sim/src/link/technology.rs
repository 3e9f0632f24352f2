//! The technologies of links.

use std::time::Duration;

use sextant_channel::{Db, Dbm};
use sextant_kernel::SettingError;
use sextant_mac::dmg::timing::PREAMBLE;
use sextant_mac::{Band, oqpsk};

use super::ieee80211ad::Ieee80211ad;
use super::ieee802154::{Levels, Mac, Radio};
use crate::air::{CarrierThresholds, ReceptionModel, ReceptionRules};

/// Minimum ratio of signal to interference and noise at which a radio of IEEE 802.15.4 locks on to a frame.
const LOCK_THRESHOLD: Db = Db(-5.0);

/// The same for the control PHY of IEEE 802.11ad: its sensitivity of -78 dBm over a noise of -71.5 dBm.
const DMG_LOCK_THRESHOLD: Db = Db(-6.5);

/// The technology of the links of a network, with its settings.
#[derive(Clone, Debug)]
pub enum Technology {
    /// IEEE 802.15.4.
    Ieee802154(Ieee802154),
    /// Sector sweeps of IEEE 802.11ad.
    Ieee80211ad(Box<Ieee80211ad>),
}

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
    /// Refuses clocks that drift where nodes follow beacons.
    ///
    /// # Errors
    /// If there are both, with a key below the network.
    pub fn check(&self) -> Result<(), SettingError> {
        if self.radio.has_drift() && matches!(self.mac, Mac::BeaconEnabled(_)) {
            let allowed = "0 with `mac.beacon_enabled`: nodes take over the clock of the coordinator";
            return Err(SettingError::new("radio.clock_ppm", "not 0, for all nodes or a group", allowed));
        }
        Ok(())
    }
}

/// A part of the radio spectrum: networks that share it disturb each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Spectrum {
    /// A channel of a band of IEEE 802.15.4.
    Ieee802154(Band, u8),
    /// A channel of IEEE 802.11ad.
    Ieee80211ad(u8),
}

impl Technology {
    /// The settings of IEEE 802.15.4, if that is the technology.
    #[must_use]
    pub fn ieee802154(&self) -> Option<&Ieee802154> {
        match self {
            Self::Ieee802154(settings) => Some(settings),
            Self::Ieee80211ad(_) => None,
        }
    }

    /// The same, to change them.
    pub fn ieee802154_mut(&mut self) -> Option<&mut Ieee802154> {
        match self {
            Self::Ieee802154(settings) => Some(settings),
            Self::Ieee80211ad(_) => None,
        }
    }

    /// The settings of IEEE 802.11ad, if that is the technology.
    #[must_use]
    pub fn ieee80211ad(&self) -> Option<&Ieee80211ad> {
        match self {
            Self::Ieee802154(_) => None,
            Self::Ieee80211ad(settings) => Some(settings),
        }
    }

    /// Transmit power, without antennas.
    #[must_use]
    pub fn tx_power(&self) -> Dbm {
        match self {
            Self::Ieee802154(settings) => settings.radio.tx_power(),
            Self::Ieee80211ad(settings) => settings.radio.tx_power(),
        }
    }

    /// The greatest transmit power of any station, without antennas.
    pub(crate) fn greatest_tx_power(&self) -> Dbm {
        match self {
            Self::Ieee802154(settings) => settings.radio.greatest_tx_power(),
            Self::Ieee80211ad(settings) => settings.radio.tx_power(),
        }
    }

    /// Minimum power of a frame that can be received.
    #[must_use]
    pub fn sensitivity(&self) -> Dbm {
        match self {
            Self::Ieee802154(settings) => settings.radio.sensitivity(),
            Self::Ieee80211ad(settings) => settings.radio.sensitivity(),
        }
    }

    /// The part of the spectrum that it uses.
    pub(crate) fn spectrum(&self) -> Spectrum {
        match self {
            Self::Ieee802154(Ieee802154 { radio, .. }) => Spectrum::Ieee802154(radio.phy().band(), radio.channel()),
            Self::Ieee80211ad(settings) => Spectrum::Ieee80211ad(settings.radio.channel()),
        }
    }

    /// Largest gain of both antennas of a link together.
    pub(crate) fn greatest_gain(&self) -> Db {
        match self {
            Self::Ieee802154(_) => Db(0.0),
            Self::Ieee80211ad(settings) => settings.antennas.greatest_gain(),
        }
    }

    /// Least noise in the bandwidth of the receivers.
    pub(crate) fn noise_floor(&self) -> Dbm {
        match self {
            Self::Ieee802154(settings) => settings.radio.least_noise_floor(),
            Self::Ieee80211ad(settings) => settings.radio.noise_floor(),
        }
    }

    /// How far back carrier sense looks; zero if radios say when the carrier changes.
    pub(crate) fn carrier_sense(&self) -> Duration {
        match self {
            Self::Ieee802154(settings) => settings.radio.phy().cca(),
            Self::Ieee80211ad(_) => Duration::ZERO,
        }
    }

    /// Number of the rules of a node's receiver among [`Technology::reception_rules`]; those of robots and sinks are the
    /// first ones.
    pub(crate) fn rule_of(&self, node: usize) -> u16 {
        match self {
            Self::Ieee802154(settings) => settings.radio.level_of(node),
            Self::Ieee80211ad(_) => 0,
        }
    }

    /// The rules of its receivers.
    pub(crate) fn reception_rules(&self) -> Vec<ReceptionRules> {
        match self {
            Self::Ieee802154(Ieee802154 { radio, reception, .. }) => {
                let rules = |levels: &Levels| ReceptionRules {
                    model: *reception,
                    sensitivity: levels.sensitivity.to_milliwatts(),
                    noise: levels.noise_floor.to_milliwatts(),
                    lock: LOCK_THRESHOLD.to_factor(),
                    carrier: None,
                    preamble: radio.phy().synchronisation_header() - radio.phy().octet(),
                    bit_rate_hz: radio.phy().bit_rate_per_s(),
                    bit_error_rate: oqpsk::bit_error_rate,
                };
                radio.all_levels().map(rules).collect()
            }
            Self::Ieee80211ad(settings) => vec![ReceptionRules {
                model: settings.reception,
                sensitivity: settings.radio.sensitivity().to_milliwatts(),
                noise: settings.radio.noise_floor().to_milliwatts(),
                lock: DMG_LOCK_THRESHOLD.to_factor(),
                carrier: Some(CarrierThresholds {
                    signal: settings.radio.cca_threshold().to_milliwatts(),
                    energy: settings.radio.energy_threshold().to_milliwatts(),
                }),
                preamble: PREAMBLE,
                // No bit errors are worked out: their rate is not known, and such settings are refused.
                bit_rate_hz: 0.0,
                bit_error_rate: |_| 0.0,
            }],
        }
    }
}
