//! Which receivers the signals on air have reached.

use sextant_kernel::StationId;

use super::receiver_id::ReceiverId;

/// Which receivers each signal on air has reached, by receiver. The lists are used again, so that no signal allocates.
#[derive(Debug, Default)]
pub(super) struct Reached {
    on_air: Vec<Listed>,
    spare: Vec<Vec<(ReceiverId, StationId)>>,
}

#[derive(Debug)]
struct Listed {
    packet: u64,
    receivers: Vec<(ReceiverId, StationId)>,
}

impl Reached {
    /// An empty list for a signal that begins.
    pub(super) fn spare(&mut self) -> Vec<(ReceiverId, StationId)> {
        self.spare.pop().unwrap_or_default()
    }

    /// A signal begins that reaches these receivers.
    pub(super) fn begin(&mut self, packet: u64, receivers: Vec<(ReceiverId, StationId)>) {
        self.on_air.push(Listed { packet, receivers });
    }

    /// The receivers that a signal on air has reached so far.
    pub(super) fn on_air(&self, packet: u64) -> &[(ReceiverId, StationId)] {
        let listed = self.on_air.iter().find(|listed| listed.packet == packet);
        listed.map_or(&[], |listed| &listed.receivers)
    }

    /// A receiver starts to listen to a signal that is on air.
    pub(super) fn join(&mut self, packet: u64, receiver: ReceiverId, station: StationId) {
        let Some(listed) = self.on_air.iter_mut().find(|listed| listed.packet == packet) else { return };
        if let Err(place) = listed.receivers.binary_search_by_key(&receiver, |&(receiver, _)| receiver) {
            listed.receivers.insert(place, (receiver, station));
        }
    }

    /// Takes the list of a signal that ends; [`Reached::give_back`] returns it.
    pub(super) fn end(&mut self, packet: u64) -> Vec<(ReceiverId, StationId)> {
        match self.on_air.iter().position(|listed| listed.packet == packet) {
            Some(place) => self.on_air.swap_remove(place).receivers,
            None => Vec::new(),
        }
    }

    /// Gives a list back.
    pub(super) fn give_back(&mut self, mut receivers: Vec<(ReceiverId, StationId)>) {
        receivers.clear();
        self.spare.push(receivers);
    }
}
