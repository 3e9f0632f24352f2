//! One radio that listens: the signals at its antenna, the signal that it follows, and the outcome.
//!
//! Rules of the receiver: a signal above the sensitivity that starts while the radio is free is tracked. At the end of
//! its preamble, if the radio is still free and the ratio of signal to interference and noise is above the lock
//! threshold, the radio locks on to the signal until its end. All other signals are interference. Interference is constant between changes,
//! so the receiver updates its state only at changes.
//!
//! `lr-wpan` of ns-3 3.44 locks at the first symbol instead, so a stronger frame that begins within the preamble of a
//! weaker one is lost there and received here: 0.02 to 0.26 % more frames, by load and range (frames replayed in both at
//! the same instants). Without such pairs both receive the same frames.

use std::collections::VecDeque;

use sextant_channel::Milliwatts;
use sextant_kernel::SimTime;

use super::incoming::{Incoming, Span, is_strong};
use super::{ReceptionModel, ReceptionRules};
use crate::service::outcome::{Deafness, FrameOutcome};

/// One radio that listens, or why it does not.
#[derive(Clone, Debug)]
pub(crate) struct Receiver {
    listening: bool,
    /// Why it does not listen, or did not when it last was deaf.
    deafness: Deafness,
    /// Whether the channel was busy when the radio last said so.
    is_busy: bool,
    /// When it last ended to send.
    sent_until: SimTime,
    /// When the signals were last brought up to date.
    settled: SimTime,
    /// All signals at the antenna.
    present: VecDeque<Present>,
    /// The sum of their powers, in their order; `None` if one has ended since it was last asked for.
    total: Option<Milliwatts>,
    /// Those of them that are above the sensitivity, or were missed: no others can be received.
    signals: VecDeque<Incoming>,
    /// Number of signals that alone make the channel busy.
    strong: u32,
    /// Number of signals that are tracked; only the one that the radio is locked on to, if there is one.
    tracked: u32,
    /// The place of the signal that the radio is locked on to.
    locked: Option<usize>,
}

/// A signal at the antenna.
#[derive(Clone, Copy, Debug)]
struct Present {
    packet: u64,
    power: Milliwatts,
}

impl Default for Receiver {
    /// A receiver that is off.
    fn default() -> Self {
        Self {
            listening: false,
            deafness: Deafness::Off,
            is_busy: false,
            sent_until: SimTime::ZERO,
            settled: SimTime::ZERO,
            present: VecDeque::new(),
            total: Some(Milliwatts::ZERO),
            signals: VecDeque::new(),
            strong: 0,
            tracked: 0,
            locked: None,
        }
    }
}

/// A frame at the end of its time at a receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EndedSignal {
    pub(crate) power: Milliwatts,
    /// Smallest ratio of signal to interference and noise while it was followed, as a factor.
    pub(crate) sinr: f64,
    pub(crate) outcome: FrameOutcome,
    /// Whether the radio was locked on to it; with the model `overlap`, whether nothing has disturbed it.
    pub(crate) was_followed: bool,
}

impl Receiver {
    /// Whether the radio listens.
    #[inline]
    pub(crate) fn is_listening(&self) -> bool {
        self.listening
    }

    /// Starts to listen; signals that are already on air are added with [`Receiver::begin`] as `missed`.
    pub(crate) fn start(&mut self, now: SimTime) {
        self.note_sent(now);
        self.listening = true;
        self.settled = now;
    }

    /// Stops listening, or stays deaf, from now on for this reason; a frame that is being received is lost.
    pub(crate) fn stop(&mut self, now: SimTime, deafness: Deafness) {
        self.note_sent(now);
        self.deafness = deafness;
        self.listening = false;
        self.forget();
    }

    /// Nothing is at the antenna any more.
    pub(super) fn forget(&mut self) {
        self.present.clear();
        self.signals.clear();
        self.total = Some(Milliwatts::ZERO);
        (self.strong, self.tracked, self.locked) = (0, 0, None);
    }

    /// The radio changes its state: if it was sending, it sent until now.
    fn note_sent(&mut self, now: SimTime) {
        if !self.listening && self.deafness == Deafness::Transmitting {
            self.sent_until = now;
        }
    }

    /// Why the receiver missed a signal that began at `start`, which it did not hear to its end.
    pub(crate) fn deafness_since(&self, start: SimTime) -> Deafness {
        if self.sent_until > start { Deafness::Transmitting } else { self.deafness }
    }

