//! Packets that go down from a root, and those that go to nodes.

use sextant_kernel::StationId;
use sextant_mac::routing::{Data, Down, Repeat, down_octets};
use sextant_sim::Port;

use super::config::RoutedTo;
use super::outbox::{Heading, Outgoing};
use super::router::Router;
use super::rpl::Next;
use super::settings::MOST_PAYLOAD_OCTETS;
use super::way::Way;

impl Router {
    /// The station has one packet more of its own.
    pub(super) fn number_packet(&mut self, port: &mut Port<'_>) -> Data {
        #[expect(clippy::cast_possible_truncation, reason = "numbers of packets go round")]
        let number = self.record.offered.len() as u16;
        self.record.offered.push(port.now());
        port.tell_origin(number);
        Data::new(port.station(), number)
    }

    /// Another node, at random.
    pub(super) fn draw_target(&mut self, port: &Port<'_>) -> StationId {
        let others = self.routing.nodes - 1;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below the number of nodes")]
        let drawn = ((self.uniform(port) * f64::from(others)) as u32).min(others - 1);
        StationId(if drawn < port.station().0 { drawn } else { drawn + 1 })
    }

    /// To whom a packet goes next.
    pub(super) fn next_of(&self, packet: &Outgoing, port: &Port<'_>) -> Next {
        match &packet.heading {
            Heading::Up => self.way.parent().map_or(Next::Later, Next::Station),
            Heading::Down(route) => route.first().map_or(Next::Nowhere, |&first| Next::Station(first)),
            Heading::Neighbour(to, _) => Next::Station(*to),
            Heading::Rpl(datagram) => match &self.way {
                Way::Rpl(station) => station.next_of(datagram, port),
                Way::FixedRoot | Way::Fixed(_) | Way::Built { .. } => Next::Nowhere,
            },
        }
    }

    /// A packet is at the root of its tree.
    pub(super) fn take_at_root(&mut self, data: Data, octets: usize, port: &mut Port<'_>) {
        if let Some(parent) = data.parent {
            self.routes.learn(data.origin, parent);
        }
        match (self.routing.to, data.target) {
            (RoutedTo::Nodes, Some(_)) if data.is_taken => {}
            (RoutedTo::Nodes, Some(target)) => self.send_down(data, target, octets, port),
            (RoutedTo::Sink | RoutedTo::Nodes, _) => self.arrive(data.origin, data.number, data.hops, port),
            (RoutedTo::SinkAndBack, _) => {
                self.arrive(data.origin, data.number, data.hops, port);
                let answer = self.number_packet(port);
                self.send_down(answer, data.origin, octets, port);
            }
        }
    }

    /// Sends a packet from the root down to a node, if there is a way that its header has room for.
    fn send_down(&mut self, data: Data, target: StationId, octets: usize, port: &mut Port<'_>) {
        let route = self.routes.route(port.station(), target);
        match route.filter(|route| down_octets(route.len() - 1) <= MOST_PAYLOAD_OCTETS) {
            Some(route) => self.pass_on(Outgoing::new(data, Heading::Down(route), octets), port),
            None => self.count_for(&data, port, |counts| counts.no_route += 1),
        }
    }

    /// A packet comes down.
    pub(super) fn take_down(&mut self, down: Down, octets: usize, port: &mut Port<'_>) {
        let Down { origin, number, hops, route } = down;
        let hops = hops.saturating_add(1);
        let data = Data { hops, ..Data::new(origin, number) };
        match self.seen_down.note(origin, number, hops) {
            Some(Repeat::Duplicate | Repeat::Loop) => {
                self.count_for(&data, port, |counts| counts.duplicates += 1);
            }
            None if route.is_empty() => self.arrive(origin, number, hops, port),
            None => self.pass_on(Outgoing::new(data, Heading::Down(route), octets), port),
        }
    }
}
