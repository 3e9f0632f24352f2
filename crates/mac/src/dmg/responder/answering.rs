//! An answer under way, and the slots of an A-BFT that it takes.
//!
//! A slot holds so many SSW frames (FSS). A responder with more sectors goes on at the start of the next slot, and if the
//! A-BFT ends before, in a later one of the same initiator (IEEE 802.11ad-2012, 9.35.5). It listens at the end of each
//! slot: the initiator gives feedback on the frames of that slot, and the best of them counts.

use sextant_kernel::SimTime;

use super::{HeardSweep, RSS_BACKOFF, RSS_RETRY_LIMIT, Responder, ResponderOutcome, ResponderReport, State};
use crate::dmg::frame::SectorFeedback;
use crate::dmg::port::{Event, Radio};
use crate::dmg::settings::{Abft, Contention};
use crate::dmg::timing::MBIFS;

/// An answer under way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Answering {
    pub(super) heard: HeardSweep,
    /// Contention window.
    pub(super) cw: u32,
    pub(super) sweeps: u8,
    /// Start of the sweep for one station, or of the slot of the A-BFT.
    pub(super) start: SimTime,
    /// The first frame of the slot of the A-BFT.
    pub(super) first: u16,
    /// The best choice of a sector of this station so far, of slots before the last one.
    pub(super) choice: Option<SectorFeedback>,
}

impl Answering {
    /// The same with a further choice: the one with the higher SNR stays.
    pub(super) fn with_choice(self, choice: SectorFeedback) -> Self {
        let best = self.choice.filter(|known| known.snr >= choice.snr).unwrap_or(choice);
        Self { choice: Some(best), ..self }
    }
}

impl Responder {
    /// The frame after the last one that is sent without a pause for the next slot.
    pub(super) fn end_of_turn(&self, answering: Answering) -> u16 {
        let total = self.layout.total();
        match self.settings.contention() {
            Contention::Abft(abft) if !answering.heard.is_unicast => {
                total.min(answering.first + u16::from(abft.frames_per_slot()))
            }
            _ => total,
        }
    }

    /// Waits for the end of a slot, after which the sweep goes on.
    pub(super) fn wait_for_slot(
        &mut self,
        answering: Answering,
        abft: Abft,
        now: SimTime,
        radio: &mut impl Radio,
    ) -> Option<ResponderReport> {
        self.alarm.set(now, answering.start + abft.slot_duration(), Event::TransmitReady, radio);
        self.state = State::BetweenSlots(answering);
        None
    }

    /// A slot is over, and there are more sectors: goes on in the next one, or in a later A-BFT if it was the last.
    pub(super) fn next_slot(&mut self, answering: Answering, radio: &mut impl Radio) -> Option<ResponderReport> {
        let Contention::Abft(abft) = self.settings.contention() else { unreachable!("only an A-BFT has slots") };
        let first = self.end_of_turn(answering);
        let start = answering.start + abft.slot_duration();
        if start + abft.slot_duration() <= answering.heard.end + MBIFS + abft.duration() {
            self.send(Answering { start, first, ..answering }, first, radio);
            return None;
        }
        self.unfinished = Some((answering.heard.initiator, first));
        let outcome = match answering.choice {
            Some(choice) => ResponderOutcome::Trained(choice),
            None if abft.has_feedback() => {
                self.fail(radio);
                ResponderOutcome::NoFeedback
            }
            None => ResponderOutcome::Sent,
        };
        Some(self.end(answering, outcome))
    }

    /// An A-BFT has passed without feedback: after too many of these, some pass without an answer.
    pub(super) fn fail(&mut self, radio: &mut impl Radio) {
        self.failed += 1;
        if self.failed > RSS_RETRY_LIMIT {
            self.failed = 0;
            self.skip = radio.slots(RSS_BACKOFF - 1);
        }
    }
}
