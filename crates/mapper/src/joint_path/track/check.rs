//! Whether receivers are where they are said to be, and whether ranges are metres.

use sextant_channel::Position;
use sextant_kernel::{Interrupted, Watch};

use super::epochs::Epochs;
use super::moments::{Moments, log_density};
use super::problem::{TrackPoint, TrackProblem};
use super::reading::{TagReading, TagValue};
use super::report::{DoubtedReceiver, PlaceUnit, RangeFault, Track, TrackHeight, TrackRangeLaw};
use super::{Sought, TrackSettings, heights, tracked_as_given};
use crate::error::MapError;
use crate::numerics::median;
use crate::range_ml::UNITS;

/// An offset up to this is a bias of the track (m).
const LEAST_OFFSET_M: f64 = 6.0;
/// Fewer ranges of a receiver say nothing.
const LEAST: usize = 10;
/// A receiver is doubted if its ranges are usually off by so many times as much as those of the others, and by so much (m).
const TIMES: f64 = 4.0;
const NOTABLE_M: f64 = 0.5;
/// A scale beyond this is not one of devices. Ranges are odd if so large a share of them is wild, or if their errors are so large a share
/// of them.
const LARGEST_SCALE: f64 = 0.15;
const WILD: f64 = 0.2;
const LARGE: f64 = 0.2;
/// Another unit, or two receivers in each other's place, are told if the ranges are more probable so by so much each (nats).
const CLEAR: f64 = 0.5;
/// The whole track is tried only if moments by themselves gain so much each (nats), and of pairs of receivers at most so often.
const WORTH_A_TRIAL: f64 = 0.25;
const TRIALS: usize = 4;
/// Pairs are sought among so many receivers whose ranges are off most.
const PAIRED: usize = 20;
/// Two other receivers explain as much as the best pair if the ranges gain so large a share by them.
const ALIKE: f64 = 0.8;
/// A receiver disagrees with the rest if the others are more probable without it by so much each, beyond the usual one (nats).
const DISAGREES: f64 = 0.3;

/// The receivers whose ranges fit the track clearly worse than those of the others.
pub(super) fn doubted(problem: &TrackProblem<'_>, point: &TrackPoint) -> Vec<DoubtedReceiver> {
    let mut errors = vec![Vec::new(); problem.receivers.len()];
    for (receiver, error_m) in problem.errors(point, false) {
        errors[receiver].push(error_m.abs());
    }
    let heard = errors.iter_mut().enumerate().filter(|(_, errors)| errors.len() >= LEAST);
    let off: Vec<(usize, f64)> = heard.map(|(receiver, errors)| (receiver, median(errors))).collect();
    if off.len() < 3 {
        return Vec::new();
    }
    let others_m = median(&mut off.iter().map(|&(_, off_m)| off_m).collect::<Vec<_>>());
    let is_doubted = |&&(_, off_m): &&(usize, f64)| off_m > (TIMES * others_m).max(NOTABLE_M);
    off.iter().filter(is_doubted).map(|&(receiver, off_m)| DoubtedReceiver { receiver, off_m, others_m }).collect()
}

/// A track to be explained, with what it is made of.
pub(super) struct Check<'a> {
    pub(super) found: &'a Track,
    pub(super) receivers: &'a [Position],
    pub(super) readings: &'a [TagReading],
    pub(super) settings: TrackSettings,
    pub(super) watch: &'a dyn Watch,
}

