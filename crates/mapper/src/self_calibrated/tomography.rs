//! The map of obstacles: absorption that explains which packets were lost along which lines.

use rayon::prelude::*;
use sextant_channel::{Position, ReceptionLog};

use super::absorption::{AbsorptionMap, slant};
use super::counts::Counts;
use super::model::{FLOOR, Model};
use super::normal::density;
use super::posterior::Belief;
use super::settings::ObstacleKnowledge;
use super::start::gap_m;

/// Parts that the lines are dealt to, whatever the threads, so that sums have one order.
const PARTS: usize = 8;
/// Crossings of lines and cells, at most; of more lines every second, third, ... is used.
const MOST_CROSSINGS: f64 = 2e7;
/// Cells, at most.
const MOST_CELLS: f64 = 2e5;
/// Lines shorter than this share of the range cross nothing that matters.
const SHORTEST: f64 = 0.03;
/// Lines within this share of the end of the curve may be too long to be received, rather than obstructed.
const MARGIN: f64 = 0.03;
/// The end of the curve for this purpose.
const FAINT: f64 = 0.02;
/// Absorption of a cell, at most [standard deviations].
const OPAQUE: f64 = 4.0;
/// What a cell must gain to absorb, in standard deviations of its gain by chance.
const THRESHOLD: f64 = 1.5;
/// The penalty of a difference between neighbours, as a share of that of absorption.
const SMOOTHNESS: f64 = 0.1;
/// Differences below this count less [standard deviations].
const SOFT: f64 = 0.05;
/// The threshold of a cell where the robot met an obstacle, as a share.
const CONTACT: f64 = 0.2;
/// Least curvature of the cost along a line.
const LEAST_CURVATURE: f64 = 0.05;
/// Drives longer than this many gaps between stops need not have been straight.
const STRAIGHT: f64 = 1.5;

/// A line from a stop to a node.
#[derive(Clone, Copy, Debug)]
struct Line {
    score: f64,
    efficiency: f64,
    received: f64,
    missed: f64,
    /// Length in the cells, in widths of a cell.
    length: f64,
    /// Where its crossings end.
    end: usize,
    half: Half,
}

/// The lines are halved to see whether what one half tells holds for the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Half {
    One,
    Other,
}

/// Some of the lines, and what they say of the cells.
#[derive(Debug, Default)]
struct Part {
    lines: Vec<Line>,
    crossings: Vec<(u32, f32)>,
    gradient: Vec<f64>,
    curvature: Vec<f64>,
}

/// Radio tomography.
#[derive(Debug)]
pub(super) struct Tomography {
    pub(super) map: AbsorptionMap,
    /// Cells where nothing can stand.
    is_free: Vec<bool>,
    /// Factor on the threshold of each cell.
    reluctance: Vec<f64>,
    threshold: Vec<f64>,
    parts: Vec<Part>,
    next: Vec<f64>,
}

impl Tomography {
    /// Cells over the places of the nodes, which are known to about `slack_m`.
    pub(super) fn new(
        log: &ReceptionLog,
        nodes: &[Belief],
        cell_m: f64,
        slack_m: f64,
        knowledge: ObstacleKnowledge,
    ) -> Self {
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for belief in nodes {
            for (axis, value) in [belief.mean.x_m, belief.mean.y_m].into_iter().enumerate() {
                low[axis] = low[axis].min(value - slack_m);
                high[axis] = high[axis].max(value + slack_m);
            }
        }
        let map = AbsorptionMap::new(low, high, cell_m, MOST_CELLS);
        let cells = map.cells.len();
        let mut tomography = Self {
            is_free: vec![false; cells],
            reluctance: vec![1.0; cells],
            threshold: vec![0.0; cells],
            parts: (0..PARTS).map(|_| Part::default()).collect(),
            next: vec![0.0; cells],
            map,
        };
        if knowledge == ObstacleKnowledge::FromLog {
            tomography.learn(log);
        }
        tomography
    }

    /// Takes note of where the robot drove, and what it met.
    fn learn(&mut self, log: &ReceptionLog) {
        let straight_m = STRAIGHT * gap_m(log).unwrap_or(0.0);
        for pair in log.stops().windows(2) {
            let (from, to) = (pair[0].position, pair[1].position);
            if from.distance_m(to) <= straight_m {
                self.map.crossings(from, to, |cell, _, _| self.is_free[cell] = true);
            }
        }
        for contact in log.contacts() {
            if let Some(cell) = self.map.cell(contact.position) {
                self.reluctance[cell] = CONTACT;
            }
        }
    }

