//! What a link says to the application of a station.

use sextant_channel::{Db, Milliwatts};
use sextant_kernel::StationId;

use super::radio_event::RadioNews;
use super::report::SendReport;
use super::sweep::Announcement;

/// What a link says to the application of a station.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Upcall {
    /// A frame for the station was received. Its payload is still in the buffer of the network.
    Delivered {
        station: StationId,
        from: StationId,
        sequence: u8,
        power: Milliwatts,
        sector: Option<u8>,
        snr: Option<Db>,
    },
    /// A frame of the station has ended.
    Sent { station: StationId, report: SendReport },
    /// The station has listened long enough, and nothing that it must answer is under way.
    Listened { station: StationId },
    /// The sweep of the station is over. The answers are still in the network.
    Swept { station: StationId },
    /// The radio of the station has news for its program. The payload of a frame is still in the buffer of the network.
    Radio { station: StationId, news: RadioNews },
    /// The station heard another one that announces itself.
    Announced { station: StationId, announcement: Announcement },
}

impl Upcall {
    /// The station to whose application it goes.
    pub(crate) fn station(&self) -> StationId {
        let (Self::Delivered { station, .. }
        | Self::Sent { station, .. }
        | Self::Listened { station }
        | Self::Swept { station }
        | Self::Radio { station, .. }
        | Self::Announced { station, .. }) = *self;
        station
    }
}
