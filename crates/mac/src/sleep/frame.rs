//! The frames of CSL, to the octet: wake-up frames, and acknowledgements with the phase (IEEE 802.15.4-2015, 7.3.5, 7.4.2.3 and
//! 7.4.2.6).
//!
//! ```
//! use sextant_kernel::StationId;
//! use sextant_mac::sleep::frame::WakeUpFrame;
//!
//! let frame = WakeUpFrame { pan: 0xABCD, to: Some(StationId(5)), rendezvous: 300 };
//! let mut mpdu = Vec::new();
//! frame.write(&mut mpdu);
//! assert_eq!(mpdu[..10], [0x2D, 0x85, 0xCD, 0xAB, 0x05, 0x00, 0x82, 0x0E, 0x2C, 0x01]);
//! assert_eq!(WakeUpFrame::parse(&mpdu), Some(frame));
//! ```

use std::time::Duration;

use sextant_kernel::StationId;

use super::settings::GUARD_SYMBOLS;
use crate::frame::{Address, Header};
use crate::tsch::frame::{elements, finish};
use crate::{Phy, fcs};

/// The unit of phases, periods and times to the rendezvous: ten symbols.
#[must_use]
pub fn unit(phy: Phy) -> Duration {
    phy.symbols(GUARD_SYMBOLS)
}

/// A span in whole units, at most as much as a frame can tell.
#[must_use]
pub fn rendezvous_units(span: Duration, phy: Phy) -> u16 {
    u16::try_from(span.as_nanos() / unit(phy).as_nanos()).unwrap_or(u16::MAX)
}

/// Multipurpose, with a long frame control and a short destination.
const MULTIPURPOSE: u8 = 5 | 1 << 3 | 2 << 4;
/// The PAN is given, the sequence number is left out, information elements follow.
const WITH_PAN_AND_ELEMENTS: u8 = 1 | 1 << 2 | 1 << 7;

/// An acknowledgement of version 2 with information elements and a short destination.
const ACKNOWLEDGEMENT: u16 = 2 | 1 << 9 | 2 << 10 | 2 << 12;

/// The same without elements and destination.
const PLAIN_ACKNOWLEDGEMENT: u16 = 2 | 2 << 12;

const RENDEZVOUS_TIME: u16 = 0x1D;
const CSL: u16 = 0x1A;

/// A wake-up frame: who is meant, and when the frame that it announces comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WakeUpFrame {
    /// The PAN.
    pub pan: u16,
    /// Whom it wakes; `None` if all.
    pub to: Option<StationId>,
    /// Time from its end to the first symbol of the frame that it announces (units of ten symbols).
    pub rendezvous: u16,
}

impl WakeUpFrame {
    /// Replaces the content of `mpdu` with the MPDU: 12 octets for a station with a short address.
    pub fn write(&self, mpdu: &mut Vec<u8>) {
        mpdu.clear();
        mpdu.extend([MULTIPURPOSE, WITH_PAN_AND_ELEMENTS]);
        mpdu.extend(self.pan.to_le_bytes());
        self.to.map_or(Address::BROADCAST, Address::of).write(mpdu);
        elements::write_header(RENDEZVOUS_TIME, &self.rendezvous.to_le_bytes(), mpdu);
        finish(mpdu);
    }

    /// Reads an MPDU; `None` if it is no wake-up frame.
    #[must_use]
    pub fn parse(mpdu: &[u8]) -> Option<Self> {
        let covered = checked(mpdu)?;
        let (header, rest) = Header::split(covered).ok()?;
        let to = header.destination?;
        if covered.first() != Some(&MULTIPURPOSE) {
            return None;
        }
        let content = element(rest, RENDEZVOUS_TIME)?;
        let rendezvous = u16::from_le_bytes(*content.first_chunk()?);
        let to_station = if to.address == Address::BROADCAST { None } else { Some(to.address.station()?) };
        Some(Self { pan: to.pan?, to: to_station, rendezvous })
    }
}

