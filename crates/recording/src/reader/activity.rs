//! Reads what radios did besides the packets of the trace: all frames on air, and when receivers are on by plan.

use std::path::Path;

use prost::Message as _;

use crate::error::RecordingError;
use crate::mcap_file::Piece;
use crate::messages::names::{CELLS_TOPIC, CHECKS_TOPIC, FRAMES_TOPIC};
use crate::messages::{CellMessage, CheckMessage, FrameMessage};

/// What radios did, as far as a recording has it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedActivity {
    /// The frames on air; none if frames were not recorded.
    pub frames: Vec<RecordedFrame>,
    /// The cells in the schedules of stations.
    pub cells: Vec<CellMessage>,
    /// When stations that sleep check the channel.
    pub checks: Vec<CheckMessage>,
}

/// A frame on air.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordedFrame {
    /// First symbol on air (ns).
    pub start_ns: u64,
    /// Time on air (ns).
    pub airtime_ns: u64,
    /// Index of the station that sent it.
    pub source: u32,
    /// What it is.
    pub kind: FrameType,
}

/// The type of a frame of IEEE 802.15.4 (2015, 7.2.2.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameType {
    /// A beacon.
    Beacon,
    /// A data frame: also one without payload, and a strobe.
    Data,
    /// An acknowledgement.
    Acknowledgement,
    /// A command of the MAC.
    Command,
    /// A multipurpose frame, such as a wake-up frame.
    Multipurpose,
    /// Another one, or one of another standard.
    Other,
}

impl FrameType {
    /// That of a MAC frame, by the lowest bits of its first octet.
    fn of(mpdu: &[u8]) -> Self {
        match mpdu.first().map(|octet| octet & 0b111) {
            Some(0) => Self::Beacon,
            Some(1) => Self::Data,
            Some(2) => Self::Acknowledgement,
            Some(3) => Self::Command,
            Some(5) => Self::Multipurpose,
            _ => Self::Other,
        }
    }
}

/// Takes a piece of the recording `path`.
pub(super) fn take(activity: &mut RecordedActivity, path: &Path, piece: &Piece<'_>) -> Result<(), RecordingError> {
    let Piece::Message { channel, data, .. } = piece else { return Ok(()) };
    let wrong = |why: prost::DecodeError| RecordingError::message(path, &channel.topic, why.to_string());
    match channel.topic.as_str() {
        FRAMES_TOPIC => {
            let FrameMessage { start_ns, airtime_ns, source, mpdu, .. } =
                FrameMessage::decode(*data).map_err(wrong)?;
            activity.frames.push(RecordedFrame { start_ns, airtime_ns, source, kind: FrameType::of(&mpdu) });
        }
        CELLS_TOPIC => activity.cells.push(CellMessage::decode(*data).map_err(wrong)?),
        CHECKS_TOPIC => activity.checks.push(CheckMessage::decode(*data).map_err(wrong)?),
        _ => {}
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_tell_their_type_in_three_bits() {
        // The first octet of an acknowledgement, of a data frame, of a beacon of 2015, and of a wake-up frame.
        let types = [0x02, 0x61, 0x00, 0x05].map(|octet| FrameType::of(&[octet, 0x88]));
        assert_eq!(types, [FrameType::Acknowledgement, FrameType::Data, FrameType::Beacon, FrameType::Multipurpose]);
        assert_eq!(FrameType::of(&[]), FrameType::Other);
    }
}
