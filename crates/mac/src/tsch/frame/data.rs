//! Data frames, and the empty ones that keep the time.

use sextant_kernel::StationId;

use super::{
    ACK_REQUEST, DESTINATION_MODE, Kind, PAN_ID_COMPRESSION, SOURCE_MODE, SlotFrameError, VERSION_2, finish, open,
};
use crate::frame::{Address, Header, HeaderAddress};

/// A data frame of a network with slots: from one station to another, which acknowledges it, or to all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SlotData<'a> {
    /// The PAN of both.
    pub pan: u16,
    /// Its sender.
    pub from: StationId,
    /// To whom it goes; `None` if to all.
    pub to: Option<StationId>,
    /// Sequence number.
    pub sequence: u8,
    /// What it carries: nothing if it keeps the time.
    pub payload: &'a [u8],
}

impl<'a> SlotData<'a> {
    /// Replaces the content of `mpdu` with the MPDU. It has as many octets as a frame of earlier revisions.
    pub fn write(&self, mpdu: &mut Vec<u8>) {
        write_header(self, 0, mpdu);
        mpdu.extend(self.payload);
        finish(mpdu);
    }

    /// Reads an MPDU.
    ///
    /// # Errors
    /// If it is not a data frame of version 2 between stations.
    pub fn parse(mpdu: &'a [u8]) -> Result<Self, SlotFrameError> {
        let (_, header, payload) = open(mpdu, Kind::Data)?;
        Self::of_header(&header, payload)
    }

    /// The frame with this header.
    pub(super) fn of_header(header: &Header, payload: &'a [u8]) -> Result<Self, SlotFrameError> {
        let sequence = header.sequence.ok_or(SlotFrameError::Missing("sequence number"))?;
        let station = |address: Option<HeaderAddress>, what| {
            address.and_then(|address| address.address.station()).ok_or(SlotFrameError::Missing(what))
        };
        let from = station(header.source, "source that is a station")?;
        let is_to_all = header.destination.is_some_and(|to| to.address == Address::BROADCAST);
        let to = match is_to_all {
            true => None,
            false => Some(station(header.destination, "destination that is a station")?),
        };
        let pan = header.destination.and_then(|to| to.pan).ok_or(SlotFrameError::Missing("PAN"))?;
        Ok(Self { pan, from, to, sequence, payload })
    }
}

/// Replaces the content of `mpdu` with the header of a data frame; `further` are bits of its frame control.
pub(super) fn write_header(frame: &SlotData<'_>, further: u16, mpdu: &mut Vec<u8>) {
    mpdu.clear();
    let source = Address::of(frame.from);
    let destination = frame.to.map_or(Address::BROADCAST, Address::of);
    let mode = |address: Address| match address {
        Address::Short(_) => 2,
        Address::Extended(_) => 3,
    };
    // With two extended addresses the bit would leave out the PAN (table 7-2).
    let are_extended = mode(source) == 3 && mode(destination) == 3;
    let control = Kind::Data as u16
        | further
        | if frame.to.is_some() { ACK_REQUEST } else { 0 }
        | if are_extended { 0 } else { PAN_ID_COMPRESSION }
        | mode(destination) << DESTINATION_MODE
        | VERSION_2
        | mode(source) << SOURCE_MODE;
    mpdu.extend(control.to_le_bytes());
    mpdu.push(frame.sequence);
    mpdu.extend(frame.pan.to_le_bytes());
    destination.write(mpdu);
    source.write(mpdu);
}