/// An acknowledgement that tells when its sender listens next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CslAck {
    /// Sequence number of the frame that it acknowledges.
    pub sequence: u8,
    /// The PAN.
    pub pan: u16,
    /// The sender of that frame; all if it is not told.
    pub to: Option<StationId>,
    /// Time from the first symbol of the acknowledgement to when the receiver is on next (units of ten symbols).
    pub phase: u16,
    /// From one such instant to the next (the same units).
    pub period: u16,
}

impl CslAck {
    /// Its size with a short address (octets).
    pub const OCTETS: u8 = 15;

    /// Replaces the content of `mpdu` with the MPDU.
    pub fn write(&self, mpdu: &mut Vec<u8>) {
        mpdu.clear();
        mpdu.extend(ACKNOWLEDGEMENT.to_le_bytes());
        mpdu.push(self.sequence);
        mpdu.extend(self.pan.to_le_bytes());
        self.to.map_or(Address::BROADCAST, Address::of).write(mpdu);
        let [phase, period] = [self.phase, self.period].map(u16::to_le_bytes);
        elements::write_header(CSL, &[phase[0], phase[1], period[0], period[1]], mpdu);
        finish(mpdu);
    }

    /// Reads an MPDU; `None` if it is no such acknowledgement.
    #[must_use]
    pub fn parse(mpdu: &[u8]) -> Option<Self> {
        let covered = checked(mpdu)?;
        let (header, rest) = Header::split(covered).ok()?;
        let to = header.destination?;
        if covered.first_chunk().map(|octets| u16::from_le_bytes(*octets)) != Some(ACKNOWLEDGEMENT) {
            return None;
        }
        let &[a, b, c, d] = element(rest, CSL)?.first_chunk()?;
        let [phase, period] = [[a, b], [c, d]].map(u16::from_le_bytes);
        let to_station = if to.address == Address::BROADCAST { None } else { Some(to.address.station()?) };
        Some(Self { sequence: header.sequence?, pan: to.pan?, to: to_station, phase, period })
    }
}

/// Replaces the content of `mpdu` with an acknowledgement of version 2 that tells nothing: that of a station that is always on.
pub fn write_plain_ack(sequence: u8, mpdu: &mut Vec<u8>) {
    mpdu.clear();
    mpdu.extend(PLAIN_ACKNOWLEDGEMENT.to_le_bytes());
    mpdu.push(sequence);
    finish(mpdu);
}

/// The octets before a check sequence that is right.
fn checked(mpdu: &[u8]) -> Option<&[u8]> {
    let (covered, check) = mpdu.split_last_chunk()?;
    (u16::from_le_bytes(*check) == fcs(covered)).then_some(covered)
}

/// The content of the element of a header with this number.
fn element(mut octets: &[u8], wanted: u16) -> Option<&[u8]> {
    loop {
        let (id, content, rest) = elements::header_element(octets).ok()?;
        if id == wanted {
            return Some(content);
        }
        octets = rest;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_of_csl_are_read_as_they_were_written() {
        let mut mpdu = Vec::new();
        for to in [None, Some(StationId(7))] {
            let frame = WakeUpFrame { pan: 0x5E87, to, rendezvous: 781 };
            frame.write(&mut mpdu);
            assert_eq!((mpdu.len(), WakeUpFrame::parse(&mpdu)), (12, Some(frame)));
            mpdu[8] ^= 1;
            assert_eq!(WakeUpFrame::parse(&mpdu), None);
        }
        let ack = CslAck { sequence: 9, pan: 0x5E87, to: Some(StationId(2)), phase: 17, period: 781 };
        ack.write(&mut mpdu);
        assert_eq!((mpdu.len(), CslAck::parse(&mpdu)), (usize::from(CslAck::OCTETS), Some(ack)));
        assert_eq!(WakeUpFrame::parse(&mpdu), None);
    }
}
