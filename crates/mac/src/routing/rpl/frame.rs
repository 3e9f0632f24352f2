//! What a frame of a network with RPL carries: a message to neighbours, or a packet.

use sextant_kernel::StationId;

use super::datagram::Datagram;
use super::message::{DioConfiguration, ICMPV6, Message};

/// IPv6, header compressed: link-local addresses, hop limit 255, the next header in line ...
const LOCAL: u8 = 0x7B;
/// ... to all RPL stations, `ff02::1a`, ...
const TO_ALL: [u8; 3] = [0x3B, ICMPV6, 0x1A];
/// ... or to one.
const TO_ONE: [u8; 2] = [0x33, ICMPV6];
/// What a frame of a network with RPL carries.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RplFrame {
    /// A message to neighbours.
    Local(Message),
    /// A packet that may go over several hops.
    Datagram(Datagram),
}

impl RplFrame {
    /// Reads what a frame carries; `None` if that is nothing of this kind.
    #[must_use]
    pub fn read(octets: &[u8]) -> Option<Self> {
        let rest = octets.strip_prefix(&[LOCAL]);
        let message = rest.and_then(|rest| rest.strip_prefix(&TO_ALL).or_else(|| rest.strip_prefix(&TO_ONE)));
        match message {
            Some(message) => Message::read(message).map(Self::Local),
            None => Datagram::read(octets).map(Self::Datagram),
        }
    }
}

/// Writes a message to neighbours to `octets`, in place of what is there: to one if there is one, or to all.
pub fn local_octets(
    message: &Message,
    to: Option<StationId>,
    configuration: &DioConfiguration,
    octets: &mut Vec<u8>,
) {
    octets.clear();
    octets.push(LOCAL);
    match to {
        Some(_) => octets.extend(TO_ONE),
        None => octets.extend(TO_ALL),
    }
    message.write(configuration, octets);
}
