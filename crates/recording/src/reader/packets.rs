//! Reads the packet trace of a recording.

use std::path::Path;

use super::run::sound;
use crate::error::RecordingError;
use crate::mcap_file::Piece;
use crate::messages::names::{ASSESSMENTS_TOPIC, HOPS_TOPIC, PACKETS_TOPIC, TRANSMISSIONS_TOPIC};
use crate::messages::{AssessmentMessage, HopMessage, PacketMessage, TransmissionMessage};

/// A packet with its assessments and transmissions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedPacket {
    /// The packet.
    pub packet: PacketMessage,
    /// The assessments of the channel for it, in their order.
    pub assessments: Vec<AssessmentMessage>,
    /// Its transmissions, in their order.
    pub transmissions: Vec<TransmissionMessage>,
    /// Whose packet it is one hop of, if it goes over several.
    pub hop: Option<HopMessage>,
}

/// Reads the packets of the recording `path` in the order in which they ended; none if packets were not recorded. Needs
/// memory for all of them.
///
/// # Errors
/// If the file cannot be read or is damaged, or an assessment, a transmission or a hop does not follow its packet.
pub fn read_packets(path: &Path) -> Result<Vec<RecordedPacket>, RecordingError> {
    let mut packets: Vec<RecordedPacket> = Vec::new();
    sound(path, &mut |piece| take(&mut packets, path, &piece))?;
    Ok(packets)
}

/// Takes a piece of the recording `path`.
pub(crate) fn take(packets: &mut Vec<RecordedPacket>, path: &Path, piece: &Piece<'_>) -> Result<(), RecordingError> {
    let Piece::Message { channel, data, .. } = piece else { return Ok(()) };
    let wrong = |problem: String| RecordingError::message(path, &channel.topic, problem);
    add(packets, &channel.topic, data).map_err(wrong)
}

fn add(packets: &mut Vec<RecordedPacket>, topic: &str, data: &[u8]) -> Result<(), String> {
    fn last(packets: &mut [RecordedPacket], id: u64) -> Result<&mut RecordedPacket, String> {
        let last = packets.last_mut().filter(|last| last.packet.packet == id);
        last.ok_or_else(|| format!("packet {id} is not the one before"))
    }
    match topic {
        PACKETS_TOPIC => {
            let packet = decode(data)?;
            packets.push(RecordedPacket { packet, ..RecordedPacket::default() });
        }
        ASSESSMENTS_TOPIC => {
            let assessment: AssessmentMessage = decode(data)?;
            last(packets, assessment.packet)?.assessments.push(assessment);
        }
        TRANSMISSIONS_TOPIC => {
            let transmission: TransmissionMessage = decode(data)?;
            last(packets, transmission.packet)?.transmissions.push(transmission);
        }
        HOPS_TOPIC => {
            let hop: HopMessage = decode(data)?;
            let id = hop.packet;
            last(packets, id)?.hop = Some(hop);
        }
        _ => {}
    }
    Ok(())
}

fn decode<M: prost::Message + Default>(data: &[u8]) -> Result<M, String> {
    M::decode(data).map_err(|why| why.to_string())
}
