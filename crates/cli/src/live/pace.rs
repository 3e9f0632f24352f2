//! Simulated time against the wall clock.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use sextant_kernel::SimTime;

use crate::interrupt::Interrupt;

/// While time passes, it is told this often.
const TICK: Duration = Duration::from_millis(50);

/// Lets simulated time pass as the wall clock says, step by step, or not at all.
#[derive(Debug)]
pub(crate) struct Pace {
    state: Mutex<State>,
    changed: Condvar,
    interrupt: Interrupt,
}

#[derive(Debug)]
struct State {
    is_paused: bool,
    /// Simulated seconds in a second; `None` for as fast as possible.
    speed: Option<f64>,
    /// Steps that were asked for and not made.
    steps: u32,
    /// Simulated time at `since`.
    time: SimTime,
    /// From when on time passes.
    since: Instant,
    /// The last instant of which is known that something happens then.
    known: SimTime,
}

/// How far a run is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Progress {
    /// Whether time stands still.
    pub(crate) is_paused: bool,
    /// Simulated seconds in a second; `None` for as fast as possible.
    pub(crate) speed: Option<f64>,
    /// Simulated time.
    pub(crate) time: SimTime,
}

impl Pace {
    /// Time 0, at which everything stays if `is_paused`. After a signal, nothing waits.
    pub(crate) fn new(speed: Option<f64>, is_paused: bool, interrupt: Interrupt) -> Self {
        let state = State { is_paused, speed, steps: 0, time: SimTime::ZERO, since: now(), known: SimTime::ZERO };
        Self { state: Mutex::new(state), changed: Condvar::new(), interrupt }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Time stands still.
    pub(crate) fn pause(&self) -> Progress {
        self.change(|state| state.is_paused = true)
    }

    /// Time goes on.
    pub(crate) fn resume(&self) -> Progress {
        self.change(|state| (state.is_paused, state.steps) = (false, 0))
    }

    /// Pauses or goes on.
    pub(crate) fn toggle(&self) -> Progress {
        self.change(|state| (state.is_paused, state.steps) = (!state.is_paused, 0))
    }

    /// Time stands still after the next instant at which something is recorded.
    pub(crate) fn step(&self) -> Progress {
        self.change(|state| {
            state.is_paused = true;
            state.steps = state.steps.saturating_add(1);
        })
    }

    /// Time passes faster or slower from now on.
    pub(crate) fn set_speed(&self, speed: Option<f64>) -> Progress {
        self.change(|state| state.speed = speed)
    }

    /// How far the run is.
    pub(crate) fn progress(&self) -> Progress {
        self.change(|_| ())
    }

    fn change(&self, change: impl FnOnce(&mut State)) -> Progress {
        let mut state = self.state();
        state.time = Self::time(&state);
        state.since = now();
        change(&mut state);
        self.changed.notify_all();
        Progress { is_paused: state.is_paused, speed: state.speed, time: state.time.min(state.known) }
    }

    /// Simulated time now.
    fn time(state: &State) -> SimTime {
        match state.speed {
            Some(speed) if !state.is_paused => passed(state.time, state.since.elapsed(), speed),
            _ => state.time,
        }
    }

    /// Waits until simulated time is `next`, and tells `tick` the time while it passes. An instant before now has come.
    pub(crate) fn wait_until(&self, next: SimTime, tick: impl Fn(SimTime)) {
        let mut state = self.state();
        state.known = state.known.max(next);
        while next > state.time && !self.interrupt.is_requested() {
            let mut longest = TICK;
            if state.is_paused && state.steps > 0 {
                state.steps -= 1;
                break;
            }
            if !state.is_paused {
                let Some(speed) = state.speed else { break };
                let time = Self::time(&state);
                if time >= next {
                    break;
                }
                tick(time);
                longest = longest.min((next - time).div_f64(speed));
            }
            state = self.changed.wait_timeout(state, longest).unwrap_or_else(PoisonError::into_inner).0;
        }
        if next > state.time {
            (state.time, state.since) = (next, now());
            tick(next);
        }
    }
}

fn now() -> Instant {
    #[expect(clippy::disallowed_methods, reason = "a live view follows the wall clock")]
    Instant::now()
}

/// Simulated time when `span` has passed at `speed` since `time`; the last instant if it would be later.
fn passed(time: SimTime, span: Duration, speed: f64) -> SimTime {
    let span_ns = u64::try_from(span.mul_f64(speed).as_nanos()).unwrap_or(u64::MAX);
    SimTime::from_nanos(time.as_nanos().saturating_add(span_ns))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fast_view_that_is_left_open_stays_at_the_last_instant() {
        let second = Duration::from_secs(1);
        assert_eq!(passed(SimTime::from_nanos(5), second, 2.0), SimTime::from_nanos(2_000_000_005));
        assert_eq!(passed(SimTime::from_nanos(5), 86_400 * second, 1e9), SimTime::MAX);
    }
}
