//! What a station does with packets that go over several hops.

use std::sync::Arc;

use sextant_kernel::{EventKey, SimTime, StationId};
use sextant_mac::routing::fragment::{Fragment, Reassembly};
use sextant_mac::routing::rpl::LEAST_DATA_OCTETS;
use sextant_mac::routing::{Beacon, Data, HOP_LIMIT, Packet, Reaction, Repeat, Seen, SourceRoutes};
use sextant_sim::{
    Application, Delivery, Destination, FrameId, NetworkId, Payload, Port, SendOutcome, SendReport, Timer,
};

use super::config::RoutedTo;
use super::counts::Counts;
use super::deliveries::Arrival;
use super::outbox::{Counted, Heading, Outbox, Outgoing, Sent};
use super::record::{ParentChange, StationRecord};
use super::settings::{MAC_OCTETS, Routing};
use super::source::Source;
use super::way::Way;

const TRAFFIC: Timer = Timer(0);
const BEACON: Timer = Timer(1);
pub(super) const RESEND: Timer = Timer(2);
pub(super) const REASSEMBLY: Timer = Timer(3);

/// The application of a station that takes part in routing.
pub(crate) struct Router {
    pub(super) routing: Arc<Routing>,
    pub(super) way: Way,
    pub(super) source: Option<Source>,
    pub(super) outbox: Outbox,
    /// Packets that come in fragments, if they do.
    pub(super) reassembly: Option<Reassembly>,
    pub(super) expiry_due: Option<EventKey>,
    /// Number of the last packet that went in fragments.
    pub(super) tag: u16,
    pub(super) seen: Seen,
    /// The same for packets that go down.
    pub(super) seen_down: Seen,
    /// The ways down, in a root.
    pub(super) routes: SourceRoutes,
    /// Random numbers drawn so far.
    draws: u64,
    beacon_due: Option<EventKey>,
    /// A packet or message that is written, ...
    pub(super) octets: Vec<u8>,
    /// ... and a piece of it.
    pub(super) piece: Vec<u8>,
    /// Size of the packet that the MAC has (octets), of which it may be a piece.
    pub(super) octets_of_first: usize,
    /// What happens before it is not counted.
    pub(super) counted_from: SimTime,
    pub(super) record: StationRecord,
}

impl Router {
    pub(super) fn new(routing: Arc<Routing>, way: Way, source: Option<Source>, counted_from: SimTime) -> Self {
        let fragments = routing.fragments;
        Self {
            routing,
            way,
            source,
            outbox: Outbox::default(),
            reassembly: fragments.map(|fragments| Reassembly::new(fragments.most, fragments.timeout)),
            expiry_due: None,
            tag: 0,
            seen: Seen::default(),
            seen_down: Seen::default(),
            routes: SourceRoutes::default(),
            draws: 0,
            beacon_due: None,
            octets: Vec::new(),
            piece: Vec::new(),
            octets_of_first: 0,
            counted_from,
            record: StationRecord::default(),
        }
    }

    /// What the station leaves behind; `transmissions` of a frame that its link kept are those so far.
    pub(super) fn into_record(mut self, transmissions: impl Fn(FrameId) -> u32) -> StationRecord {
        if let Some(sent) = self.outbox.under_way() {
            self.count_sent(&sent, transmissions(sent.frame));
        }
        let packets = self.outbox.iter().filter(|packet| packet.is_data());
        let waiting = packets.map(|packet| (packet.data.origin, packet.data.number)).collect();
        let routes = match &self.way {
            Way::Rpl(station) => station.routes() + self.routes.stations().count(),
            Way::Built { .. } | Way::FixedRoot | Way::Fixed(_) => 0,
        };
        let (parent, parent_etx) = (self.way.parent(), self.way.parent_etx());
        StationRecord { waiting, parent, parent_etx, routes, ..self.record }
    }

    pub(super) fn uniform(&mut self, port: &Port<'_>) -> f64 {
        self.draws += 1;
        port.uniform(self.draws)
    }

    pub(super) fn count(&mut self, port: &Port<'_>, add: impl FnOnce(&mut Counts)) {
        if port.now() >= self.counted_from {
            add(&mut self.record.counts);
        }
    }

