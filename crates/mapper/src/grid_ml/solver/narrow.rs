//! Ruling vertices out without looking at each of them.

use sextant_channel::Position;

use super::admission::Admission;
use super::cuts::{Cuts, Narrowing};
use super::lanes::LANES;
use super::score::{Scorer, Survivors, bounds};
use super::screen::highest;
use super::{ReceptionCurve, Sink, Wedges};

/// With fewer vertices, bounds cost more than they save.
const MANY: usize = 4 * LANES;

/// Cuts made before the most promising vertices are scored.
const CUTS: usize = 3;

impl Scorer<'_> {
    /// Whether [`narrow`](Self::narrow) applies: to stops that are heard or not, under a trapezoid.
    pub(super) fn can_narrow(&self) -> bool {
        self.admission == Admission::WithinAll
            && self.evidence.counts.is_empty()
            && self.soft.is_none()
            && self.wedges.and_then(Wedges::coverage).is_none()
            && !self.curve.is_table()
            && self.curve.floor < self.curve.top
    }

    /// Scores the most promising survivors, and drops them and those that cannot be as good, as long as this drops most
    /// of them. The next cut is made where the others allow the highest likelihood, so that a few find the summit.
    pub(super) fn narrow<S: Sink>(&mut self, constant: f64, sink: &mut S) {
        if self.survivors.index.len() <= MANY {
            return;
        }
        let mut narrowing = std::mem::take(&mut self.survivors.narrowing);
        let Narrowing { cuts, limits } = &mut narrowing;
        cuts.look_at(self.curve, &self.evidence.heard, &self.survivors.silent, self.survivors.corners);
        while self.survivors.index.len() > MANY {
            let before = self.survivors.index.len();
            self.survivors.limit(self.curve, cuts, limits);
            let first = highest::<LANES>(limits);
            self.score(first, LANES, constant, sink);
            let least = sink.least() - constant;
            first.iter().for_each(|&vertex| limits[vertex] = f64::NEG_INFINITY);
            self.survivors.keep(|vertex| limits[vertex] > f64::NEG_INFINITY && limits[vertex] >= least);
            if 2 * self.survivors.index.len() > before {
                break;
            }
        }
        self.survivors.narrowing = narrowing;
    }
}

impl Survivors {
    fn place(&self, vertex: usize) -> [f64; 3] {
        [self.x[vertex], self.y[vertex], self.z[vertex]]
    }

    /// Sets `limits` to the most that the log-likelihoods may be.
    fn limit(&self, curve: &ReceptionCurve, cuts: &Cuts, limits: &mut Vec<f64>) {
        let extent = [bounds(&self.x), bounds(&self.y), bounds(&self.z)];
        let middle = extent.map(|(low, high)| 0.5 * (low + high));
        let apart = |vertex: usize| {
            let place = self.place(vertex);
            (0..3).map(|axis| (place[axis] - middle[axis]).powi(2)).sum::<f64>()
        };
        let mut at = (0..self.index.len()).min_by(|&a, &b| apart(a).total_cmp(&apart(b))).unwrap_or(0);
        limits.clear();
        limits.resize(self.index.len(), f64::INFINITY);
        for _ in 0..CUTS {
            let place = self.place(at);
            let farthest = |axis: usize| (place[axis] - extent[axis].0).max(extent[axis].1 - place[axis]);
            let reach_m = (0..3).map(|axis| farthest(axis).powi(2)).sum::<f64>().sqrt();
            let cut = cuts.cut(curve, Position::from(place), reach_m);
            let mut summit = (f64::NEG_INFINITY, at);
            for (vertex, limit) in limits.iter_mut().enumerate() {
                let here = cut.at(self.place(vertex));
                *limit = if here < *limit { here } else { *limit };
                summit = if *limit > summit.0 { (*limit, vertex) } else { summit };
            }
            if summit.1 == at {
                break;
            }
            at = summit.1;
        }
    }

    /// Drops all vertices but those that `is_kept`.
    fn keep(&mut self, is_kept: impl Fn(usize) -> bool) {
        let mut kept = 0;
        for vertex in 0..self.index.len() {
            if is_kept(vertex) {
                self.x[kept] = self.x[vertex];
                self.y[kept] = self.y[vertex];
                self.z[kept] = self.z[vertex];
                self.index[kept] = self.index[vertex];
                kept += 1;
            }
        }
        for values in [&mut self.x, &mut self.y, &mut self.z] {
            values.truncate(kept);
        }
        self.index.truncate(kept);
    }
}
