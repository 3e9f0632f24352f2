//! Straight lines between stops and nodes, and the evidence of their receptions on the cells that they cross.

use sextant_channel::Position;
use sextant_kernel::maths::ln;

use super::model::{CEILING, FLOOR, Model};
use crate::absorption::claims::CellEvidence;
use crate::absorption::{AbsorptionMap, slant};
use crate::numerics::normal::density;

/// Least curvature of the log-likelihood along a line, per packet. It keeps steps short where the log-likelihood is
/// flat or not concave.
const LEAST_CURVATURE: f64 = 0.05;

/// A line from a stop to a node.
#[derive(Clone, Copy, Debug)]
pub(super) struct SightLine {
    /// z over the length of the line.
    pub(super) score: f64,
    /// Efficiency of the stop.
    pub(super) efficiency: f64,
    /// Packets received.
    pub(super) received: f64,
    /// Packets missed.
    pub(super) missed: f64,
    /// Number of the node.
    pub(super) node: u32,
    /// The half that the line belongs to.
    pub(super) half: Half,
}

/// The lines are divided into two halves, to test the estimate from one half on the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Half {
    One,
    Other,
}

/// A line with the cells that it crosses.
#[derive(Clone, Copy, Debug)]
struct RecordedWorld {
    line: SightLine,
    /// Length in the cells, in widths of a cell.
    length: f64,
    /// Cosine and sine of twice its direction in the plane.
    doubled: [f64; 2],
    /// Where its crossings end.
    end: usize,
}

/// Some of the lines, and their sums for the cells.
#[derive(Debug, Default)]
pub(super) struct Lines {
    lines: Vec<RecordedWorld>,
    /// Cells, and the lengths in them in widths of a cell.
    crossings: Vec<(u32, f32)>,
    /// By cell: the gradient of the log-likelihood, or the Fisher information.
    pub(super) gradient: Vec<f64>,
    /// By cell: the curvature of the cost.
    pub(super) curvature: Vec<f64>,
}

impl Lines {
    pub(super) fn clear(&mut self) {
        self.lines.clear();
        self.crossings.clear();
    }

    /// Adds a line between two places. Free cells do not count.
    pub(super) fn draw(&mut self, map: &AbsorptionMap, is_free: &[bool], ends: [Position; 2], line: SightLine) {
        let [from, to] = ends;
        let slant = slant(to - from);
        let way = to - from;
        let (sin, cos) = libm::sincos(2.0 * libm::atan2(way.y_m, way.x_m));
        let mut drawn = RecordedWorld { line, length: 0.0, doubled: [cos, sin], end: 0 };
        map.crossings(from, to, |cell, enter, leave| {
            if !is_free[cell] {
                let length = (leave - enter) * slant;
                #[expect(clippy::cast_possible_truncation, reason = "cells are few, and lengths need no precision")]
                self.crossings.push((cell as u32, length as f32));
                drawn.length += length;
            }
        });
        drawn.end = self.crossings.len();
        self.lines.push(drawn);
    }

    /// Sums the gradient of the log-likelihood, and the curvature of a separable surrogate, over the lines of one
    /// half or of both. The surrogate of a line gives each of its cells the curvature along the line times the length
    /// of the whole line (De Pierro 1995), so all cells can move at the same time.
    pub(super) fn differentiate(&mut self, model: &Model, cells: &[f64], half: Option<Half>) {
        self.begin(cells.len());
        let Self { lines, crossings, gradient, curvature } = self;
        for (drawn, crossings) in each(lines, crossings, half) {
            let (slope, bend) = drawn.line.derivatives(model, absorbed(cells, crossings));
            let bend = bend * drawn.length;
            for &(cell, length) in crossings {
                let (cell, length) = (cell as usize, f64::from(length));
                gradient[cell] += slope * length;
                curvature[cell] += bend * length;
            }
        }
    }

