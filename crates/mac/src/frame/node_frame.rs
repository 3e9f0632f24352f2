//! The frame that a node sends.

use sextant_kernel::{NodeId, SettingError};

use super::{Address, Endpoint, Frame};
use crate::timing::MAX_MPDU_OCTETS;

/// Octets that are neither payload nor address: frame control, sequence number, PAN, FCS.
const OVERHEAD_OCTETS: u8 = 2 + 1 + 2 + 2;
/// First octet of the payload: not a dispatch value of 6LoWPAN or of another protocol that analysers guess.
const MAGIC: u8 = 0x3F;

/// The frame of a node: a data frame of a given size within its PAN. Payload: 0x3F, then zeros.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NodeFrame {
    source: Endpoint,
    destination: Endpoint,
    mpdu_octets: u8,
}

impl NodeFrame {
    /// The broadcast of `node` in `pan`, with an MPDU of `mpdu_octets`, FCS included.
    ///
    /// # Errors
    /// If `mpdu_octets` is too small for the header or larger than a radio can send. Allowed: 11 to 127;
    /// 17 to 127 for nodes beyond n65533, which have extended addresses.
    pub fn broadcast(pan: u16, node: NodeId, mpdu_octets: u8) -> Result<Self, SettingError> {
        Self::new(pan, node, Address::BROADCAST, mpdu_octets)
    }

    /// A frame of `node` to one station in `pan`, which must acknowledge it.
    ///
    /// # Errors
    /// As for [`NodeFrame::broadcast`]; the minimum is six octets larger for a station beyond n65533.
    pub fn acknowledged(pan: u16, node: NodeId, to: NodeId, mpdu_octets: u8) -> Result<Self, SettingError> {
        Self::new(pan, node, Address::of(to), mpdu_octets)
    }

    fn new(pan: u16, node: NodeId, to: Address, mpdu_octets: u8) -> Result<Self, SettingError> {
        let source = Endpoint { pan, address: Address::of(node) };
        let destination = Endpoint { pan, address: to };
        let frame = Self { source, destination, mpdu_octets };
        let least = frame.overhead_octets();
        if !(least..=MAX_MPDU_OCTETS).contains(&mpdu_octets) {
            let allowed = format!("{least} to {MAX_MPDU_OCTETS} octets for node {node}");
            return Err(SettingError::new("mpdu_octets", mpdu_octets, allowed));
        }
        Ok(frame)
    }

    /// Size of its MPDU (octets).
    #[must_use]
    pub const fn mpdu_octets(&self) -> u8 {
        self.mpdu_octets
    }

    const fn overhead_octets(&self) -> u8 {
        OVERHEAD_OCTETS + self.source.address.octets() + self.destination.address.octets()
    }

    /// Replaces the content of `mpdu` with the MPDU; see [`Frame::write`].
    pub fn write(&self, sequence: u8, mpdu: &mut Vec<u8>) {
        let mut payload = [0; MAX_MPDU_OCTETS as usize];
        payload[0] = MAGIC;
        let payload = &payload[..usize::from(self.mpdu_octets - self.overhead_octets())];
        let mut frame = Frame::data(sequence, self.source, self.destination, payload);
        frame.ack_request = self.destination.address != Address::BROADCAST;
        frame.write(mpdu).expect("the size was checked");
    }
}
