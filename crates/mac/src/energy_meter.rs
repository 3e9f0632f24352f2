//! How long a radio is in each of its states.

use std::time::Duration;

use sextant_channel::Dbm;
use sextant_kernel::SimTime;

use crate::energy::{EnergySpent, RadioState, RadioStates};

/// A span of less than 584 years (ns).
#[inline]
fn nanos(span: Duration) -> u64 {
    (SimTime::ZERO + span).as_nanos()
}

/// Times between one start of the receiver and another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cycles {
    /// Time with the receiver on (ns).
    on: u64,
    /// Time at rest (ns).
    resting: u64,
    /// How much of it a radio that is idle at rest needs to turn around (ns).
    turned: u64,
}

impl Cycles {
    /// The receiver was on for `on_ns`, and then at rest for `resting_ns`; it needs `turnaround_ns` to come on (ns).
    #[inline]
    pub fn add(&mut self, on_ns: u64, resting_ns: u64, turnaround_ns: u64) {
        self.on += on_ns;
        self.resting += resting_ns;
        self.turned += resting_ns.min(turnaround_ns);
    }
}

/// How long one radio was in each of its states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EnergyMeter {
    state: RadioState,
    since: SimTime,
    /// Time in each state (ns).
    spans: [u64; 5],
    /// How long the radio has been idle without a break, or was before its present state (ns).
    rested: u64,
    /// Time that the way from receiving to idle takes (ns).
    fall: u64,
    /// What is left of that time (ns).
    falling: u64,
}

impl EnergyMeter {
    /// A meter for a radio that is in `state` at `now`.
    #[must_use]
    pub const fn new(state: RadioState, now: SimTime) -> Self {
        Self { state, since: now, spans: [0; 5], rested: 0, fall: 0, falling: 0 }
    }

    /// The same for a radio that takes so long from receiving to idle: that time counts as a turnaround.
    #[must_use]
    pub fn with_fall(self, fall: Duration) -> Self {
        Self { fall: nanos(fall), ..self }
    }

    /// The state that the radio is in.
    #[must_use]
    #[inline]
    pub const fn state(&self) -> RadioState {
        self.state
    }

    /// The radio changes to `state` at `now`, or stays in it.
    ///
    /// # Panics
    /// If `now` is before the last change.
    #[inline]
    pub fn enter(&mut self, state: RadioState, now: SimTime) {
        let span = now.as_nanos().checked_sub(self.since.as_nanos()).expect("an earlier instant");
        if self.state == RadioState::Idle {
            let falling = span.min(self.falling);
            self.falling -= falling;
            self.spans[RadioState::Turnaround as usize] += falling;
            self.spans[RadioState::Idle as usize] += span - falling;
            self.rested += span - falling;
        } else {
            self.spans[self.state as usize] += span;
        }
        if state != self.state {
            if state == RadioState::Idle {
                self.rested = 0;
                self.falling = if self.state == RadioState::Receive { self.fall } else { 0 };
            } else if self.state != RadioState::Idle {
                self.rested = 0;
            }
        }
        self.state = state;
        self.since = now;
    }

    /// The receiver has just come on after idling: the turnaround of the radio, of this length, took place in the last
    /// part of the time in which it seemed idle. Nothing changes if the radio was not idle before.
    #[inline]
    pub fn wake(&mut self, turnaround: Duration) {
        let turned = nanos(turnaround).min(std::mem::take(&mut self.rested));
        self.spans[RadioState::Idle as usize] -= turned;
        self.spans[RadioState::Turnaround as usize] += turned;
    }

    /// The receiver, which has just come on, goes to rest and comes on again, as often as it may be: `at` is when it came on
    /// for the last time. What [`enter`](Self::enter) and [`wake`](Self::wake) would count, in one.
    #[inline]
    pub fn cycle(&mut self, resting: RadioState, cycles: &Cycles, at: SimTime) {
        let turned = if resting == RadioState::Idle { cycles.turned } else { 0 };
        self.spans[RadioState::Receive as usize] += cycles.on;
        self.spans[resting as usize] += cycles.resting - turned;
        self.spans[RadioState::Turnaround as usize] += turned;
        self.since = at;
    }

