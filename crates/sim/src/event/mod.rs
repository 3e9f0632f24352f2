//! Events of a simulation.

pub(crate) mod ieee80211ad;
pub(crate) mod ieee802154;
pub(crate) mod link;
pub(crate) mod programmed;
pub(crate) mod sleeping;
pub(crate) mod tsch;

use sextant_kernel::{Rank, StationId};
use sextant_mac::Class;

use crate::service::network_id::NetworkId;
use crate::service::sensed::TargetId;
use link::LinkEvent;

/// Number of a timer of an application: its own choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Timer(pub u16);

/// An event of a simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Event {
    /// A timer of a station's application is due.
    Timer(StationId, Timer),
    /// An event of a station's link to a network.
    Link(StationId, NetworkId, LinkEvent),
    /// A robot's drive is over.
    DriveEnded(StationId),
    /// A node that moves begins its next leg.
    NodeTurned(StationId),
    /// A target begins its next leg.
    TargetTurned(TargetId),
    /// A target enters the radius of detection of a node.
    TargetEntered(StationId, TargetId),
    /// A target leaves the radius of detection of a node.
    TargetLeft(StationId, TargetId),
    /// A target enters the radius of detection of a node, whose sensor misses it.
    TargetMissed(StationId, TargetId),
    /// The sensor of a node raises a false alarm.
    FalseAlarmRaised(StationId),
    /// A false alarm of a node about a target is over.
    FalseAlarmEnded(StationId, TargetId),
    /// A node samples the fields.
    SampleDue(StationId),
    /// A node dies.
    Died(StationId),
    /// The battery of a node may be empty.
    BatteryDue(StationId),
    /// A noise begins, or its next part.
    NoiseStarted(u16),
    /// A part of a noise ends.
    NoiseEnded(u16),
    /// The start is over: what follows is counted.
    WarmedUp,
    /// A robot has driven the next part of an arc.
    ArcPartDriven(StationId),
    /// A listener has moved so far that its halo is drawn anew.
    HaloDue(StationId),
}

impl Event {
    /// Rank of the event among those of the same instant.
    #[inline]
    pub(crate) fn rank(self) -> Rank {
        match self {
            Self::Timer(station, _)
            | Self::DriveEnded(station)
            | Self::NodeTurned(station)
            | Self::ArcPartDriven(station)
            | Self::HaloDue(station)
            | Self::TargetEntered(station, _)
            | Self::TargetLeft(station, _)
            | Self::TargetMissed(station, _)
            | Self::FalseAlarmRaised(station)
            | Self::FalseAlarmEnded(station, _)
            | Self::SampleDue(station)
            | Self::Died(station)
            | Self::BatteryDue(station) => Class::Application.rank(station),
            Self::NoiseStarted(noise) => Class::StartOfSignal.rank(StationId(noise.into())),
            Self::NoiseEnded(noise) => Class::EndOfSignal.rank(StationId(noise.into())),
            Self::WarmedUp => Class::Application.rank(StationId(0)),
            Self::TargetTurned(TargetId(target)) => Class::Application.rank(StationId(target.into())),
            Self::Link(station, _, event) => event.class().rank(station),
        }
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn an_event_fits_in_eight_bytes() {
        assert!(size_of::<super::Event>() <= 8, "{} bytes", size_of::<super::Event>());
    }
}
