//! Quiet stations: channel access that runs ahead of the event queue.
//!
//! Nobody sees what the radio of a quiet station does between its frames: a node whose application looks at nothing that it
//! hears backs off, turns its receiver on, and off again. These steps need no event in the queue. When one begins, the
//! link looks ahead to the next event that others may notice: an assessment whose result is open, a transmission. Only
//! that one goes into the queue, and when it comes the steps before it are taken, each at its instant. What is on air now
//! may be enough for a later assessment to find the channel busy: that is such a step as well, unless it ends the frame.
//!
//! The steps are those that the queue would have brought, and are counted as events. Whoever asks for the state of a quiet
//! station in between has to take the steps that are due by then: see [`Links::catch_up`].

use std::time::Duration;

use sextant_kernel::{SimTime, StationId};
use sextant_mac::csma::{self, Contention, Csma};
use sextant_mac::{Cycles, Phy, RadioState};

use super::{Links, Spans};
use crate::air::Sense;
use crate::event::ieee802154::Event;
use crate::event::link::LinkEvent;
use crate::link::clock::Clock;
use crate::link::ieee802154::mac::NodeMac;
use crate::link::ieee802154::stack::{Due, Plan, Stack};
use crate::link::ieee802154::transceiver::Transceiver;
use crate::link::links::Cut;
use crate::link::radios::Radios;
use crate::scene::Scene;

impl Links {
    /// Whether nobody sees what the radio of a station does between its frames.
    pub(super) fn is_quiet(&self, station: StationId, scene: &Scene) -> bool {
        let stack = &self.stacks[station.index()];
        let is_unslotted = matches!(self.macs[station.index()], NodeMac::Unslotted(_));
        // What is found at the place of now may differ at that of later.
        let stands = scene.roll.is_node(station) && !scene.is_moving_node(station);
        self.is_only && is_unslotted && stands && !stack.listening && stack.track.is_none()
    }

    /// Puts the next event of a quiet station that others may notice into the queue, if it is not there.
    pub(super) fn look_ahead(&mut self, station: StationId, scene: &mut Scene) {
        let stack = &mut self.stacks[station.index()];
        let (Some(due), None, NodeMac::Unslotted(csma)) = (stack.due, stack.timer, &self.macs[station.index()])
        else {
            return;
        };
        if !csma.is_busy() {
            // The spacing after the last frame: nothing follows, unless there is another frame before its end.
            return;
        }
        let (place, cca, air) = (scene.place(station), self.radios.phy().cca(), self.radios.air);
        let (from, to) = (scene.now, scene.now + cca);
        let radio = self.radios.interface(station);
        let mut sense = Sense { radio, place, from, to, threshold: stack.cca_threshold };
        // Of windows that begin now or later.
        let busy_until = scene.airs[air].busy_until(&sense);
        let mut will_be_busy = |end: SimTime, scene: &mut Scene| {
            (sense.from, sense.to) = (end.saturating_sub(cca), end);
            scene.airs[air].will_be_busy(&sense)
        };
        let (mut first, mut clock) = (due, stack.clock);
        let mut contention = contention_at(due, csma);
        if contention.is_none() && private_step(due.event).is_some() {
            // The spacing after a frame, or a radio that turns around after its backoff.
            let mut ahead = Ahead { clock, due };
            let mut machine = csma.clone();
            while let (None, Some(step)) = (contention, private_step(ahead.due.event)) {
                let is_assessment = step == (csma::Event::CcaEnded { busy: true });
                if is_assessment && (machine.gives_up_if_busy() || !will_be_busy(ahead.due.at, scene)) {
                    break;
                }
                machine.handle(step, &mut AheadRadio { ahead: &mut ahead, radios: &self.radios, scene, station });
                contention = contention_at(ahead.due, &machine);
            }
            (first, clock) = (ahead.due, ahead.clock);
        }
        let Some(mut contention) = contention else {
            stack.plan = None;
            stack.await_from_queue(first, &self.radios, station, scene);
            return;
        };
        let Spans { cca_ns, backoff_ns, turnaround_ns } = self.spans;
        let (mut start_ns, mut steps, mut cycles) = (first.at.as_nanos(), 1, Cycles::default());
        let end = loop {
            let on_ns = clock.span_ns(cca_ns);
            let end = SimTime::from_nanos(start_ns + on_ns);
            let mut is_busy = |scene: &mut Scene| match busy_until {
                Some(until) if end >= to => end <= until,
                _ => will_be_busy(end, scene),
            };
            if contention.is_last() || !is_busy(scene) {
                break end;
            }
            let greatest = contention.defer();
            let periods = scene.backoff(self.radios.network, station, end.as_nanos(), greatest);
            let resting_ns = clock.span_ns(backoff_ns * u64::from(periods));
            cycles.add(on_ns, resting_ns, turnaround_ns);
            start_ns = end.as_nanos() + resting_ns;
            steps += 2;
        };
        let start = SimTime::from_nanos(start_ns);
        stack.plan = Some(Plan { first, contention, start, steps, cycles, clock });
        stack.await_from_queue(Due { at: end, event: Event::CcaEnded }, &self.radios, station, scene);
    }

