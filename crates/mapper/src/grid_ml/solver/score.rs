//! The likelihood at a list of vertices, a few at a time.

use std::ops::Range;

use sextant_channel::{CellIndex, Position};
use sextant_kernel::Watch;

use super::admission::Admission;
use super::curve::ReceptionCurve;
use super::cuts::Narrowing;
use super::evidence::PacketEvidence;
use super::lanes::{LANES, Lanes};
use super::screen::{BoundScene, Screen};
use super::soft::SoftSectors;
use super::wedges::Wedges;
use super::{LatticeRow, Sink};
use crate::lattice::Lattice;

/// Vertices collected before they are scored: bounds the memory.
const BATCH: usize = 2048;

/// Vertices to be scored.
#[derive(Debug, Default)]
pub(crate) struct Survivors {
    pub(super) x: Vec<f64>,
    pub(super) y: Vec<f64>,
    pub(super) z: Vec<f64>,
    pub(super) index: Vec<u64>,
    /// Stops in range that have no entry for the node.
    pub(super) silent: Vec<Position>,
    /// Bounding box of the vertices.
    pub(super) corners: [[f64; 3]; 2],
    pub(super) narrowing: Narrowing,
    screen: Screen,
    chosen: Vec<usize>,
}

/// Scores the vertices of one node.
pub(crate) struct Scorer<'s> {
    pub(crate) lattice: &'s Lattice,
    pub(crate) cells: &'s CellIndex,
    pub(crate) curve: &'s ReceptionCurve,
    pub(crate) admission: Admission,
    pub(crate) wedges: Option<&'s Wedges>,
    pub(crate) soft: Option<&'s SoftSectors>,
    pub(crate) evidence: &'s PacketEvidence,
    pub(crate) survivors: &'s mut Survivors,
    pub(crate) watch: &'s dyn Watch,
    /// Whether the work was ended: no vertex is scored any more.
    pub(crate) is_stopped: bool,
    /// Whether a vertex with a likelihood above zero was found.
    pub(crate) any_admitted: bool,
    pub(crate) evaluated: u64,
}

