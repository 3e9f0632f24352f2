//! The map of obstacles: absorption that explains which packets were lost along which lines.

use std::collections::BTreeMap;

use rayon::prelude::*;
use sextant_channel::ReceptionLog;
use sextant_kernel::{Interrupted, Seed, Watch};

use super::belief::PlaceBelief;
use super::counts::{Record, StopCounts};
use super::lines::{Half, Lines, SightLine};
use super::model::Model;
use super::settings::ObstacleKnowledge;
use crate::absorption::AbsorptionMap;
use crate::absorption::claims::{CellEvidence, ObstacleClaim, regions};
use crate::log_facts::reach::gap_m;
use crate::purpose;

/// Number of parts into which the lines are divided. It does not depend on the threads, so that sums have a fixed
/// order.
const PARTS: usize = 8;
/// Maximum number of crossings of lines and cells. If there would be more, a random sample of the lines is used.
const MOST_CROSSINGS: f64 = 5e6;
/// Maximum number of cells.
const MOST_CELLS: f64 = 2e5;
/// Lines shorter than this share of the range cross nothing that matters.
const SHORTEST: f64 = 0.03;
/// Lines within this share of the end of the curve may be too long to be received, rather than obstructed.
const MARGIN: f64 = 0.03;
/// The end of the curve for this purpose.
const FAINT: f64 = 0.02;
/// Highest absorption of a cell (standard deviations). Two such cells stop all packets of a clear link.
const OPAQUE: f64 = 4.0;
/// Least gain of an absorbing cell, in standard deviations of the gain by chance: the 95 % quantile of the normal
/// distribution.
const THRESHOLD: f64 = 1.645;
/// The penalty of a difference between neighbours, as a share of that of absorption.
const SMOOTHNESS: f64 = 0.25;
/// The penalty of differences below this is weaker (standard deviations).
const SOFT: f64 = 0.05;
/// Factor on the threshold of a cell where the robot met an obstacle.
const CONTACT: f64 = 0.2;
/// Drives longer than this many gaps between stops may not have been straight.
const STRAIGHT: f64 = 1.5;

/// What is divided into halves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Division {
    /// The lines.
    Lines,
    /// The nodes, each with all its lines: lines of a node may share what weakens them.
    Nodes,
}

/// Radio tomography by penalised maximum likelihood.
#[derive(Debug)]
pub(super) struct Tomography {
    pub(super) map: AbsorptionMap,
    /// Cells where no obstacle can be.
    is_free: Vec<bool>,
    /// Factor on the threshold of each cell.
    reluctance: Vec<f64>,
    threshold: Vec<f64>,
    parts: Vec<Lines>,
    next: Vec<f64>,
}