    /// An event of channel access comes for a quiet station: takes the steps before it.
    #[inline]
    pub(super) fn take_steps(&mut self, station: StationId, event: Event, scene: &mut Scene) {
        if !self.stacks[station.index()].is_quiet {
            return;
        }
        let this = Due { at: scene.now, event };
        while let Some(due) = self.stacks[station.index()].due
            && due != this
        {
            match &self.stacks[station.index()].plan {
                Some(plan) if plan.first == due => self.take_plan(station, scene),
                _ => self.take_step(station, due, scene),
            }
        }
        let stack = &mut self.stacks[station.index()];
        (stack.due, stack.queued, stack.timer) = (None, None, None);
    }

    /// Takes the steps of the plan of a station at once.
    #[inline]
    fn take_plan(&mut self, station: StationId, scene: &mut Scene) {
        let NodeMac::Unslotted(csma) = &mut self.macs[station.index()] else { unreachable!("it is unslotted") };
        let resting = csma.resting_state();
        let stack = &mut self.stacks[station.index()];
        let Some(plan) = &stack.plan else { return };
        stack.wanted = csma.assess(plan.contention);
        stack.awaits_ack = false;
        // The air need not know: the radio is as deaf as at rest, and what follows the assessment tells the air.
        stack.meter.enter(stack.wanted, plan.first.at);
        stack.meter.wake(self.radios.phy().turnaround());
        stack.meter.cycle(resting, &plan.cycles, plan.start);
        stack.clock = plan.clock;
        let steps = plan.steps;
        (stack.due, stack.plan) = (stack.queued, None);
        scene.steps += steps;
    }

    fn take_step(&mut self, station: StationId, due: Due, scene: &mut Scene) {
        let step = private_step(due.event).expect("what others may notice is in the queue");
        let now = std::mem::replace(&mut scene.now, due.at);
        let stack = &mut self.stacks[station.index()];
        stack.due = None;
        if stack.plan.as_ref().is_some_and(|plan| plan.first == due) {
            stack.plan = None;
        }
        let mut radio = Transceiver { radios: &self.radios, stack, scene, station, awaits_ack: false };
        let report = self.macs[station.index()].handle(due.at, step, &mut radio);
        debug_assert_eq!(report, None, "no step ends a frame");
        scene.now = now;
        scene.steps += 1;
    }

