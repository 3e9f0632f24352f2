//! The messages of a station of RPL.

use std::time::Duration;

use sextant_kernel::{SimTime, StationId};
use sextant_mac::routing::Data;
use sextant_mac::routing::rpl::{
    Action, Content, Dao, DaoAck, DaoStatus, Datagram, Dio, Direction, Downward, HOP_LIMIT, Learned, Message,
    OptionFlags, Rank, RplOption, SourceRoute, Stage, local_octets,
};
use sextant_sim::{Destination, NetworkId, Payload, Port};

use super::timers::{DAO, DAO_AGAIN, DIS, PROBE};
use crate::routing::counts::Counts;
use crate::routing::outbox::{Heading, Outgoing};
use crate::routing::router::Router;
use crate::routing::rpl::DIO;

/// Ways down are refreshed this long before they expire, and up to once more at random (Contiki-NG).
const REFRESH_BEFORE: Duration = Duration::from_secs(60);

impl Router {
    /// Gives a message to all to the MAC at once, and counts it. One that finds the queue of the MAC full is lost, and not counted.
    fn broadcast(&mut self, message: &Message, port: &mut Port<'_>, add: impl FnOnce(&mut Counts)) {
        let Some(configuration) = self.rpl().map(|station| station.plan.configuration) else { return };
        local_octets(message, None, &configuration, &mut self.octets);
        if port.send(NetworkId::default(), Destination::All, Payload::Octets(&self.octets)).is_ok() {
            self.count(port, add);
        }
    }

    pub(super) fn send_dio(&mut self, port: &mut Port<'_>) {
        let uniform = self.uniform(port);
        let Some(station) = self.rpl() else { return };
        if !station.dodag.may_tell() {
            return;
        }
        let is_left_out = station.trickle.is_superfluous() && !station.dodag.is_root();
        let dio = if is_left_out { None } else { station.dodag.tell() };
        let due = station.trickle.next(uniform);
        station.set(DIO, due.saturating_since(port.now()), port);
        match dio {
            Some(dio) => self.broadcast(&Message::Dio(dio), port, |counts| {
                counts.beacons += 1;
                counts.rpl.dio += 1;
            }),
            None => self.count(port, |counts| counts.rpl.left_out += 1),
        }
    }

    pub(super) fn send_dis(&mut self, port: &mut Port<'_>) {
        let Some(station) = self.rpl() else { return };
        let interval = station.plan.dis_interval;
        if !station.dodag.is_root() && station.dodag.parent().is_none() {
            self.broadcast(&Message::Dis, port, |counts| counts.rpl.dis += 1);
            self.set_around(DIS, interval, port);
        }
    }

    /// Tries a link with a DIO to its neighbour.
    pub(super) fn send_probe(&mut self, port: &mut Port<'_>) {
        let uniform = self.uniform(port);
        let Some(station) = self.rpl() else { return };
        let (target, interval) = (station.dodag.probed(port.now(), uniform), station.plan.probing);
        if let Some(target) = target {
            self.send_dio_to(target, port);
        }
        if let Some(interval) = interval {
            self.set_around(PROBE, interval, port);
        }
    }

    pub(super) fn send_dio_to(&mut self, to: StationId, port: &mut Port<'_>) {
        let Some(station) = self.rpl() else { return };
        let Some(dio) = station.dodag.dio() else { return };
        let configuration = station.plan.configuration;
        local_octets(&Message::Dio(dio), Some(to), &configuration, &mut self.octets);
        let sent = port.send(NetworkId::default(), Destination::Station(to), Payload::Octets(&self.octets));
        if let (Ok(frame), Some(station)) = (sent, self.rpl()) {
            station.under_way.push((frame, to));
            self.count(port, |counts| counts.rpl.unicast_dio += 1);
        }
    }

