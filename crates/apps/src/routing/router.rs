//! What a station does with packets that go over several hops.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use sextant_kernel::{EventKey, SimTime, StationId};
use sextant_mac::routing::{
    Beacon, Collection, Data, Down, HOP_LIMIT, Packet, Reaction, Repeat, Seen, SourceRoutes, Trickle,
};
use sextant_sim::{
    Application, Delivery, Destination, NetworkId, Payload, Port, SendError, SendOutcome, SendReport, Timer,
};

use super::config::RoutedTo;
use super::outbox::{Heading, Outbox, Outgoing};
use super::record::{Arrival, Counts, ParentChange, StationRecord};
use super::settings::{MAC_OCTETS, Routing};
use super::source::Source;

const TRAFFIC: Timer = Timer(0);
const BEACON: Timer = Timer(1);
const RESEND: Timer = Timer(2);

/// Least time before a packet is given to the MAC again (ms), ...
const PAUSE_MS: f64 = 16.0;
/// ... and the most that is added to it at random, as in TinyOS.
const PAUSE_SPREAD_MS: f64 = 15.0;

/// How a station finds the next one.
#[derive(Clone, Debug)]
pub(super) enum Way {
    /// It is the root of a tree that does not change.
    FixedRoot,
    /// It has this parent in a tree that does not change.
    Fixed(Option<StationId>),
    /// Beacons tell.
    Built { is_root: bool, tree: Box<Collection>, trickle: Trickle },
}

impl Way {
    /// That of the root of a tree that beacons build.
    pub(super) fn root(own: StationId, trickle: Trickle) -> Self {
        Self::Built { is_root: true, tree: Box::new(Collection::of_root(own)), trickle }
    }

    /// That of a node in a tree that beacons build.
    pub(super) fn node(own: StationId, trickle: Trickle, hysteresis_etx: f64) -> Self {
        Self::Built { is_root: false, tree: Box::new(Collection::of_node(own, hysteresis_etx)), trickle }
    }

    pub(super) fn is_root(&self) -> bool {
        matches!(self, Self::FixedRoot | Self::Built { is_root: true, .. })
    }

    pub(super) fn parent(&self) -> Option<StationId> {
        match self {
            Self::FixedRoot => None,
            Self::Fixed(parent) => *parent,
            Self::Built { tree, .. } => tree.parent(),
        }
    }

    fn cost(&self) -> Option<f64> {
        match self {
            Self::FixedRoot | Self::Fixed(_) => None,
            Self::Built { tree, .. } => tree.cost(),
        }
    }

    /// Whether a packet that goes up comes from a station that is not farther from the root.
    fn is_uphill(&self, cost: Option<f64>) -> bool {
        matches!(self, Self::Built { tree, is_root: false, .. } if tree.is_uphill(cost))
    }
}

/// The application of a station that takes part in routing.
pub struct Router {
    pub(super) routing: Arc<Routing>,
    pub(super) way: Way,
    source: Option<Source>,
    outbox: Outbox,
    seen: Seen,
    /// The same for packets that go down.
    pub(super) seen_down: Seen,
    /// The ways down, in a root.
    pub(super) routes: SourceRoutes,
    /// The greatest number of an arrived packet of each origin.
    latest: BTreeMap<StationId, u32>,
    /// Random numbers drawn so far.
    draws: u64,
    beacon_due: Option<EventKey>,
    octets: Vec<u8>,
    /// What happens before it is not counted.
    counted_from: SimTime,
    pub(super) record: StationRecord,
}

impl Router {
    pub(super) fn new(routing: Arc<Routing>, way: Way, source: Option<Source>, counted_from: SimTime) -> Self {
        Self {
            routing,
            way,
            source,
            outbox: Outbox::default(),
            seen: Seen::default(),
            seen_down: Seen::default(),
            routes: SourceRoutes::default(),
            latest: BTreeMap::new(),
            draws: 0,
            beacon_due: None,
            octets: Vec::new(),
            counted_from,
            record: StationRecord::default(),
        }
    }

