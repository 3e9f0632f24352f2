//! What an initiator heard in answer to a sweep.

use sextant_channel::Db;
use sextant_kernel::SimTime;

use crate::dmg::{MacAddress, SectorFeedback, SnrReport, TxSector};

/// The answer of a station: of its frames, the one that was heard best; of equals, the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// The station.
    pub responder: MacAddress,
    /// The sector of the initiator that it heard best.
    pub select: TxSector,
    /// SNR at which it heard that sector.
    pub select_snr: SnrReport,
    /// SINR of its frame at the initiator.
    pub snr: Db,
    /// Its sector from which it sent that frame.
    pub responder_sector: TxSector,
    /// Number of its frames that were decoded.
    pub frames: u16,
}

impl Answer {
    pub(super) const fn new(
        responder: MacAddress,
        responder_sector: TxSector,
        feedback: SectorFeedback,
        snr: Db,
    ) -> Self {
        Self { responder, select: feedback.select, select_snr: feedback.snr, snr, responder_sector, frames: 1 }
    }
}

/// Feedback to be sent.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Promise {
    due: SimTime,
    answer: Answer,
}

/// The best answer of each station, and the feedback that is still to be sent.
#[derive(Clone, Debug, Default)]
pub(super) struct Answers {
    /// In the order of the addresses.
    best: Vec<Answer>,
    promises: Vec<Promise>,
}

impl Answers {
    pub(super) fn best(&self) -> &[Answer] {
        &self.best
    }

    pub(super) fn clear(&mut self) {
        self.best.clear();
        self.promises.clear();
    }

    pub(super) fn hear(&mut self, answer: Answer) {
        match self.best.binary_search_by_key(&answer.responder, |best| best.responder) {
            Ok(index) => {
                let best = &mut self.best[index];
                let frames = best.frames + 1;
                *best = Answer { frames, ..if answer.snr > best.snr { answer } else { *best } };
            }
            Err(index) => self.best.insert(index, answer),
        }
    }

    /// Feedback to `answer` is due. Of two answers for which it is due at one instant, the one heard better gets it: they
    /// share a slot. Better frames of the same sweep replace earlier ones.
    pub(super) fn promise(&mut self, answer: Answer, due: SimTime) {
        match self.promises.iter_mut().find(|promise| promise.due == due) {
            Some(promise) if answer.snr > promise.answer.snr => promise.answer = answer,
            Some(_) => {}
            None => self.promises.push(Promise { due, answer }),
        }
    }

    /// The station was deaf or busy when feedback was due: no longer possible.
    pub(super) fn forget_before(&mut self, now: SimTime) {
        self.promises.retain(|promise| promise.due >= now);
    }

    pub(super) fn next_due(&self) -> Option<SimTime> {
        self.promises.iter().map(|promise| promise.due).min()
    }

    /// Removes the promise that is due first.
    ///
    /// # Panics
    /// If there is none.
    pub(super) fn take_next(&mut self) -> Answer {
        let first = (0..self.promises.len()).min_by_key(|&i| self.promises[i].due).expect("a promise");
        self.promises.swap_remove(first).answer
    }
}