    /// Draws the lines anew for the places of the nodes.
    pub(super) fn draw(&mut self, counts: &Counts<'_>, nodes: &[Belief], model: &Model) {
        let Self { map, is_free, parts, .. } = self;
        let end_m = model.clear.iter().rposition(|&clear| clear > FAINT).unwrap_or(0);
        #[expect(clippy::cast_precision_loss, reason = "a few hundred bins")]
        let end_m = model.last_bin_m() * end_m as f64 / (model.clear.len() - 1) as f64;
        let reach_m = end_m * (1.0 - MARGIN);
        let stride = stride(counts, nodes, reach_m, map.cell_m());
        let share = nodes.len().div_ceil(PARTS).max(1);
        let shares = nodes.chunks(share).chain(std::iter::repeat(&[][..]));
        let work: Vec<(&mut Part, &[Belief])> = parts.iter_mut().zip(shares).collect();
        work.into_par_iter().for_each(|(part, nodes)| {
            part.lines.clear();
            part.crossings.clear();
            for belief in nodes {
                let spread_m = belief.spread_m(0).max(belief.spread_m(1));
                let to_m = reach_m.min(end_m - spread_m);
                if to_m <= 0.0 {
                    continue;
                }
                counts.within(counts.log.of(belief.node), belief.mean, to_m, |link| {
                    let (way, lot) = (belief.mean - link.place, lot(belief.node.0, link.stop));
                    let distance_m = way.length_m();
                    let packets = link.received.saturating_add(link.missed);
                    if packets == 0 || distance_m < SHORTEST * end_m || !lot.is_multiple_of(stride) {
                        return;
                    }
                    part.add(map, is_free, link.place, belief.mean, Line {
                        score: model.score(distance_m),
                        efficiency: model.efficiency(link.stop as usize),
                        received: f64::from(link.received),
                        missed: f64::from(link.missed),
                        length: 0.0,
                        end: 0,
                        half: if lot / stride % 2 == 0 { Half::One } else { Half::Other },
                    });
                });
            }
        });
    }

    /// Whether absorption estimated from half of the lines explains the other half better than none does, by more
    /// than three standard deviations of the difference.
    pub(super) fn is_warranted(&mut self, model: &Model, rounds: usize) -> bool {
        let (mut sum, mut squares) = (0.0, 0.0);
        for half in [Half::One, Half::Other] {
            self.map.cells.fill(0.0);
            self.set_threshold(model, Some(half));
            for _ in 0..rounds {
                self.step(model, Some(half));
            }
            for part in &self.parts {
                let mut from = 0;
                for line in &part.lines {
                    let crossings = &part.crossings[from..line.end];
                    from = line.end;
                    if line.half != half {
                        let gain = line.log_likelihood(model, absorbed(&self.map.cells, crossings))
                            - line.log_likelihood(model, 0.0);
                        sum += gain;
                        squares += gain * gain;
                    }
                }
            }
        }
        self.map.cells.fill(0.0);
        sum > 3.0 * squares.sqrt()
    }

    /// Improves the absorption, starting from what it is, and returns how much the last round changed a cell at most.
    pub(super) fn improve(&mut self, model: &Model, rounds: usize) -> f64 {
        self.set_threshold(model, None);
        let mut change = 0.0;
        for _ in 0..rounds {
            change = self.step(model, None);
        }
        if std::env::var("DBG").is_ok() { let mut t = self.threshold.clone(); t.sort_by(f64::total_cmp); let n = t.len(); println!("   threshold {:.2} {:.2} {:.2} {:.2} change {change:.4} absorbing {}", t[n/10], t[n/2], t[n*9/10], t[n-1], self.map.cells.iter().filter(|c| **c > 0.001).count()); }
        self.map.count();
        change
    }

    /// The threshold of a cell: the standard deviation of the gradient of the likelihood there without obstacles.
    fn set_threshold(&mut self, model: &Model, half: Option<Half>) {
        let cells = &self.map.cells;
        self.parts.par_iter_mut().for_each(|part| {
            part.begin(cells.len());
            let mut from = 0;
            for line in &part.lines {
                let crossings = &part.crossings[from..line.end];
                from = line.end;
                if half.is_none_or(|half| half == line.half) {
                    let information = line.information(model);
                    for &(cell, length) in crossings {
                        part.gradient[cell as usize] += information * f64::from(length) * f64::from(length);
                    }
                }
            }
        });
        for (cell, threshold) in self.threshold.iter_mut().enumerate() {
            let information: f64 = self.parts.iter().map(|part| part.gradient[cell]).sum();
            *threshold = knob("TH", THRESHOLD) * self.reluctance[cell] * information.sqrt();
        }
    }