    /// Takes the steps of a station that come before `cut`. Returns when the last one was.
    pub(super) fn catch_up_station(&mut self, station: StationId, cut: Cut, scene: &mut Scene) -> SimTime {
        let mut last = SimTime::ZERO;
        while let Some(due) = self.stacks[station.index()].due
            && private_step(due.event).is_some()
            && (due.at, due.event.class().rank(station)) < (cut.at, cut.rank)
            && self.stacks[station.index()].queued != Some(due)
        {
            self.take_step(station, due, scene);
            last = due.at;
        }
        last
    }

    /// Takes the steps of a station that come before the event under way.
    #[inline]
    pub(super) fn catch_up_now(&mut self, station: StationId, scene: &mut Scene) {
        if self.stacks[station.index()].due.is_some() {
            self.catch_up_station(station, Cut::now(scene), scene);
        }
    }

    /// A station is not quiet any more.
    pub(super) fn rouse(&mut self, station: StationId, scene: &mut Scene) {
        if !self.stacks[station.index()].is_quiet {
            return;
        }
        self.catch_up_now(station, scene);
        let stack = &mut self.stacks[station.index()];
        stack.is_quiet = false;
        (stack.queued, stack.plan) = (None, None);
        if let Some(key) = stack.timer.take() {
            scene.queue.cancel(key);
        }
        if let Some(Due { at, event }) = stack.due.take() {
            let event = self.radios.event(station, LinkEvent::Ieee802154(event));
            stack.timer = Some(scene.at(at, event));
        }
    }
}

/// The step of channel access that an event is, if nobody notices it. An assessment is one if it is certain to find the channel
/// busy.
#[inline]
const fn private_step(event: Event) -> Option<csma::Event> {
    match event {
        Event::Csma(
            step @ (csma::Event::BackoffExpired | csma::Event::SenseReady | csma::Event::InterframeSpaceEnded),
        ) => Some(step),
        Event::CcaEnded => Some(csma::Event::CcaEnded { busy: true }),
        _ => None,
    }
}

/// Where channel access of a quiet station is, ahead of the queue.
struct Ahead {
    clock: Clock,
    due: Due,
}

/// The contention of a machine, if its backoff is what comes next.
#[inline]
fn contention_at(due: Due, machine: &Csma) -> Option<Contention> {
    match due.event {
        Event::Csma(csma::Event::BackoffExpired) => machine.contention(),
        _ => None,
    }
}

impl Stack {
    /// Puts what channel access of a quiet station waits for into the queue.
    #[inline(always)]
    fn await_from_queue(&mut self, due: Due, radios: &Radios<Phy>, station: StationId, scene: &mut Scene) {
        self.queued = Some(due);
        let event = radios.event(station, LinkEvent::Ieee802154(due.event));
        self.timer = Some(scene.at(due.at, event));
    }
}

/// What a copy of the machine of a quiet station acts on: it only finds out what comes when.
struct AheadRadio<'a> {
    ahead: &'a mut Ahead,
    radios: &'a Radios<Phy>,
    scene: &'a Scene,
    station: StationId,
}

impl AheadRadio<'_> {
    #[inline]
    fn wait(&mut self, span: Duration, event: Event) {
        let at = self.ahead.due.at + self.ahead.clock.span(span);
        self.ahead.due = Due { at, event };
    }
}

impl csma::Radio for AheadRadio<'_> {
    #[inline]
    fn backoff_periods(&mut self, max_inclusive: u32) -> u32 {
        self.scene.backoff(self.radios.network, self.station, self.ahead.due.at.as_nanos(), max_inclusive)
    }

    #[inline]
    fn after(&mut self, span: Duration, event: csma::Event) {
        self.wait(span, Event::Csma(event));
    }

    fn cancel_timer(&mut self) {}

    #[inline]
    fn enter(&mut self, _state: RadioState) {}

    #[inline]
    fn start_cca(&mut self) {
        self.wait(self.radios.phy().cca(), Event::CcaEnded);
    }

    fn start_transmission(&mut self, _frame: csma::OutgoingFrame) {
        unreachable!("a transmission is no private step");
    }
}
