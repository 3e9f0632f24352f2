//! Sector sweeps: why a station sweeps, and what it learns.

use sextant_channel::{Db, Dbm, SectorSnr};
use sextant_kernel::StationId;

use super::network_id::NetworkId;

/// Who answers a sector sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SweepKind {
    /// All nodes that hear it.
    Gather,
    /// No station: the sender announces itself.
    Announce,
}

/// What one node answered to a sector sweep of this station.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepAnswer {
    /// The node.
    pub from: StationId,
    /// The sector of this station that the node heard best, by its identity in logs
    /// ([`Antenna::identity`](sextant_channel::Antenna::identity)); `None` if the antenna has no sectors.
    pub sector: Option<u8>,
    /// Signal-to-noise ratio at which the node heard it, as its frame reports it: in steps of 0.25 dB, -13 to 50.75 dB.
    pub snr: Db,
    /// Power of the node's best frame at this station.
    pub rssi: Dbm,
    /// The sector of the node from which it sent that frame, as the frame calls it.
    pub node_sector: u8,
    /// All sectors of this station that the node heard, by their identities in logs, ascending: in steps of 0.25 dB, -8 to
    /// 55.75 dB. Empty if the node was not asked, its report was lost, or the antenna has no sectors.
    pub sectors: Vec<SectorSnr>,
}

/// A frame of a sweep with which another station announces itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Announcement {
    /// The network in which it was received.
    pub network: NetworkId,
    /// The station that sweeps.
    pub from: StationId,
    /// The sector from which it sent the frame, by its identity in logs; `None` if its antenna has no sectors.
    pub sector: Option<u8>,
    /// Signal-to-noise ratio of the frame.
    pub snr: Db,
    /// Power of the frame.
    pub rssi: Dbm,
}

/// Why a sweep cannot begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SweepError {
    /// A sweep of this station is under way or waits, or its answer to another one is under way.
    #[error("a sweep is under way")]
    Busy,
    /// The station is not in this network, or the network has no sector sweeps.
    #[error("this station has no sector sweeps in this network")]
    NoSectors,
}
