//! The feedback to an answer: how long a responder waits for it, what it does with it, and what if none comes.

use sextant_kernel::SimTime;

use super::{Answering, Responder, ResponderOutcome, ResponderReport, State, choice};
use crate::dmg::address::MacAddress;
use crate::dmg::frame::{BeamRefinement, SectorFeedback, SweepBody, SweepFrame};
use crate::dmg::port::{Event, Radio};
use crate::dmg::settings::Contention;
use crate::dmg::timing::{AIR_PROPAGATION, MAX_SLS_RETRIES, MBIFS, SSW_ACK_TIMEOUT, SSW_FEEDBACK_AIRTIME};

impl Responder {
    /// The sweep was sent.
    pub(super) fn await_feedback(
        &mut self,
        answering: Answering,
        now: SimTime,
        radio: &mut impl Radio,
    ) -> Option<ResponderReport> {
        let feedback = MBIFS + SSW_FEEDBACK_AIRTIME + AIR_PROPAGATION * 2;
        let is_last = self.end_of_turn(answering) == self.layout.total();
        let until = match self.settings.contention() {
            // The initiator repeats its feedback until it is acknowledged.
            _ if answering.heard.is_unicast => {
                now + feedback + (SSW_ACK_TIMEOUT + SSW_FEEDBACK_AIRTIME) * u32::from(MAX_SLS_RETRIES)
            }
            // It may go to another station whose sweep overlapped, and that one may report.
            Contention::CsmaFeedback { .. } => {
                now + feedback + self.settings.taken_after_feedback(answering.heard.total_sectors)
            }
            Contention::Abft(abft) if abft.has_feedback() => answering.start + abft.slot_duration(),
            Contention::Abft(abft) if !is_last => return self.wait_for_slot(answering, abft, now, radio),
            Contention::Csma | Contention::Abft(_) => return Some(self.end(answering, ResponderOutcome::Sent)),
        };
        let event = if is_last { Event::WaitExpired } else { Event::TransmitReady };
        self.alarm.set(now, until, event, radio);
        self.state = State::AwaitingFeedback(answering);
        None
    }

    /// A choice of a sector of this station.
    pub(super) fn take(
        &mut self,
        now: SimTime,
        initiator: MacAddress,
        feedback: SectorFeedback,
        refinement: BeamRefinement,
        radio: &mut impl Radio,
    ) -> Option<ResponderReport> {
        let answering = match (self.state, self.acknowledged) {
            (State::AwaitingFeedback(answering), _) if answering.heard.initiator == initiator => answering,
            (State::Listening, Some(heard)) if heard.initiator == initiator => {
                Answering { heard, cw: 0, sweeps: 1, start: now, first: 0, choice: None }
            }
            _ => return None,
        };
        self.alarm.clear(radio);
        if answering.heard.is_unicast {
            self.alarm.set(now, now + MBIFS, Event::TransmitReady, radio);
            self.state = State::TurningToAck(answering, feedback);
            return None;
        }
        self.failed = 0;
        let answering = answering.with_choice(feedback);
        match self.settings.contention() {
            Contention::Abft(abft) if self.end_of_turn(answering) < self.layout.total() => {
                self.wait_for_slot(answering, abft, now, radio)
            }
            _ if refinement.asks_for_all_sectors() && !self.measurements.is_empty() => {
                self.turn_to_report(answering, feedback, now, radio);
                None
            }
            _ => Some(self.end(answering, ResponderOutcome::Trained(answering.choice.unwrap_or(feedback)))),
        }
    }

    pub(super) fn acknowledge(&mut self, answering: Answering, feedback: SectorFeedback, radio: &mut impl Radio) {
        let body = SweepBody::Ack { feedback: choice(answering.heard), refinement: BeamRefinement::default() };
        let frame = SweepFrame { duration_us: 0, to: answering.heard.initiator, from: self.address, body };
        radio.transmit(frame, feedback.select);
        self.state = State::Acknowledging(answering, feedback);
    }

    /// No feedback came in time: contends again, or gives up.
    pub(super) fn miss(
        &mut self,
        answering: Answering,
        now: SimTime,
        radio: &mut impl Radio,
    ) -> Option<ResponderReport> {
        match self.settings.contention() {
            Contention::CsmaFeedback { max_retries, .. }
                if !answering.heard.is_unicast && answering.sweeps <= max_retries =>
            {
                let cw = self.settings.access_category().widened(answering.cw);
                self.contend(Answering { cw, ..answering }, now, now, radio);
                return self.pursue(now, radio);
            }
            Contention::Abft(_) if !answering.heard.is_unicast && answering.choice.is_none() => self.fail(radio),
            _ => {}
        }
        let outcome = answering.choice.map_or(ResponderOutcome::NoFeedback, ResponderOutcome::Trained);
        Some(self.end(answering, outcome))
    }
}
