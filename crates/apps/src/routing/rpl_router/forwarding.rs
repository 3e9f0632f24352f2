//! Packets in a network with RPL: on their way up, along source routes, and down by tables.

use sextant_kernel::StationId;
use sextant_mac::routing::rpl::{Action, Content, Datagram, Direction, Downward, HOP_LIMIT, OptionFlags, RplFrame};
use sextant_mac::routing::{Data, Repeat};
use sextant_sim::Port;

use super::messages::upward;
use crate::routing::config::RoutedTo;
use crate::routing::outbox::{Heading, Outgoing};
use crate::routing::router::Router;
use crate::routing::rpl::RankErrors;
use crate::routing::settings::MOST_PAYLOAD_OCTETS;
use crate::routing::way::Way;

impl Router {
    /// The station has a packet of its own, for a node or, without one, for the root.
    pub(in crate::routing) fn originate_rpl(
        &mut self,
        data: Data,
        target: Option<StationId>,
        octets: usize,
        port: &mut Port<'_>,
    ) {
        let own = port.station();
        let data = Data { target, ..data };
        let datagram = Datagram {
            source: own,
            // A node may not know the root yet, and writes it into the packet when it is sent.
            destination: target.unwrap_or(own),
            hop_limit: HOP_LIMIT,
            option: Some(upward()),
            route: None,
            content: Content::Data(data.number),
        };
        self.route_datagram(datagram, data, octets, None, port);
    }

    /// A frame came from a neighbour.
    pub(in crate::routing) fn hear_rpl(&mut self, from: StationId, payload: &[u8], port: &mut Port<'_>) {
        match RplFrame::read(payload) {
            Some(RplFrame::Local(message)) => self.hear_message(from, &message, port),
            Some(RplFrame::Datagram(datagram)) => self.take_datagram(from, datagram, payload.len(), port),
            None => {}
        }
    }

    fn take_datagram(&mut self, from: StationId, mut datagram: Datagram, octets: usize, port: &mut Port<'_>) {
        if !self.check_rank(from, &mut datagram, port) {
            return;
        }
        let own = port.station();
        let hops = HOP_LIMIT.saturating_sub(datagram.hop_limit).saturating_add(1);
        let payload_octets = octets.saturating_sub(datagram.header_octets());
        let number = match datagram.content {
            Content::Data(number) => Some(number),
            Content::Message(_) => None,
        };
        if let Some(number) = number
            && self.is_dropped_as_repeat(&datagram, number, hops, port)
        {
            return;
        }
        while datagram.destination == own && datagram.advance() {}
        // Any root takes what goes to a root.
        let is_for_root = self.way.is_root() && datagram.destination.0 >= self.routing.nodes;
        if datagram.destination == own || is_for_root {
            return match datagram.content {
                Content::Data(number) => self.arrive_by_rpl(datagram.source, number, hops, payload_octets, port),
                Content::Message(message) => self.take_message(&message, port),
            };
        }
        datagram.hop_limit = datagram.hop_limit.saturating_sub(1);
        let data = Data { hops, ..Data::new(datagram.source, number.unwrap_or(0)) };
        if datagram.hop_limit == 0 {
            if number.is_some() {
                self.count_for(&data, port, |counts| counts.hop_limit_drops += 1);
            }
            return;
        }
        self.route_datagram(datagram, data, payload_octets, Some(from), port);
    }

    /// Looks at the rank of the sender; `false` if the packet is dropped (RFC 6550, 11.2.2.2).
    fn check_rank(&mut self, from: StationId, datagram: &mut Datagram, port: &mut Port<'_>) -> bool {
        let now = port.now();
        let (Some(station), Some(option)) = (self.rpl(), &mut datagram.option) else { return true };
        let (before, sender_rank) = (option.flags, option.sender_rank);
        let is_wrong = option.is_wrong_at(station.dodag.rank());
        let is_dropped = is_wrong && before == OptionFlags::RankError && station.plan.rank_errors == RankErrors::Drop;
        if is_wrong {
            option.flags = OptionFlags::RankError;
            self.count(port, |counts| counts.rpl.rank_errors += 1);
            // The sender learns the rank of this station.
            self.send_dio_to(from, port);
        }
        if before == OptionFlags::RankError
            && let Some(station) = self.rpl()
        {
            let actions = station.dodag.corrected(from, sender_rank, now);
            self.act(&actions, port);
        }
        if is_dropped {
            self.count(port, |counts| counts.rpl.rank_error_drops += 1);
            self.act(&[Action::HastenDio], port);
        }
        !is_dropped
    }

    /// Whether a packet has come before, and is dropped for that.
    fn is_dropped_as_repeat(&mut self, datagram: &Datagram, number: u16, hops: u8, port: &mut Port<'_>) -> bool {
        let is_up = datagram.option.is_some_and(|option| option.direction == Direction::Up);
        let is_root = self.way.is_root();
        let data = Data::new(datagram.source, number);
        let seen = if is_up { &mut self.seen } else { &mut self.seen_down };
        match seen.note(datagram.source, number, hops) {
            None => false,
            Some(Repeat::Loop) if is_up && !is_root => {
                self.count_for(&data, port, |counts| counts.loops += 1);
                false
            }
            Some(Repeat::Loop | Repeat::Duplicate) => {
                self.count_for(&data, port, |counts| counts.duplicates += 1);
                true
            }
        }
    }

    /// Finds the way of a packet from here, and puts it into the queue.
    fn route_datagram(
        &mut self,
        mut datagram: Datagram,
        data: Data,
        payload_octets: usize,
        from: Option<StationId>,
        port: &mut Port<'_>,
    ) {
        let (own, now) = (port.station(), port.now());
        let is_data = matches!(datagram.content, Content::Data(_));
        let Way::Rpl(station) = &mut self.way else { return };
        let is_root = station.dodag.is_root();
        if let Some(option) = &mut datagram.option {
            let by_table = station.plan.dodag.downward == Downward::ByStations;
            let next = if by_table { station.table.next(datagram.destination, now) } else { None };
            // The station below that sent the packet up or down knows no way: that by it is no way.
            let next = match next.filter(|&next| Some(next) == from) {
                Some(back) => {
                    station.table.forget(datagram.destination, back);
                    None
                }
                None => next,
            };
            let has_way = match (next, option.direction) {
                (Some(_), _) => {
                    option.direction = Direction::Down;
                    true
                }
                (None, Direction::Down) => false,
                (None, Direction::Up) if is_root && by_table => false,
                (None, Direction::Up) if is_root => self.lead(&mut datagram, own),
                (None, Direction::Up) => true,
            };
            if !has_way {
                if is_data {
                    self.count_for(&data, port, |counts| counts.no_route += 1);
                }
                return;
            }
        }
        let room = self.routing.fragments.map_or(MOST_PAYLOAD_OCTETS, |_| usize::from(u16::MAX));
        if is_data && datagram.header_octets() + payload_octets > room {
            return self.count_for(&data, port, |counts| counts.no_route += 1);
        }
        self.enqueue(Outgoing::new(data, Heading::Rpl(Box::new(datagram)), payload_octets), port);
    }

    /// Data came to this station, and go no farther.
    fn arrive_by_rpl(&mut self, origin: StationId, number: u16, hops: u8, octets: usize, port: &mut Port<'_>) {
        self.arrive(origin, number, hops, port);
        if self.way.is_root() && self.routing.to == RoutedTo::SinkAndBack {
            let answer = self.number_packet(port);
            self.originate_rpl(answer, Some(origin), octets, port);
        }
    }
}