    /// One round of separable paraboloidal surrogates (De Pierro 1995; Erdogan and Fessler 1999): each cell moves to
    /// the minimum of a parabola that bounds the cost from above, all cells at once.
    fn step(&mut self, model: &Model, half: Option<Half>) -> f64 {
        let cells = &self.map.cells;
        self.parts.par_iter_mut().for_each(|part| part.differentiate(model, cells, half));
        let [columns, rows] = self.map.counts();
        let mut most = 0.0_f64;
        let smoothness = knob("SM", SMOOTHNESS);
        for cell in 0..cells.len() {
            if self.is_free[cell] {
                continue;
            }
            let here = cells[cell];
            let threshold = self.threshold[cell];
            let mut gradient = -threshold;
            let mut curvature = 1e-9;
            for part in &self.parts {
                gradient += part.gradient[cell];
                curvature += part.curvature[cell];
            }
            let (i, j) = (cell % columns, cell / columns);
            let neighbours = [
                (i > 0).then(|| cell - 1),
                (i + 1 < columns).then(|| cell + 1),
                (j > 0).then(|| cell - columns),
                (j + 1 < rows).then(|| cell + columns),
            ];
            for neighbour in neighbours.into_iter().flatten().filter(|&neighbour| !self.is_free[neighbour]) {
                let difference = here - cells[neighbour];
                let weight = smoothness * 0.5 * (threshold + self.threshold[neighbour])
                    / (difference * difference + SOFT * SOFT).sqrt();
                gradient -= weight * difference;
                curvature += 2.0 * weight;
            }
            let there = (here + gradient / curvature).clamp(0.0, OPAQUE);
            most = most.max((there - here).abs());
            self.next[cell] = there;
        }
        std::mem::swap(&mut self.map.cells, &mut self.next);
        most
    }
}

impl Part {
    fn add(&mut self, map: &AbsorptionMap, is_free: &[bool], from: Position, to: Position, mut line: Line) {
        let slant = slant(to - from);
        map.crossings(from, to, |cell, enter, leave| {
            if !is_free[cell] {
                let length = (leave - enter) * slant;
                #[expect(clippy::cast_possible_truncation, reason = "cells are few, and lengths need no precision")]
                self.crossings.push((cell as u32, length as f32));
                line.length += length;
            }
        });
        line.end = self.crossings.len();
        self.lines.push(line);
    }

    fn begin(&mut self, cells: usize) {
        for sums in [&mut self.gradient, &mut self.curvature] {
            sums.clear();
            sums.resize(cells, 0.0);
        }
    }

    /// Sums the gradient of the log-likelihood, and the curvature of the surrogate, over the lines.
    fn differentiate(&mut self, model: &Model, cells: &[f64], half: Option<Half>) {
        self.begin(cells.len());
        let mut from = 0;
        for line in &self.lines {
            let crossings = &self.crossings[from..line.end];
            from = line.end;
            if half.is_some_and(|half| half != line.half) {
                continue;
            }
            let (slope, curvature) = line.derivatives(model, absorbed(cells, crossings));
            let curvature = curvature * line.length;
            for &(cell, length) in crossings {
                let (cell, length) = (cell as usize, f64::from(length));
                self.gradient[cell] += slope * length;
                self.curvature[cell] += curvature * length;
            }
        }
    }
}

impl Line {
    fn probability(&self, model: &Model, absorbed: f64) -> f64 {
        (self.efficiency * model.normal().below(self.score - absorbed)).clamp(FLOOR, 1.0 - 1e-4)
    }

    fn log_likelihood(&self, model: &Model, absorbed: f64) -> f64 {
        let p = self.probability(model, absorbed);
        self.received * libm::log(p) + self.missed * libm::log1p(-p)
    }

    /// Slope of the log-likelihood with absorption, and the curvature of a parabola below it.
    fn derivatives(&self, model: &Model, absorbed: f64) -> (f64, f64) {
        let x = self.score - absorbed;
        let passed = model.normal().below(x).max(1e-9);
        let density = density(x);
        let ratio = density / passed;
        let odds = self.efficiency * density / (1.0 - self.probability(model, absorbed));
        let slope = self.missed * odds - self.received * ratio;
        let curvature = self.received * ratio * (ratio + x) + self.missed * odds * (odds - x);
        (slope, curvature.max(LEAST_CURVATURE * (self.received + self.missed)))
    }

    /// Fisher information of the absorption at none.
    fn information(&self, model: &Model) -> f64 {
        let p = self.probability(model, 0.0);
        let slope = self.efficiency * density(self.score);
        (self.received + self.missed) * slope * slope / (p * (1.0 - p))
    }
}

fn absorbed(cells: &[f64], crossings: &[(u32, f32)]) -> f64 {
    crossings.iter().map(|&(cell, length)| cells[cell as usize] * f64::from(length)).sum()
}

/// How many lines to one that is used.
fn stride(counts: &Counts<'_>, nodes: &[Belief], reach_m: f64, cell_m: f64) -> u64 {
    let mut lines = 0.0;
    // A sample is enough for an estimate.
    let every = nodes.len().div_ceil(1000);
    for belief in nodes.iter().step_by(every.max(1)) {
        counts.within(&[], belief.mean, reach_m, |_| lines += 1.0);
    }
    #[expect(clippy::cast_precision_loss, reason = "a number of nodes")]
    let crossings = lines * every as f64 * reach_m / cell_m;
    crate::lattice::whole(crossings / MOST_CROSSINGS) as u64 + 1
}

/// A number that scatters the lines evenly.
fn lot(node: u32, stop: u32) -> u64 {
    let mut bits = (u64::from(node) << 32 | u64::from(stop)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    bits ^ (bits >> 31)
}

pub(super) fn knob(name: &str, value: f64) -> f64 { std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(value) }
