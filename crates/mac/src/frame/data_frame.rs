//! The data frames of stations: who sends, to whom, and how large.

use sextant_kernel::{SettingError, StationId};

use super::{Address, Endpoint, Frame};
use crate::timing::MAX_MPDU_OCTETS;

/// Octets that are neither payload nor address: frame control, sequence number, PAN, FCS.
const OVERHEAD_OCTETS: u8 = 2 + 1 + 2 + 2;
/// First octet of a payload that says nothing: not a dispatch value of 6LoWPAN or of another protocol that analysers
/// guess.
const MAGIC: u8 = 0x3F;

/// A payload that says nothing, for traffic of which only the size matters: 0x3F, then zeros.
static FILLER: [u8; MAX_MPDU_OCTETS as usize] = {
    let mut octets = [0; MAX_MPDU_OCTETS as usize];
    octets[0] = MAGIC;
    octets
};

/// A data frame from one station to another, which acknowledges it, or to all stations of the PAN.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DataFrame {
    source: Endpoint,
    destination: Endpoint,
    asks: Asks,
}

/// Whether a frame asks for an acknowledgement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Asks {
    ForAcknowledgement,
    ForNothing,
}

impl DataFrame {
    /// A frame of `from` to all stations in `pan`.
    #[must_use]
    pub fn broadcast(pan: u16, from: StationId) -> Self {
        let source = Endpoint { pan, address: Address::of(from) };
        Self { source, destination: Endpoint { pan, address: Address::BROADCAST }, asks: Asks::ForNothing }
    }

    /// A frame of `from` to one station in `pan`, which must acknowledge it.
    #[must_use]
    pub fn unicast(pan: u16, from: StationId, to: StationId) -> Self {
        let source = Endpoint { pan, address: Address::of(from) };
        Self { source, destination: Endpoint { pan, address: Address::of(to) }, asks: Asks::ForAcknowledgement }
    }

    /// The same, without a request for an acknowledgement.
    #[must_use]
    pub fn without_acknowledgement(self) -> Self {
        Self { asks: Asks::ForNothing, ..self }
    }

    /// Size of everything but the payload (octets), FCS included: 11 for two short addresses; each extended address
    /// takes six more.
    #[must_use]
    pub const fn overhead_octets(&self) -> u8 {
        OVERHEAD_OCTETS + self.source.address.octets() + self.destination.address.octets()
    }

    /// Largest payload (octets).
    #[must_use]
    pub const fn max_payload_octets(&self) -> u8 {
        MAX_MPDU_OCTETS - self.overhead_octets()
    }

    /// The payload that says nothing and fills an MPDU of `mpdu_octets`, FCS included.
    ///
    /// # Errors
    /// If `mpdu_octets` is too small for the header or larger than a radio can send. Allowed: 11 to 127 with short
    /// addresses.
    pub fn filler(&self, mpdu_octets: u8) -> Result<&'static [u8], SettingError> {
        let least = self.overhead_octets();
        if !(least..=MAX_MPDU_OCTETS).contains(&mpdu_octets) {
            let sender = self.source.address.station().map_or(String::new(), |sender| format!(" for {sender}"));
            let allowed = format!("{least} to {MAX_MPDU_OCTETS} octets{sender}");
            return Err(SettingError::new("mpdu_octets", mpdu_octets, allowed));
        }
        Ok(&FILLER[..usize::from(mpdu_octets - least)])
    }

    /// The frame with this payload.
    #[must_use]
    pub fn frame<'a>(&self, sequence: u8, payload: &'a [u8]) -> Frame<'a> {
        let mut frame = Frame::data(sequence, self.source, self.destination, payload);
        frame.ack_request = self.asks == Asks::ForAcknowledgement;
        frame
    }

    /// Replaces the content of `mpdu` with the MPDU; see [`Frame::write`].
    ///
    /// # Panics
    /// If the payload is larger than [`DataFrame::max_payload_octets`].
    pub fn write(&self, sequence: u8, payload: &[u8], mpdu: &mut Vec<u8>) {
        self.frame(sequence, payload).write(mpdu).expect("the size was checked");
    }
}