    pub(super) fn send_new_dao(&mut self, port: &mut Port<'_>) {
        let Some(station) = self.rpl() else { return };
        if station.dodag.parent().is_none() {
            return;
        }
        let number = station.registration.begin();
        if station.plan.dao_tries == 0 {
            // Nobody answers: it counts as known, and is told again after half of its time.
            let (actions, lifetime) = (station.dodag.registered(), station.plan.lifetime);
            self.refresh_after(lifetime / 2, port);
            self.act(&actions, port);
        } else {
            let retry = station.plan.dao_retry;
            self.set_dao(DAO_AGAIN, retry, port);
        }
        self.send_own_dao(number, port);
    }

    pub(super) fn send_dao_again(&mut self, port: &mut Port<'_>) {
        let Some(station) = self.rpl() else { return };
        if let Some(number) = station.registration.again(station.plan.dao_tries) {
            let retry = station.plan.dao_retry;
            self.set_dao(DAO_AGAIN, retry, port);
            self.send_own_dao(number, port);
        } else if station.dodag.parent().is_some() {
            let actions = station.dodag.repair(port.now());
            self.count(port, |counts| counts.rpl.repairs += 1);
            self.act(&actions, port);
        }
    }

    /// The next DAO comes a while before this time is over.
    fn refresh_after(&mut self, span: Duration, port: &mut Port<'_>) {
        let before = REFRESH_BEFORE.mul_f64(1.0 + self.uniform(port));
        if let Some(station) = self.rpl() {
            station.stop(DAO_AGAIN, port);
            station.set(DAO, if span > before { span - before } else { span }, port);
        }
    }

    fn send_own_dao(&mut self, number: u8, port: &mut Port<'_>) {
        let own = port.station();
        let Some(station) = self.rpl() else { return };
        let (Some(parent), Some(root)) = (station.dodag.parent(), station.dodag.root()) else { return };
        let asks = station.plan.dao_tries > 0;
        let lifetime_min = station.plan.configuration.lifetime_min;
        let dao = Dao { target: own, parent: None, lifetime_min, number, asks };
        if station.plan.dodag.downward == Downward::ByStations {
            self.send_to_neighbour(parent, Message::Dao(dao), port);
        } else {
            let message = Message::Dao(Dao { parent: Some(parent), ..dao });
            let option = Some(upward());
            self.send_message(Datagram { option, ..message_to(root, message, port) }, port);
        }
    }

    /// Puts a message to a neighbour into the queue.
    pub(super) fn send_to_neighbour(&mut self, to: StationId, message: Message, port: &mut Port<'_>) {
        let packet = Outgoing::new(nameless(port.station()), Heading::Neighbour(to, message), 0);
        self.enqueue(packet, port);
    }

    /// Puts a message over several hops into the queue.
    fn send_message(&mut self, datagram: Datagram, port: &mut Port<'_>) {
        let data = nameless(datagram.source);
        self.enqueue(Outgoing::new(data, Heading::Rpl(Box::new(datagram)), 0), port);
    }

    /// A neighbour sent a message.
    pub(super) fn hear_message(&mut self, from: StationId, message: &Message, port: &mut Port<'_>) {
        match message {
            Message::Dis => {
                self.act(&[Action::HastenDio], port);
            }
            Message::Dio(dio) => self.hear_dio(from, dio, port),
            Message::Dao(dao) => self.take_dao_of_child(from, dao, port),
            Message::DaoAck(answer) => self.take_answer(answer, port),
        }
    }

    fn hear_dio(&mut self, from: StationId, dio: &Dio, port: &mut Port<'_>) {
        let now = port.now();
        let Some(station) = self.rpl() else { return };
        if dio.rank.is_finite() {
            station.trickle.hear(now);
        }
        let actions = station.dodag.heard(from, dio, now);
        self.act(&actions, port);
    }

