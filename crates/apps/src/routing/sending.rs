//! How packets leave the queue of a station, one by one, and piece by piece.

use std::time::Duration;

use sextant_kernel::StationId;
use sextant_mac::routing::fragment;
use sextant_mac::routing::{Data, Down};
use sextant_sim::{Destination, NetworkId, Payload, Port, SendError};

use super::config::RoutedTo;
use super::outbox::{Counted, Heading, Kind, Outgoing, Sent};
use super::router::{RESEND, Router};
use super::rpl::Next;
use super::settings::MOST_PAYLOAD_OCTETS;
use super::source::Source;
use super::way::Way;

/// Least time before a packet is given to the MAC again (ms), ...
const PAUSE_MS: f64 = 16.0;
/// ... and the most that is added to it at random, as in TinyOS.
const PAUSE_SPREAD_MS: f64 = 15.0;

impl Router {
    /// Adds a packet to the queue, if there is room.
    pub(super) fn enqueue(&mut self, packet: Outgoing, port: &mut Port<'_>) {
        let (is_data, data) = (packet.is_data(), packet.data);
        if self.outbox.add(packet, self.routing.queue_packets) {
            self.pump(port);
        } else if is_data {
            self.count_for(&data, port, |counts| counts.queue_drops += 1);
        } else {
            self.count(port, |counts| counts.rpl.lost += 1);
        }
    }

    /// Gives the first packet, or the next piece of it, to the MAC, if there is one and the station knows to whom.
    pub(super) fn pump(&mut self, port: &mut Port<'_>) {
        let Some(first) = self.outbox.first() else { return };
        let to = match self.next_of(first, port) {
            Next::Station(to) => to,
            Next::Later => return,
            Next::Nowhere => {
                if first.is_data() {
                    let data = first.data;
                    self.count_for(&data, port, |counts| counts.no_route += 1);
                }
                return self.first_is_done(port);
            }
        };
        let (kind, data) = (first.kind(), first.data);
        self.write_first(to, port);
        let most = if self.reassembly.is_some() { MOST_PAYLOAD_OCTETS } else { usize::MAX };
        let payload = if self.octets.len() > most {
            let pieces = self.outbox.pieces(to, self.tag.wrapping_add(1));
            self.tag = pieces.tag;
            fragment::write(&self.octets, pieces.tag, most, pieces.number, &mut self.piece);
            &self.piece
        } else {
            &self.octets
        };
        let is_fragment = self.octets.len() > most;
        self.octets_of_first = self.octets.len();
        match port.send(NetworkId::default(), Destination::Station(to), Payload::Octets(payload)) {
            Ok(frame) => {
                let counted = match kind {
                    Kind::Packet if port.is_counted(data.origin, data.number) => Counted::Packet,
                    Kind::Dao | Kind::NoPath | Kind::DaoAck if port.now() >= self.counted_from => Counted::Message,
                    Kind::Packet | Kind::Dao | Kind::NoPath | Kind::DaoAck => Counted::Nothing,
                };
                self.outbox.send(Sent { frame, to, counted });
                self.count(port, |counts| {
                    counts.fragments += u64::from(is_fragment);
                    counts.rpl.dao += u64::from(matches!(kind, Kind::Dao | Kind::NoPath));
                    counts.rpl.dao_ack += u64::from(kind == Kind::DaoAck);
                });
            }
            Err(SendError::QueueFull(_)) => self.wait_for_mac(port),
            Err(_) => self.give_up(port),
        }
    }

    /// Writes the first packet, for the station `to`.
    fn write_first(&mut self, to: StationId, port: &Port<'_>) {
        let Some(first) = self.outbox.first() else { return };
        match &first.heading {
            Heading::Up => {
                // The root makes ways down of what origins tell.
                let tells = self.routing.to != RoutedTo::Sink && first.data.origin == port.station();
                let parent = if tells { Some(to) } else { first.data.parent };
                let data = Data { cost: self.way.cost(), parent, ..first.data };
                data.write(first.octets, &mut self.octets);
            }
            Heading::Down(route) => {
                let Data { origin, number, hops, .. } = first.data;
                Down { origin, number, hops, route: route[1..].to_vec() }.write(first.octets, &mut self.octets);
            }
            Heading::Rpl(datagram) => {
                if let Way::Rpl(station) = &self.way {
                    let ready = station.ready(datagram, &first.data);
                    station.write(&ready, first.octets, &mut self.octets);
                }
            }
            Heading::Neighbour(_, message) => {
                if let Way::Rpl(station) = &self.way {
                    station.write_message(message, to, &mut self.octets);
                }
            }
        }
    }

    /// The first packet did not reach the next station.
    pub(super) fn try_again(&mut self, port: &mut Port<'_>) {
        let is_tried_again = self.outbox.front().is_some_and(Outgoing::is_tried_again);
        if is_tried_again && self.outbox.pause(self.routing.resends) {
            self.resume_later(port);
        } else {
            self.give_up(port);
        }
    }

    /// The MAC had no room for the first packet: it was not sent, so this is no try.
    fn wait_for_mac(&mut self, port: &mut Port<'_>) {
        self.outbox.wait();
        self.resume_later(port);
    }

    fn resume_later(&mut self, port: &mut Port<'_>) {
        let pause_ms = PAUSE_MS + PAUSE_SPREAD_MS * self.uniform(port);
        port.after(Duration::from_secs_f64(pause_ms / 1e3), RESEND);
    }

    pub(super) fn give_up(&mut self, port: &mut Port<'_>) {
        let data = self.outbox.front().filter(|first| first.is_data()).map(|first| first.data);
        match data {
            Some(data) => self.count_for(&data, port, |counts| counts.given_up += 1),
            None => self.count(port, |counts| counts.rpl.lost += 1),
        }
        self.first_is_done(port);
    }

    /// Whether a piece of the first packet follows that which was sent last.
    pub(super) fn has_more_pieces(&mut self) -> bool {
        let Some(pieces) = self.outbox.front().map(|first| first.pieces) else { return false };
        let octets = self.octets_of_first;
        self.reassembly.is_some() && fragment::piece(octets, MOST_PAYLOAD_OCTETS, pieces.number + 1).is_some()
    }

    /// The first packet leaves the queue.
    pub(super) fn first_is_done(&mut self, port: &mut Port<'_>) {
        self.outbox.remove_first();
        let own = port.station();
        let is_saturated = self.source.as_ref().is_some_and(Source::is_saturated);
        if is_saturated && self.outbox.iter().all(|packet| packet.data.origin != own || !packet.is_data()) {
            self.originate(port);
        }
        self.pump(port);
    }
}
