//! A contention for the channel that is certain to find it busy, several times in a row.

use super::port::Attempt;
use super::{Csma, Receiver, State};
use crate::RadioState;

/// Backoffs and assessments of a frame, one after the other, as far as its station can know them in advance: what
/// [`Csma::handle`] does with [`BackoffExpired`](super::Event::BackoffExpired) and busy channels, without the radio.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contention {
    /// Busy assessments of this channel access.
    busy: u8,
    exponent: u8,
    /// Assessments of the frame.
    ccas: u32,
    max_be: u8,
    max_backoffs: u8,
}

impl Contention {
    /// The assessment after the backoff finds the channel busy, and the frame is not given up: the greatest number of periods of
    /// the next backoff.
    #[inline]
    pub fn defer(&mut self) -> u32 {
        debug_assert!(!self.is_last(), "the frame is given up");
        self.busy += 1;
        self.ccas += 1;
        self.exponent = (self.exponent + 1).min(self.max_be);
        (1 << self.exponent) - 1
    }

    /// Whether the next assessment ends the frame if it finds the channel busy.
    #[must_use]
    #[inline]
    pub const fn is_last(&self) -> bool {
        self.busy >= self.max_backoffs
    }
}

impl Csma {
    /// The contention under way, if the radio assesses the channel at once when the backoff is over.
    #[must_use]
    #[inline]
    pub const fn contention(&self) -> Option<Contention> {
        match self.state {
            State::BackingOff(Receiver::AtRest) if !self.settings.has_idle_turnarounds() => Some(Contention {
                busy: self.attempt.busy,
                exponent: self.attempt.exponent,
                ccas: self.attempt.ccas,
                max_be: self.settings.max_be(),
                max_backoffs: self.settings.max_backoffs(),
            }),
            _ => None,
        }
    }

    /// The backoff of a contention that [`Csma::contention`] began is over: the assessment is under way, and the radio is in
    /// [`RadioState::Receive`].
    #[inline]
    pub const fn assess(&mut self, contention: Contention) -> RadioState {
        let Contention { busy, exponent, ccas, .. } = contention;
        self.attempt = Attempt { busy, exponent, ccas: ccas + 1, ..self.attempt };
        self.state = State::Sensing;
        RadioState::Receive
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_contention_ends_after_as_many_busy_assessments_as_are_allowed() {
        let mut contention = Contention { busy: 0, exponent: 3, ccas: 0, max_be: 5, max_backoffs: 4 };
        let mut longest = Vec::new();
        while !contention.is_last() {
            longest.push(contention.defer());
        }
        assert_eq!(longest, [15, 31, 31, 31]);
        assert_eq!((contention.busy, contention.ccas), (4, 4));
    }
}
