//! The window for the answers of many stations: when it ends, and when feedback is due in it.

use sextant_kernel::SimTime;

use super::{Initiator, InitiatorOutcome, InitiatorReport, State, Sweep};
use crate::dmg::port::{Event, Radio};
use crate::dmg::settings::Contention;
use crate::dmg::timing::{CCA_DETECTION, MBIFS, SLOT, slot_sweep_duration, sweep_end};

/// The time for answers of many stations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Window {
    pub(super) opens: SimTime,
    pub(super) closes: SimTime,
}

impl Initiator {
    /// When feedback to the sweep of a responder is due, of which a frame was decoded now; `None` without feedback.
    pub(super) fn feedback_due(&self, now: SimTime, window: Window, cdown: u16, duration_us: u16) -> Option<SimTime> {
        match self.settings.contention() {
            Contention::CsmaFeedback { .. } => {
                Some(sweep_end(now, cdown, duration_us, self.settings.taken_after_answer()) + MBIFS)
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
        window: Window,
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
                self.inform(answer, 0, radio);
                self.state = State::Informing(sweep, window);
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

    /// When to look whether the window is over. Without feedback it is over once no station can still be contending: the
    /// channel was idle for AIFS and the largest backoff, the time to notice a signal, and a sweep whose frames point
    /// elsewhere but for the last. A station that gets no
    /// feedback contends again with a larger backoff, so then only the end of the window counts.
    fn check(&self, window: Window, now: SimTime) -> SimTime {
        if self.settings.contention() != Contention::Csma {
            return window.closes;
        }
        let category = self.settings.access_category();
        let idle = category.aifs() + SLOT * category.cw_min() + CCA_DETECTION + self.settings.longest_answer();
        let since = if self.carrier.is_busy() { now } else { self.carrier.free_from().max(window.opens) };
        window.closes.min(since + idle)
    }
}
