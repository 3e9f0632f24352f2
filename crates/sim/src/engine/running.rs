//! Running: the event loop, and how it ends.

use sextant_kernel::SimTime;

use super::{Ended, Engine};
use crate::application::Application;
use crate::event::Event;
use crate::link::links::Cut;
use crate::model::Model;
use crate::observer::Observer;

/// Events between two looks at whether to go on.
const LOOK: u64 = 1000;

/// No simulation goes on after this: 158 years, half of what time can be. What robots do may never end.
const LATEST: SimTime = SimTime::from_nanos(5_000_000_000_000_000_000);

impl<A: Application> Engine<A> {
    /// Runs until all tasks are done, the time is over, nothing is left to happen, or the observer ends it.
    pub(crate) fn run(mut self, observer: &mut impl Observer) -> Ended<A> {
        let interrupted = self.run_on(observer);
        let end = self.now();
        self.conclude(end, interrupted, observer)
    }

    /// Begins, and goes on until all tasks are done, the time is over, nothing is left to happen, or the observer ends it.
    /// Returns whether the observer did.
    pub(crate) fn run_on(&mut self, observer: &mut impl Observer) -> bool {
        self.begin(observer);
        let (mut interrupted, mut is_drained, mut is_over) = (false, false, false);
        while !(interrupted || self.has_finished()) {
            let Some((now, event)) = self.model.scene.queue.pop() else {
                is_drained = true;
                break;
            };
            if now >= self.end.unwrap_or(LATEST) {
                is_over = true;
                break;
            }
            interrupted = !self.take(now, event, observer);
        }
        let is_timed_out = !interrupted && !self.has_finished();
        match self.end.or(is_over.then_some(LATEST)).filter(|_| is_timed_out) {
            Some(end) => {
                self.catch_up(Cut::before(end));
                self.model.scene.now = end;
            }
            None if is_drained => {
                let last = self.catch_up(Cut::before(SimTime::MAX));
                self.model.scene.now = self.model.scene.now.max(last);
            }
            None => {
                self.catch_up(Cut::now(&self.model.scene));
            }
        }
        interrupted
    }

    /// Goes on until `end`, or until nothing is left to happen, though all tasks are done.
    pub(crate) fn go_on_until(&mut self, end: SimTime, observer: &mut impl Observer) {
        while self.model.scene.queue.peek_time().is_some_and(|time| time < end) {
            let Some((now, event)) = self.model.scene.queue.pop() else { break };
            self.take(now, event, observer);
        }
        self.catch_up(Cut::before(end));
    }

    /// Whether all tasks are done.
    fn has_finished(&self) -> bool {
        self.ends_with_tasks && self.model.unfinished == 0
    }

    /// When the last event was, or the time was over.
    pub(crate) fn now(&self) -> SimTime {
        self.model.scene.now
    }

    /// Takes an event; returns whether the observer wants to go on.
    #[inline]
    fn take(&mut self, now: SimTime, event: Event, observer: &mut impl Observer) -> bool {
        if self.is_dropped(event) {
            return true;
        }
        self.model.scene.now = now;
        self.model.scene.event = event;
        self.events += 1;
        let goes_on = self.handle(event, observer);
        // A robot may listen for long.
        goes_on && (!self.events.is_multiple_of(LOOK) || observer.goes_on(self.progress()))
    }

    /// Ends at `end`: what is left behind.
    pub(crate) fn conclude(mut self, end: SimTime, interrupted: bool, observer: &mut impl Observer) -> Ended<A> {
        self.model.scene.now = end;
        // What a robot has driven so far counts.
        for robot in 0..self.model.vehicles.len() {
            self.model.halt(self.model.scene.roll.robot(robot));
        }
        self.model.tell(&mut self.logs, observer);
        self.tell_targets(observer);
        for network in &mut self.model.networks {
            network.trace_pending(&mut self.model.scene);
        }
        self.model.tell_packets(observer);
        self.finish(interrupted)
    }

    /// Brings the links to their states before `cut`. Returns when the last one changed.
    pub(super) fn catch_up(&mut self, cut: Cut) -> SimTime {
        let Model { scene, networks, .. } = &mut self.model;
        networks.iter_mut().map(|network| network.catch_up(cut, scene)).max().unwrap_or(SimTime::ZERO)
    }
}
