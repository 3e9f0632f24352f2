//! The radio of a station whose program commands it: what takes how long, what is refused, and what follows by itself.
//!
//! A radio *rests* off, idle or with its receiver on, as its program says. From there it is called away for a while: by a window in
//! which it receives, by a frame that it sends, by the wait for an acknowledgement, or by an acknowledgement that it
//! sends. Then it goes back to its rest. From idle to receiving, from receiving to sending and back it takes a turnaround; from
//! off the time to wake up; to idle and to off no time.

mod changes;
mod port;
mod settings;

use std::time::Duration;

use sextant_kernel::SimTime;

use crate::energy::RadioState;
use crate::timing::Phy;

use port::LATEST;
pub use port::{Event, News, Refusal, Rest, Sending, Timers, Whole};
pub use settings::{ProgramConfig, ProgramSettings};

/// A frame that is due.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Scheduled {
    at: SimTime,
    airtime: Duration,
    awaited: Option<u8>,
}

/// What a radio does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Activity {
    /// It is where it rests, or in a window.
    Resting,
    /// It is on its way there.
    Changing { until: SimTime },
    /// It turns around for the frame that is due, or sends it.
    Sending { until: SimTime },
    /// It turns around to wait for this acknowledgement.
    TurningBack { awaited: u8, until: SimTime },
    /// It waits for this acknowledgement.
    Awaiting { awaited: u8, until: SimTime },
    /// It acknowledges a frame.
    Acknowledging { until: SimTime },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Window {
    until: SimTime,
    is_open: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Assessment {
    until: SimTime,
    whole: Whole,
}

/// The radio of a station whose program commands it. It begins off.
#[derive(Clone, Debug)]
pub struct ProgramRadio {
    turnaround: Duration,
    wake_up: Duration,
    ack_airtime: Duration,
    ack_wait: Duration,
    rest: Rest,
    state: RadioState,
    activity: Activity,
    /// When it is awake, if it wakes up.
    awake: SimTime,
    window: Option<Window>,
    assessment: Option<Assessment>,
    scheduled: Option<Scheduled>,
}

impl ProgramRadio {
    /// A radio that is off.
    #[must_use]
    pub fn new(settings: &ProgramSettings, phy: Phy) -> Self {
        Self {
            turnaround: phy.turnaround(),
            wake_up: settings.wake_up(),
            ack_airtime: phy.ack_airtime(),
            ack_wait: phy.ack_wait(),
            rest: Rest::Off,
            state: RadioState::Sleep,
            activity: Activity::Resting,
            awake: SimTime::ZERO,
            window: None,
            assessment: None,
            scheduled: None,
        }
    }

    /// The same, with its receiver on.
    #[must_use]
    pub fn receiving(self) -> Self {
        Self { rest: Rest::Receive, state: RadioState::Receive, ..self }
    }

    /// Its state.
    #[must_use]
    pub const fn state(&self) -> RadioState {
        self.state
    }

    /// Whether it sends something, turns around for that, or waits for an acknowledgement.
    #[must_use]
    pub const fn is_sending(&self) -> bool {
        !matches!(self.activity, Activity::Resting | Activity::Changing { .. })
    }

    /// Whether it waits for an acknowledgement with its receiver on.
    #[must_use]
    pub const fn is_awaiting(&self) -> bool {
        matches!(self.activity, Activity::Awaiting { .. })
    }

    /// When the first symbol of a frame could go out, if its program commanded that now and it sent nothing else.
    #[must_use]
    pub fn earliest(&self, now: SimTime) -> SimTime {
        match (self.activity, self.state) {
            (_, RadioState::Sleep) => now + self.wake_up,
            (Activity::Resting | Activity::Changing { .. }, _) => self.awake.max(now + self.turnaround),
            (_, _) => self.free_at().unwrap_or(now) + self.turnaround,
        }
    }

    /// When it is free of what it sends; `None` if it sends nothing.
    fn free_at(&self) -> Option<SimTime> {
        match self.activity {
            Activity::Resting | Activity::Changing { .. } => None,
            Activity::Sending { until }
            | Activity::TurningBack { until, .. }
            | Activity::Awaiting { until, .. }
            | Activity::Acknowledging { until } => Some(until),
        }
    }

    /// Whether its receiver should be on when it sends nothing.
    fn is_wanted_on(&self) -> bool {
        self.rest == Rest::Receive || self.window.is_some_and(|window| window.is_open)
    }

    /// Changes where it rests; a window and an assessment of the channel end at once, without news. What it sends ends
    /// first. A radio that could not wake up in time for a frame that is due is idle until that is out, and then off. Returns
    /// when it is there.
    pub fn rest(&mut self, rest: Rest, now: SimTime, timers: &mut impl Timers) -> SimTime {
        self.rest = rest;
        if self.window.take().is_some() {
            timers.cancel(Event::WindowDue);
            timers.cancel(Event::WindowOver);
        }
        match self.free_at() {
            Some(free) if rest == Rest::Receive => free + self.turnaround,
            Some(free) => free,
            None => self.settle(now, timers),
        }
    }

    /// Opens a window: the receiver is on from `from`, or as soon as possible if that is absent, until `until`. It replaces an
    /// earlier window. Returns its start.
    ///
    /// # Errors
    /// If the receiver cannot be on by then, or the window has no length or ends too late.
    pub fn open(
        &mut self,
        from: Option<SimTime>,
        until: SimTime,
        now: SimTime,
        timers: &mut impl Timers,
    ) -> Result<SimTime, Refusal> {
        let earliest = match (self.state, self.activity) {
            (RadioState::Receive, Activity::Resting) => now,
            (_, Activity::Changing { until }) if self.is_wanted_on() => until,
            _ => self.earliest(now),
        };
        let from = from.unwrap_or(earliest);
        if until > LATEST {
            return Err(Refusal::TooLate(until));
        }
        if from < earliest {
            return Err(Refusal::TooEarly { asked: from, earliest });
        }
        if until <= from {
            return Err(Refusal::EmptyWindow { from, until });
        }
        timers.cancel(Event::WindowDue);
        let lead = if self.rest == Rest::Off { self.wake_up } else { self.turnaround };
        let due = SimTime::from_nanos(from.as_nanos().saturating_sub((SimTime::ZERO + lead).as_nanos()));
        let was_open = self.window.is_some_and(|window| window.is_open);
        let is_open = due <= now;
        self.window = Some(Window { until, is_open });
        timers.set(Event::WindowOver, until);
        if !is_open {
            timers.set(Event::WindowDue, due);
        }
        if (is_open || was_open) && self.free_at().is_none() {
            self.settle(now, timers);
        }
        Ok(from)
    }

    /// Looks at the channel for `span` from now, with the receiver on. Returns when that is over.
    ///
    /// # Errors
    /// If the receiver is not on for so long, or it looks at the channel already.
    pub fn assess(&mut self, span: Duration, now: SimTime, timers: &mut impl Timers) -> Result<SimTime, Refusal> {
        let until = now + span;
        if let Some(assessment) = self.assessment {
            return Err(Refusal::Assessing { until: assessment.until });
        }
        let stays_on =
            self.rest == Rest::Receive || self.window.is_some_and(|window| window.is_open && window.until >= until);
        if self.state != RadioState::Receive || self.activity != Activity::Resting || !stays_on {
            return Err(Refusal::NotReceiving);
        }
        if let Some(due) = self.scheduled
            && due.at < until + self.turnaround
        {
            return Err(Refusal::Sending { until: due.at + due.airtime });
        }
        self.assessment = Some(Assessment { until, whole: Whole::Unbroken });
        timers.set(Event::AssessmentEnded, until);
        Ok(until)
    }

    /// Sends a frame without any channel access. Returns when its first symbol goes out.
    ///
    /// # Errors
    /// If it cannot be ready by then, has something else to send, or looks at the channel.
    pub fn send(&mut self, sending: Sending, now: SimTime, timers: &mut impl Timers) -> Result<SimTime, Refusal> {
        let Sending { at, airtime, awaited } = sending;
        if let Some(due) = self.scheduled {
            return Err(Refusal::Sending { until: due.at + due.airtime });
        }
        if let Some(until) = self.free_at() {
            return Err(Refusal::Sending { until });
        }
        let earliest = self.earliest(now);
        let at = at.unwrap_or(earliest);
        if at > LATEST {
            return Err(Refusal::TooLate(at));
        }
        if at < earliest {
            return Err(Refusal::TooEarly { asked: at, earliest });
        }
        if let Some(assessment) = self.assessment
            && at < assessment.until + self.turnaround
        {
            return Err(Refusal::Assessing { until: assessment.until });
        }
        self.scheduled = Some(Scheduled { at, airtime, awaited });
        if at == earliest {
            self.turn(now, timers)
        } else {
            self.plan_turn(timers)
        }
        Ok(at)
    }

    /// How long it waits for an acknowledgement from now on, counted from the end of a frame: that of the standard
    /// (macAckWaitDuration) at first.
    ///
    /// # Errors
    /// If an acknowledgement would not be over by then; returns the least time.
    pub fn set_ack_wait(&mut self, wait: Duration) -> Result<(), Duration> {
        let least = self.turnaround + self.ack_airtime;
        if wait < least {
            return Err(least);
        }
        self.ack_wait = wait;
        Ok(())
    }

    /// It does nothing any more; its timers are to be cancelled.
    pub fn turn_off(&mut self) {
        (self.rest, self.state, self.activity) = (Rest::Off, RadioState::Sleep, Activity::Resting);
        (self.window, self.assessment, self.scheduled) = (None, None, None);
    }

    /// Takes back a frame for which it has not turned around yet. Returns whether there was one.
    pub fn take_back(&mut self, timers: &mut impl Timers) -> bool {
        if self.scheduled.is_none() || matches!(self.activity, Activity::Sending { .. }) {
            return false;
        }
        self.scheduled = None;
        timers.cancel(Event::TurnDue);
        true
    }

    /// Changes the channel. If the receiver is on, it is deaf for a turnaround. Returns when it is ready.
    ///
    /// # Errors
    /// If it sends something.
    pub fn tune(&mut self, now: SimTime, timers: &mut impl Timers) -> Result<SimTime, Refusal> {
        if let Some(until) = self.free_at() {
            return Err(Refusal::Sending { until });
        }
        self.forget_assessment(timers);
        if !self.is_wanted_on() {
            return Ok(if let Activity::Changing { until } = self.activity { until } else { now });
        }
        Ok(self.change(self.awake.max(now + self.turnaround), RadioState::Turnaround, timers))
    }

    /// Acknowledges a frame that was received just now. Returns whether it does: a frame that is due goes first.
    pub fn acknowledge(&mut self, now: SimTime, timers: &mut impl Timers) -> bool {
        let start = now + self.turnaround;
        let until = start + self.ack_airtime;
        let is_free = self.scheduled.is_none_or(|due| due.at >= until + self.turnaround);
        if self.activity != Activity::Resting || !is_free {
            return false;
        }
        if let Some(assessment) = &mut self.assessment {
            assessment.whole = Whole::Broken;
        }
        self.activity = Activity::Acknowledging { until };
        self.state = RadioState::Turnaround;
        timers.set(Event::AcknowledgementDue, start);
        true
    }

    /// An acknowledgement with this sequence number was received. Returns whether the radio waited for it.
    pub fn receive_acknowledgement(&mut self, sequence: u8, now: SimTime, timers: &mut impl Timers) -> bool {
        match self.activity {
            Activity::Awaiting { awaited, .. } if awaited == sequence => {
                timers.cancel(Event::WaitOver);
                self.settle(now, timers);
                true
            }
            _ => false,
        }
    }

    /// Handles an event; returns the news.
    pub fn handle(&mut self, event: Event, now: SimTime, timers: &mut impl Timers) -> Option<News> {
        match event {
            Event::Ready => self.be_ready(),
            Event::WindowDue => {
                if let Some(window) = &mut self.window {
                    window.is_open = true;
                }
                if self.free_at().is_none() {
                    self.settle(now, timers);
                }
                None
            }
            Event::WindowOver => {
                self.window = None;
                if self.free_at().is_none() {
                    self.settle(now, timers);
                }
                Some(News::WindowOver)
            }
            Event::AssessmentEnded => self.assessment.take().map(|assessment| News::Assessed(assessment.whole)),
            Event::TurnDue => {
                self.turn(now, timers);
                None
            }
            Event::FrameDue => {
                let due = self.scheduled.expect("a frame that is due is scheduled");
                self.state = RadioState::Transmit;
                timers.set(Event::FrameEnded, now + due.airtime);
                Some(News::FrameBegins)
            }
            Event::FrameEnded => {
                let awaited = self.scheduled.take().and_then(|due| due.awaited);
                match awaited {
                    Some(awaited) => {
                        let until = now + self.ack_wait;
                        self.activity = Activity::TurningBack { awaited, until };
                        self.state = RadioState::Turnaround;
                        timers.set(Event::Ready, now + self.turnaround);
                        timers.set(Event::WaitOver, until);
                    }
                    None => {
                        self.settle(now, timers);
                    }
                }
                Some(News::Sent)
            }
            Event::AcknowledgementDue => {
                self.state = RadioState::Transmit;
                timers.set(Event::AcknowledgementEnded, now + self.ack_airtime);
                Some(News::AcknowledgementBegins)
            }
            Event::AcknowledgementEnded => {
                self.settle(now, timers);
                Some(News::AcknowledgementSent)
            }
            Event::WaitOver => {
                self.settle(now, timers);
                Some(News::Unacknowledged)
            }
        }
    }
}

#[cfg(test)]
mod tests;