    /// Forgets all time so far: the meter starts again at `now`.
    pub fn restart(&mut self, now: SimTime) {
        self.enter(self.state, now);
        self.spans = [0; 5];
        // Of a turnaround that comes later only what lies after `now` counts.
        self.rested = 0;
    }

    /// Time in `state` until the last call of [`EnergyMeter::enter`].
    #[must_use]
    pub const fn span(&self, state: RadioState) -> Duration {
        Duration::from_nanos(self.spans[state as usize])
    }

    /// Adds what another meter of the same radio measured in the same time, of which each knows a part: whatever state one
    /// of them saw besides `rests_in`, the other took for `rests_in`.
    pub fn add_activity(&mut self, other: &Self, rests_in: RadioState) {
        let rest = rests_in as usize;
        for (state, &span) in other.spans.iter().enumerate().filter(|&(state, _)| state != rest) {
            self.spans[state] += span;
            self.spans[rest] = self.spans[rest].saturating_sub(span);
        }
    }

    /// Energy until the last call of [`EnergyMeter::enter`] of a radio that was in `state` all the time instead.
    #[must_use]
    pub fn at_rest(&self, state: RadioState, radio: &RadioStates, tx_power: Dbm) -> EnergySpent {
        let mut meter = Self::new(state, SimTime::ZERO);
        meter.spans[state as usize] = self.spans.iter().sum();
        meter.spent(radio, tx_power)
    }

