//! Frames of networks with slots, to the octet: data, messages about cells, enhanced acknowledgements and enhanced beacons (IEEE 802.15.4-2015, 7.3
//! and 7.4). They have the frame version 2, which information elements need.
//!
//! ```
//! use sextant_mac::tsch::frame::EnhancedAck;
//!
//! let acknowledgement = EnhancedAck { sequence: 7, to: None, correction_us: 100, is_refusal: false };
//! let mut mpdu = Vec::new();
//! acknowledgement.write(&mut mpdu);
//! assert_eq!(mpdu, [0x02, 0x22, 0x07, 0x02, 0x0F, 0x64, 0x00, 0xD5, 0xFB]);
//! assert_eq!(EnhancedAck::parse(&mpdu)?, acknowledgement);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod ack;
mod beacon;
mod data;
pub(crate) mod elements;
mod six_p;
#[cfg(test)]
mod tests;

pub use ack::EnhancedAck;
pub use beacon::{AdvertisedCell, AdvertisedSlotframe, EnhancedBeacon};
pub use data::SlotData;
pub use six_p::SixPFrame;

use crate::fcs;
use crate::frame::{Header, ParseError};

/// Why octets are not a frame of a network with slots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SlotFrameError {
    /// The header is invalid.
    #[error(transparent)]
    Header(#[from] ParseError),
    /// The octets end within an information element.
    #[error("the frame ends within an information element")]
    TruncatedElement,
    /// The frame is of another type or version.
    #[error("the frame control is {0:#06x}; allowed: that of {1}, of version 2")]
    OtherFrame(u16, &'static str),
    /// Something that the frame needs is not there.
    #[error("the frame has no {0}")]
    Missing(&'static str),
}

/// Type of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
enum Kind {
    Beacon = 0,
    Data = 1,
    Acknowledgement = 2,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Beacon => "an enhanced beacon",
            Self::Data => "data",
            Self::Acknowledgement => "an enhanced acknowledgement",
        }
    }
}

const ACK_REQUEST: u16 = 1 << 5;
const PAN_ID_COMPRESSION: u16 = 1 << 6;
const ELEMENTS: u16 = 1 << 9;
const DESTINATION_MODE: u32 = 10;
const VERSION_2: u16 = 2 << 12;
const SOURCE_MODE: u32 = 14;

/// Adds the frame check sequence.
pub(crate) fn finish(mpdu: &mut Vec<u8>) {
    mpdu.extend(fcs(mpdu).to_le_bytes());
}

/// The frame control, header and the octets after the addresses of a frame of this kind, without its check sequence.
fn open(mpdu: &[u8], kind: Kind) -> Result<(u16, Header, &[u8]), SlotFrameError> {
    let Some((covered, &check)) = mpdu.split_last_chunk() else {
        return Err(ParseError::Truncated { octets: mpdu.len(), part: "FCS" }.into());
    };
    let (found, computed) = (u16::from_le_bytes(check), fcs(covered));
    if found != computed {
        return Err(ParseError::BadFcs { found, computed }.into());
    }
    let (header, rest) = Header::split(covered)?;
    let control = covered.first_chunk().map_or(0, |octets| u16::from_le_bytes(*octets));
    if control & 7 != kind as u16 || control >> 12 & 3 != 2 {
        return Err(SlotFrameError::OtherFrame(control, kind.name()));
    }
    Ok((control, header, rest))
}
