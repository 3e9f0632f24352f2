//! The likelihood at a list of vertices, a few at a time.

use std::ops::Range;

use sextant_channel::Position;
use sextant_kernel::Watch;

use super::coverage::Coverage;
use super::curve::Curve;
use super::evidence::{Count, Evidence};
use super::receiver::Receiver;
use super::screen::{Scene, Screen};
use super::soft::SoftSectors;
use super::wedges::Wedges;
use super::{Row, Sink};
use crate::Lattice;
use crate::cells::CellIndex;

/// Vertices scored side by side, so that the compiler fills the vector registers.
const LANES: usize = 4;

/// Vertices collected before they are scored: bounds the memory.
const BATCH: usize = 2048;

/// Which vertices are in the search set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Admission {
    /// Vertices within R and in the sector of every stop that received. The caller gives only such vertices to the
    /// scorer.
    WithinAll,
    /// Vertices within R and in the sector of any stop that received. The scorer checks this.
    WithinAny,
}

/// Vertices to be scored.
#[derive(Debug, Default)]
pub(crate) struct Survivors {
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
    index: Vec<u64>,
    /// Stops in range that have no entry for the node.
    silent: Vec<Position>,
    /// Bounding box of the vertices.
    corners: [[f64; 3]; 2],
    screen: Screen,
    chosen: Vec<usize>,
}