    /// What the station leaves behind.
    pub(super) fn into_record(self) -> StationRecord {
        let waiting = self.outbox.iter().map(|packet| (packet.data.origin, packet.data.number)).collect();
        let parent_etx = match &self.way {
            Way::Built { tree, .. } => tree.parent_etx(),
            Way::FixedRoot | Way::Fixed(_) => None,
        };
        StationRecord { waiting, parent: self.way.parent(), parent_etx, ..self.record }
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

    /// Sets the timer of the next packet of its own.
    fn schedule(&mut self, port: &mut Port<'_>) {
        if let Some(due) = self.source.as_mut().and_then(|source| source.next(port)) {
            port.after(due.saturating_since(port.now()), TRAFFIC);
        }
    }

    /// The station has a packet of its own.
    fn originate(&mut self, port: &mut Port<'_>) {
        let Some(source) = &mut self.source else { return };
        let octets = usize::from(source.take().saturating_sub(MAC_OCTETS));
        let target = match self.routing.to {
            RoutedTo::Sink | RoutedTo::SinkAndBack => None,
            RoutedTo::Nodes => Some(self.draw_target(port)),
        };
        let data = Data { target, ..self.number_packet(port) };
        self.seen.note(data.origin, data.number, 0);
        self.enqueue(Outgoing { data, heading: Heading::Up, octets, resends: 0 }, port);
        self.schedule(port);
    }

    /// Adds a packet to the queue, if there is room.
    pub(super) fn enqueue(&mut self, packet: Outgoing, port: &mut Port<'_>) {
        if self.outbox.add(packet, self.routing.queue_packets) {
            self.pump(port);
        } else {
            self.count(port, |counts| counts.queue_drops += 1);
        }
    }

    /// Gives the first packet to the MAC, if there is one and the station knows to whom.
    fn pump(&mut self, port: &mut Port<'_>) {
        let Some(first) = self.outbox.first() else { return };
        let Some(to) = self.next_of(first) else { return };
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
        }
        match port.send(NetworkId::default(), Destination::Station(to), Payload::Octets(&self.octets)) {
            Ok(frame) => self.outbox.send(frame, to),
            Err(SendError::QueueFull(_)) => self.try_again(port),
            Err(_) => self.give_up(port),
        }
    }

    /// The first packet did not reach the next station.
    fn try_again(&mut self, port: &mut Port<'_>) {
        if self.outbox.pause(self.routing.resends) {
            let pause_ms = PAUSE_MS + PAUSE_SPREAD_MS * self.uniform(port);
            port.after(Duration::from_secs_f64(pause_ms / 1e3), RESEND);
        } else {
            self.give_up(port);
        }
    }

    fn give_up(&mut self, port: &mut Port<'_>) {
        self.count(port, |counts| counts.given_up += 1);
        self.first_is_done(port);
    }

    /// The first packet leaves the queue.
    fn first_is_done(&mut self, port: &mut Port<'_>) {
        self.outbox.remove_first();
        let own = port.station();
        let is_saturated = self.source.as_ref().is_some_and(Source::is_saturated);
        if is_saturated && self.outbox.iter().all(|packet| packet.data.origin != own) {
            self.originate(port);
        }
        self.pump(port);
    }

