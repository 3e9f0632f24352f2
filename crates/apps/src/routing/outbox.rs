//! The packets that wait in a station.

use std::collections::VecDeque;

use sextant_kernel::StationId;
use sextant_mac::routing::Data;
use sextant_mac::routing::rpl::{Content, Datagram, Message};
use sextant_sim::FrameId;

/// A packet that waits in a station, or is under way to the next one.
#[derive(Clone, Debug)]
pub(super) struct Outgoing {
    pub(super) data: Data,
    pub(super) heading: Heading,
    /// Size of its payload with the header of the packet (octets); more if the header needs more.
    pub(super) octets: usize,
    /// How often it was sent again.
    pub(super) resends: u8,
    /// What of it was sent, if it goes in fragments.
    pub(super) pieces: Pieces,
}

/// What of a packet in fragments was sent.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pieces {
    /// To whom the first piece went.
    to: Option<StationId>,
    /// The number by which its receiver knows the packet.
    pub(super) tag: u16,
    /// The piece to send now.
    pub(super) number: usize,
}

/// Which way a packet goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Heading {
    /// To the parent.
    Up,
    /// Along these stations.
    Down(Vec<StationId>),
    /// As RPL has it.
    Rpl(Box<Datagram>),
    /// A message of RPL to a neighbour.
    Neighbour(StationId, Message),
}

impl Outgoing {
    /// A packet that was not sent yet.
    pub(super) fn new(data: Data, heading: Heading, octets: usize) -> Self {
        Self { data, heading, octets, resends: 0, pieces: Pieces::default() }
    }

    /// What it is.
    pub(super) fn kind(&self) -> Kind {
        let message = match &self.heading {
            Heading::Up | Heading::Down(_) => return Kind::Packet,
            Heading::Neighbour(_, message) => message,
            Heading::Rpl(datagram) => match &datagram.content {
                Content::Data(_) => return Kind::Packet,
                Content::Message(message) => message,
            },
        };
        match message {
            Message::DaoAck(_) => Kind::DaoAck,
            Message::Dao(dao) if dao.lifetime_min == 0 => Kind::NoPath,
            Message::Dao(_) | Message::Dio(_) | Message::Dis => Kind::Dao,
        }
    }

    /// Whether it is given to the MAC again if it did not reach the next station. A copy of a message over several hops would be
    /// sent on as such, and its origin sends it again anyway if it is not answered.
    pub(super) fn is_tried_again(&self) -> bool {
        let is_over_hops = matches!(self.heading, Heading::Rpl(_));
        match self.kind() {
            Kind::Packet => true,
            Kind::Dao | Kind::DaoAck => !is_over_hops,
            Kind::NoPath => false,
        }
    }

    /// Whether it is a packet with data, and no message of RPL.
    pub(super) fn is_data(&self) -> bool {
        self.kind() == Kind::Packet
    }
}

/// What waits in a station.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A packet with data.
    Packet,
    /// A message that a station can be reached, ...
    Dao,
    /// ... or no longer: it is not given to the MAC again.
    NoPath,
    /// An answer to such a message.
    DaoAck,
}

/// A packet that the MAC has.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sent {
    pub(super) frame: FrameId,
    pub(super) to: StationId,
    pub(super) counted: Counted,
}

/// As what the transmissions of a packet count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Counted {
    /// As those of a packet with data.
    Packet,
    /// As those of a message of RPL.
    Message,
    /// As none: the packet was offered, or the message sent, in the warm-up.
    Nothing,
}

/// The packets that wait in a station. One at a time is given to the MAC, and stays first until it is through.
#[derive(Clone, Debug, Default)]
pub(super) struct Outbox {
    waiting: VecDeque<Outgoing>,
    /// The first one, if the MAC has it.
    under_way: Option<Sent>,
    /// Whether the first one waits before it is given to the MAC again.
    is_pausing: bool,
}

impl Outbox {
    /// Adds a packet, if there are fewer than `most`.
    pub(super) fn add(&mut self, packet: Outgoing, most: usize) -> bool {
        let has_room = self.waiting.len() < most;
        if has_room {
            self.waiting.push_back(packet);
        }
        has_room
    }

    /// The packet to give to the MAC now, if there is one.
    pub(super) fn first(&self) -> Option<&Outgoing> {
        let is_free = self.under_way.is_none() && !self.is_pausing;
        self.waiting.front().filter(|_| is_free)
    }

    /// The pieces of the first packet, for that station: if others went to another one, it begins anew with the tag `tag`.
    pub(super) fn pieces(&mut self, to: StationId, tag: u16) -> Pieces {
        let Some(first) = self.waiting.front_mut() else { return Pieces::default() };
        if first.pieces.to != Some(to) {
            first.pieces = Pieces { to: Some(to), tag, number: 0 };
        }
        first.pieces
    }

    /// A piece of the first packet is through: the next one follows.
    pub(super) fn next_piece(&mut self) {
        if let Some(first) = self.waiting.front_mut() {
            first.pieces.number += 1;
            first.resends = 0;
        }
    }

    /// The first packet, whether it waits or is under way.
    pub(super) fn front(&self) -> Option<&Outgoing> {
        self.waiting.front()
    }

    /// The first packet is with the MAC.
    pub(super) fn send(&mut self, sent: Sent) {
        self.under_way = Some(sent);
    }

    /// The first packet, if the MAC has it.
    pub(super) fn under_way(&self) -> Option<Sent> {
        self.under_way
    }

    /// The MAC is done with `frame`: the first packet, if it was that.
    pub(super) fn ended(&mut self, frame: FrameId) -> Option<Sent> {
        self.under_way.take_if(|sent| sent.frame == frame)
    }

    /// The first packet is through, or given up.
    pub(super) fn remove_first(&mut self) -> Option<Outgoing> {
        self.waiting.pop_front()
    }

    /// The first packet waits before it is given to the MAC again; `false` if that was done `most` times.
    pub(super) fn pause(&mut self, most: u8) -> bool {
        let again = self.waiting.front_mut().is_some_and(|first| {
            first.resends = first.resends.saturating_add(1);
            first.resends <= most
        });
        self.is_pausing = again;
        again
    }

    /// The first packet waits until the MAC has room for it: it was not sent.
    pub(super) fn wait(&mut self) {
        self.is_pausing = true;
    }

    /// The pause is over.
    pub(super) fn resume(&mut self) {
        self.is_pausing = false;
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Outgoing> {
        self.waiting.iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_packet_that_waits_for_the_mac_has_no_try_less() {
        let data = Data::new(StationId(0), 0);
        let mut outbox = Outbox::default();
        assert!(outbox.add(Outgoing::new(data, Heading::Up, 50), 1));
        for _ in 0..3 {
            outbox.wait();
            assert!(outbox.first().is_none());
            outbox.resume();
            assert_eq!(outbox.first().map(|first| first.resends), Some(0));
        }
        assert!(outbox.pause(1) && !outbox.pause(1), "one try more");
    }
}