    /// Sums the Fisher information of the absorption of each cell, at zero absorption, into the gradient.
    pub(super) fn inform(&mut self, model: &Model, cells: usize, half: Option<Half>) {
        self.begin(cells);
        let Self { lines, crossings, gradient, .. } = self;
        for (drawn, crossings) in each(lines, crossings, half) {
            let information = drawn.line.information(model);
            for &(cell, length) in crossings {
                gradient[cell as usize] += information * f64::from(length) * f64::from(length);
            }
        }
    }

    /// The gain in log-likelihood from the absorption of `cells`, for each line of one half.
    pub(super) fn gains(&self, model: &Model, cells: &[f64], half: Half) -> impl Iterator<Item = f64> {
        each(&self.lines, &self.crossings, Some(half)).map(|(drawn, crossings)| {
            let line = &drawn.line;
            line.log_likelihood(model, absorbed(cells, crossings)) - line.log_likelihood(model, 0.0)
        })
    }

    /// The evidence of each of `cells` cells.
    pub(super) fn evidence(&self, model: &Model, cells: usize) -> Vec<CellEvidence> {
        let mut evidence = vec![CellEvidence::default(); cells];
        for (drawn, crossings) in each(&self.lines, &self.crossings, None) {
            let information = drawn.line.information(model);
            for &(cell, length) in crossings {
                let length = f64::from(length);
                evidence[cell as usize].add(information * length * length, drawn.doubled);
            }
        }
        evidence
    }

    /// For each line of one half and each region that it crosses: the region, the node, and what the log-likelihood gains from
    /// the absorption of `cells` in the region, beside that of all others.
    pub(super) fn gains_of_regions(
        &self,
        model: &Model,
        cells: &[f64],
        region: &[Option<usize>],
        half: Half,
    ) -> Vec<(usize, u32, f64)> {
        let mut gains = Vec::new();
        let mut within: Vec<(usize, f64)> = Vec::new();
        for (drawn, crossings) in each(&self.lines, &self.crossings, Some(half)) {
            within.clear();
            for &(cell, length) in crossings {
                let Some(region) = region[cell as usize] else { continue };
                let loss = cells[cell as usize] * f64::from(length);
                match within.iter_mut().find(|(other, _)| *other == region) {
                    Some((_, sum)) => *sum += loss,
                    None => within.push((region, loss)),
                }
            }
            let all = absorbed(cells, crossings);
            let with = drawn.line.log_likelihood(model, all);
            let gain = |loss: f64| with - drawn.line.log_likelihood(model, (all - loss).max(0.0));
            gains.extend(within.iter().map(|&(region, loss)| (region, drawn.line.node, gain(loss))));
        }
        gains
    }

    fn begin(&mut self, cells: usize) {
        for sums in [&mut self.gradient, &mut self.curvature] {
            sums.clear();
            sums.resize(cells, 0.0);
        }
    }
}

/// The lines of one half, or of both, with their crossings.
fn each<'a>(
    lines: &'a [RecordedWorld],
    crossings: &'a [(u32, f32)],
    half: Option<Half>,
) -> impl Iterator<Item = (&'a RecordedWorld, &'a [(u32, f32)])> {
    let begins = std::iter::once(0).chain(lines.iter().map(|drawn| drawn.end));
    let all = lines.iter().zip(begins).map(|(drawn, begin)| (drawn, &crossings[begin..drawn.end]));
    all.filter(move |(drawn, _)| half.is_none_or(|half| half == drawn.line.half))
}

impl SightLine {
    fn probability(&self, model: &Model, absorbed: f64) -> f64 {
        (self.efficiency * model.normal().below(self.score - absorbed)).clamp(FLOOR, CEILING)
    }

    fn log_likelihood(&self, model: &Model, absorbed: f64) -> f64 {
        let p = self.probability(model, absorbed);
        self.received * ln(p) + self.missed * ln(1.0 - p)
    }

