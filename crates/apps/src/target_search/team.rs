//! What robots tell each other: who can meet which target when.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use sextant_kernel::{SimTime, StationId};
use sextant_sim::{Port, TargetId};

use super::assignment::assign;
use super::message::{Claim, Message};
use super::outbox::Outbox;
use crate::navigation::FloodKey;

/// Time between two claims of a robot.
const INTERVAL: Duration = Duration::from_secs(2);
/// A claim that is older than this says nothing any more.
const MEMORY: Duration = Duration::from_secs(10);

/// What a robot knows of the plans of all robots. Each robot tells them when it would meet each target, by a message that
/// all nodes pass on; each works out the same assignment, with the least sum of times.
#[derive(Clone, Debug, Default)]
pub(super) struct Team {
    size: usize,
    claims: BTreeMap<StationId, (SimTime, BTreeMap<TargetId, f64>)>,
    captured: BTreeSet<TargetId>,
    told: Option<SimTime>,
    has_news: bool,
    number: u16,
}

impl Team {
    /// A team of `size` robots.
    pub(super) fn new(size: usize) -> Self {
        Self { size, ..Self::default() }
    }

    /// Number of its robots.
    pub(super) fn size(&self) -> usize {
        self.size
    }

    /// The targets that were captured.
    pub(super) fn captured(&self) -> &BTreeSet<TargetId> {
        &self.captured
    }

    /// This robot has captured a target.
    pub(super) fn capture(&mut self, target: TargetId) {
        self.captured.insert(target);
        self.has_news = true;
    }

    /// Another robot sent its plans.
    pub(super) fn hear(&mut self, robot: StationId, claims: &[(TargetId, Claim)], now: SimTime) {
        let mut times_s = BTreeMap::new();
        for &(target, claim) in claims {
            match claim {
                Claim::Sought(seconds) => {
                    times_s.insert(target, seconds);
                }
                Claim::Captured => {
                    self.captured.insert(target);
                }
            }
        }
        self.claims.insert(robot, (now, times_s));
    }

    /// The target that this robot should seek, if it would meet them in `times_s`.
    pub(super) fn choose(&self, own: StationId, times_s: &BTreeMap<TargetId, f64>, now: SimTime) -> Option<TargetId> {
        let targets: Vec<TargetId> = times_s.keys().copied().collect();
        let mut robots: BTreeMap<StationId, &BTreeMap<TargetId, f64>> = (self.claims.iter())
            .filter(|(_, (told, _))| now.saturating_since(*told) <= MEMORY)
            .map(|(&robot, (_, times_s))| (robot, times_s))
            .collect();
        robots.insert(own, times_s);
        let rows: Vec<Vec<Option<f64>>> = robots
            .values()
            .map(|times_s| targets.iter().map(|target| times_s.get(target).copied()).collect())
            .collect();
        let at = robots.keys().position(|&robot| robot == own)?;
        assign(&rows)[at].map(|target| targets[target])
    }

    /// Tells the other robots, if there are any and it is time.
    pub(super) fn tell(&mut self, times_s: &BTreeMap<TargetId, f64>, outbox: &mut Outbox, port: &mut Port<'_>) {
        let now = port.now();
        let is_due = self.told.is_none_or(|told| now.saturating_since(told) >= INTERVAL);
        let has_any = !(times_s.is_empty() && self.captured.is_empty());
        if self.size < 2 || !has_any || !(is_due || self.has_news) {
            return;
        }
        self.told = Some(now);
        self.has_news = false;
        self.number = self.number.wrapping_add(1);
        let captured = self.captured.iter().map(|&target| (target, Claim::Captured));
        let sought = times_s.iter().map(|(&target, &seconds)| (target, Claim::Sought(seconds)));
        let targets = captured.chain(sought).take(Message::MOST_CLAIMS).collect();
        let key = FloodKey { origin: port.station(), number: self.number };
        outbox.broadcast(&Message::Claim { key, targets }, port);
    }
}