impl Check<'_> {
    /// Why ranges do not fit: another unit, an offset, or receivers in each other's place. Each is first tried at some moments that are
    /// placed for themselves, and only the best ones with a whole track.
    ///
    /// # Errors
    /// If `watch` ends the work.
    pub(super) fn fault(&self) -> Result<Option<RangeFault>, MapError> {
        let Some(law) = self.found.fit.of_ranges else { return Ok(None) };
        let epochs = Epochs::of(self.readings);
        let [usual_height_m, _] = heights::prior_m(self.receivers, self.settings.height_m);
        let Some(moments) = Moments::of(&epochs, self.receivers, usual_height_m) else { return Ok(None) };
        // A track with one height is compared with others that have one.
        let law = match self.found.fit.height {
            TrackHeight::Wandering => {
                let (settings, sought) = (self.settings, Sought::ConstantHeight);
                let constant = tracked_as_given(self.receivers, self.readings, settings, sought, self.watch)?;
                constant.fit.of_ranges.unwrap_or(law)
            }
            _ => law,
        };
        if let Some(fault) = self.other_measure(&law, &moments)? {
            return Ok(Some(fault));
        }
        let Some(moments) = Moments::of(&epochs, self.receivers, self.found.fit.height_m) else { return Ok(None) };
        let pairs = self.exchanged(&law, &moments)?;
        if !pairs.is_empty() {
            return Ok(Some(RangeFault::Exchanged(pairs)));
        }
        let law = self.found.fit.of_ranges.unwrap_or(law);
        let is_unexplained = has_large_errors(&law, self.usual_m()) && self.found.doubted.is_empty();
        Ok(is_unexplained
            .then(|| RangeFault::Unexplained { usually_m: spread_m(&law), receivers: self.disagreeing(&moments) }))
    }

    /// How long ranges usually are, in their unit.
    fn usual_m(&self) -> f64 {
        let ranges = self.readings.iter().filter_map(|reading| match reading.value {
            TagValue::Range(range_m) => Some(range_m.abs()),
            TagValue::Strength(_) => None,
        });
        median(&mut ranges.collect::<Vec<_>>())
    }

    /// The law of the ranges of a track with other receivers or readings, if that is settled and its law is one of devices.
    fn tried(&self, receivers: &[Position], readings: &[TagReading]) -> Result<Option<TrackRangeLaw>, Interrupted> {
        let Ok(tried) = tracked_as_given(receivers, readings, self.settings, Sought::ConstantHeight, self.watch)
        else {
            self.watch.check()?;
            return Ok(None);
        };
        Ok(tried.fit.of_ranges.filter(|law| law.scale.abs() < LARGEST_SCALE))
    }

    /// Another unit of the ranges or of the places, or an offset, with which the ranges fit clearly better.
    fn other_measure(&self, law: &TrackRangeLaw, moments: &Moments) -> Result<Option<RangeFault>, Interrupted> {
        let as_given = log_density(&moments.errors_in_m(self.receivers, 1.0));
        let mut tried = Vec::new();
        for unit in UNITS.into_iter().skip(1) {
            let errors_m = moments.errors_in_m(self.receivers, unit.of_metre);
            tried.push((log_density(&errors_m) - libm::log(unit.of_metre), RangeFault::Unit(unit)));
        }
        for unit in PlaceUnit::OTHERS {
            let errors_m = moments.errors_shrunk_m(self.receivers, unit.of_metre);
            tried.push((log_density(&errors_m), RangeFault::Places(unit)));
        }
        self.watch.check()?;
        let offset_m = moments.offset_m(self.receivers);
        if offset_m.abs() > LEAST_OFFSET_M {
            tried.push((
                log_density(&moments.errors_with_offset_m(self.receivers, offset_m)),
                RangeFault::Offset { offset_m },
            ));
        }
        tried.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut best: Option<(f64, RangeFault)> = None;
        for (_, fault) in tried.into_iter().take_while(|&(of, _)| of > as_given + WORTH_A_TRIAL).take(TRIALS) {
            let gain = self.tried_measure(&fault)?.map_or(0.0, |density| density - law.log_density);
            if gain > CLEAR && best.as_ref().is_none_or(|(best, _)| gain > *best) {
                best = Some((gain, fault));
            }
        }
        Ok(best.map(|(_, fault)| fault))
    }

    /// The mean logarithm of the density of ranges with a measure (per unit of what was measured), if it makes a good track.
    fn tried_measure(&self, fault: &RangeFault) -> Result<Option<f64>, Interrupted> {
        let of_law = |law: Option<TrackRangeLaw>| law.filter(|law| !has_large_errors(law, f64::INFINITY));
        Ok(match fault {
            RangeFault::Unit(unit) => {
                let scaled: Vec<TagReading> =
                    self.readings.iter().map(|reading| with_range(reading, |range| range / unit.of_metre)).collect();
                of_law(self.tried(self.receivers, &scaled)?).map(|law| law.log_density - libm::log(unit.of_metre))
            }
            RangeFault::Places(unit) => {
                let shrunk: Vec<Position> =
                    self.receivers.iter().map(|&place| place * (1.0 / unit.of_metre)).collect();
                of_law(self.tried(&shrunk, self.readings)?).map(|law| law.log_density)
            }
            RangeFault::Offset { offset_m } => {
                let moved: Vec<TagReading> =
                    self.readings.iter().map(|reading| with_range(reading, |range| range - offset_m)).collect();
                of_law(self.tried(self.receivers, &moved)?).map(|law| law.log_density)
            }
            RangeFault::Exchanged(_) | RangeFault::Unexplained { .. } => None,
        })
    }

    /// Pairs of receivers which, each in the other's place, explain the ranges clearly better: the best one, and those that explain
    /// about as much. In a room with four receivers in its corners, those of two opposite walls do.
    fn exchanged(&self, law: &TrackRangeLaw, moments: &Moments) -> Result<Vec<[usize; 2]>, Interrupted> {
        let given_m = moments.errors_m(self.receivers);
        let off_m = |receiver: usize| moments.usually_off_m(receiver, &given_m);
        let mut heard: Vec<(f64, usize)> = self.heard().into_iter().map(|one| (off_m(one), one)).collect();
        heard.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut heard: Vec<usize> = heard.into_iter().take(PAIRED).map(|(_, receiver)| receiver).collect();
        heard.sort_unstable();
        let given = log_density(&given_m);
        let mut gains = Vec::new();
        for (at, &one) in heard.iter().enumerate() {
            self.watch.check()?;
            for &other in &heard[at + 1..] {
                let errors_m = moments.changed_errors_m(&self.with_exchanged([one, other]), [one, other], &given_m);
                gains.push((log_density(&errors_m) - given, [one, other]));
            }
        }
        gains.sort_by(|a, b| b.0.total_cmp(&a.0));
        let best = gains.first().map_or(0.0, |&(best, _)| best);
        let is_worth = |&(gain, _): &(f64, [usize; 2])| gain > WORTH_A_TRIAL.max(0.5 * best);
        let mut clear = Vec::new();
        for (_, pair) in gains.into_iter().take_while(is_worth).take(TRIALS) {
            let of_pair = self.tried(&self.with_exchanged(pair), self.readings)?;
            let of_pair = of_pair.filter(|of_pair| !has_large_errors(of_pair, self.usual_m()));
            let gain = of_pair.map_or(0.0, |of_pair| of_pair.log_density - law.log_density);
            clear.extend((gain > CLEAR).then_some((gain, pair)));
        }
        clear.sort_by(|a, b| b.0.total_cmp(&a.0));
        let best = clear.first().map_or(0.0, |&(best, _)| best);
        Ok(clear.into_iter().take_while(|(gain, _)| *gain >= ALIKE * best).map(|(_, pair)| pair).collect())
    }

    /// The receivers with enough ranges.
    fn heard(&self) -> Vec<usize> {
        let mut ranges = vec![0; self.receivers.len()];
        for reading in self.readings.iter().filter(|reading| matches!(reading.value, TagValue::Range(_))) {
            ranges[reading.receiver] += 1;
        }
        (0..ranges.len()).filter(|&receiver| ranges[receiver] >= LEAST).collect()
    }

    /// The receivers with two of them in each other's place.
    fn with_exchanged(&self, [one, other]: [usize; 2]) -> Vec<Position> {
        let mut receivers = self.receivers.to_vec();
        receivers.swap(one, other);
        receivers
    }

    /// The receivers without which the ranges of the others agree much better, most first.
    fn disagreeing(&self, moments: &Moments) -> Vec<usize> {
        let without = (self.heard().into_iter())
            .map(|receiver| (log_density(&moments.errors_without_m(self.receivers, receiver)), receiver))
            .filter(|(density, _)| density.is_finite());
        let mut without: Vec<(f64, usize)> = without.collect();
        if without.len() < 4 {
            return Vec::new();
        }
        let usual = median(&mut without.iter().map(|&(density, _)| density).collect::<Vec<_>>());
        without.sort_by(|a, b| b.0.total_cmp(&a.0));
        let disagrees = |&(density, _): &(f64, usize)| density > usual + DISAGREES;
        without.into_iter().take_while(disagrees).map(|(_, receiver)| receiver).collect()
    }
}

/// How large the errors of ranges usually are (m).
fn spread_m(law: &TrackRangeLaw) -> f64 {
    law.errors.noise_m() + law.errors.shares().late * law.errors.excess_m()
}

fn has_large_errors(law: &TrackRangeLaw, usual_m: f64) -> bool {
    law.errors.shares().wild > WILD || spread_m(law) > LARGE * usual_m
}

fn with_range(reading: &TagReading, changed: impl Fn(f64) -> f64) -> TagReading {
    let value = match reading.value {
        TagValue::Range(range_m) => TagValue::Range(changed(range_m)),
        strength @ TagValue::Strength(_) => strength,
    };
    TagReading { value, ..*reading }
}
