//! How the nodes share the channel.

use sextant_kernel::{SettingError, SimTime, StationId};
use sextant_mac::csma::{self, Csma, CsmaSettings, OutgoingFrame, Report};
use sextant_mac::device::{self, Device};
use sextant_mac::frame::{Address, Beacon};
use sextant_mac::superframe::BeaconEnabled;
use sextant_mac::{Phy, RadioState};

use crate::link::config::MacConfig;

/// How nodes share the channel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Mac {
    /// Unslotted CSMA-CA.
    CsmaUnslotted(CsmaSettings),
    /// Superframes of a coordinator.
    BeaconEnabled(BeaconEnabled),
}

impl TryFrom<MacConfig> for Mac {
    type Error = SettingError;

    fn try_from(config: MacConfig) -> Result<Self, SettingError> {
        let key = config.key();
        let own = match config {
            MacConfig::CsmaUnslotted(csma) => CsmaSettings::try_from(csma).map(Self::CsmaUnslotted),
            MacConfig::BeaconEnabled(beacons) => BeaconEnabled::try_from(beacons).map(Self::BeaconEnabled),
            MacConfig::Program(_) | MacConfig::SectorSweep(_) | MacConfig::Tsch(_) | MacConfig::Sleep(_) => {
                let allowed = "`csma_unslotted` or `beacon_enabled`, the channel access of IEEE 802.15.4";
                return Err(SettingError::new(key, "set for IEEE 802.15.4", allowed));
            }
        };
        own.map_err(|error| error.within(key))
    }
}

impl Mac {
    /// Settings of contention, slotted or unslotted.
    #[must_use]
    pub fn csma(&self) -> CsmaSettings {
        match self {
            Self::CsmaUnslotted(csma) => *csma,
            Self::BeaconEnabled(beacons) => beacons.csma(),
        }
    }

    /// The initial state of a node's radio.
    pub(crate) fn initial_state(&self) -> RadioState {
        match self {
            Self::CsmaUnslotted(csma) => csma.state_without_frame(),
            Self::BeaconEnabled(_) => Device::INITIAL_STATE,
        }
    }

    /// The MAC of a node.
    pub(crate) fn of(&self, node: StationId, phy: Phy) -> NodeMac {
        match self {
            Self::CsmaUnslotted(csma) => NodeMac::Unslotted(Csma::new(*csma, phy)),
            Self::BeaconEnabled(beacons) => {
                NodeMac::Device(Box::new(Device::new(beacons, phy, short_address(node).unwrap_or(Address::NONE))))
            }
        }
    }

    /// The MAC of a robot or a sink, whose receiver is on at rest.
    pub(crate) fn of_collector(&self, phy: Phy) -> NodeMac {
        match self {
            Self::CsmaUnslotted(csma) => NodeMac::Unslotted(Csma::new(csma.with_receiver_on(), phy)),
            Self::BeaconEnabled(_) => NodeMac::ReceivesOnly,
        }
    }
}

/// The short address of a station, if it has one.
pub(crate) fn short_address(station: StationId) -> Option<u16> {
    match Address::of(station) {
        Address::Short(short) => Some(short),
        Address::Extended(_) => None,
    }
}

/// The channel access of one station.
pub(crate) enum NodeMac {
    Unslotted(Csma),
    Device(Box<Device>),
    /// A station that sends no data: the coordinator of superframes.
    ReceivesOnly,
}

impl NodeMac {
    pub(crate) fn is_transmitter(&self) -> bool {
        !matches!(self, Self::ReceivesOnly)
    }

    pub(crate) fn follows_beacons(&self) -> bool {
        matches!(self, Self::Device(_))
    }

    #[inline]
    pub(crate) fn is_busy(&self) -> bool {
        match self {
            Self::Unslotted(csma) => csma.is_busy(),
            Self::Device(device) => device.is_busy(),
            Self::ReceivesOnly => false,
        }
    }

    /// Whether an acknowledgement that is received may mean something to it.
    #[inline]
    pub(crate) fn awaits_acknowledgement(&self) -> bool {
        match self {
            Self::Unslotted(csma) => csma.awaits_acknowledgement(),
            Self::Device(device) => device.is_busy(),
            Self::ReceivesOnly => false,
        }
    }

    #[inline]
    pub(crate) fn start(&mut self, now: SimTime, frame: OutgoingFrame, radio: &mut impl device::Radio) {
        match self {
            Self::Unslotted(csma) => csma.start(frame, radio),
            Self::Device(device) => device.start(now, frame, radio),
            Self::ReceivesOnly => unreachable!("it is given no frame"),
        }
    }

    #[inline]
    pub(crate) fn handle(
        &mut self,
        now: SimTime,
        event: csma::Event,
        radio: &mut impl device::Radio,
    ) -> Option<Report> {
        match self {
            Self::Unslotted(csma) => csma.handle(event, radio),
            Self::Device(device) => device.handle_csma(now, event, radio),
            Self::ReceivesOnly => unreachable!("it has no channel access"),
        }
    }

    /// Handles an event of following beacons.
    pub(crate) fn track(&mut self, now: SimTime, event: device::Event, radio: &mut impl device::Radio) {
        match self {
            Self::Device(device) => device.handle(now, event, radio),
            Self::Unslotted(_) | Self::ReceivesOnly => unreachable!("only devices follow beacons"),
        }
    }

    /// A beacon of `octets` was received; a station without superframes ignores it.
    pub(crate) fn receive_beacon(
        &mut self,
        now: SimTime,
        octets: u8,
        beacon: &Beacon<'_>,
        radio: &mut impl device::Radio,
    ) {
        if let Self::Device(device) = self {
            device.receive_beacon(now, octets, beacon, radio);
        }
    }
}
