//! The technologies of links.

use std::time::Duration;

use sextant_channel::Dbm;
use sextant_mac::{Band, oqpsk};

use super::ieee802154::{Mac, Radio};
use crate::air::{ReceptionModel, ReceptionRules};

/// The technology of the links of a network, with its settings.
#[derive(Clone, Debug)]
pub enum Technology {
    /// IEEE 802.15.4.
    Ieee802154(Ieee802154),
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

/// A part of the radio spectrum: networks that share it disturb each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Spectrum {
    /// A channel of a band of IEEE 802.15.4.
    Ieee802154(Band, u8),
}

impl Technology {
    /// The settings of IEEE 802.15.4, if that is the technology.
    #[must_use]
    pub fn ieee802154(&self) -> Option<&Ieee802154> {
        match self {
            Self::Ieee802154(settings) => Some(settings),
        }
    }

    /// The same, to change them.
    pub fn ieee802154_mut(&mut self) -> Option<&mut Ieee802154> {
        match self {
            Self::Ieee802154(settings) => Some(settings),
        }
    }

    /// The part of the spectrum that it uses.
    pub(crate) fn spectrum(&self) -> Spectrum {
        match self {
            Self::Ieee802154(Ieee802154 { radio, .. }) => Spectrum::Ieee802154(radio.phy().band(), radio.channel()),
        }
    }

    /// Largest transmit power, antennas included.
    pub(crate) fn greatest_power(&self) -> Dbm {
        match self {
            Self::Ieee802154(settings) => settings.radio.tx_power(),
        }
    }

    /// Noise in the bandwidth of the receivers.
    pub(crate) fn noise_floor(&self) -> Dbm {
        match self {
            Self::Ieee802154(settings) => settings.radio.noise_floor(),
        }
    }

    /// How far back carrier sense looks.
    pub(crate) fn carrier_sense(&self) -> Duration {
        match self {
            Self::Ieee802154(settings) => settings.radio.phy().cca(),
        }
    }

    /// The rules of its receivers.
    pub(crate) fn reception_rules(&self) -> ReceptionRules {
        match self {
            Self::Ieee802154(Ieee802154 { radio, reception, .. }) => ReceptionRules {
                model: *reception,
                sensitivity: radio.sensitivity().to_milliwatts(),
                noise: radio.noise_floor().to_milliwatts(),
                preamble: radio.phy().synchronisation_header() - radio.phy().octet(),
                bit_rate_hz: radio.phy().bit_rate_per_s(),
                bit_error_rate: oqpsk::bit_error_rate,
            },
        }
    }
}
