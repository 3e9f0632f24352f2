//! Where a node may be: the cells of its box that hold the probability, halved where it is.

use sextant_channel::Position;

use super::evidence::{PatternEvidence, PatternLikelihood};
use crate::log_facts::SoughtHeights;
use crate::log_facts::search_box::SearchBox;
use crate::numerics::whole;
use crate::posterior::Verdict;

/// Cells along the longest side of a box, in the plane and in space.
const FIRST: [f64; 2] = [20.0, 10.0];
/// Cells this far below the likeliest are not halved: while the likelihood is blurred, and when it is not.
const KEPT: [f64; 2] = [9.0, 8.0];
/// No more cells than this are halved at a time.
const MOST: usize = 400;
/// Cells are small enough at this share of the spread of the posterior.
const FINE: f64 = 0.5;
/// Times that cells are halved, at most.
const HALVINGS: u32 = 12;

/// Steps of the search for the likeliest place, each shorter than the one before.
const REFINED: u32 = 10;

/// A cell with the log-likelihood at its middle.
#[derive(Clone, Copy, Debug)]
pub(super) struct WeighedCell {
    pub(super) position: Position,
    pub(super) value: f64,
}

/// The posterior of a node.
#[derive(Clone, Debug)]
pub(super) struct CellPosterior {
    /// With probabilities that sum to 1.
    pub(super) places: Vec<(Position, f64)>,
    pub(super) likeliest: (Position, f64),
    /// The logarithm of the mean likelihood over the box.
    pub(super) ln_evidence: f64,
    pub(super) verdict: Verdict,
    /// How far below the highest the highest log-likelihood at a guessed end of the box is.
    pub(super) edge_below: f64,
    pub(super) step_m: f64,
    pub(super) evaluated: u64,
}

/// How closely places are looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Look {
    /// The first cells alone.
    Rough,
    /// Cells are halved to the end.
    Whole,
}

/// At how many places the likelihood of a node is computed, at most.
pub(super) fn most_evaluations(heights: SoughtHeights) -> f64 {
    let [level, space] = FIRST;
    let (first, parts) =
        if heights.high_m <= heights.low_m { (level * level, 4.0) } else { (space * space * space, 8.0) };
    first + f64::from(HALVINGS) * parts * MOST as f64
}

/// The posterior of a node in a box, in cells of at most `step_m` where it is not wide. `likelihood` is that for cells of a
/// width (m), blurred by as much as the cells are wide.
pub(super) fn find<'a>(
    likelihood: &impl Fn(f64) -> PatternLikelihood<'a>,
    evidence: &PatternEvidence,
    within: &SearchBox,
    step_m: f64,
    look: Look,
) -> Option<CellPosterior> {
    let sides = [0, 1, 2].map(|axis| (within.high[axis] - within.low[axis]).max(0.0));
    let is_level = within.is_level();
    let longest = sides.iter().copied().fold(0.0, f64::max);
    let mut steps = (longest / FIRST[usize::from(!is_level)]).max(step_m);
    let mut counts = [1_usize; 3];
    for axis in 0..if is_level { 2 } else { 3 } {
        counts[axis] = whole((sides[axis] / steps).ceil()).max(1);
    }
    let mut evaluated = 0;
    let mut cells: Vec<WeighedCell> = Vec::new();
    let centre = within.middle();
    let mut of_step = likelihood(steps);
    let mut value = |likelihood: &PatternLikelihood<'_>, position: Position| {
        evaluated += 1;
        WeighedCell { position, value: likelihood.at(evidence, position) }
    };
    for k in 0..counts[2] {
        for j in 0..counts[1] {
            for i in 0..counts[0] {
                let offset = |at: usize, axis: usize| (at as f64 + 0.5 - 0.5 * counts[axis] as f64) * steps;
                let position = centre + Position::new(offset(i, 0), offset(j, 1), offset(k, 2));
                cells.push(value(&of_step, position));
            }
        }
    }
    let all = cells.len() as f64;
    let mut shrinks = 1.0;
    let mut is_wide = false;
    let halvings = if look == Look::Rough { 0 } else { HALVINGS };
    for _ in 0..halvings {
        let highest = cells.iter().map(|cell| cell.value).fold(f64::NEG_INFINITY, f64::max);
        if !highest.is_finite() {
            return None;
        }
        cells.retain(|cell| cell.value >= highest - KEPT[usize::from(of_step.is_sharp())]);
        let is_fine = steps <= step_m && steps <= FINE * spread_m(&cells, highest, if is_level { 2.0 } else { 3.0 });
        if of_step.is_sharp() && (is_fine || cells.len() > MOST) {
            break;
        }
        if is_fine {
            // Smaller cells change nothing, but a sharper likelihood may.
            is_wide = true;
            of_step = likelihood(0.0);
            cells.iter_mut().for_each(|cell| *cell = value(&of_step, cell.position));
            continue;
        }
        if cells.len() > MOST {
            cells.sort_by(|a, b| b.value.total_cmp(&a.value));
            cells.truncate(MOST);
        }
        steps *= 0.5;
        of_step = likelihood(if is_wide { 0.0 } else { steps });
        shrinks *= if is_level { 0.25 } else { 0.125 };
        let quarter = 0.5 * steps;
        let signs = [-quarter, quarter];
        let ups = if is_level { &[0.0][..] } else { &signs[..] };
        let mut next = Vec::with_capacity(cells.len() * 8);
        for cell in &cells {
            for &up in ups {
                for north in signs {
                    for east in signs {
                        next.push(value(&of_step, cell.position + Position::new(east, north, up)));
                    }
                }
            }
        }
        cells = next;
    }
    posterior(&cells, within, all / shrinks, steps, evaluated)
}

