//! Frames of IEEE 802.15.4 as octets (2006, clause 7.2): writer and parser.
//!
//! ```
//! use sextant_mac::frame::{Address, FrameBody, Endpoint, Frame};
//!
//! let mut mpdu = Vec::new();
//! Frame::acknowledgement(0x6A).write(&mut mpdu)?;
//! assert_eq!(mpdu, [0x02, 0x00, 0x6A, 0xE4, 0x79]);
//! assert_eq!(Frame::parse(&mpdu)?.sequence, 0x6A);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod address;
mod beacon;
mod control;
mod cursor;
mod data_frame;
mod header;
#[cfg(test)]
mod tests;

pub(crate) use address::BROADCAST_PAN;
pub use address::{Address, Endpoint};
pub use beacon::{Beacon, GuaranteedSlot, Superframe};
pub use data_frame::DataFrame;
pub use header::{Header, HeaderAddress};

use crate::fcs;
use crate::timing::MAX_MPDU_OCTETS;
use control::{Control, FrameKind};
use cursor::Cursor;

/// Revision of the standard that a frame follows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Version {
    /// IEEE 802.15.4-2003.
    #[default]
    V2003,
    /// IEEE 802.15.4-2006.
    V2006,
}

/// Command of a MAC command frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum MacCommand {
    /// A device asks to join.
    AssociationRequest = 1,
    /// The coordinator answers it.
    AssociationResponse = 2,
    /// A device leaves or is sent away.
    DisassociationNotification = 3,
    /// A device asks for the frame that is pending for it.
    DataRequest = 4,
    /// Two coordinators use the same PAN identifier.
    PanIdConflictNotification = 5,
    /// A device lost its coordinator.
    OrphanNotification = 6,
    /// A device asks all coordinators for a beacon.
    BeaconRequest = 7,
    /// The coordinator changed its settings, or answers an orphan.
    CoordinatorRealignment = 8,
    /// A device asks for a guaranteed time slot.
    GtsRequest = 9,
}

impl MacCommand {
    const ALL: [Self; 9] = [
        Self::AssociationRequest,
        Self::AssociationResponse,
        Self::DisassociationNotification,
        Self::DataRequest,
        Self::PanIdConflictNotification,
        Self::OrphanNotification,
        Self::BeaconRequest,
        Self::CoordinatorRealignment,
        Self::GtsRequest,
    ];
}

/// Content of a frame, by its type.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FrameBody<'a> {
    /// A beacon of a coordinator.
    Beacon(Beacon<'a>),
    /// Data.
    Data(&'a [u8]),
    /// An acknowledgement.
    Acknowledgement,
    /// A MAC command.
    Command {
        /// The command.
        command: MacCommand,
        /// Octets after its identifier.
        payload: &'a [u8],
    },
}

/// A frame without security: an MPDU without its FCS.
///
/// Whether the source PAN is omitted (PAN ID compression) is not stored: it is omitted exactly
/// if both ends are in the same PAN.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    /// Revision of the standard.
    pub version: Version,
    /// Whether the sender has more frames for the receiver.
    pub frame_pending: bool,
    /// Whether an acknowledgement is requested.
    pub ack_request: bool,
    /// Sequence number.
    pub sequence: u8,
    /// Destination, if given.
    pub destination: Option<Endpoint>,
    /// Source, if given.
    pub source: Option<Endpoint>,
    /// Content.
    pub body: FrameBody<'a>,
}

/// Why octets are not a valid frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ParseError {
    /// The frame ends too early.
    #[error("the frame ends after {octets} octets, within its {part}")]
    Truncated {
        /// Size of the frame (octets).
        octets: usize,
        /// The part that is not complete.
        part: &'static str,
    },
    /// The frame is longer than a radio can send.
    #[error("the frame has {0} octets; allowed: at most 127")]
    Oversized(usize),
    /// The frame check sequence is wrong.
    #[error("the FCS is {found:#06x}; the octets before it give {computed:#06x}")]
    BadFcs {
        /// The value received.
        found: u16,
        /// The correct value.
        computed: u16,
    },
    /// The frame type is one of the reserved ones.
    #[error("frame type {0} is reserved; allowed: 0 to 3")]
    ReservedType(u8),
    /// The frame version is not 0 or 1.
    #[error("frame version {0} is not supported; allowed: 0 (2003) and 1 (2006)")]
    UnsupportedVersion(u8),
    /// The frame is secured.
    #[error("secured frames are not supported")]
    Secured,
    /// An address has the reserved addressing mode.
    #[error("addressing mode 1 of the {0} is reserved; allowed: 0, 2 and 3")]
    ReservedAddressingMode(&'static str),
    /// The source PAN is omitted, but an address is missing.
    #[error("PAN ID compression needs both addresses")]
    CompressionWithoutBothAddresses,
    /// The command is one of the reserved ones.
    #[error("command {0} is reserved; allowed: 1 to 9")]
    ReservedCommand(u8),
    /// An acknowledgement has octets after its header.
    #[error("{0} octets follow the header of an acknowledgement; allowed: none")]
    AcknowledgementWithPayload(usize),
}

/// Why a frame cannot be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WriteError {
    /// The frame is longer than a radio can send.
    #[error("the frame would have {0} octets; allowed: at most 127")]
    Oversized(usize),
    /// A value of a beacon does not fit in its field.
    #[error("{field} of the beacon is {found}; allowed: 0 to {allowed}")]
    BeaconField {
        /// The field.
        field: &'static str,
        /// Its value.
        found: usize,
        /// The largest value.
        allowed: usize,
    },
}

