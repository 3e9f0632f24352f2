//! Whether receivers are where they are said to be, and whether ranges are metres.

use sextant_channel::Position;
use sextant_kernel::Watch;

use super::problem::{TrackPoint, TrackProblem};
use super::reading::{TagReading, TagValue};
use super::report::{DoubtedReceiver, Track, TrackRangeLaw};
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
/// Another unit is told if the ranges are more probable in it by so much each (nats).
const CLEAR: f64 = 0.5;

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

/// The unit in which the ranges of an odd track fit clearly better than as metres.
pub(super) fn other_unit(
    found: &Track,
    receivers: &[Position],
    readings: &[TagReading],
    settings: TrackSettings,
    watch: &dyn Watch,
) -> Result<Option<RangeUnit>, MapError> {
    let Some(law) = found.fit.of_ranges else { return Ok(None) };
    let ranges = readings.iter().filter_map(|reading| match reading.value {
        TagValue::Range(range_m) => Some(range_m.abs()),
        TagValue::Strength(_) => None,
    });
    let usual_m = median(&mut ranges.collect::<Vec<_>>());
    if found.fit.settled && !is_odd(&law, usual_m) {
        return Ok(None);
    }
    let mut best: Option<(f64, RangeUnit)> = None;
    for unit in UNITS.into_iter().skip(1) {
        let scaled: Vec<TagReading> = readings.iter().map(|reading| in_metres(reading, unit)).collect();
        let Ok(tried) = tracked_as_given(receivers, &scaled, settings, watch) else {
            watch.check()?;
            continue;
        };
        let Some(of_unit) = tried.fit.of_ranges.filter(|law| law.scale.abs() < LARGEST_SCALE) else { continue };
        let log_density = of_unit.log_density - libm::log(unit.of_metre);
        if log_density > law.log_density + CLEAR && best.is_none_or(|(best, _)| log_density > best) {
            best = Some((log_density, unit));
        }
    }
    Ok(best.map(|(_, unit)| unit))
}

fn is_odd(law: &TrackRangeLaw, usual_m: f64) -> bool {
    let shares = law.errors.shares();
    let spread_m = law.errors.noise_m() + shares.late * law.errors.excess_m();
    law.scale.abs() > LARGEST_SCALE || shares.wild > WILD || spread_m > LARGE * usual_m
}

fn in_metres(reading: &TagReading, unit: RangeUnit) -> TagReading {
    let value = match reading.value {
        TagValue::Range(range) => TagValue::Range(range / unit.of_metre),
        strength @ TagValue::Strength(_) => strength,
    };
    TagReading { value, ..*reading }
}