impl Scorer<'_> {
    /// Adds the vertices `span` of a row.
    pub(crate) fn push(&mut self, row: LatticeRow, span: Range<usize>, sink: &mut impl Sink) {
        if self.is_stopped {
            return;
        }
        let first = self.lattice.index([0, row[0], row[1]]);
        let (y, z) = (self.lattice.coordinate(1, row[0]), self.lattice.coordinate(2, row[1]));
        for i in span {
            self.survivors.x.push(self.lattice.coordinate(0, i));
            self.survivors.y.push(y);
            self.survivors.z.push(z);
            self.survivors.index.push(first + i as u64);
            if self.survivors.index.len() == BATCH {
                self.flush(sink);
            }
        }
    }

    /// Scores the vertices added since the last time and gives them to `sink`.
    pub(crate) fn flush<S: Sink>(&mut self, sink: &mut S) {
        let count = self.survivors.index.len();
        if count == 0 {
            return;
        }
        self.is_stopped = self.watch.is_stopped();
        if self.is_stopped {
            self.survivors.clear();
            return;
        }
        self.evaluated += count as u64;
        let constant = self.find_silent();
        if S::WANTS_PEAK && self.can_narrow() {
            self.narrow(constant, sink);
        }
        let count = self.survivors.index.len();
        let mut chosen = std::mem::take(&mut self.survivors.chosen);
        chosen.clear();
        // Bounds do not include sectors, so they are useless where receptions contradict their sectors.
        let is_bounded = self.admission == Admission::WithinAll || !self.evidence.is_sectored();
        if S::WANTS_FEW && count > 2 * LANES && is_bounded && self.bound() {
            // The most promising vertices rule out most others.
            let first = self.survivors.screen.highest::<LANES>();
            self.score(first, LANES, constant, sink);
            let candidates = self.survivors.screen.candidates(sink.least() - constant);
            chosen.extend(candidates.filter(|vertex| !first.contains(vertex)));
        } else {
            // Begin in the middle: the likelihood is often highest there, which rules out the rest early.
            chosen.extend((count / 2..count).chain(0..count / 2));
        }
        for block in chosen.chunks(LANES) {
            // The last block is filled up with copies of a vertex. Their results are not used.
            let lanes = std::array::from_fn(|lane| block[lane.min(block.len() - 1)]);
            self.score(lanes, block.len(), constant, sink);
        }
        self.survivors.chosen = chosen;
        self.survivors.clear();
    }

    /// Bounds the likelihoods of the survivors; returns whether it did.
    fn bound(&mut self) -> bool {
        let coverage = self.wedges.and_then(Wedges::coverage);
        let Survivors { x, y, z, silent, corners, screen, .. } = &mut *self.survivors;
        let scene = BoundScene {
            curve: self.curve,
            evidence: self.evidence,
            silent,
            coverage,
            vertices: [x, y, z],
            corners: *corners,
        };
        screen.bound(&scene)
    }

    /// Gives `sink` the log-likelihoods of the first `count` of a few survivors.
    pub(super) fn score(&mut self, vertices: [usize; LANES], count: usize, constant: f64, sink: &mut impl Sink) {
        let Survivors { x, y, z, index, silent, .. } = &*self.survivors;
        let (x, y, z) = (vertices.map(|v| x[v]), vertices.map(|v| y[v]), vertices.map(|v| z[v]));
        let mut lanes = Lanes::new(&x, &y, &z);
        let coverage = self.wedges.and_then(Wedges::coverage);
        match self.wedges.filter(|_| self.admission == Admission::WithinAny && self.evidence.is_sectored()) {
            Some(wedges) => lanes.multiply_sectors(self.curve, self.evidence, wedges),
            None => lanes.multiply_entries(self.curve, self.evidence, coverage, self.admission),
        }
        if let (Some(wedges), Some(soft)) = (self.wedges, self.soft) {
            lanes.multiply_names(self.evidence, wedges, soft);
        }
        // Missed packets can only lower a likelihood.
        if lanes.highest() + constant < sink.least() {
            return;
        }
        match coverage {
            Some(coverage) => lanes.multiply_silence(self.curve, silent, coverage),
            None => lanes.multiply(self.curve, silent, |square| 1.0 - self.curve.at(square)),
        }
        for (lane, &vertex) in vertices[..count].iter().enumerate() {
            let value = lanes.log_likelihood(lane);
            if value > f64::NEG_INFINITY {
                self.any_admitted = true;
                sink.take(index[vertex], Position::new(x[lane], y[lane], z[lane]), value + constant);
            }
        }
    }

    /// Finds the silent stops that are in range of a survivor. Returns what the others add to every
    /// log-likelihood.
    fn find_silent(&mut self) -> f64 {
        let Survivors { x, y, z, silent, corners, .. } = &mut *self.survivors;
        let (x0, x1) = bounds(x);
        let (y0, y1) = bounds(y);
        let (z0, z1) = bounds(z);
        *corners = [[x0, y0, z0], [x1, y1, z1]];
        let reach = self.curve.range_m;
        silent.clear();
        for points in self.cells.near_box([x0 - reach, y0 - reach, z0 - reach], [x1 + reach, y1 + reach, z1 + reach])
        {
            for &(place, stop) in points {
                let dx = place.x_m - place.x_m.clamp(x0, x1);
                let dy = place.y_m - place.y_m.clamp(y0, y1);
                let dz = place.z_m - place.z_m.clamp(z0, z1);
                if dx * dx + dy * dy + dz * dz < self.curve.range_squared && !self.evidence.is_listed(stop) {
                    silent.push(place);
                }
            }
        }
        let afar = (self.evidence.silent_stops() - silent.len()) as f64;
        afar * self.curve.ln_missed_afar
    }
}

impl Survivors {
    fn clear(&mut self) {
        for values in [&mut self.x, &mut self.y, &mut self.z] {
            values.clear();
        }
        self.index.clear();
    }
}

pub(super) fn bounds(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &value| (low.min(value), high.max(value)))
}