/// The mean standard deviation along the axes (m).
fn spread_m(cells: &[WeighedCell], highest: f64, axes: f64) -> f64 {
    let (mut weight, mut sum) = (0.0, Position::ORIGIN);
    for cell in cells {
        let likelihood = libm::exp(cell.value - highest);
        weight += likelihood;
        sum = sum + cell.position * likelihood;
    }
    let mean = sum * (1.0 / weight);
    let square: f64 = cells
        .iter()
        .map(|cell| {
            let off = cell.position - mean;
            libm::exp(cell.value - highest) * off.dot(off)
        })
        .sum();
    (square / weight / axes).sqrt()
}

fn posterior(
    cells: &[WeighedCell],
    within: &SearchBox,
    all: f64,
    step_m: f64,
    evaluated: u64,
) -> Option<CellPosterior> {
    let mut verdict = Verdict::default();
    let mut likeliest = (Position::ORIGIN, f64::NEG_INFINITY);
    let mut edge = f64::NEG_INFINITY;
    for cell in cells {
        verdict.take(cell.value);
        if cell.value > likeliest.1 {
            likeliest = (cell.position, cell.value);
        }
        if within.is_at_edge(cell.position, step_m) {
            edge = edge.max(cell.value);
        }
    }
    let highest = likeliest.1;
    if !highest.is_finite() {
        return None;
    }
    let sum: f64 = cells.iter().map(|cell| libm::exp(cell.value - highest)).sum();
    let places = cells.iter().map(|cell| (cell.position, libm::exp(cell.value - highest) / sum)).collect();
    Some(CellPosterior {
        places,
        likeliest,
        ln_evidence: highest + libm::log(sum / all),
        verdict: verdict.among(all),
        edge_below: highest - edge,
        step_m,
        evaluated,
    })
}

impl CellPosterior {
    /// The mean place (m).
    pub(super) fn mean(&self) -> Position {
        self.places.iter().fold(Position::ORIGIN, |sum, &(place, probability)| sum + place * probability)
    }

    /// The likeliest place, closer than the cells are wide.
    pub(super) fn refined(&self, likelihood: &PatternLikelihood<'_>, evidence: &PatternEvidence) -> Position {
        let mut best = (self.likeliest.0, likelihood.at(evidence, self.likeliest.0));
        let mut step_m = 0.5 * self.step_m;
        for _ in 0..REFINED {
            let middle = best.0;
            for (east, north) in [(step_m, 0.0), (-step_m, 0.0), (0.0, step_m), (0.0, -step_m)] {
                let place = middle + Position::new(east, north, 0.0);
                let value = likelihood.at(evidence, place);
                if value > best.1 {
                    best = (place, value);
                }
            }
            step_m *= 0.6;
        }
        best.0
    }

    /// A few places that stand for all, each with the same probability.
    pub(super) fn sample(&self, count: usize) -> Vec<Position> {
        let mut sample = Vec::with_capacity(count);
        let mut below = 0.0;
        for &(place, probability) in &self.places {
            below += probability;
            while sample.len() < count && (sample.len() as f64 + 0.5) / count as f64 <= below {
                sample.push(place);
            }
        }
        sample
    }
}