    /// A signal of `power` is at the antenna from `now` on; `missed` if the receiver was deaf at its start.
    pub(crate) fn begin(
        &mut self,
        now: SimTime,
        packet: u64,
        power: Milliwatts,
        missed: Option<Deafness>,
        rules: &ReceptionRules,
    ) {
        self.settle(now, rules);
        let audible = power >= rules.sensitivity;
        let disturbed = match rules.model {
            ReceptionModel::Overlap => {
                let mut disturbed = false;
                for other in &mut self.signals {
                    let mutual = audible && other.power >= rules.sensitivity;
                    other.disturbed |= mutual;
                    disturbed |= mutual;
                }
                disturbed
            }
            ReceptionModel::SinrThreshold { .. } | ReceptionModel::SirThreshold { .. } | ReceptionModel::Ber => {
                // Those before the last one have been disturbed by it.
                if let Some(last) = self.signals.back_mut() {
                    last.disturbed = true;
                }
                !self.present.is_empty()
            }
        };
        self.present.push_back(Present { packet, power });
        self.total = self.total.map(|total| total + power);
        self.strong += u32::from(is_strong(power, rules));
        if missed.is_none() && !audible {
            return;
        }
        let tracked = missed.is_none() && self.locked.is_none();
        self.tracked += u32::from(tracked);
        self.signals.push_back(Incoming {
            packet,
            power,
            preamble_end: now + rules.preamble,
            tracked,
            missed,
            disturbed,
            least_sinr: f64::INFINITY,
            least_sir: f64::INFINITY,
            log_intact: 0.0,
        });
    }

    /// Whether the channel became busy (`true`) or idle (`false`) since the radio last said so.
    pub(crate) fn carrier_change(&mut self, rules: &ReceptionRules) -> Option<bool> {
        let energy = rules.carrier?.energy;
        let is_busy = self.listening && (self.strong > 0 || self.total() >= energy);
        (std::mem::replace(&mut self.is_busy, is_busy) != is_busy).then_some(is_busy)
    }

    /// The signal of `packet` ends at `now`: returns how it was heard, or `None` if it was never at the antenna while
    /// the radio listened. `luck` is uniform in (0, 1).
    pub(crate) fn end(
        &mut self,
        now: SimTime,
        packet: u64,
        rules: &ReceptionRules,
        luck: impl FnOnce() -> f64,
    ) -> Option<EndedSignal> {
        let place = self.present.iter().position(|present| present.packet == packet)?;
        self.settle(now, rules);
        let power = self.remove(place);
        self.strong -= u32::from(is_strong(power, rules));
        let alone = power.ratio(rules.noise);
        let Some((signal, locked)) = self.take(packet) else {
            return Some(EndedSignal { power, sinr: alone, outcome: FrameOutcome::Weak, was_followed: false });
        };
        let drowned = |least: f64| if alone < least { FrameOutcome::Weak } else { FrameOutcome::Collided };
        let fate = if let Some(deafness) = signal.missed {
            FrameOutcome::NotListened(deafness)
        } else if signal.power < rules.sensitivity {
            FrameOutcome::Weak
        } else {
            match rules.model {
                ReceptionModel::Overlap if signal.disturbed => FrameOutcome::Collided,
                ReceptionModel::Overlap => FrameOutcome::Received,
                ReceptionModel::SinrThreshold { least } if locked && signal.least_sinr >= least => {
                    FrameOutcome::Received
                }
                ReceptionModel::SinrThreshold { least } => drowned(least),
                ReceptionModel::SirThreshold { least } if locked && signal.least_sir >= least => {
                    FrameOutcome::Received
                }
                ReceptionModel::SirThreshold { .. } if signal.disturbed => FrameOutcome::Collided,
                ReceptionModel::SirThreshold { .. } => FrameOutcome::Weak,
                ReceptionModel::Ber if locked && luck() < libm::exp(signal.log_intact) => FrameOutcome::Received,
                ReceptionModel::Ber if signal.disturbed => FrameOutcome::Collided,
                ReceptionModel::Ber => FrameOutcome::Weak,
            }
        };
        let was_followed = match rules.model {
            ReceptionModel::Overlap => signal.tracked && !signal.disturbed,
            ReceptionModel::SinrThreshold { .. } | ReceptionModel::SirThreshold { .. } | ReceptionModel::Ber => {
                locked
            }
        };
        Some(EndedSignal { power, sinr: signal.least_sinr.min(alone), outcome: fate, was_followed })
    }

