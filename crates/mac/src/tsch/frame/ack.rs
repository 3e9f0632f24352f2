//! Enhanced acknowledgements.

use super::{DESTINATION_MODE, ELEMENTS, Kind, SlotFrameError, VERSION_2, elements, finish, open};
use crate::frame::{Address, Endpoint};

/// The correction is a number of 12 bits with a sign (us).
const LARGEST_CORRECTION_US: i16 = 2047;
const SMALLEST_CORRECTION_US: i16 = -2048;

/// The bit that says that there was no room for the frame.
const REFUSAL: u16 = 1 << 15;

/// An enhanced acknowledgement with a correction of the clock (IEEE 802.15.4-2015, 7.3.3 and 7.4.2.7).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EnhancedAck {
    /// Sequence number of the frame that it acknowledges.
    pub sequence: u8,
    /// The sender of that frame, if it is told.
    pub to: Option<Endpoint>,
    /// How much later than it came the frame was expected (us): -2048 to 2047. The sender, if its time source is the receiver, adds
    /// it to the start of its next slot.
    pub correction_us: i16,
    /// Whether the frame came and there was no room for it.
    pub is_refusal: bool,
}

impl EnhancedAck {
    /// The most octets that it has, with an extended address.
    pub const MOST_OCTETS: u8 = 19;

    /// Its size (octets).
    #[must_use]
    pub fn octets(&self) -> u8 {
        // Frame control, sequence number, element and check sequence; PAN and address.
        9 + self.to.map_or(0, |to| 2 + to.address.octets())
    }

    /// A correction as it fits into the frame (us).
    #[must_use]
    pub fn fitting(correction_us: i64) -> i16 {
        let fitting = correction_us.clamp(SMALLEST_CORRECTION_US.into(), LARGEST_CORRECTION_US.into());
        i16::try_from(fitting).expect("it was limited")
    }

    /// Replaces the content of `mpdu` with the MPDU.
    pub fn write(&self, mpdu: &mut Vec<u8>) {
        mpdu.clear();
        let mode = self.to.map_or(0, |to| match to.address {
            Address::Short(_) => 2,
            Address::Extended(_) => 3,
        });
        let control = Kind::Acknowledgement as u16 | ELEMENTS | VERSION_2 | mode << DESTINATION_MODE;
        mpdu.extend(control.to_le_bytes());
        mpdu.push(self.sequence);
        if let Some(to) = self.to {
            mpdu.extend(to.pan.to_le_bytes());
            to.address.write(mpdu);
        }
        let bits = Self::fitting(self.correction_us.into()).cast_unsigned() & 0x0FFF;
        let bits = if self.is_refusal { bits | REFUSAL } else { bits };
        elements::write_header(elements::TIME_CORRECTION, &bits.to_le_bytes(), mpdu);
        finish(mpdu);
    }

    /// Reads an MPDU.
    ///
    /// # Errors
    /// If it is not an enhanced acknowledgement with a correction.
    pub fn parse(mpdu: &[u8]) -> Result<Self, SlotFrameError> {
        let (control, header, mut rest) = open(mpdu, Kind::Acknowledgement)?;
        let sequence = header.sequence.ok_or(SlotFrameError::Missing("sequence number"))?;
        let to = match header.destination {
            None => None,
            Some(to) => {
                let pan = to.pan.ok_or(SlotFrameError::Missing("PAN of its destination"))?;
                Some(Endpoint { pan, address: to.address })
            }
        };
        if control & ELEMENTS == 0 {
            return Err(SlotFrameError::Missing("information elements"));
        }
        while !rest.is_empty() {
            let (id, content, others) = elements::header_element(rest)?;
            if let (elements::TIME_CORRECTION, &[low, high]) = (id, content) {
                let bits = u16::from_le_bytes([low, high]);
                // The sign is in bit 11.
                let correction_us = (bits << 4).cast_signed() >> 4;
                return Ok(Self { sequence, to, correction_us, is_refusal: bits & REFUSAL != 0 });
            }
            rest = others;
        }
        Err(SlotFrameError::Missing("correction of the clock"))
    }
}