    /// Counts something that happens to a packet, if that counts.
    pub(super) fn count_for(&mut self, packet: &Data, port: &Port<'_>, add: impl FnOnce(&mut Counts)) {
        if port.is_counted(packet.origin, packet.number) {
            add(&mut self.record.counts);
        }
    }

    /// Counts transmissions of the first packet of the queue.
    fn count_sent(&mut self, sent: &Sent, transmissions: u32) {
        let transmissions = u64::from(transmissions);
        match sent.counted {
            Counted::Packet => self.record.counts.transmissions += transmissions,
            Counted::Message => self.record.counts.rpl.transmissions += transmissions,
            Counted::Nothing => {}
        }
    }

    /// Sets the timer of the next packet of its own.
    pub(super) fn schedule(&mut self, port: &mut Port<'_>) {
        if let Some(due) = self.source.as_mut().and_then(|source| source.next(port)) {
            port.after(due.saturating_since(port.now()), TRAFFIC);
        }
    }

    /// The station has a packet of its own.
    pub(super) fn originate(&mut self, port: &mut Port<'_>) {
        let Some(source) = &mut self.source else { return };
        let octets = usize::from(source.take().saturating_sub(MAC_OCTETS));
        let octets = self.routing.fragments.map_or(octets, |fragments| fragments.packet_octets);
        let target = match self.routing.to {
            RoutedTo::Sink | RoutedTo::SinkAndBack => None,
            RoutedTo::Nodes => Some(self.draw_target(port)),
        };
        let data = Data { target, ..self.number_packet(port) };
        self.seen.note(data.origin, data.number, 0);
        if self.rpl().is_some() {
            let payload_octets = octets.saturating_sub(LEAST_DATA_OCTETS.into());
            self.originate_rpl(data, target, payload_octets, port);
        } else {
            self.enqueue(Outgoing::new(data, Heading::Up, octets), port);
        }
        self.schedule(port);
    }

    /// Does what follows from something that the tree learned.
    fn react(&mut self, reaction: Reaction, port: &mut Port<'_>) {
        if reaction.has_changed_parent {
            self.follow_parent(port);
        }
        if reaction.is_inconsistent {
            self.hasten_beacons(port);
        }
        if reaction.has_changed_parent {
            self.pump(port);
        }
    }

    /// The station has another parent, or none: notes it, and tells its link. Returns it.
    pub(super) fn follow_parent(&mut self, port: &mut Port<'_>) -> Option<StationId> {
        let (parent, etx) = (self.way.parent(), self.way.parent_etx());
        self.record.parents.push(ParentChange { time: port.now(), parent, etx });
        port.follow(NetworkId::default(), parent);
        parent
    }

    /// The next beacon is sent soon.
    fn hasten_beacons(&mut self, port: &mut Port<'_>) {
        let uniform = self.uniform(port);
        let Way::Built { trickle, .. } = &mut self.way else { return };
        if let Some(due) = trickle.reset(port.now(), uniform) {
            if let Some(earlier) = self.beacon_due.take() {
                port.cancel(earlier);
            }
            self.beacon_due = Some(port.after(due.saturating_since(port.now()), BEACON));
        }
    }

    fn send_beacon(&mut self, port: &mut Port<'_>) {
        let uniform = self.uniform(port);
        let Way::Built { tree, trickle, .. } = &mut self.way else { return };
        tree.beacon().write(&mut self.octets);
        let due = trickle.next(uniform);
        // A beacon that finds the queue of the MAC full is lost, and does not count.
        if port.send(NetworkId::default(), Destination::All, Payload::Octets(&self.octets)).is_ok() {
            self.count(port, |counts| counts.beacons += 1);
        }
        self.beacon_due = Some(port.after(due.saturating_since(port.now()), BEACON));
    }

    fn hear_beacon(&mut self, from: StationId, beacon: &Beacon, port: &mut Port<'_>) {
        if let Way::Built { tree, .. } = &mut self.way {
            let reaction = tree.heard(from, beacon);
            self.react(reaction, port);
        }
    }