    /// Whether the radio is locked on to the signal of `packet`. With the model `overlap`, whether nothing has disturbed that
    /// so far.
    pub(crate) fn follows(&mut self, now: SimTime, packet: u64, rules: &ReceptionRules) -> bool {
        self.settle(now, rules);
        match rules.model {
            ReceptionModel::Overlap => {
                let mut signals = self.signals.iter();
                signals.any(|signal| signal.packet == packet && signal.tracked && !signal.disturbed)
            }
            ReceptionModel::SinrThreshold { .. } | ReceptionModel::SirThreshold { .. } | ReceptionModel::Ber => {
                self.locked.is_some_and(|locked| self.signals[locked].packet == packet)
            }
        }
    }

    /// Until when the radio follows what is at its antenna now: the end of the signal that it is locked on to, or the end of
    /// the last preamble that it tracks. `None` if it follows nothing. With the model `overlap`, the last end of all signals that
    /// it tracks. `end_of` is the end of the signal of a packet that
    /// matters.
    pub(crate) fn followed_until(
        &mut self,
        now: SimTime,
        rules: &ReceptionRules,
        end_of: impl Fn(u64) -> Option<SimTime>,
    ) -> Option<SimTime> {
        self.settle(now, rules);
        if let Some(locked) = self.locked {
            return end_of(self.signals[locked].packet);
        }
        let tracked = self.signals.iter().filter(|signal| signal.tracked);
        match rules.model {
            ReceptionModel::Overlap => tracked.filter_map(|signal| end_of(signal.packet)).max(),
            ReceptionModel::SinrThreshold { .. } | ReceptionModel::SirThreshold { .. } | ReceptionModel::Ber => {
                tracked.filter(|signal| end_of(signal.packet).is_some()).map(|signal| signal.preamble_end).max()
            }
        }
    }

    /// Removes the signal in a place from the antenna; returns its power.
    #[inline]
    fn remove(&mut self, place: usize) -> Milliwatts {
        let removed = self.present.remove(place).expect("a place among those at the antenna");
        self.total = self.present.is_empty().then_some(Milliwatts::ZERO);
        removed.power
    }

    /// The sum of the powers of all signals at the antenna, in their order.
    #[inline]
    fn total(&mut self) -> Milliwatts {
        let present = &self.present;
        *self.total.get_or_insert_with(|| present.iter().map(|present| present.power).sum())
    }

    /// Takes the signal of a packet out of those that can be received, if it is there; also returns whether the radio was
    /// locked on to it.
    #[inline]
    fn take(&mut self, packet: u64) -> Option<(Incoming, bool)> {
        let place = self.signals.iter().position(|signal| signal.packet == packet)?;
        let signal = self.signals.remove(place)?;
        self.tracked -= u32::from(signal.tracked);
        let is_locked = self.locked == Some(place);
        self.locked = match self.locked {
            Some(locked) if locked > place => Some(locked - 1),
            Some(locked) if locked < place => Some(locked),
            Some(_) | None => None,
        };
        Some((signal, is_locked))
    }

    /// Updates all tracked signals until `now`, with the signals present until now.
    #[inline(always)]
    fn settle(&mut self, now: SimTime, rules: &ReceptionRules) {
        let since = std::mem::replace(&mut self.settled, now);
        if self.tracked == 0 || now == since || matches!(rules.model, ReceptionModel::Overlap) {
            return;
        }
        let total = self.total();
        self.follow(&Span { since, now, total }, rules);
    }

    /// Updates all tracked signals after a time during which nothing has changed.
    #[inline(never)]
    fn follow(&mut self, span: &Span, rules: &ReceptionRules) {
        match self.locked {
            Some(locked) => self.signals[locked].suffer(span, rules),
            None => self.settle_free(span, rules),
        }
    }

    /// The same as long as the radio is free: it may lock on to a signal.
    fn settle_free(&mut self, span: &Span, rules: &ReceptionRules) {
        for (place, signal) in self.signals.iter_mut().enumerate() {
            if signal.tracked && signal.preamble_end <= span.now {
                if span.sinr(signal.power, rules) > rules.lock {
                    self.locked = Some(place);
                    break;
                }
                signal.tracked = false;
                self.tracked -= 1;
            }
        }
        if let Some(locked) = self.locked {
            self.signals.iter_mut().for_each(|signal| signal.tracked = false);
            self.signals[locked].tracked = true;
            self.tracked = 1;
        }
        self.signals.iter_mut().filter(|signal| signal.tracked).for_each(|signal| signal.suffer(span, rules));
    }
}

#[cfg(test)]
mod tests;
