//! Frames that carry a message of the 6top protocol.

use sextant_kernel::StationId;

use super::data::{SlotData, write_header};
use super::{ELEMENTS, Kind, SlotFrameError, elements, finish, open};

/// Before the message in its element of the IETF: which of the protocols it is (RFC 8480, section 3.1, and RFC 8137).
const SIX_P: u8 = 0xC9;

/// A frame with a message of the 6top protocol, in an information element of the IETF.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SixPFrame<'a> {
    /// The PAN of both.
    pub pan: u16,
    /// Its sender.
    pub from: StationId,
    /// To whom it goes.
    pub to: StationId,
    /// Sequence number of the frame.
    pub sequence: u8,
    /// The message.
    pub message: &'a [u8],
}

impl<'a> SixPFrame<'a> {
    /// What it has beyond the message and an empty data frame (octets): two descriptors of elements, and which protocol it is.
    pub const ELEMENT_OCTETS: u8 = 5;

    /// Replaces the content of `mpdu` with the MPDU.
    pub fn write(&self, mpdu: &mut Vec<u8>) {
        let &Self { pan, from, to, sequence, message } = self;
        write_header(&SlotData { pan, from, to: Some(to), sequence, payload: &[] }, ELEMENTS, mpdu);
        elements::write_header(elements::PAYLOAD_FOLLOWS, &[], mpdu);
        let mut content = vec![SIX_P];
        content.extend(message);
        elements::write_payload(elements::IETF, &content, mpdu);
        finish(mpdu);
    }

    /// Reads an MPDU.
    ///
    /// # Errors
    /// If it is not a data frame between stations with such a message.
    pub fn parse(mpdu: &'a [u8]) -> Result<Self, SlotFrameError> {
        let (control, header, mut rest) = open(mpdu, Kind::Data)?;
        if control & ELEMENTS == 0 {
            return Err(SlotFrameError::Missing("information elements"));
        }
        let SlotData { pan, from, to, sequence, .. } = SlotData::of_header(&header, &[])?;
        let to = to.ok_or(SlotFrameError::Missing("destination that is a station"))?;
        loop {
            let (id, _, others) = elements::header_element(rest)?;
            rest = others;
            if id == elements::PAYLOAD_FOLLOWS {
                break;
            }
        }
        while !rest.is_empty() {
            let (group, content, others) = elements::payload_element(rest)?;
            rest = others;
            if let (elements::IETF, Some((&SIX_P, message))) = (group, content.split_first()) {
                return Ok(Self { pan, from, to, sequence, message });
            }
        }
        Err(SlotFrameError::Missing("message of the 6top protocol"))
    }
}