/// Scores the vertices of one node.
pub(crate) struct Scorer<'s> {
    pub(crate) lattice: &'s Lattice,
    pub(crate) cells: &'s CellIndex,
    pub(crate) curve: &'s Curve,
    pub(crate) admission: Admission,
    pub(crate) wedges: Option<&'s Wedges>,
    pub(crate) soft: Option<&'s SoftSectors>,
    pub(crate) evidence: &'s Evidence,
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
    pub(crate) fn push(&mut self, row: Row, span: Range<usize>, sink: &mut impl Sink) {
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
        let scene = Scene {
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
    fn score(&mut self, vertices: [usize; LANES], count: usize, constant: f64, sink: &mut impl Sink) {
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

fn bounds(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &value| (low.min(value), high.max(value)))
}

/// Running products at a few vertices: `mantissa · 2^exponent · exp(logarithm)`, so that no product underflows.
/// A factor of zero is kept as a mantissa of zero.
struct Lanes<'v> {
    x: &'v [f64; LANES],
    y: &'v [f64; LANES],
    z: &'v [f64; LANES],
    mantissa: [f64; LANES],
    exponent: [i64; LANES],
    logarithm: [f64; LANES],
}

impl<'v> Lanes<'v> {
    fn new(x: &'v [f64; LANES], y: &'v [f64; LANES], z: &'v [f64; LANES]) -> Self {
        Self { x, y, z, mantissa: [1.0; LANES], exponent: [0; LANES], logarithm: [0.0; LANES] }
    }

    /// The vertex of a lane as seen from a place (m).
    fn apart(&self, place: Position, lane: usize) -> [f64; 3] {
        [self.x[lane] - place.x_m, self.y[lane] - place.y_m, self.z[lane] - place.z_m]
    }

    #[inline(always)]
    fn distance_squared(&self, place: Position, lane: usize) -> f64 {
        let (dx, dy, dz) = (self.x[lane] - place.x_m, self.y[lane] - place.y_m, self.z[lane] - place.z_m);
        dx * dx + dy * dy + dz * dz
    }

    /// Multiplies by the factors of the entries of the log.
    fn multiply_entries(
        &mut self,
        curve: &Curve,
        evidence: &Evidence,
        coverage: Option<Coverage<'_>>,
        admission: Admission,
    ) {
        if admission == Admission::WithinAny {
            self.keep_near(evidence.receptions().iter().map(|receiver| receiver.place), curve.range_squared);
        }
        self.multiply(curve, &evidence.heard, |square| curve.at(square));
        for count in &evidence.counts {
            self.multiply_count(curve, count, coverage);
        }
    }

    /// Multiplies by the probabilities of the sectors that the node named. A sector that contradicts a vertex counts as a
    /// reception from beyond R already.
    fn multiply_names(&mut self, evidence: &Evidence, wedges: &Wedges, soft: &SoftSectors) {
        for &Receiver { place, sector, .. } in evidence.receptions() {
            let Some(sector) = sector else { continue };
            for lane in 0..LANES {
                let apart = self.apart(place, lane);
                if wedges.admits(sector, apart) {
                    self.logarithm[lane] += soft.ln_probability(sector, apart);
                }
            }
        }
    }

    /// What a stop that heard nothing says of the vertex of a lane: the probability of a reception, that of a vertex
    /// beyond R where no sector points.
    fn heard_in_a_sector(&self, curve: &Curve, coverage: Coverage<'_>, place: Position, lane: usize) -> f64 {
        let is_covered = coverage.covers(self.apart(place, lane));
        if is_covered { curve.at(self.distance_squared(place, lane)) } else { curve.floor }
    }

    /// Multiplies by the factors of stops that heard nothing, where sectors do not cover every direction.
    fn multiply_silence(&mut self, curve: &Curve, places: &[Position], coverage: Coverage<'_>) {
        for chunk in places.chunks(curve.chunk) {
            for &place in chunk {
                for lane in 0..LANES {
                    self.mantissa[lane] *= 1.0 - self.heard_in_a_sector(curve, coverage, place, lane);
                }
            }
            self.normalise();
        }
    }

    /// The same where sectors may be contradicted: a reception outside its sector counts as one from beyond R, and a
    /// vertex that contradicts all receptions is not in the search set.
    fn multiply_sectors(&mut self, curve: &Curve, evidence: &Evidence, wedges: &Wedges) {
        let mut is_near = [false; LANES];
        for &Receiver { place, packets, sector } in evidence.receptions() {
            let mut factors = [0.0; LANES];
            for lane in 0..LANES {
                let square = self.distance_squared(place, lane);
                let is_inside = sector.is_none_or(|sector| wedges.admits(sector, self.apart(place, lane)));
                factors[lane] = if is_inside { curve.at(square) } else { curve.floor };
                is_near[lane] |= is_inside && square < curve.range_squared;
            }
            self.raise(curve, factors, packets);
        }
        for count in evidence.counts.iter().filter(|count| count.missed > 0) {
            self.multiply_missed(curve, count, wedges.coverage());
        }
        for (mantissa, is_near) in self.mantissa.iter_mut().zip(is_near) {
            *mantissa = if is_near { *mantissa } else { 0.0 };
        }
    }

    /// Multiplies by `factor` of the squared distance to each of `places`.
    #[inline(always)]
    fn multiply(&mut self, curve: &Curve, places: &[Position], factor: impl Fn(f64) -> f64) {
        for chunk in places.chunks(curve.chunk) {
            let mut product = self.mantissa;
            for &place in chunk {
                for (lane, product) in product.iter_mut().enumerate() {
                    *product *= factor(self.distance_squared(place, lane));
                }
            }
            self.mantissa = product;
            self.normalise();
        }
    }

    /// Multiplies by the factors of a stop that received some packets and missed others.
    fn multiply_count(&mut self, curve: &Curve, count: &Count, coverage: Option<Coverage<'_>>) {
        let mut received = [0.0; LANES];
        for (lane, s) in received.iter_mut().enumerate() {
            *s = curve.at(self.distance_squared(count.place, lane));
        }
        self.raise(curve, received, count.received);
        self.multiply_missed(curve, count, coverage);
    }

    /// Multiplies by the factors of the packets that a stop missed.
    fn multiply_missed(&mut self, curve: &Curve, count: &Count, coverage: Option<Coverage<'_>>) {
        let coverage = coverage.filter(|_| count.received == 0);
        let mut missed = [0.0; LANES];
        for (lane, factor) in missed.iter_mut().enumerate() {
            *factor = 1.0
                - match coverage {
                    Some(coverage) => self.heard_in_a_sector(curve, coverage, count.place, lane),
                    None => curve.at(self.distance_squared(count.place, lane)),
                };
        }
        self.raise(curve, missed, count.missed);
    }

    /// Multiplies by `factors` to the power `times`.
    fn raise(&mut self, curve: &Curve, factors: [f64; LANES], times: u32) {
        for (lane, factor) in factors.into_iter().enumerate() {
            if times as usize <= curve.chunk {
                for _ in 0..times {
                    self.mantissa[lane] *= factor;
                }
            } else if factor > 0.0 {
                self.logarithm[lane] += f64::from(times) * libm::log(factor);
            } else {
                self.mantissa[lane] = 0.0;
            }
        }
        self.normalise();
    }

    /// Sets the product to zero where none of `places` is within range.
    fn keep_near(&mut self, places: impl Iterator<Item = Position>, range_squared: f64) {
        let mut nearest = [f64::INFINITY; LANES];
        for place in places {
            for (lane, nearest) in nearest.iter_mut().enumerate() {
                let square = self.distance_squared(place, lane);
                *nearest = if square < *nearest { square } else { *nearest };
            }
        }
        for (mantissa, nearest) in self.mantissa.iter_mut().zip(nearest) {
            *mantissa = if nearest < range_squared { *mantissa } else { 0.0 };
        }
    }

    /// Moves the powers of two of the mantissas (normal numbers, or zero) to the exponents.
    #[inline(always)]
    fn normalise(&mut self) {
        const FRACTION: u64 = (1 << 52) - 1;
        const ONE: u64 = 1023 << 52;
        for (mantissa, exponent) in self.mantissa.iter_mut().zip(&mut self.exponent) {
            let bits = mantissa.to_bits();
            *exponent += (bits >> 52) as i64 - 1023;
            let fraction = f64::from_bits(bits & FRACTION | ONE);
            *mantissa = if *mantissa > 0.0 { fraction } else { 0.0 };
        }
    }

    fn highest(&self) -> f64 {
        (0..LANES).map(|lane| self.log_likelihood(lane)).fold(f64::NEG_INFINITY, f64::max)
    }

    fn log_likelihood(&self, lane: usize) -> f64 {
        if self.mantissa[lane] > 0.0 {
            let exponent = self.exponent[lane] as f64;
            libm::log(self.mantissa[lane]) + exponent * std::f64::consts::LN_2 + self.logarithm[lane]
        } else {
            f64::NEG_INFINITY
        }
    }
}
