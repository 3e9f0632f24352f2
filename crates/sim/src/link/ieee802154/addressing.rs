//! How the frames of a network are told from those of others: PAN, addresses and first sequence numbers.

use sextant_kernel::{Seed, SettingError, StationId};
use sextant_mac::frame::DataFrame;

use crate::link::radio_settings::FrameSize;
use crate::purpose;
use crate::service::network_id::NetworkId;
use crate::service::report::{Destination, Payload, SendError};

/// PAN of the first network; the others follow.
const FIRST_PAN: u16 = 0x5E87;

/// PAN of a network.
pub(in crate::link) fn pan(network: NetworkId) -> u16 {
    FIRST_PAN + u16::from(network.0)
}

/// The number before that of the first frame of a station.
pub(in crate::link) fn first_sequence(scene_seed: Seed, station: StationId, network: NetworkId) -> u8 {
    let place = [station.0.into(), network.0.into(), 0];
    scene_seed.bits(purpose::SEQUENCE, place).to_be_bytes()[0]
}

/// The header of the data frames of a station to others of its PAN.
pub(in crate::link) fn header(pan: u16, station: StationId, to: Destination) -> DataFrame {
    match to {
        Destination::All => DataFrame::broadcast(pan, station),
        Destination::Station(to) => DataFrame::unicast(pan, station, to),
    }
}

/// Size of the frame to all that carries a payload of this size (octets).
pub(in crate::link) fn frame_octets(payload_octets: u16) -> u16 {
    payload_octets + u16::from(DataFrame::broadcast(0, StationId(0)).overhead_octets())
}

/// Size of the frame that carries this payload behind the addresses of `frame` (octets).
///
/// # Errors
/// [`SendError::Oversized`].
pub(in crate::link) fn offered_octets(frame: &DataFrame, payload: Payload<'_>) -> Result<u8, SendError> {
    match payload {
        Payload::Filler(mpdu_octets) => {
            debug_assert!(frame.filler(mpdu_octets).is_ok(), "sizes of traffic were checked at the start");
            Ok(mpdu_octets)
        }
        Payload::Octets(octets) => {
            let allowed = frame.max_payload_octets();
            match u8::try_from(octets.len()) {
                Ok(found) if found <= allowed => Ok(found + frame.overhead_octets()),
                _ => Err(SendError::Oversized { found: octets.len(), allowed: allowed.into() }),
            }
        }
    }
}

/// Refuses frames without room for the addresses.
///
/// # Errors
/// With the key `mpdu_octets`.
pub(in crate::link) fn check_frame(frame: FrameSize) -> Result<(), SettingError> {
    let FrameSize { network, from, mpdu_octets, acknowledged } = frame;
    let pan = pan(network);
    let to = if acknowledged { Destination::Station(from) } else { Destination::All };
    header(pan, from, to).filler(mpdu_octets).map(|_| ())
}
