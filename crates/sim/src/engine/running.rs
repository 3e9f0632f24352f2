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

/// How far an engine is.
pub(super) enum Stage {
    /// It has not begun.
    Ready,
    /// It waits at this time.
    Waiting {
        at: SimTime,
        /// What happens next, if it is known: no pending event is before it.
        next: Option<(SimTime, Event)>,
    },
    /// It has ended: by itself, or because the observer ended it.
    Ended { interrupted: bool },
}

/// Why the loop takes no more events.
enum Halt {
    /// All tasks are done.
    Finished,
    /// The observer ended it.
    Interrupted,
    /// Nothing is left to happen.
    Drained,
    /// This happens next, at the limit or after it.
    Due(SimTime, Event),
}

/// No simulation goes on after this: 158 years, half of what time can be. What robots do may never end.
const LATEST: SimTime = SimTime::from_nanos(5_000_000_000_000_000_000);

impl<A: Application> Engine<A> {
    /// Runs until all tasks are done, the time is over, nothing is left to happen, or the observer ends it.
    pub(crate) fn run(mut self, observer: &mut impl Observer) -> Ended<A> {
        self.advance(SimTime::MAX, observer);
        let end = self.now();
        self.conclude(end, observer)
    }

    /// Begins, or goes on, until `time`: what happens at that instant is still to come. It ends before if all tasks are done,
    /// the time is over, nothing is left to happen, or the observer ends it.
    pub(crate) fn advance(&mut self, time: SimTime, observer: &mut impl Observer) {
        let next = match &mut self.stage {
            Stage::Ready => {
                self.begin(observer);
                None
            }
            Stage::Waiting { at, .. } if time <= *at => return,
            Stage::Waiting { next, .. } => next.take(),
            Stage::Ended { .. } => return,
        };
        let last = self.end.unwrap_or(LATEST);
        self.stage = match self.go_on(next, last.min(time), observer) {
            Halt::Due(now, event) if time < last => Stage::Waiting { at: time, next: Some((now, event)) },
            Halt::Drained if time < last && self.end.is_some() => Stage::Waiting { at: time, next: None },
            halt => {
                self.settle(&halt);
                Stage::Ended { interrupted: matches!(halt, Halt::Interrupted) }
            }
        };
    }

    /// The loop: takes `next` and what follows, before `limit`.
    fn go_on(&mut self, mut next: Option<(SimTime, Event)>, limit: SimTime, observer: &mut impl Observer) -> Halt {
        while !self.has_finished() {
            let Some((now, event)) = next.take().or_else(|| self.model.scene.queue.pop()) else {
                return Halt::Drained;
            };
            if now >= limit {
                return Halt::Due(now, event);
            }
            if !self.take(now, event, observer) {
                return Halt::Interrupted;
            }
        }
        Halt::Finished
    }

    /// Brings the links and the clock to the end.
    fn settle(&mut self, halt: &Halt) {
        let end = match halt {
            Halt::Due(..) => Some(self.end.unwrap_or(LATEST)),
            Halt::Drained => self.end,
            Halt::Finished | Halt::Interrupted => {
                self.catch_up(Cut::now(&self.model.scene));
                return;
            }
        };
        let last = self.catch_up(Cut::before(end.unwrap_or(SimTime::MAX)));
        self.model.scene.now = end.unwrap_or(self.model.scene.now.max(last));
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

    /// Whether the observer ended it.
    pub(crate) fn is_interrupted(&self) -> bool {
        matches!(self.stage, Stage::Ended { interrupted: true })
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
    pub(crate) fn conclude(mut self, end: SimTime, observer: &mut impl Observer) -> Ended<A> {
        self.model.scene.now = end;
        if !self.warm_up.is_zero() && end <= SimTime::ZERO + self.warm_up {
            // It ends within the warm-up, of which nothing counts.
            self.restart_meters();
        }
        // What a robot has driven so far counts.
        for robot in 0..self.model.vehicles.len() {
            self.model.halt(self.model.scene.roll.robot(robot));
        }
        self.model.tell(&mut self.logs, observer);
        self.tell_targets(observer);
        for network in &mut self.model.networks {
            network.leave_pending(&mut self.model.scene);
        }
        self.model.tell_packets(observer);
        self.finish()
    }

    /// What radios and batteries have used so far does not count.
    pub(super) fn restart_meters(&mut self) {
        let now = self.model.scene.now;
        self.restart_batteries();
        self.model.networks.iter_mut().for_each(|network| network.restart_meters(now));
    }

    /// Brings the links to their states before `cut`. Returns when the last one changed.
    pub(super) fn catch_up(&mut self, cut: Cut) -> SimTime {
        let Model { scene, networks, .. } = &mut self.model;
        networks.iter_mut().map(|network| network.catch_up(cut, scene)).max().unwrap_or(SimTime::ZERO)
    }
}