impl Tomography {
    /// Cells that cover the places of the nodes, which are known to about `slack_m`.
    pub(super) fn new(
        log: &ReceptionLog,
        nodes: &[PlaceBelief],
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
            parts: (0..PARTS).map(|_| Lines::default()).collect(),
            next: vec![0.0; cells],
            map,
        };
        if knowledge == ObstacleKnowledge::FromLog {
            tomography.learn(log);
        }
        tomography
    }

    /// Uses where the robot drove and which obstacles it met.
    fn learn(&mut self, log: &ReceptionLog) {
        let straight_m = STRAIGHT * gap_m(log).unwrap_or(0.0);
        for drive in log.drives().filter(|drive| drive.length_m() <= straight_m) {
            self.map.crossings(drive.from, drive.to, |cell, _, _| self.is_free[cell] = true);
        }
        for contact in log.contacts() {
            if let Some(cell) = self.map.cell(contact.position) {
                self.reluctance[cell] = CONTACT;
            }
        }
    }

    /// Selects the lines again, for the current places of the nodes, and divides them into halves: each line by itself, or each
    /// node with all its lines.
    pub(super) fn draw(
        &mut self,
        counts: &StopCounts<'_>,
        nodes: &[PlaceBelief],
        model: &Model,
        division: Division,
        watch: &dyn Watch,
    ) -> Result<(), Interrupted> {
        let Self { map, is_free, parts, .. } = self;
        let end_m = model.reach_m(FAINT);
        let reach_m = end_m * (1.0 - MARGIN);
        let share = share_of_lines(counts, nodes, reach_m, map.cell_m());
        let dealt = nodes.chunks(nodes.len().div_ceil(PARTS).max(1)).chain(std::iter::repeat(&[][..]));
        let work: Vec<(&mut Lines, &[PlaceBelief])> = parts.iter_mut().zip(dealt).collect();
        work.into_par_iter().try_for_each(|(lines, nodes)| {
            lines.clear();
            let mut record = Record::default();
            for belief in nodes {
                watch.check()?;
                let spread_m = belief.spread_m(0).max(belief.spread_m(1));
                let to_m = reach_m.min(end_m - spread_m);
                if to_m <= 0.0 {
                    continue;
                }
                let of_node = Seed(0).uniform(purpose::MAPPER, [u64::from(belief.node.0), u64::MAX, 0]);
                counts.read(belief.node, &mut record);
                counts.within(&record, belief.mean, to_m, |link| {
                    let distance_m = link.place.distance_m(belief.mean);
                    let lot = Seed(0).uniform(purpose::MAPPER, [u64::from(belief.node.0), u64::from(link.stop), 0]);
                    let is_silent = link.received == 0 && link.missed == 0;
                    if is_silent || !counts.tells(&link, belief.mean) || distance_m < SHORTEST * end_m || lot > share
                    {
                        return;
                    }
                    let is_first = match division {
                        Division::Lines => lot < 0.5 * share,
                        Division::Nodes => of_node < 0.5,
                    };
                    lines.draw(
                        map,
                        is_free,
                        [link.place, belief.mean],
                        SightLine {
                            score: model.score(distance_m),
                            efficiency: model.efficiency(link.stop as usize),
                            received: f64::from(link.received),
                            missed: f64::from(link.missed),
                            node: belief.node.0,
                            half: if is_first { Half::One } else { Half::Other },
                        },
                    );
                });
            }
            Ok(())
        })
    }

    /// Whether absorption estimated from half of the lines explains the other half better than no absorption, by more
    /// than three standard deviations of the difference. Resets all absorption.
    pub(super) fn is_warranted(
        &mut self,
        model: &Model,
        rounds: usize,
        watch: &dyn Watch,
    ) -> Result<bool, Interrupted> {
        let (mut sum, mut squares) = (0.0, 0.0);
        for (half, other) in [(Half::One, Half::Other), (Half::Other, Half::One)] {
            self.estimate(model, half, rounds, watch)?;
            for gain in self.parts.iter().flat_map(|part| part.gains(model, &self.map.cells, other)) {
                sum += gain;
                squares += gain * gain;
            }
        }
        self.map.cells.fill(0.0);
        Ok(sum > 3.0 * squares.sqrt())
    }

    /// The regions that absorb, with the evidence of each: absorption estimated from half of the nodes is tried on the other
    /// half. The lines must be divided by nodes. Leaves the absorption as it is.
    pub(super) fn claims(
        &mut self,
        model: &Model,
        rounds: usize,
        watch: &dyn Watch,
    ) -> Result<Vec<ObstacleClaim>, Interrupted> {
        let found = self.map.cells.clone();
        let of_parts: Vec<Vec<CellEvidence>> =
            self.parts.par_iter().map(|part| part.evidence(model, found.len())).collect();
        let evidence =
            |cell: usize| of_parts.iter().fold(CellEvidence::default(), |sum, part| sum.joined(&part[cell]));
        let evidence: Vec<CellEvidence> = (0..found.len()).map(evidence).collect();
        let [columns, _] = self.map.counts();
        let (region, count) = regions(&found, &evidence, columns);
        let mut gains: Vec<BTreeMap<u32, f64>> = vec![BTreeMap::new(); count];
        for (half, other) in [(Half::One, Half::Other), (Half::Other, Half::One)] {
            self.estimate(model, half, rounds, watch)?;
            for part in &self.parts {
                for (region, node, gain) in part.gains_of_regions(model, &self.map.cells, &region, other) {
                    *gains[region].entry(node).or_default() += gain;
                }
            }
        }
        self.map.cells = found;
        let mut cells: Vec<Vec<[usize; 2]>> = vec![Vec::new(); count];
        for (cell, region) in region.iter().enumerate() {
            if let Some(region) = region {
                cells[*region].push([cell % columns, cell / columns]);
            }
        }
        let claim = |(cells, gains): (Vec<[usize; 2]>, BTreeMap<u32, f64>)| {
            ObstacleClaim::new(cells, self.map.cell_m(), gains.into_values())
        };
        Ok(cells.into_iter().zip(gains).filter_map(claim).collect())
    }

    /// Estimates the absorption anew from one half of the lines.
    fn estimate(&mut self, model: &Model, half: Half, rounds: usize, watch: &dyn Watch) -> Result<(), Interrupted> {
        self.map.cells.fill(0.0);
        self.set_threshold(model, Some(half));
        for _ in 0..rounds {
            watch.check()?;
            self.step(model, Some(half));
        }
        Ok(())
    }

    /// Improves the absorption, starting from its current values.
    pub(super) fn improve(&mut self, model: &Model, rounds: usize, watch: &dyn Watch) -> Result<(), Interrupted> {
        self.set_threshold(model, None);
        for _ in 0..rounds {
            watch.check()?;
            self.step(model, None);
        }
        self.map.count();
        Ok(())
    }

    /// The threshold of a cell: [`THRESHOLD`] standard deviations of the gradient of the likelihood there without
    /// obstacles.
    fn set_threshold(&mut self, model: &Model, half: Option<Half>) {
        let cells = self.map.cells.len();
        self.parts.par_iter_mut().for_each(|part| part.inform(model, cells, half));
        for (cell, threshold) in self.threshold.iter_mut().enumerate() {
            let information: f64 = self.parts.iter().map(|part| part.gradient[cell]).sum();
            *threshold = THRESHOLD * self.reluctance[cell] * information.sqrt();
        }
    }

    /// One round of separable surrogates (De Pierro 1995; Erdogan and Fessler 1999): each cell moves to the optimum
    /// of its own parabola, all cells at the same time.
    fn step(&mut self, model: &Model, half: Option<Half>) {
        let cells = &self.map.cells;
        self.parts.par_iter_mut().for_each(|part| part.differentiate(model, cells, half));
        let [columns, rows] = self.map.counts();
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
                let weight = SMOOTHNESS * 0.5 * (threshold + self.threshold[neighbour])
                    / (difference * difference + SOFT * SOFT).sqrt();
                gradient -= weight * difference;
                curvature += 2.0 * weight;
            }
            self.next[cell] = (here + gradient / curvature).clamp(0.0, OPAQUE);
        }
        std::mem::swap(&mut self.map.cells, &mut self.next);
    }
}

/// The share of the lines that is used, as so many in one.
fn share_of_lines(counts: &StopCounts<'_>, nodes: &[PlaceBelief], reach_m: f64, cell_m: f64) -> f64 {
    let mut lines = 0.0;
    // A sample is enough for an estimate.
    let every = nodes.len().div_ceil(1000).max(1);
    for belief in nodes.iter().step_by(every) {
        counts.within(&Record::default(), belief.mean, reach_m, |_| lines += 1.0);
    }
    let crossings = lines * every as f64 * reach_m / cell_m;
    (MOST_CROSSINGS / crossings.max(1.0)).min(1.0)
}
