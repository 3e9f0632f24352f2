//! How the frames of a network are told from those of others: PAN and first sequence numbers.

use sextant_kernel::{Seed, StationId};

use crate::purpose;
use crate::service::network_id::NetworkId;

/// PAN of the first network; the others follow.
const FIRST_PAN: u16 = 0x5E87;

/// PAN of a network.
pub(super) fn pan(network: NetworkId) -> u16 {
    FIRST_PAN + u16::from(network.0)
}

/// The number before that of the first frame of a station.
pub(super) fn first_sequence(scene_seed: Seed, station: StationId, network: NetworkId) -> u8 {
    let place = [station.0.into(), network.0.into(), 0];
    scene_seed.bits(purpose::SEQUENCE, place).to_be_bytes()[0]
}
