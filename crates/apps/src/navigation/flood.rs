//! Messages that reach all nodes hop by hop: each node that hears one passes it on once.

use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

use sextant_kernel::StationId;
use sextant_sim::{Port, Timer};

/// Messages that a station remembers.
const REMEMBERED: usize = 64;

/// Which message it is: the station where it began, and a number there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct FloodKey {
    /// The station where it began.
    pub origin: StationId,
    /// Its number among those of this station; after 65535 comes 0.
    pub number: u16,
}

/// Passes messages on, with two rules against a storm of them (Ni, Tseng, Chen, Sheu 1999, "The broadcast storm problem
/// in a mobile ad hoc network", counter-based scheme): each station waits for a random time, and stays silent if it
/// hears enough copies meanwhile.
#[derive(Clone, Debug)]
pub(crate) struct Flood {
    jitter: Duration,
    enough: u32,
    /// The timer of the first message that waits; those of the others follow, up to `timers` of them.
    first_timer: u16,
    timers: u16,
    next_timer: u16,
    /// The messages heard, the latest last, with the number of copies.
    heard: VecDeque<(FloodKey, u32)>,
    waiting: BTreeMap<u16, (FloodKey, Vec<u8>)>,
}

impl Flood {
    /// Waits up to `jitter` before it passes a message on, and does not if it has heard it `enough` times then. It uses
    /// the timers from `first_timer` on, at most `timers` of them.
    #[must_use]
    pub(crate) fn new(jitter: Duration, enough: u32, first_timer: u16, timers: u16) -> Self {
        Self { jitter, enough, first_timer, timers, next_timer: 0, heard: VecDeque::new(), waiting: BTreeMap::new() }
    }

    /// The station itself began a message: copies that come back are not passed on.
    pub(crate) fn begin(&mut self, key: FloodKey) {
        self.remember(key, u32::MAX);
    }

    /// A copy of a message was heard; `octets` are to be passed on. `draw` is a random number in (0, 1). Returns whether
    /// it is the first copy.
    pub(crate) fn hear(&mut self, key: FloodKey, octets: &[u8], draw: f64, port: &mut Port<'_>) -> bool {
        if let Some((_, copies)) = self.heard.iter_mut().rev().find(|(other, _)| *other == key) {
            *copies = copies.saturating_add(1);
            return false;
        }
        self.remember(key, 1);
        let timer = self.first_timer + self.next_timer;
        self.next_timer = (self.next_timer + 1) % self.timers;
        // A message that still waits for the timer of this one is so old that no station needs it.
        self.waiting.insert(timer, (key, octets.to_vec()));
        port.after(self.jitter.mul_f64(draw), Timer(timer));
        true
    }

    /// A timer is due. Returns the message to pass on now, if one waited for it and too few copies were heard.
    pub(crate) fn due(&mut self, timer: Timer) -> Option<(FloodKey, Vec<u8>)> {
        let (key, octets) = self.waiting.remove(&timer.0)?;
        let copies = self.heard.iter().rev().find(|(other, _)| *other == key).map_or(1, |&(_, copies)| copies);
        (copies < self.enough).then_some((key, octets))
    }

    fn remember(&mut self, key: FloodKey, copies: u32) {
        if self.heard.len() == REMEMBERED {
            self.heard.pop_front();
        }
        self.heard.push_back((key, copies));
    }
}