    /// Slope of the log-likelihood with absorption, and its negative curvature.
    fn derivatives(&self, model: &Model, absorbed: f64) -> (f64, f64) {
        let x = self.score - absorbed;
        let density = density(x);
        let ratio = density / model.normal().below(x).max(1e-9);
        let odds = self.efficiency * density / (1.0 - self.probability(model, absorbed));
        let slope = self.missed * odds - self.received * ratio;
        let bend = self.received * ratio * (ratio + x) + self.missed * odds * (odds - x);
        (slope, bend.max(LEAST_CURVATURE * (self.received + self.missed)))
    }

    /// Fisher information of the absorption at zero absorption.
    fn information(&self, model: &Model) -> f64 {
        let p = self.probability(model, 0.0);
        let slope = self.efficiency * density(self.score);
        (self.received + self.missed) * slope * slope / (p * (1.0 - p))
    }
}

fn absorbed(cells: &[f64], crossings: &[(u32, f32)]) -> f64 {
    crossings.iter().map(|&(cell, length)| cells[cell as usize] * f64::from(length)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_the_log_likelihood() {
        let model = Model::new(10.0, 1);
        for (received, missed) in [(1.0, 0.0), (0.0, 1.0), (3.0, 2.0)] {
            let line = SightLine { score: 0.8, efficiency: 0.9, received, missed, node: 0, half: Half::One };
            for absorbed in [0.0, 0.4, 1.5] {
                let h = 0.05;
                let [low, here, high] = [-h, 0.0, h].map(|h| line.log_likelihood(&model, absorbed + h));
                let (slope, bend) = line.derivatives(&model, absorbed);
                assert!((slope - (high - low) / (2.0 * h)).abs() < 0.01, "{received} of {absorbed}: {slope}");
                let expected = -(high - 2.0 * here + low) / (h * h);
                assert!((bend - expected).abs() < 0.05 || expected < LEAST_CURVATURE * (received + missed), "{bend}");
            }
        }
    }

    #[test]
    fn free_cells_do_not_count_and_halves_are_apart() {
        let model = Model::new(10.0, 1);
        let map = AbsorptionMap::new([0.0, 0.0], [3.9, 0.9], 1.0, 100.0);
        let is_free = [false, true, false, false];
        let mut lines = Lines::default();
        let ends = [Position::new(0.5, 0.5, 0.0), Position::new(2.5, 0.5, 0.0)];
        for half in [Half::One, Half::Other] {
            let missed = if half == Half::One { 1.0 } else { 0.0 };
            lines.draw(
                &map,
                &is_free,
                ends,
                SightLine { score: 1.0, efficiency: 1.0, received: 1.0 - missed, missed, node: 0, half },
            );
        }
        let cells = [1.0, 9.0, 1.0, 9.0];
        let gain = |half| lines.gains(&model, &cells, half).sum::<f64>();
        // The line crosses half a cell at each end, which absorb one standard deviation together: Φ(0) instead of
        // Φ(1).
        let passed = 0.841_344_746;
        assert!((gain(Half::One) - libm::log(0.5 / (1.0 - passed))).abs() < 1e-4);
        assert!((gain(Half::Other) - libm::log(0.5 / passed)).abs() < 1e-4);
        let region = [Some(0), None, Some(1), None];
        let found = lines.gains_of_regions(&model, &cells, &region, Half::One);
        assert_eq!(found.iter().map(|&(region, node, _)| (region, node)).collect::<Vec<_>>(), [(0, 0), (1, 0)]);
        // Without one of them half a standard deviation is left: a missed packet is likelier with it.
        assert!(found.iter().all(|&(_, _, gain)| (gain - libm::log(0.5 / (1.0 - 0.691_462_461))).abs() < 1e-4));
        lines.differentiate(&model, &cells, Some(Half::One));
        assert!(lines.gradient[0] > 0.0 && (lines.gradient[0] - lines.gradient[2]).abs() < 1e-12);
        assert!(lines.gradient[1].abs() < 1e-12 && lines.gradient[3].abs() < 1e-12);
        lines.differentiate(&model, &cells, Some(Half::Other));
        assert!(lines.gradient[0] < 0.0);
    }
}
