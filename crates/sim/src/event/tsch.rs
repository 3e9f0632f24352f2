//! Events of a station's link with time-slotted channel hopping.

use sextant_mac::Class;

/// An event of a station's link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Event {
    /// The first symbol of its frame goes out.
    FrameStarts,
    /// Its frame ends.
    FrameEnds,
    /// The first symbol of its acknowledgement goes out.
    AckStarts,
    /// Its acknowledgement ends.
    AckEnds,
    /// No acknowledgement of its frame came.
    AckMissed,
    /// Its next enhanced beacon is due.
    BeaconDue,
    /// It looks whether its clock was corrected.
    SynchronisationChecked,
    /// It looks at the cells that it has agreed on.
    CellsDue,
    /// It scans, and changes to another channel.
    ChannelChanged,
    /// It has listened long enough.
    ListeningOver,
}

impl Event {
    /// Class of the event among those of the same instant.
    #[inline]
    pub(crate) const fn class(self) -> Class {
        match self {
            Self::FrameEnds | Self::AckEnds => Class::EndOfSignal,
            Self::FrameStarts | Self::AckStarts => Class::StartOfSignal,
            Self::AckMissed
            | Self::BeaconDue
            | Self::SynchronisationChecked
            | Self::CellsDue
            | Self::ChannelChanged => Class::Timer,
            Self::ListeningOver => Class::Application,
        }
    }
}