    fn take_packet(&mut self, data: Data, octets: usize, port: &mut Port<'_>) {
        if self.way.is_uphill(data.cost) {
            self.hasten_beacons(port);
        }
        let hops = data.hops.saturating_add(1);
        match self.seen.note(data.origin, data.number, hops) {
            Some(Repeat::Duplicate) => return self.count_for(&data, port, |counts| counts.duplicates += 1),
            Some(Repeat::Loop) if self.way.is_root() => {
                return self.count_for(&data, port, |counts| counts.duplicates += 1);
            }
            Some(Repeat::Loop) => self.count_for(&data, port, |counts| counts.loops += 1),
            None => {}
        }
        let arrives = data.target == Some(port.station()) && !data.is_taken;
        if arrives {
            self.arrive(data.origin, data.number, hops, port);
        }
        // The root makes ways down of what packets tell, so one that its target took on the way goes on.
        let data = Data { hops, is_taken: data.is_taken || arrives, ..data };
        if self.way.is_root() {
            self.take_at_root(data, octets, port);
        } else {
            self.pass_on(Outgoing::new(data, Heading::Up, octets), port);
        }
    }

    /// A whole packet or message came from a neighbour.
    fn hear(&mut self, from: StationId, payload: &[u8], port: &mut Port<'_>) {
        if self.rpl().is_some() {
            return self.hear_rpl(from, payload, port);
        }
        match Packet::read(payload) {
            Some(Packet::Beacon(beacon)) => self.hear_beacon(from, &beacon, port),
            Some(Packet::Data(data)) => self.take_packet(data, payload.len(), port),
            Some(Packet::Down(down)) => self.take_down(down, payload.len(), port),
            None => {}
        }
    }

    /// Sends a packet of others on, unless it has made too many hops.
    pub(super) fn pass_on(&mut self, packet: Outgoing, port: &mut Port<'_>) {
        if packet.data.hops >= HOP_LIMIT {
            self.count_for(&packet.data, port, |counts| counts.hop_limit_drops += 1);
        } else {
            self.enqueue(packet, port);
        }
    }

    /// A packet is where it should be.
    pub(super) fn arrive(&mut self, origin: StationId, number: u16, hops: u8, port: &Port<'_>) {
        self.record.arrived.push(Arrival { origin, number, hops, time: port.now() });
    }
}

impl Application for Router {
    fn hears(&self) -> bool {
        true
    }

    fn started(&mut self, port: &mut Port<'_>) {
        self.schedule(port);
        port.follow(NetworkId::default(), self.way.parent());
        let uniform = self.uniform(port);
        if let Way::Built { trickle, .. } = &mut self.way {
            let due = trickle.begin(port.now(), uniform);
            self.beacon_due = Some(port.after(due.saturating_since(port.now()), BEACON));
        }
        if self.rpl().is_some() {
            self.start_rpl(port);
        }
    }

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        match timer {
            TRAFFIC => self.originate(port),
            BEACON => self.send_beacon(port),
            RESEND => {
                self.outbox.resume();
                self.pump(port);
            }
            REASSEMBLY => self.reassembly_is_over(port),
            _ => self.time_rpl(timer, port),
        }
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        let whole = match Fragment::read(delivery.payload).filter(|_| self.reassembly.is_some()) {
            Some(fragment) => match self.take_fragment(delivery.from, &fragment, port) {
                Some(packet) => packet,
                None => return,
            },
            None => return self.hear(delivery.from, delivery.payload, port),
        };
        self.hear(delivery.from, &whole, port);
    }

    fn sent(&mut self, _network: NetworkId, report: &SendReport, port: &mut Port<'_>) {
        let Some(sent) = self.outbox.ended(report.frame) else { return self.end_of_frame(report, port) };
        let (to, is_through) = (sent.to, report.outcome == SendOutcome::Acknowledged);
        self.count_sent(&sent, report.transmissions);
        if !is_through {
            self.try_again(port);
        } else if self.has_more_pieces() {
            self.outbox.next_piece();
            self.pump(port);
        } else {
            self.first_is_done(port);
        }
        self.learn_link(to, report, port);
        if let Way::Built { tree, .. } = &mut self.way {
            let reaction = tree.sent(to, report.attempts, u32::from(is_through));
            self.react(reaction, port);
        }
    }
}
