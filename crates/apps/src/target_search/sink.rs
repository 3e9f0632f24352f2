//! The application of a sink: it gathers the first detections of a target, and tells all robots.

use std::collections::BTreeMap;
use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::{SimTime, StationId};
use sextant_sim::{Application, Delivery, NetworkId, Port, TargetId, Timer};

use super::message::{FirstDetection, Message};
use super::node::{ENOUGH_COPIES, FLOOD_JITTER};
use super::outbox::{MessageCounts, Outbox};
use crate::navigation::{Flood, FloodKey};

/// The timer of the message that tells the nodes the way to the sink.
const TREE: Timer = Timer(1);
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

/// A sink: it tells the nodes the way to itself, and the robots where a target was detected first.
#[derive(Debug)]
pub struct SearchSink {
    alarms: BTreeMap<TargetId, Gathered>,
    flood: Flood,
    number: u16,
    trees: u32,
    outbox: Outbox,
    draws: u64,
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
            flood: Flood::new(FLOOD_JITTER, ENOUGH_COPIES, FIRST_FLOOD, FLOODS),
            number: 0,
            trees: 0,
            outbox: Outbox::new(network),
            draws: 0,
        }
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
        let message = Message::Alarm { key, target, time: gathered.first, place };
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