    /// Does what follows from something that the tree learned.
    fn react(&mut self, reaction: Reaction, port: &mut Port<'_>) {
        if reaction.has_changed_parent {
            self.record.changes.push(ParentChange { time: port.now(), parent: self.way.parent() });
            port.follow(NetworkId::default(), self.way.parent());
        }
        if reaction.is_inconsistent {
            self.hasten_beacons(port);
        }
        if reaction.has_changed_parent {
            self.pump(port);
        }
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
        // A beacon that finds the queue of the MAC full is lost like any other.
        let _ = port.send(NetworkId::default(), Destination::All, Payload::Octets(&self.octets));
        self.beacon_due = Some(port.after(due.saturating_since(port.now()), BEACON));
        self.count(port, |counts| counts.beacons += 1);
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
            Some(Repeat::Duplicate) => return self.count(port, |counts| counts.duplicates += 1),
            Some(Repeat::Loop) if self.way.is_root() => {
                return self.count(port, |counts| counts.duplicates += 1);
            }
            Some(Repeat::Loop) => self.count(port, |counts| counts.loops += 1),
            None => {}
        }
        let data = Data { hops, ..data };
        if self.way.is_root() {
            self.take_at_root(data, octets, port);
        } else {
            self.pass_on(Outgoing { data, heading: Heading::Up, octets, resends: 0 }, port);
        }
    }

    /// Sends a packet of others on, unless it has made too many hops.
    pub(super) fn pass_on(&mut self, packet: Outgoing, port: &mut Port<'_>) {
        if packet.data.hops >= HOP_LIMIT {
            self.count(port, |counts| counts.hop_limit_drops += 1);
        } else {
            self.enqueue(packet, port);
        }
    }

    /// A packet is where it should be.
    pub(super) fn arrive(&mut self, origin: StationId, number: u16, hops: u8, port: &Port<'_>) {
        let latest = self.latest.get(&origin).copied();
        let number = whole_number(number, latest);
        let greatest = latest.map_or(number, |latest| latest.max(number));
        self.latest.insert(origin, greatest);
        self.record.arrived.push(Arrival { origin, number, hops, time: port.now() });
    }
}

/// The number whose last 16 bits are `number` that is nearest to `latest`.
fn whole_number(number: u16, latest: Option<u32>) -> u32 {
    let Some(latest) = latest else { return number.into() };
    let bytes = latest.to_le_bytes();
    let ahead = number.wrapping_sub(u16::from_le_bytes([bytes[0], bytes[1]]));
    if ahead < 1 << 15 {
        latest.wrapping_add(ahead.into())
    } else {
        // Older than the latest one, but not than the first.
        latest.checked_sub(u32::from(ahead.wrapping_neg())).unwrap_or(number.into())
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
    }

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        match timer {
            TRAFFIC => self.originate(port),
            BEACON => self.send_beacon(port),
            _ => {
                self.outbox.resume();
                self.pump(port);
            }
        }
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        match Packet::read(delivery.payload) {
            Some(Packet::Beacon(beacon)) => self.hear_beacon(delivery.from, &beacon, port),
            Some(Packet::Data(data)) => self.take_packet(data, delivery.payload.len(), port),
            Some(Packet::Down(down)) => self.take_down(down, delivery.payload.len(), port),
            None => {}
        }
    }

    fn sent(&mut self, _network: NetworkId, report: &SendReport, port: &mut Port<'_>) {
        let Some(to) = self.outbox.ended(report.frame) else { return };
        let is_through = report.outcome == SendOutcome::Acknowledged;
        let transmissions = report.transmissions;
        self.count(port, |counts| counts.transmissions += u64::from(transmissions));
        if is_through {
            self.first_is_done(port);
        } else {
            self.try_again(port);
        }
        if let Way::Built { tree, .. } = &mut self.way {
            let reaction = tree.sent(to, transmissions, u32::from(is_through));
            self.react(reaction, port);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_packets_go_round_and_are_made_whole_again() {
        for (number, latest, whole) in [
            (7, None, 7),
            (8, Some(7), 8),
            (5, Some(7), 5),
            (0, Some(65_535), 65_536),
            (65_535, Some(65_536), 65_535),
            (2, Some(3 * 65_536 + 1), 3 * 65_536 + 2),
            (65_530, Some(3), 65_530),
        ] {
            assert_eq!(whole_number(number, latest), whole, "{number} after {latest:?}");
        }
    }
}
