//! Timers of applications: exact instants, in a stated order.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::{EventKey, SimTime};
use sextant_sim::{Application, Port, Timer};

use crate::network;

/// Sets its timers at the start, and writes down when each was due.
#[derive(Default)]
struct Clock {
    /// Spans of the timers 0, 1, ...
    spans: Vec<Duration>,
    /// The timer that cancels another one when it is due.
    cancels: Option<(Timer, Timer)>,
    /// The timer that is set again when it is due, this often and with this span.
    repeats: Option<(Timer, u32, Duration)>,
    keys: Vec<EventKey>,
    due: Vec<(SimTime, Timer)>,
}

impl Application for Clock {
    fn started(&mut self, port: &mut Port<'_>) {
        self.keys = self.spans.iter().zip(0..).map(|(&span, number)| port.after(span, Timer(number))).collect();
    }

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        self.due.push((port.now(), timer));
        if let Some((by, Timer(cancelled))) = self.cancels
            && timer == by
        {
            port.cancel(self.keys[usize::from(cancelled)]);
        }
        if let Some((repeated, left @ 1.., span)) = self.repeats
            && timer == repeated
        {
            self.repeats = Some((repeated, left - 1, span));
            port.after(span, timer);
        }
    }
}

/// When the timers of each of `clocks` were due (ns), each on a node of its own.
fn due(clocks: Vec<Clock>) -> Vec<Vec<(u64, u16)>> {
    let places = vec![Position::ORIGIN; clocks.len()];
    let ended = network::run(network::engine(&places, network::link(1.0, network::prompt()), 1), clocks);
    let due = |clock: Clock| clock.due.iter().map(|&(at, Timer(number))| (at.as_nanos(), number)).collect();
    ended.applications.into_iter().map(due).collect()
}

fn spans(nanos: &[u64]) -> Vec<Duration> {
    nanos.iter().copied().map(Duration::from_nanos).collect()
}

#[test]
fn several_timers_are_due_at_their_exact_instants() {
    let clock = Clock { spans: spans(&[7_000_000_001, 3, 0, 86_400_000_000_000]), ..Clock::default() };
    assert_eq!(due(vec![clock]), [vec![(0, 2), (3, 1), (7_000_000_001, 0), (86_400_000_000_000, 3)]]);
}

#[test]
fn timers_of_one_instant_are_due_in_the_order_in_which_they_were_set() {
    let clock = Clock { spans: spans(&[5, 5, 4, 5]), ..Clock::default() };
    assert_eq!(due(vec![clock]), [vec![(4, 2), (5, 0), (5, 1), (5, 3)]]);
}

#[test]
fn a_cancelled_timer_is_never_due_and_a_late_cancellation_changes_nothing() {
    let early = Clock { spans: spans(&[5, 6, 7]), cancels: Some((Timer(0), Timer(1))), ..Clock::default() };
    // At the same instant, but set later; and a timer that was due already, or is due now.
    let equal = Clock { spans: spans(&[5, 5, 7]), cancels: Some((Timer(0), Timer(1))), ..Clock::default() };
    let late = Clock { spans: spans(&[5, 6, 7]), cancels: Some((Timer(2), Timer(0))), ..Clock::default() };
    let own = Clock { spans: spans(&[5, 6, 7]), cancels: Some((Timer(1), Timer(1))), ..Clock::default() };
    assert_eq!(
        due(vec![early, equal, late, own]),
        [vec![(5, 0), (7, 2)], vec![(5, 0), (7, 2)], vec![(5, 0), (6, 1), (7, 2)], vec![(5, 0), (6, 1), (7, 2)]]
    );
}

#[test]
fn a_timer_can_be_set_again_when_it_is_due_also_at_the_same_instant() {
    let beat =
        Clock { spans: spans(&[10]), repeats: Some((Timer(0), 3, Duration::from_nanos(10))), ..Clock::default() };
    let stutter = Clock { spans: spans(&[10, 10]), repeats: Some((Timer(0), 2, Duration::ZERO)), ..Clock::default() };
    assert_eq!(
        due(vec![beat, stutter]),
        [vec![(10, 0), (20, 0), (30, 0), (40, 0)], vec![(10, 0), (10, 1), (10, 0), (10, 0)]]
    );
}

#[test]
fn a_cancelled_timer_does_not_hit_the_timer_that_takes_its_place() {
    // Timer 0 is due and its place is free; it is set again, and then timer 1 cancels by the old key.
    let clock = Clock {
        spans: spans(&[5, 6]),
        repeats: Some((Timer(0), 1, Duration::from_nanos(5))),
        cancels: Some((Timer(1), Timer(0))),
        ..Clock::default()
    };
    assert_eq!(due(vec![clock]), [vec![(5, 0), (6, 1), (10, 0)]]);
}
