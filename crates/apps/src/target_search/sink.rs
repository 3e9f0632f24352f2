//! The application of a sink: it gathers the first detections of a target, and tells all robots.

use std::collections::BTreeMap;
use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::{SimTime, StationId};
use sextant_sim::{Application, Delivery, NetworkId, Port, TargetId, Timer};

use super::message::{FirstDetection, Message};
use super::node::{ENOUGH_COPIES, FLOOD_JITTER};
use super::outbox::{MessageCounts, Outbox};
use super::reports::{GRACE, Reports, Sighted};
use crate::navigation::{Flood, FloodKey};

/// The timer of the message that tells the nodes the way to the sink.
const TREE: Timer = Timer(1);
/// The timer of the next look whether an alarm is confirmed.
const LOOK: Timer = Timer(2);
/// The timers of messages to pass on.
const FIRST_FLOOD: u16 = 100;
const FLOODS: u16 = 64;
/// The timers of the alarms, one for each target.
const FIRST_ALARM: u16 = 1000;

/// How often the nodes get the way, and how long the sink waits in between.
const TREES: u32 = 2;
const TREE_INTERVAL: Duration = Duration::from_millis(800);
/// How long it gathers detections after the first one has come.
const GATHERING: Duration = Duration::from_millis(500);
/// How often an alarm is sent, and the time in between.
const ALARMS: u32 = 3;
const ALARM_INTERVAL: Duration = Duration::from_secs(3);
/// How often it looks whether an alarm is confirmed.
const LOOK_INTERVAL: Duration = Duration::from_secs(1);

/// A sink: it tells the nodes the way to itself, and the robots where a target was detected first.
#[derive(Debug)]
pub struct SearchSink {
    alarms: BTreeMap<TargetId, Gathered>,
    /// What it doubts detections by, if it does.
    doubts: Option<Doubts>,
    reports: BTreeMap<TargetId, Reports>,
    flood: Flood,
    number: u16,
    trees: u32,
    outbox: Outbox,
    draws: u64,
}

/// What a sink doubts detections by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Doubts {
    /// Number of nodes that confirm each other.
    pub(super) confirming: u8,
    /// How far apart they are on the map at most (m).
    pub(super) reach_m: f64,
}

/// The first detections of a target.
#[derive(Clone, Debug)]
struct Gathered {
    first: SimTime,
    /// The places of the nodes that detected it (m).
    places: BTreeMap<StationId, Position>,
    sent: u32,
}

impl SearchSink {
    /// A sink in a network.
    #[must_use]
    pub fn new(network: NetworkId) -> Self {
        Self {
            alarms: BTreeMap::new(),
            doubts: None,
            reports: BTreeMap::new(),
            flood: Flood::new(FLOOD_JITTER, ENOUGH_COPIES, FIRST_FLOOD, FLOODS),
            number: 0,
            trees: 0,
            outbox: Outbox::new(network),
            draws: 0,
        }
    }

    /// The same, if it has doubts.
    #[must_use]
    pub(super) fn with_doubts(self, doubts: Option<Doubts>) -> Self {
        Self { doubts, ..self }
    }

    /// What it sent.
    #[must_use]
    pub fn into_record(self) -> MessageCounts {
        self.outbox.counts
    }

    fn key(&mut self, port: &Port<'_>) -> FloodKey {
        self.number = self.number.wrapping_add(1);
        let key = FloodKey { origin: port.station(), number: self.number };
        self.flood.begin(key);
        key
    }

    fn gather(&mut self, detection: FirstDetection, port: &mut Port<'_>) {
        if let Some(doubts) = self.doubts {
            return self.weigh(detection, doubts, port);
        }
        let FirstDetection { node, target, time, place } = detection;
        let gathered = self.alarms.entry(target).or_insert_with(|| {
            port.after(GATHERING, Timer(FIRST_ALARM + target.0));
            Gathered { first: time, places: BTreeMap::new(), sent: 0 }
        });
        if gathered.sent == 0 {
            gathered.first = gathered.first.min(time);
            gathered.places.insert(node, place);
        }
    }

    /// A node says that it detected a target, which may be false.
    fn weigh(&mut self, detection: FirstDetection, doubts: Doubts, port: &mut Port<'_>) {
        if self.reports.is_empty() {
            port.after(GRACE, LOOK);
        }
        let reports = self.reports.entry(detection.target).or_default();
        let Doubts { confirming, reach_m } = doubts;
        if let Some(sighted) = reports.add(detection, confirming, reach_m, port.now()) {
            self.tell(detection.target, sighted, port);
        }
    }

    /// Tells all of the targets that nobody confirms.
    fn look(&mut self, port: &mut Port<'_>) {
        let Some(Doubts { reach_m, .. }) = self.doubts else { return };
        let now = port.now();
        let best = |(&target, reports): (&TargetId, &mut Reports)| Some((target, reports.best_so_far(reach_m, now)?));
        let sighted: Vec<_> = self.reports.iter_mut().filter_map(best).collect();
        for (target, sighted) in sighted {
            self.tell(target, sighted, port);
        }
        port.after(LOOK_INTERVAL, LOOK);
    }

    /// Tells all which nodes detected a target together.
    fn tell(&mut self, target: TargetId, Sighted { time, place, nodes }: Sighted, port: &mut Port<'_>) {
        let key = self.key(port);
        let message = Message::Alarm { key, target, time, place, nodes: Some(nodes) };
        self.outbox.broadcast(&message, port);
    }

    /// Tells all where the target was detected first: the mean of the places of the nodes (thesis, equation of the
    /// initial location).
    fn alarm(&mut self, target: TargetId, port: &mut Port<'_>) {
        let key = self.key(port);
        let Some(gathered) = self.alarms.get_mut(&target) else { return };
        let sum = gathered.places.values().fold(Position::ORIGIN, |sum, &place| sum + place);
        let place = sum * (1.0 / gathered.places.len() as f64);
        gathered.sent += 1;
        if gathered.sent < ALARMS {
            port.after(ALARM_INTERVAL, Timer(FIRST_ALARM + target.0));
        }
        let message = Message::Alarm { key, target, time: gathered.first, place, nodes: None };
        self.outbox.broadcast(&message, port);
    }
}

impl Application for SearchSink {
    fn hears(&self) -> bool {
        true
    }

    fn started(&mut self, port: &mut Port<'_>) {
        // Not at the very start, when all robots ask.
        port.after(TREE_INTERVAL / 4, TREE);
    }

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        if timer == TREE {
            let key = self.key(port);
            self.outbox.broadcast(&Message::Tree { key, hops: 0 }, port);
            self.trees += 1;
            if self.trees < TREES {
                port.after(TREE_INTERVAL, TREE);
            }
        } else if timer == LOOK {
            self.look(port);
        } else if let Some((_, octets)) = self.flood.due(timer) {
            if let Ok(message) = Message::read(&octets) {
                self.outbox.broadcast(&message, port);
            }
        } else if let Some(target) = timer.0.checked_sub(FIRST_ALARM) {
            self.alarm(TargetId(target), port);
        }
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        match Message::read(delivery.payload) {
            Ok(Message::Detection(detection)) => self.gather(detection, port),
            Ok(Message::Claim { key, .. } | Message::Alarm { key, .. }) => {
                self.draws += 1;
                let draw = port.uniform(self.draws);
                self.flood.hear(key, delivery.payload, draw, port);
            }
            _ => {}
        }
    }
}
