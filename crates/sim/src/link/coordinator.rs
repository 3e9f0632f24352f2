//! What a technology needs to know to set up the station that sends beacons.

use std::time::Duration;

use sextant_kernel::{Seed, StationId};

use crate::service::network_id::NetworkId;
use crate::world::layout::PlacedNode;

/// The station that sends beacons.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Post {
    pub(crate) station: StationId,
    /// Number of the robot that it is, and how long that listens at a stop; `None` if it always listens.
    pub(crate) listen: Option<(usize, Duration)>,
}

/// Frames that the nodes send.
#[derive(Clone, Debug)]
pub(crate) struct Demand {
    /// Key of the table that says so.
    pub(crate) key: String,
    pub(crate) mpdu_octets: u8,
    pub(crate) acknowledged: bool,
}

/// Who sends beacons to whom, and what the nodes send.
#[derive(Clone, Debug)]
pub(crate) struct Coordination<'a> {
    pub(crate) network: NetworkId,
    pub(crate) seed: Seed,
    pub(crate) post: Post,
    pub(crate) nodes: &'a [PlacedNode],
    pub(crate) demands: &'a [Demand],
}
