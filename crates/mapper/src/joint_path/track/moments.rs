//! Some moments of a track, each placed for itself: a cheap measure of how well ranges agree.

use sextant_channel::Position;

use super::epochs::Epochs;
use super::start::{best_place, flat_range};
use crate::comparators::lateration::Range;
use crate::numerics::median;
use crate::range_ml::error_law;

/// So many moments are enough, and fewer than that say nothing.
const MOST: usize = 40;
const LEAST: usize = 8;
/// Offsets are tried in so many steps, and again as many about the best one.
const STEPS: u32 = 20;

/// Moments with ranges to three receivers or more.
#[derive(Clone, Debug)]
pub(super) struct Moments {
    /// Of each moment, receivers and ranges to them.
    of: Vec<Vec<(usize, f64)>>,
    height_m: f64,
    /// By how much ranges are too long, as metres (m).
    bias_m: f64,
}

/// How ranges become metres.
#[derive(Clone, Copy)]
struct Measure {
    /// A metre in their unit.
    of_metre: f64,
    bias_m: f64,
}

impl Moments {
    /// Moments spread over a track, of a tag at this height (m). `None` if there are too few.
    pub(super) fn of(epochs: &Epochs, receivers: &[Position], height_m: f64) -> Option<Self> {
        let ranged = |(_, near): (f64, &[_])| {
            let by_receiver = Epochs::by_receiver(near, receivers.len(), false);
            let all = by_receiver.into_iter().enumerate().filter(|(_, ranges)| !ranges.is_empty());
            all.map(|(receiver, mut ranges)| (receiver, median(&mut ranges))).collect::<Vec<_>>()
        };
        let all: Vec<Vec<(usize, f64)>> = epochs.around().map(ranged).filter(|ranges| ranges.len() >= 3).collect();
        if all.len() < LEAST {
            return None;
        }
        let every = all.len().div_ceil(MOST);
        let found = Self { of: all.into_iter().step_by(every).collect(), height_m, bias_m: 0.0 };
        Some(Self { bias_m: found.bias_m(receivers, 1.0), ..found })
    }

    /// By how much ranges of which a metre has so many units are usually too long (m).
    fn bias_m(&self, receivers: &[Position], of_metre: f64) -> f64 {
        median(&mut self.errors_by_m(receivers, Measure { of_metre, bias_m: 0.0 }).concat())
    }

    /// The errors at each moment of ranges of which a metre has so many units (m).
    pub(super) fn errors_in_m(&self, receivers: &[Position], of_metre: f64) -> Vec<Vec<f64>> {
        self.errors_by_m(receivers, Measure { of_metre, bias_m: self.bias_m(receivers, of_metre) })
    }

    /// The same of ranges in metres, if the places are in a unit of which a metre has so many.
    pub(super) fn errors_shrunk_m(&self, receivers: &[Position], of_metre: f64) -> Vec<Vec<f64>> {
        let shrunk: Vec<Position> = receivers.iter().map(|&place| place * (1.0 / of_metre)).collect();
        Self { height_m: self.height_m / of_metre, ..self.clone() }.errors_in_m(&shrunk, 1.0)
    }

    /// The same of ranges that are all too long by so much (m).
    pub(super) fn errors_with_offset_m(&self, receivers: &[Position], offset_m: f64) -> Vec<Vec<f64>> {
        self.errors_by_m(receivers, Measure { of_metre: 1.0, bias_m: offset_m })
    }

    /// By how much all ranges are too long if moments agree best so (m): the nearest receiver is nearer than the receivers are apart.
    pub(super) fn offset_m(&self, receivers: &[Position]) -> f64 {
        let first = receivers.first().copied().unwrap_or(Position::ORIGIN);
        let extent_m = receivers.iter().map(|place| place.distance_m(first)).fold(0.0, f64::max);
        let shortest =
            |moment: &Vec<(usize, f64)>| moment.iter().map(|&(_, range)| range).fold(f64::INFINITY, f64::min);
        let shortest_m = median(&mut self.of.iter().map(shortest).collect::<Vec<_>>());
        let fit = |offset_m: f64| log_density(&self.errors_with_offset_m(receivers, offset_m));
        let best = |from_m: f64, step_m: f64| {
            let tried = (0..=STEPS).map(|step| from_m - step_m * f64::from(step));
            tried
                .map(|offset_m| (fit(offset_m), offset_m))
                .max_by(|a, b| a.0.total_cmp(&b.0))
                .map_or(0.0, |(_, at)| at)
        };
        let step_m = extent_m / f64::from(STEPS);
        let coarse_m = best(shortest_m, step_m);
        best(coarse_m + step_m, 2.0 * step_m / f64::from(STEPS))
    }

