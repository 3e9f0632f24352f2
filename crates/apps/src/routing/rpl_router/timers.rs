//! The timers of a station of RPL, and what it does when it learns something.

use std::time::Duration;

use sextant_kernel::StationId;
use sextant_mac::routing::rpl::{Action, Dao, Downward, LinkOutcome, Message};
use sextant_sim::{NetworkId, Port, SendOutcome, SendReport, Timer};

use crate::routing::router::Router;
use crate::routing::rpl::{DIO, RplStation};
use crate::routing::way::Way;

pub(super) const DIS: Timer = Timer(17);
/// A new DAO is due, ...
pub(super) const DAO: Timer = Timer(18);
/// ... or the last one again.
pub(super) const DAO_AGAIN: Timer = Timer(19);
pub(super) const PROBE: Timer = Timer(20);
pub(super) const LEAVE: Timer = Timer(21);
pub(super) const MINUTE: Timer = Timer(22);

/// Time without a parent after which a station leaves its tree (Contiki-NG).
const LEAVES_AFTER: Duration = Duration::from_secs(300);
/// An urgent probe is sent within this time.
const URGENT_WITHIN: Duration = Duration::from_secs(4);
const A_MINUTE: Duration = Duration::from_secs(60);
/// What is known of links ages each so many minutes.
const AGEING_MIN: u32 = 15;

impl Router {
    /// The state of RPL; `None` in a tree of another kind.
    pub(in crate::routing) fn rpl(&mut self) -> Option<&mut RplStation> {
        match &mut self.way {
            Way::Rpl(station) => Some(station),
            Way::FixedRoot | Way::Fixed(_) | Way::Built { .. } => None,
        }
    }

    /// Sets a timer to a span that is drawn in 50 to 150 % of `mean`.
    pub(super) fn set_around(&mut self, timer: Timer, mean: Duration, port: &mut Port<'_>) {
        let uniform = self.uniform(port);
        if let Some(station) = self.rpl() {
            station.set(timer, mean.mul_f64(0.5 + uniform), port);
        }
    }

    /// The simulation begins.
    pub(in crate::routing) fn start_rpl(&mut self, port: &mut Port<'_>) {
        let uniform = self.uniform(port);
        let Some(station) = self.rpl() else { return };
        station.set(MINUTE, A_MINUTE, port);
        let dis_interval = station.plan.dis_interval;
        if station.dodag.is_root() {
            station.hasten_dio(uniform, port);
        } else {
            self.set_around(DIS, dis_interval, port);
        }
    }

    /// A timer of RPL is due.
    pub(in crate::routing) fn time_rpl(&mut self, timer: Timer, port: &mut Port<'_>) {
        let Some(station) = self.rpl() else { return };
        station.due.remove(&timer);
        match timer {
            DIO => self.send_dio(port),
            DIS => self.send_dis(port),
            DAO => self.send_new_dao(port),
            DAO_AGAIN => self.send_dao_again(port),
            PROBE => self.send_probe(port),
            LEAVE => station.dodag.leave(),
            _ => self.pass_minute(port),
        }
    }

    fn pass_minute(&mut self, port: &mut Port<'_>) {
        let now = port.now();
        self.routes.expire(now);
        let Some(station) = self.rpl() else { return };
        station.set(MINUTE, A_MINUTE, port);
        station.minutes += 1;
        if station.minutes.is_multiple_of(AGEING_MIN) {
            station.dodag.age();
        }
        station.table.expire(now);
        let dis_interval = station.plan.dis_interval;
        let seeks = !station.dodag.is_root() && station.dodag.parent().is_none() && !station.is_set(DIS);
        let actions = station.dodag.reconsider(now);
        if seeks {
            self.set_around(DIS, dis_interval, port);
        }
        self.act(&actions, port);
    }