    /// Energy until the last call of [`EnergyMeter::enter`], with a radio that transmits at `tx_power`.
    #[must_use]
    pub fn spent(&self, radio: &RadioStates, tx_power: Dbm) -> EnergySpent {
        let joules = |state| radio.power_w(state, tx_power) * self.span(state).as_secs_f64();
        EnergySpent {
            tx_j: joules(RadioState::Transmit),
            rx_j: joules(RadioState::Receive) + joules(RadioState::Turnaround),
            idle_j: joules(RadioState::Idle),
            sleep_j: joules(RadioState::Sleep),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CustomRadioConfig, EnergyConfig, Phy};

    const PHY: Phy = Phy::Oqpsk2450;

    fn assert_close(found: f64, expected: f64, tolerance: f64) {
        assert!((found - expected).abs() < tolerance, "{found}, not {expected}");
    }

    #[test]
    fn many_cycles_count_as_each_of_them_would() {
        let turnaround = Duration::from_micros(12);
        // On, and then at rest (us): the second rest is shorter than the turnaround.
        let spans =
            [(100, 40), (7, 5), (30, 12)].map(|(on, rest)| (Duration::from_micros(on), Duration::from_micros(rest)));
        for resting in [RadioState::Idle, RadioState::Sleep] {
            let start = SimTime::ZERO + Duration::from_micros(3);
            let (mut each, mut cycles, mut now) =
                (EnergyMeter::new(RadioState::Receive, start), Cycles::default(), start);
            for (on, rest) in spans {
                cycles.add(nanos(on), nanos(rest), nanos(turnaround));
                now += on;
                each.enter(resting, now);
                now += rest;
                each.enter(RadioState::Receive, now);
                each.wake(turnaround);
            }
            let mut at_once = EnergyMeter::new(RadioState::Receive, start);
            at_once.cycle(resting, &cycles, now);
            for meter in [&mut each, &mut at_once] {
                meter.enter(RadioState::Sleep, now + Duration::from_micros(9));
            }
            for state in [RadioState::Receive, RadioState::Turnaround, RadioState::Idle, RadioState::Sleep] {
                assert_eq!(at_once.span(state), each.span(state), "{resting:?}: {state:?}");
            }
            let turned_us = if resting == RadioState::Idle { 12 + 5 + 12 } else { 0 };
            assert_eq!(at_once.span(RadioState::Turnaround), Duration::from_micros(turned_us));
        }
    }

    #[test]
    fn a_meter_counts_each_state_once() {
        let at = |us| SimTime::ZERO + Duration::from_micros(us);
        let mut meter = EnergyMeter::new(RadioState::Sleep, at(0));
        for (us, state) in [
            (100, RadioState::Idle),
            (130, RadioState::Receive),
            (130, RadioState::Turnaround),
            (150, RadioState::Transmit),
            (190, RadioState::Sleep),
            (200, RadioState::Sleep),
        ] {
            meter.enter(state, at(us));
        }
        let spans = [
            (RadioState::Sleep, 110),
            (RadioState::Idle, 30),
            (RadioState::Receive, 0),
            (RadioState::Turnaround, 20),
            (RadioState::Transmit, 40),
        ];
        for (state, us) in spans {
            assert_eq!(meter.span(state), Duration::from_micros(us), "{state:?}");
        }
        let config = CustomRadioConfig { supply_v: 2.0, tx_ma: 4.0, rx_ma: 3.0, idle_ma: 2.0, sleep_ma: 1.0 };
        let radio = RadioStates::try_from(EnergyConfig::Custom(config)).expect("good currents");
        let spent = meter.spent(&radio, Dbm(0.0));
        assert_close(spent.tx_j, 320e-9, 1e-15);
        assert_close(spent.rx_j, 120e-9, 1e-15);
        assert_close(spent.idle_j, 120e-9, 1e-15);
        assert_close(spent.total_j(), 780e-9, 1e-15);
    }

    #[test]
    fn a_receiver_that_comes_on_has_turned_around_in_the_last_part_of_its_idle_time() {
        let at = |us| SimTime::ZERO + Duration::from_micros(us);
        let turnaround = PHY.turnaround();
        let mut meter = EnergyMeter::new(RadioState::Idle, at(0));
        // Idle for 500 us, CCA, busy, idle for 100 us, CCA, busy, CCA at once.
        meter.enter(RadioState::Receive, at(500));
        meter.wake(turnaround);
        meter.enter(RadioState::Idle, at(628));
        meter.enter(RadioState::Receive, at(728));
        meter.wake(turnaround);
        meter.enter(RadioState::Idle, at(856));
        meter.enter(RadioState::Receive, at(856));
        meter.wake(turnaround);
        meter.enter(RadioState::Turnaround, at(984));
        meter.enter(RadioState::Receive, at(1176));
        meter.wake(turnaround);
        meter.enter(RadioState::Sleep, at(1200));
        let span = |state| meter.span(state);
        assert_eq!(span(RadioState::Idle), Duration::from_micros(500 - 192));
        assert_eq!(span(RadioState::Turnaround), Duration::from_micros(192 + 100 + 192));
        assert_eq!(span(RadioState::Receive), Duration::from_micros(128 + 128 + 128 + 24));
    }

    #[test]
    fn the_way_back_to_idle_counts_as_a_turnaround_if_it_takes_time() {
        let at = |us| SimTime::ZERO + Duration::from_micros(us);
        let mut meter = EnergyMeter::new(RadioState::Receive, at(0)).with_fall(PHY.turnaround());
        meter.enter(RadioState::Idle, at(100));
        meter.enter(RadioState::Idle, at(200));
        meter.enter(RadioState::Receive, at(500));
        meter.wake(PHY.turnaround());
        meter.enter(RadioState::Idle, at(600));
        meter.enter(RadioState::Turnaround, at(650));
        meter.enter(RadioState::Transmit, at(660));
        meter.enter(RadioState::Idle, at(700));
        meter.enter(RadioState::Idle, at(750));
        let span = |state| meter.span(state);
        // 400 us idle after receiving: the way back, what is left, and the way to receiving, which takes 192 us of it.
        assert_eq!(span(RadioState::Idle), Duration::from_micros(400 - 192 - 192 + 50));
        assert_eq!(span(RadioState::Turnaround), Duration::from_micros(192 + 192 + 50 + 10));
        meter.restart(at(800));
        meter.enter(RadioState::Receive, at(830));
        assert_eq!(meter.span(RadioState::Idle), Duration::from_micros(30));
        assert_eq!(meter.span(RadioState::Transmit), Duration::ZERO);
    }
}