    /// The same as metres.
    pub(super) fn errors_m(&self, receivers: &[Position]) -> Vec<Vec<f64>> {
        self.errors_by_m(receivers, self.as_metres())
    }

    /// The same with other places of some receivers, where the errors with all places as given are known.
    pub(super) fn changed_errors_m(
        &self,
        receivers: &[Position],
        changed: [usize; 2],
        given_m: &[Vec<f64>],
    ) -> Vec<Vec<f64>> {
        let has_changed = |moment: &[(usize, f64)]| moment.iter().any(|(receiver, _)| changed.contains(receiver));
        let of = |(moment, given_m): (&Vec<(usize, f64)>, &Vec<f64>)| {
            if has_changed(moment) { self.errors_of_m(moment, receivers, self.as_metres()) } else { given_m.clone() }
        };
        self.of.iter().zip(given_m).map(of).collect()
    }

    /// The errors without a receiver, of the moments at which three others have ranges.
    pub(super) fn errors_without_m(&self, receivers: &[Position], left_out: usize) -> Vec<Vec<f64>> {
        let others = |moment: &Vec<(usize, f64)>| {
            moment.iter().copied().filter(|(receiver, _)| *receiver != left_out).collect::<Vec<_>>()
        };
        let kept = self.of.iter().map(others).filter(|moment| moment.len() >= 3);
        kept.map(|moment| self.errors_of_m(&moment, receivers, self.as_metres())).collect()
    }

    /// How far off the ranges of a receiver usually are (m), where the errors of all are known.
    pub(super) fn usually_off_m(&self, receiver: usize, errors_m: &[Vec<f64>]) -> f64 {
        let all = self.of.iter().flatten().zip(errors_m.iter().flatten());
        let mut own: Vec<f64> =
            all.filter(|((of, _), _)| *of == receiver).map(|(_, error_m)| error_m.abs()).collect();
        if own.is_empty() { 0.0 } else { median(&mut own) }
    }

    fn as_metres(&self) -> Measure {
        Measure { of_metre: 1.0, bias_m: self.bias_m }
    }

    fn errors_by_m(&self, receivers: &[Position], measure: Measure) -> Vec<Vec<f64>> {
        self.of.iter().map(|moment| self.errors_of_m(moment, receivers, measure)).collect()
    }

    fn errors_of_m(&self, moment: &[(usize, f64)], receivers: &[Position], measure: Measure) -> Vec<f64> {
        let Measure { of_metre, bias_m } = measure;
        let flat: Vec<Range> = moment
            .iter()
            .map(|&(receiver, range)| flat_range(receivers[receiver], range / of_metre - bias_m, self.height_m))
            .collect();
        let middle = flat.iter().fold(Position::ORIGIN, |sum, range| sum + range.anchor) * (1.0 / flat.len() as f64);
        let place = best_place(&flat, middle, None);
        flat.iter().map(|range| range.distance_m - apart_m(place, range.anchor)).collect()
    }
}

/// Mean logarithm of the density of some errors under the law that suits them (per m); below all others if there are none.
pub(super) fn log_density(errors_m: &[Vec<f64>]) -> f64 {
    let all = errors_m.concat();
    if all.is_empty() {
        return f64::NEG_INFINITY;
    }
    error_law::of_errors(&all).prepared().log_likelihood(all.iter().copied()) / all.len() as f64
}

fn apart_m(place: Position, anchor: Position) -> f64 {
    libm::hypot(place.x_m - anchor.x_m, place.y_m - anchor.y_m)
}
