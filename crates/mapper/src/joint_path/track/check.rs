//! Whether receivers are where they are said to be, and whether ranges are metres.

use sextant_channel::Position;
use sextant_kernel::{Interrupted, Watch};

use super::epochs::Epochs;
use super::moments::{Moments, log_density};
use super::problem::{TrackPoint, TrackProblem};
use super::reading::{TagReading, TagValue};
use super::report::{DoubtedReceiver, RangeFault, Track, TrackRangeLaw};
use super::{TrackSettings, tracked_as_given};
use crate::error::MapError;
use crate::numerics::median;
use crate::range_ml::{RangeUnit, UNITS};

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
    /// Why ranges do not fit: another unit, or receivers in each other's place. Each is first tried at some moments that are placed for
    /// themselves, and only the best ones with a whole track.
    ///
    /// # Errors
    /// If `watch` ends the work.
    pub(super) fn fault(&self) -> Result<Option<RangeFault>, MapError> {
        let Some(law) = self.found.fit.of_ranges else { return Ok(None) };
        let Some(moments) = Moments::of(&Epochs::of(self.readings), self.receivers, self.found.fit.height_m) else {
            return Ok(None);
        };
        let has_large_errors = has_large_errors(&law, self.usual_m());
        let is_odd = !self.found.fit.settled || has_large_errors || law.scale.abs() > LARGEST_SCALE;
        if is_odd && let Some(unit) = self.other_unit(&law, &moments)? {
            return Ok(Some(RangeFault::Unit(unit)));
        }
        let pairs = self.exchanged(&law, &moments)?;
        if !pairs.is_empty() {
            return Ok(Some(RangeFault::Exchanged(pairs)));
        }
        let is_unexplained = has_large_errors && self.found.doubted.is_empty();
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
        let Ok(tried) = tracked_as_given(receivers, readings, self.settings, self.watch) else {
            self.watch.check()?;
            return Ok(None);
        };
        Ok(tried.fit.of_ranges.filter(|law| law.scale.abs() < LARGEST_SCALE))
    }

    /// The unit in which the ranges fit clearly better than as metres.
    fn other_unit(&self, law: &TrackRangeLaw, moments: &Moments) -> Result<Option<RangeUnit>, Interrupted> {
        let of = |unit: &RangeUnit| {
            log_density(&moments.errors_in_m(self.receivers, unit.of_metre)) - libm::log(unit.of_metre)
        };
        let tried: Vec<(f64, RangeUnit)> = UNITS.into_iter().map(|unit| (of(&unit), unit)).collect();
        let (as_metres, _) = tried[0];
        let best = tried.into_iter().skip(1).max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, unit)) = best.filter(|&(best, _)| best > as_metres + WORTH_A_TRIAL) else { return Ok(None) };
        let scaled: Vec<TagReading> = self.readings.iter().map(|reading| in_metres(reading, unit)).collect();
        let of_unit = self.tried(self.receivers, &scaled)?;
        let is_clear =
            |of_unit: TrackRangeLaw| of_unit.log_density - libm::log(unit.of_metre) > law.log_density + CLEAR;
        Ok(of_unit.is_some_and(is_clear).then_some(unit))
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

fn in_metres(reading: &TagReading, unit: RangeUnit) -> TagReading {
    let value = match reading.value {
        TagValue::Range(range) => TagValue::Range(range / unit.of_metre),
        strength @ TagValue::Strength(_) => strength,
    };
    TagReading { value, ..*reading }
}