impl<'a> Frame<'a> {
    /// A data frame that requests no acknowledgement.
    #[must_use]
    pub const fn data(sequence: u8, source: Endpoint, destination: Endpoint, payload: &'a [u8]) -> Self {
        Self {
            version: Version::V2003,
            frame_pending: false,
            ack_request: false,
            sequence,
            destination: Some(destination),
            source: Some(source),
            body: FrameBody::Data(payload),
        }
    }

    /// The acknowledgement of the frame with this sequence number.
    #[must_use]
    pub const fn acknowledgement(sequence: u8) -> Self {
        Self {
            version: Version::V2003,
            frame_pending: false,
            ack_request: false,
            sequence,
            destination: None,
            source: None,
            body: FrameBody::Acknowledgement,
        }
    }

    /// Replaces the content of `mpdu` with the MPDU, FCS included. A buffer that has held a frame
    /// of this size before is not reallocated.
    ///
    /// # Errors
    /// If the frame does not fit in its format; `mpdu` then holds no valid frame.
    pub fn write(&self, mpdu: &mut Vec<u8>) -> Result<(), WriteError> {
        mpdu.clear();
        let control = self.control();
        mpdu.extend(control.to_bits().to_le_bytes());
        mpdu.push(self.sequence);
        if let Some(destination) = self.destination {
            mpdu.extend(destination.pan.to_le_bytes());
            destination.address.write(mpdu);
        }
        if let Some(source) = self.source {
            if !control.pan_id_compression {
                mpdu.extend(source.pan.to_le_bytes());
            }
            source.address.write(mpdu);
        }
        match &self.body {
            FrameBody::Beacon(beacon) => beacon.write(mpdu)?,
            FrameBody::Data(payload) => mpdu.extend(*payload),
            FrameBody::Acknowledgement => {}
            FrameBody::Command { command, payload } => {
                mpdu.push(*command as u8);
                mpdu.extend(*payload);
            }
        }
        mpdu.extend(fcs(mpdu).to_le_bytes());
        if mpdu.len() > usize::from(MAX_MPDU_OCTETS) {
            return Err(WriteError::Oversized(mpdu.len()));
        }
        Ok(())
    }

    /// Reads an MPDU, FCS included.
    ///
    /// # Errors
    /// If the octets are not a valid frame, or the frame has security or a later revision of the standard.
    pub fn parse(mpdu: &'a [u8]) -> Result<Self, ParseError> {
        if mpdu.len() > usize::from(MAX_MPDU_OCTETS) {
            return Err(ParseError::Oversized(mpdu.len()));
        }
        let Some((covered, &check)) = mpdu.split_last_chunk() else {
            return Err(ParseError::Truncated { octets: mpdu.len(), part: "FCS" });
        };
        let (found, computed) = (u16::from_le_bytes(check), fcs(covered));
        if found != computed {
            return Err(ParseError::BadFcs { found, computed });
        }
        let mut cursor = Cursor::new(covered);
        let control = Control::from_bits(cursor.u16("frame control")?)?;
        let sequence = cursor.u8("sequence number")?;
        let destination = match control.destination {
            None => None,
            Some(width) => {
                let pan = cursor.u16("destination PAN")?;
                Some(Endpoint { pan, address: Address::parse(width, &mut cursor)? })
            }
        };
        let source = match (control.source, destination) {
            (None, _) => None,
            (Some(width), Some(to)) if control.pan_id_compression => {
                Some(Endpoint { pan: to.pan, address: Address::parse(width, &mut cursor)? })
            }
            (Some(width), _) => {
                let pan = cursor.u16("source PAN")?;
                Some(Endpoint { pan, address: Address::parse(width, &mut cursor)? })
            }
        };
        let body = FrameBody::parse(control.kind, &mut cursor)?;
        let Control { version, frame_pending, ack_request, .. } = control;
        Ok(Self { version, frame_pending, ack_request, sequence, destination, source, body })
    }

    fn control(&self) -> Control {
        let same_pan = |(from, to): (Endpoint, Endpoint)| from.pan == to.pan;
        Control {
            kind: match self.body {
                FrameBody::Beacon(_) => FrameKind::Beacon,
                FrameBody::Data(_) => FrameKind::Data,
                FrameBody::Acknowledgement => FrameKind::Acknowledgement,
                FrameBody::Command { .. } => FrameKind::Command,
            },
            frame_pending: self.frame_pending,
            ack_request: self.ack_request,
            pan_id_compression: self.source.zip(self.destination).is_some_and(same_pan),
            destination: self.destination.map(|to| to.address.width()),
            version: self.version,
            source: self.source.map(|from| from.address.width()),
        }
    }
}

impl<'a> FrameBody<'a> {
    fn parse(kind: FrameKind, cursor: &mut Cursor<'a>) -> Result<Self, ParseError> {
        match kind {
            FrameKind::Beacon => Ok(FrameBody::Beacon(Beacon::parse(cursor)?)),
            FrameKind::Data => Ok(FrameBody::Data(cursor.rest())),
            FrameKind::Acknowledgement => match cursor.rest() {
                [] => Ok(FrameBody::Acknowledgement),
                surplus => Err(ParseError::AcknowledgementWithPayload(surplus.len())),
            },
            FrameKind::Command => {
                let id = cursor.u8("command identifier")?;
                let command = MacCommand::ALL.into_iter().find(|&command| command as u8 == id);
                let command = command.ok_or(ParseError::ReservedCommand(id))?;
                Ok(FrameBody::Command { command, payload: cursor.rest() })
            }
        }
    }
}