    /// Does what follows from something that the station learned.
    pub(super) fn act(&mut self, actions: &[Action], port: &mut Port<'_>) {
        for &action in actions {
            match action {
                Action::NoteParent(before) => self.note_parent(before, port),
                Action::HastenDio => {
                    let uniform = self.uniform(port);
                    if let Some(station) = self.rpl() {
                        station.hasten_dio(uniform, port);
                    }
                }
                Action::Register => {
                    let Some(delay) = self.rpl().map(|station| station.plan.dao_delay) else { return };
                    self.set_dao(DAO, delay, port);
                }
                Action::Solicit => {
                    let idle = self.rpl().filter(|station| !station.is_set(DIS));
                    if let Some(interval) = idle.map(|station| station.plan.dis_interval) {
                        self.set_around(DIS, interval, port);
                    }
                }
                Action::LeaveLater => {
                    if let Some(station) = self.rpl().filter(|station| !station.is_set(LEAVE)) {
                        station.set(LEAVE, LEAVES_AFTER, port);
                    }
                }
                Action::Stay => {
                    if let Some(station) = self.rpl() {
                        station.stop(LEAVE, port);
                        station.stop(DIS, port);
                    }
                }
                Action::BeginProbing => {
                    if let Some(interval) = self.rpl().and_then(|station| station.plan.probing) {
                        self.set_around(PROBE, interval, port);
                    }
                }
                Action::ProbeSoon => {
                    let uniform = self.uniform(port);
                    if let Some(station) = self.rpl() {
                        station.set(PROBE, URGENT_WITHIN.mul_f64(uniform), port);
                    }
                }
            }
        }
    }

    /// The station has another parent, or none, than `before`.
    fn note_parent(&mut self, before: Option<StationId>, port: &mut Port<'_>) {
        let parent = self.follow_parent(port);
        let own = port.station();
        if let Some(parent) = parent {
            port.take_time_from(NetworkId::default(), parent);
        }
        let Some(station) = self.rpl() else { return };
        if parent.is_none() {
            station.stop(DAO, port);
            station.stop(DAO_AGAIN, port);
        }
        if let Some(before) = before.filter(|_| station.plan.dodag.downward == Downward::ByStations) {
            // The old parent should not send packets down this way any more (RFC 6550, 9.8).
            let dao = Dao { target: own, parent: None, lifetime_min: 0, number: 0, asks: false };
            self.send_to_neighbour(before, Message::Dao(dao), port);
        }
        self.pump(port);
    }

    /// Sets one of both timers of DAOs, in place of the other.
    pub(super) fn set_dao(&mut self, timer: Timer, mean: Duration, port: &mut Port<'_>) {
        if let Some(station) = self.rpl() {
            station.stop(DAO, port);
            station.stop(DAO_AGAIN, port);
        }
        self.set_around(timer, mean, port);
    }

    /// A frame to one neighbour has ended that was not of the queue.
    pub(in crate::routing) fn end_of_frame(&mut self, report: &SendReport, port: &mut Port<'_>) {
        let Some(station) = self.rpl() else { return };
        if let Some(place) = station.under_way.iter().position(|&(frame, _)| frame == report.frame) {
            let (_, to) = station.under_way.swap_remove(place);
            self.learn_link(to, report, port);
        }
    }

    /// Frames to a neighbour tell how good the link is.
    pub(in crate::routing) fn learn_link(&mut self, to: StationId, report: &SendReport, port: &mut Port<'_>) {
        let outcome = match report.outcome {
            SendOutcome::Acknowledged => LinkOutcome::Acknowledged,
            SendOutcome::NoAcknowledgement => LinkOutcome::Lost,
            SendOutcome::ChannelAccessFailure | SendOutcome::Sent => LinkOutcome::Unsent,
        };
        let now = port.now();
        if let Some(station) = self.rpl() {
            let actions = station.dodag.sent(to, report.attempts, outcome, now);
            self.act(&actions, port);
        }
    }
}
