//! The window for the answers of many stations: when it ends, and when feedback is due in it.

use sextant_channel::Db;
use sextant_kernel::SimTime;

use super::{Answer, Initiator, InitiatorOutcome, InitiatorReport, State, Sweep};
use crate::dmg::address::MacAddress;
use crate::dmg::frame::{BeamRefinement, SweepBody, SweepFrame};
use crate::dmg::port::{Event, Radio};
use crate::dmg::settings::Contention;
use crate::dmg::timing::{
    AIR_PROPAGATION, CCA_DETECTION, MBIFS, SLOT, duration_field, slot_sweep_duration, sweep_end,
};

/// The time for answers of many stations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FeedbackWindow {
    pub(super) opens: SimTime,
    pub(super) closes: SimTime,
}

impl Initiator {
    /// A frame of an answer was decoded.
    pub(super) fn hear(
        &mut self,
        now: SimTime,
        frame: &SweepFrame,
        sinr: Db,
        window: FeedbackWindow,
        radio: &mut impl Radio,
    ) -> Option<InitiatorReport> {
        let SweepBody::Rss { cdown, sector, feedback } = frame.body else { return None };
        let answer = Answer::new(frame.from, sector, feedback, sinr);
        self.answers.hear(answer);
        let due = self.feedback_due(now, window, cdown, frame.duration_us)?;
        self.answers.promise(answer, due);
        match self.state {
            State::Gathering(sweep, window) => self.watch(sweep, window, now, radio),
            // First comes the report that is awaited.
            _ => None,
        }
    }

    /// When feedback to the sweep of a responder is due, of which a frame was decoded now; `None` without feedback.
    fn feedback_due(&self, now: SimTime, window: FeedbackWindow, cdown: u16, duration_us: u16) -> Option<SimTime> {
        match self.settings.contention() {
            Contention::CsmaFeedback { .. } => {
                let tail = self.settings.taken_after_answer(self.layout.total());
                Some(sweep_end(now, cdown, duration_us, tail) + MBIFS)
            }
            Contention::Abft(abft) if abft.has_feedback() && now > window.opens => {
                let slots = (now - window.opens).as_nanos() / abft.slot_duration().as_nanos();
                let slots = u32::try_from(slots).expect("at most 8 slots");
                let start = window.opens + abft.slot_duration() * slots;
                Some(start + slot_sweep_duration(abft.frames_per_slot()) + MBIFS)
            }
            Contention::Csma | Contention::Abft(_) => None,
        }
    }

    /// In the window for answers: sends the feedback that is due now, ends the window, or waits for what comes first.
    pub(super) fn watch(
        &mut self,
        sweep: Sweep,
        window: FeedbackWindow,
        now: SimTime,
        radio: &mut impl Radio,
    ) -> Option<InitiatorReport> {
        self.state = State::Gathering(sweep, window);
        self.answers.forget_before(now);
        let check = self.check(window, now);
        match self.answers.next_due() {
            Some(due) if due == now => {
                self.alarm.clear(radio);
                let answer = self.answers.take_next();
                self.answer(answer, radio);
                self.state = State::Informing(sweep, window, answer.responder);
                None
            }
            Some(due) => {
                self.alarm.set(now, due, Event::TransmitReady, radio);
                None
            }
            None if check <= now => {
                self.alarm.clear(radio);
                Some(self.end(sweep, InitiatorOutcome::Over))
            }
            None => {
                self.alarm.set(now, check, Event::WaitExpired, radio);
                None
            }
        }
    }

    /// Starts the feedback to an answer; it asks for a report of all sectors if the settings say so.
    fn answer(&self, answer: Answer, radio: &mut impl Radio) {
        let asks = self.settings.reports_all_sectors();
        let refinement = if asks { BeamRefinement::of_all_sectors() } else { BeamRefinement::default() };
        let taken = self.settings.taken_after_feedback(self.layout.total());
        self.inform(answer, duration_field(taken), refinement, radio);
    }

    /// The feedback to a station was sent: awaits its report if it was asked for one. Meanwhile the medium is its own: other
    /// feedback that is due is not sent, even if the report does not come.
    pub(super) fn expect_report(
        &mut self,
        sweep: Sweep,
        window: FeedbackWindow,
        responder: MacAddress,
        now: SimTime,
        radio: &mut impl Radio,
    ) -> Option<InitiatorReport> {
        if !self.settings.reports_all_sectors() {
            return self.watch(sweep, window, now, radio);
        }
        let until = now + self.settings.taken_after_feedback(self.layout.total()) + AIR_PROPAGATION * 2;
        self.alarm.set(now, until, Event::WaitExpired, radio);
        self.state = State::AwaitingReport(Sweep { asked: sweep.asked + 1, ..sweep }, window, responder);
        None
    }

    /// When to look whether the window is over. Without feedback it is over once no station can still be contending: the
    /// channel was idle for AIFS and the largest backoff, the time to notice a signal, and a sweep whose frames point
    /// elsewhere but for the last. A station that gets no feedback contends again with a larger backoff, so then only the
    /// end of the window counts.
    fn check(&self, window: FeedbackWindow, now: SimTime) -> SimTime {
        if self.settings.contention() != Contention::Csma {
            return window.closes;
        }
        let category = self.settings.access_category();
        let idle = category.aifs() + SLOT * category.cw_min() + CCA_DETECTION + self.settings.longest_answer();
        let since = if self.carrier.is_busy() { now } else { self.carrier.free_from().max(window.opens) };
        window.closes.min(since + idle)
    }
}