    /// A station below can be reached by way of a neighbour, or can no longer.
    fn take_dao_of_child(&mut self, from: StationId, dao: &Dao, port: &mut Port<'_>) {
        let now = port.now();
        let Some(station) = self.rpl() else { return };
        if station.plan.dodag.downward != Downward::ByStations || station.dodag.parent() == Some(from) {
            return;
        }
        let parent = station.dodag.parent();
        let is_root = station.dodag.is_root();
        if dao.lifetime_min == 0 {
            let was_known = station.table.forget(dao.target, from);
            if let Some(parent) = parent.filter(|_| was_known) {
                self.send_to_neighbour(parent, Message::Dao(*dao), port);
            }
            return;
        }
        let learned = station.table.learn(dao.target, from, dao.number, now + lifetime(dao));
        match (learned, parent) {
            (Err(_), _) => self.count(port, |counts| counts.rpl.full_tables += 1),
            (Ok(_), _) if is_root => self.note_known(dao.target, now),
            (Ok(Learned::News), Some(parent)) => {
                self.send_to_neighbour(parent, Message::Dao(Dao { asks: false, ..*dao }), port);
            }
            // Those above know it, or there is nobody above.
            (Ok(_), _) => {}
        }
        if dao.asks {
            let status = if learned.is_ok() { DaoStatus::Accepted } else { DaoStatus::Rejected };
            self.send_to_neighbour(from, Message::DaoAck(DaoAck { number: dao.number, status }), port);
        }
    }

    /// A station tells the root its parent.
    fn take_dao_at_root(&mut self, dao: &Dao, port: &mut Port<'_>) {
        let now = port.now();
        match dao.parent {
            Some(parent) if dao.lifetime_min > 0 => {
                self.routes.learn_until(dao.target, parent, now + lifetime(dao));
                self.note_known(dao.target, now);
            }
            _ => self.routes.forget(dao.target),
        }
        if !dao.asks {
            return;
        }
        let answer = Message::DaoAck(DaoAck { number: dao.number, status: DaoStatus::Accepted });
        let mut datagram = message_to(dao.target, answer, port);
        if self.lead(&mut datagram, port.station()) {
            self.send_message(datagram, port);
        }
    }

    /// Writes the way to its target into a packet; `false` if that is not known.
    pub(super) fn lead(&mut self, datagram: &mut Datagram, root: StationId) -> bool {
        let Some(stations) = self.routes.route(root, datagram.target()) else { return false };
        let Some((&first, rest)) = stations.split_first() else { return false };
        datagram.destination = first;
        datagram.route = SourceRoute::over(rest.to_vec());
        datagram.option = None;
        true
    }

    fn note_known(&mut self, target: StationId, now: SimTime) {
        self.record.known.entry(target).or_insert(now);
    }

    /// A DAO of this station was answered.
    fn take_answer(&mut self, answer: &DaoAck, port: &mut Port<'_>) {
        let Some(station) = self.rpl() else { return };
        if !station.registration.answered(answer.number) || station.dodag.stage() == Stage::Searching {
            return;
        }
        // A station for which there was no room is not reachable, but those below it need a way up.
        let (actions, lifetime) = (station.dodag.registered(), station.plan.lifetime);
        self.refresh_after(lifetime, port);
        self.act(&actions, port);
    }

    /// A message came over several hops to this station.
    pub(super) fn take_message(&mut self, message: &Message, port: &mut Port<'_>) {
        match message {
            Message::Dao(dao) => self.take_dao_at_root(dao, port),
            Message::DaoAck(answer) => self.take_answer(answer, port),
            Message::Dio(_) | Message::Dis => {}
        }
    }
}

fn lifetime(dao: &Dao) -> Duration {
    Duration::from_secs(60 * u64::from(dao.lifetime_min))
}

/// What a packet that goes up says; the rank follows when it is sent.
pub(super) fn upward() -> RplOption {
    RplOption { direction: Direction::Up, flags: OptionFlags::None, sender_rank: Rank::INFINITE }
}

fn message_to(target: StationId, message: Message, port: &Port<'_>) -> Datagram {
    let content = Content::Message(message);
    let source = port.station();
    Datagram { source, destination: target, hop_limit: HOP_LIMIT, option: None, route: None, content }
}

/// What the queue knows of a message, which has no number of its own.
fn nameless(origin: StationId) -> Data {
    Data::new(origin, 0)
}
