//! Where the search for a track begins: places from ranges of one moment, or weighted centroids by strengths.

use sextant_channel::Position;

use super::epochs::{EpochReading, Epochs};
use super::side::Line;
use crate::comparators::lateration::{Range, refine};
use crate::numerics::median;

/// Places come from readings within this time before and after (s).
const WINDOW_S: f64 = 1.0;
/// By how much the weight of a receiver falls with its strength, as a share of the amplitude.
const AMPLITUDE: f64 = 1.0;
/// Centroids of receivers on a line are on it, where nothing tells the way to either side: the search begins so far beside it, as a share
/// of its length.
const BESIDE_LINE: f64 = 0.2;

impl Epochs {
    /// A place for each epoch from the readings around it, on the wanted side of a line of receivers; `None` if no moment has ranges
    /// to three receivers, and there are no strengths.
    pub(super) fn start(&self, receivers: &[Position], height_m: f64, line: Option<&Line>) -> Option<Vec<[f64; 2]>> {
        let middle =
            receivers.iter().fold(Position::ORIGIN, |sum, &place| sum + place) * (1.0 / receivers.len() as f64);
        let of_ranges = self.places_by_ranges(receivers, middle, height_m, line);
        let known = if of_ranges.is_empty() { self.places_by_strengths(receivers, line) } else { of_ranges };
        if known.is_empty() {
            return None;
        }
        let at = |time_s: f64| {
            let after = known.partition_point(|&(known_s, _)| known_s < time_s);
            match (after.checked_sub(1).map(|before| known[before]), known.get(after)) {
                (Some((before_s, before)), Some(&(after_s, place))) if after_s > before_s => {
                    let share = (time_s - before_s) / (after_s - before_s);
                    [0, 1].map(|axis| before[axis] + share * (place[axis] - before[axis]))
                }
                (_, Some(&(_, place))) | (Some((_, place)), None) => place,
                (None, None) => [middle.x_m, middle.y_m],
            }
        };
        Some(self.times_s.iter().map(|&time_s| at(time_s)).collect())
    }

    /// The readings around each epoch.
    pub(super) fn around(&self) -> impl Iterator<Item = (f64, &[EpochReading])> {
        let (mut from, mut to) = (0, 0);
        let time_of = |reading: &EpochReading| self.times_s[reading.epoch];
        self.times_s.iter().map(move |&time_s| {
            while from < self.readings.len() && time_of(&self.readings[from]) < time_s - WINDOW_S {
                from += 1;
            }
            while to < self.readings.len() && time_of(&self.readings[to]) <= time_s + WINDOW_S {
                to += 1;
            }
            (time_s, &self.readings[from..to])
        })
    }

    /// The values of each receiver among some readings.
    pub(super) fn by_receiver(near: &[EpochReading], receivers: usize, of_strengths: bool) -> Vec<Vec<f64>> {
        let mut found: Vec<Vec<f64>> = vec![Vec::new(); receivers];
        let readings = near.iter().filter(|reading| reading.is_strength == of_strengths);
        readings.for_each(|reading| found[reading.receiver].push(reading.value));
        found
    }

    fn places_by_ranges(
        &self,
        receivers: &[Position],
        middle: Position,
        height_m: f64,
        line: Option<&Line>,
    ) -> Vec<(f64, [f64; 2])> {
        let mut last = middle;
        let mut known: Vec<(f64, [f64; 2])> = Vec::new();
        for (time_s, near) in self.around() {
            let mut by_receiver = Self::by_receiver(near, receivers.len(), false);
            let flat: Vec<Range> = by_receiver
                .iter_mut()
                .zip(receivers)
                .filter(|(ranges, _)| !ranges.is_empty())
                .map(|(ranges, receiver)| flat_range(*receiver, median(ranges), height_m))
                .collect();
            if flat.len() < 3 {
                continue;
            }
            let best = best_place(&flat, middle, Some(last));
            let [x_m, y_m] = line.map_or([best.x_m, best.y_m], |line| line.on_side([best.x_m, best.y_m]));
            last = Position::new(x_m, y_m, best.z_m);
            known.push((time_s, [x_m, y_m]));
        }
        known
    }

    /// Centroids of the receivers, weighted by the amplitude with which each was received, beside the line if they are on one.
    fn places_by_strengths(&self, receivers: &[Position], line: Option<&Line>) -> Vec<(f64, [f64; 2])> {
        let mut known = Vec::new();
        for (time_s, near) in self.around() {
            let by_receiver = Self::by_receiver(near, receivers.len(), true);
            let (mut sum, mut place) = (0.0, [0.0; 2]);
            for (strengths, receiver) in by_receiver.iter().zip(receivers).filter(|(all, _)| !all.is_empty()) {
                let mean_dbm = strengths.iter().sum::<f64>() / strengths.len() as f64;
                let weight = libm::exp(AMPLITUDE * mean_dbm * std::f64::consts::LN_10 / 20.0);
                sum += weight;
                place[0] += weight * receiver.x_m;
                place[1] += weight * receiver.y_m;
            }
            if sum > 0.0 {
                let centroid = place.map(|along| along / sum);
                known.push((time_s, line.map_or(centroid, |line| line.beside(centroid, BESIDE_LINE))));
            }
        }
        known
    }
}

/// The range in the plane to a receiver, of a tag at a height (m).
pub(super) fn flat_range(receiver: Position, range_m: f64, height_m: f64) -> Range {
    let up_m = receiver.z_m - height_m;
    Range::new(receiver, (range_m.powi(2) - up_m * up_m).max(0.0).sqrt())
}

/// The place in the plane that fits some ranges best, of the tops of six searches or, with a `last` place, seven: a place near that is
/// preferred where two fit alike. `middle` is amid the receivers.
pub(super) fn best_place(flat: &[Range], middle: Position, last: Option<Position>) -> Position {
    let usual_m = median(&mut flat.iter().map(|range| range.distance_m).collect::<Vec<_>>());
    let around = [[1.0, 0.2], [-0.2, 1.0], [-1.0, -0.2], [0.2, -1.0]]
        .map(|[x, y]| middle + Position::new(x * usual_m, y * usual_m, 0.0));
    let starts = last.into_iter().chain(around).chain([middle + Position::new(0.01, 0.02, 0.0)]);
    let away_m = |place: Position, from: Position| libm::hypot(place.x_m - from.x_m, place.y_m - from.y_m);
    let cost = |place: &Position| {
        let misfit_m: f64 = flat.iter().map(|range| (away_m(*place, range.anchor) - range.distance_m).abs()).sum();
        misfit_m + last.map_or(0.0, |last| 0.05 * away_m(*place, last))
    };
    let found = starts.map(|start| refine(start, flat, 2));
    found.min_by(|a, b| cost(a).total_cmp(&cost(b))).expect("there are starts")
}
