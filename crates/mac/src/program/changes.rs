//! How a radio that a program commands changes its state.

use sextant_kernel::SimTime;

use super::{Activity, Event, News, ProgramRadio, Rest, Timers};
use crate::energy::RadioState;

impl ProgramRadio {
    /// It has turned around, or is awake.
    pub(super) fn be_ready(&mut self) -> Option<News> {
        if let Activity::TurningBack { awaited, until } = self.activity {
            self.activity = Activity::Awaiting { awaited, until };
            self.state = RadioState::Receive;
            return None;
        }
        self.activity = Activity::Resting;
        self.state = if self.is_wanted_on() { RadioState::Receive } else { RadioState::Idle };
        Some(News::Ready)
    }

    /// Goes where it should be when it sends nothing. Returns when it is there.
    pub(super) fn settle(&mut self, now: SimTime, timers: &mut impl Timers) -> SimTime {
        let there = self.go(now, timers);
        self.plan_turn(timers);
        there
    }

    fn go(&mut self, now: SimTime, timers: &mut impl Timers) -> SimTime {
        if self.is_wanted_on() {
            return match (self.state, self.activity) {
                (RadioState::Receive, _) => {
                    self.activity = Activity::Resting;
                    now
                }
                (RadioState::Turnaround, Activity::Changing { until }) => until,
                (state, _) => {
                    if state == RadioState::Sleep {
                        self.awake = now + self.wake_up;
                    }
                    self.change(self.awake.max(now + self.turnaround), RadioState::Turnaround, timers)
                }
            };
        }
        self.forget_assessment(timers);
        timers.cancel(Event::Ready);
        let is_in_time = self.scheduled.is_none_or(|due| due.at >= now + self.wake_up);
        if self.rest == Rest::Off && is_in_time {
            self.activity = Activity::Resting;
            self.state = RadioState::Sleep;
            return now;
        }
        if self.state == RadioState::Sleep {
            self.awake = now + self.wake_up;
        }
        if self.awake > now {
            return self.change(self.awake, RadioState::Idle, timers);
        }
        self.activity = Activity::Resting;
        self.state = RadioState::Idle;
        now
    }

    /// It is on its way, in `state`, until `until`.
    pub(super) fn change(&mut self, until: SimTime, state: RadioState, timers: &mut impl Timers) -> SimTime {
        self.activity = Activity::Changing { until };
        self.state = state;
        timers.set(Event::Ready, until);
        until
    }

    /// An assessment of the channel is given up.
    pub(super) fn forget_assessment(&mut self, timers: &mut impl Timers) {
        if self.assessment.take().is_some() {
            timers.cancel(Event::AssessmentEnded);
        }
    }

    /// Sets when it must turn around for the frame that is due.
    pub(super) fn plan_turn(&mut self, timers: &mut impl Timers) {
        let Some(due) = self.scheduled else { return };
        let lead = if self.state == RadioState::Sleep { self.wake_up } else { self.turnaround };
        timers.set(Event::TurnDue, SimTime::from_nanos(due.at.as_nanos() - (SimTime::ZERO + lead).as_nanos()));
    }

    /// Turns around for the frame that is due.
    pub(super) fn turn(&mut self, now: SimTime, timers: &mut impl Timers) {
        let due = self.scheduled.expect("a frame is due");
        timers.cancel(Event::TurnDue);
        timers.cancel(Event::Ready);
        self.forget_assessment(timers);
        if self.state == RadioState::Sleep {
            self.awake = now + self.wake_up;
        }
        self.activity = Activity::Sending { until: due.at + due.airtime };
        self.state = RadioState::Turnaround;
        timers.set(Event::FrameDue, due.at);
    }
}
