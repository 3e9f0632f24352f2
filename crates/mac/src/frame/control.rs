//! The frame control field.

use super::address::Width;
use super::{ParseError, Version};

const SECURITY_ENABLED: u16 = 1 << 3;
const FRAME_PENDING: u16 = 1 << 4;
const ACK_REQUEST: u16 = 1 << 5;
const PAN_ID_COMPRESSION: u16 = 1 << 6;
const DESTINATION_MODE: u32 = 10;
const VERSION: u32 = 12;
const SOURCE_MODE: u32 = 14;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FrameKind {
    Beacon,
    Data,
    Acknowledgement,
    Command,
}

/// The frame control field (IEEE 802.15.4-2006, 7.2.1.1), of frames without security.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Control {
    pub(super) kind: FrameKind,
    pub(super) frame_pending: bool,
    pub(super) ack_request: bool,
    /// The source PAN is omitted: it is the same as the destination PAN.
    pub(super) pan_id_compression: bool,
    pub(super) destination: Option<Width>,
    pub(super) version: Version,
    pub(super) source: Option<Width>,
}

impl Control {
    pub(super) fn to_bits(self) -> u16 {
        let flag = |is_set: bool, bit: u16| if is_set { bit } else { 0 };
        let mode = |width: Option<Width>| match width {
            None => 0,
            Some(Width::Short) => 2,
            Some(Width::Extended) => 3,
        };
        let kind = match self.kind {
            FrameKind::Beacon => 0,
            FrameKind::Data => 1,
            FrameKind::Acknowledgement => 2,
            FrameKind::Command => 3,
        };
        let version = match self.version {
            Version::V2003 => 0,
            Version::V2006 => 1,
        };
        kind | flag(self.frame_pending, FRAME_PENDING)
            | flag(self.ack_request, ACK_REQUEST)
            | flag(self.pan_id_compression, PAN_ID_COMPRESSION)
            | mode(self.destination) << DESTINATION_MODE
            | version << VERSION
            | mode(self.source) << SOURCE_MODE
    }

    /// Bits 7 to 9 are reserved and ignored, as the standard says.
    pub(super) fn from_bits(bits: u16) -> Result<Self, ParseError> {
        let is_set = |bit| bits & bit != 0;
        let version = match bits >> VERSION & 3 {
            0 => Version::V2003,
            1 => Version::V2006,
            2 => return Err(ParseError::UnsupportedVersion(2)),
            _ => return Err(ParseError::UnsupportedVersion(3)),
        };
        let kind = match bits & 7 {
            0 => FrameKind::Beacon,
            1 => FrameKind::Data,
            2 => FrameKind::Acknowledgement,
            3 => FrameKind::Command,
            _ => return Err(ParseError::ReservedType(bits.to_le_bytes()[0] & 7)),
        };
        if is_set(SECURITY_ENABLED) {
            return Err(ParseError::Secured);
        }
        let width = |shift: u32, whose| match bits >> shift & 3 {
            0 => Ok(None),
            1 => Err(ParseError::ReservedAddressingMode(whose)),
            2 => Ok(Some(Width::Short)),
            _ => Ok(Some(Width::Extended)),
        };
        let destination = width(DESTINATION_MODE, "destination")?;
        let source = width(SOURCE_MODE, "source")?;
        let pan_id_compression = is_set(PAN_ID_COMPRESSION);
        if pan_id_compression && (destination.is_none() || source.is_none()) {
            return Err(ParseError::CompressionWithoutBothAddresses);
        }
        Ok(Self {
            kind,
            frame_pending: is_set(FRAME_PENDING),
            ack_request: is_set(ACK_REQUEST),
            pan_id_compression,
            destination,
            version,
            source,
        })
    }
}
