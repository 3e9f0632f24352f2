//! Cholesky's factor of a chain with a border, as a tree of fronts.

use std::ops::Range;

use nalgebra::{DMatrix, Matrix4};

use super::ChainSystem;
use super::front::eliminate;

/// So many states are eliminated at once.
const FEW: usize = 4;
/// Parts with more states are shared among threads.
const MANY: usize = 256;

/// Cholesky's factor of the curvature.
pub(in crate::joint_path) struct Factor {
    root: Front,
    states: usize,
    /// Logarithm of the determinant of the curvature.
    pub(in crate::joint_path) log_determinant: f64,
}

/// A part of the chain, eliminated.
struct Front {
    /// Where its unknowns stand: those that it eliminates, and then those that it is tied to. Both are sorted.
    unknowns: Vec<usize>,
    /// How many of them it eliminates.
    pivots: usize,
    /// Their columns of the factor.
    columns: DMatrix<f64>,
    /// Its two halves, which were eliminated before.
    halves: Vec<Front>,
}

impl Factor {
    pub(super) fn of(system: &ChainSystem, damping: f64) -> Option<Self> {
        let dissection = Dissection { system, damping, touched: touched(system) };
        let (root, _) = dissection.eliminated(0..system.states.len(), true)?;
        let mut factor = Self { root, states: system.states.len(), log_determinant: 0.0 };
        factor.log_determinant = 2.0 * factor.root.log_of_pivots();
        Some(factor)
    }

    /// Solves for the right side, of states and then border, in place.
    pub(super) fn solve(&self, side: &mut [f64]) {
        self.root.forward(side);
        self.root.backward(side);
    }

    /// The covariance of each state.
    pub(in crate::joint_path) fn covariances(&self) -> Vec<Matrix4<f64>> {
        let mut states = vec![Matrix4::zeros(); self.states];
        self.root.spread(&DMatrix::zeros(0, 0), &mut states);
        states
    }

    /// The covariance of two entries of the border.
    pub(in crate::joint_path) fn covariance_of_border(&self, entry: usize, other: usize) -> f64 {
        let mut side = vec![0.0; self.root.count()];
        side[4 * self.states + entry] = 1.0;
        self.solve(&mut side);
        side[4 * self.states + other]
    }
}

/// The first and the last state that touches each entry of the border.
fn touched(system: &ChainSystem) -> Vec<(usize, usize)> {
    let mut touched = vec![(usize::MAX, 0); system.border.len()];
    for (state, side) in system.sides.iter().enumerate() {
        for &(entry, _) in side {
            touched[entry] = (touched[entry].0.min(state), state);
        }
    }
    touched
}

/// A system that is taken apart.
struct Dissection<'a> {
    system: &'a ChainSystem,
    damping: f64,
    touched: Vec<(usize, usize)>,
}

impl Dissection<'_> {
    /// Eliminates the states of a part, and the entries of the border that nothing else touches; with what is left between the
    /// unknowns that it is tied to.
    fn eliminated(&self, part: Range<usize>, is_whole: bool) -> Option<(Front, DMatrix<f64>)> {
        let (own, halves) = if part.len() <= FEW {
            (part.clone(), Vec::new())
        } else {
            let middle = part.start + part.len() / 2;
            let (before, after) = (part.start..middle, middle + 1..part.end);
            let (before, after) = if part.len() > MANY {
                rayon::join(|| self.eliminated(before, false), || self.eliminated(after, false))
            } else {
                (self.eliminated(before, false), self.eliminated(after, false))
            };
            (middle..middle + 1, vec![before?, after?])
        };
        let (unknowns, pivots) = self.unknowns(&part, &own, &halves, is_whole);
        let at = |unknown: usize| {
            let (own, tied) = unknowns.split_at(pivots);
            own.binary_search(&unknown).or_else(|_| tied.binary_search(&unknown).map(|at| pivots + at)).ok()
        };
        let mut matrix = DMatrix::zeros(unknowns.len(), unknowns.len());
        for (half, left) in &halves {
            let places: Vec<usize> = half.tied().iter().map(|&unknown| at(unknown).expect("a tie is kept")).collect();
            for (column, &to) in places.iter().enumerate() {
                for (row, &from) in places.iter().enumerate().skip(column) {
                    matrix[(from.max(to), from.min(to))] += left[(row, column)];
                }
            }
        }
        let (part, is_end) = (part, halves.is_empty());
        self.add_states(&mut matrix, &own, if is_end { Some(&part) } else { None }, at);
        self.add_border(&mut matrix, &unknowns, pivots, at);
        eliminate(&mut matrix, pivots)?;
        let tied = unknowns.len() - pivots;
        let left = matrix.view((pivots, pivots), (tied, tied)).into_owned();
        let columns = matrix.columns(0, pivots).into_owned();
        let halves = halves.into_iter().map(|(half, _)| half).collect();
        Some((Front { unknowns, pivots, columns, halves }, left))
    }

    /// Where the unknowns of a part stand, and how many of them it eliminates.
    fn unknowns(
        &self,
        part: &Range<usize>,
        own: &Range<usize>,
        halves: &[(Front, DMatrix<f64>)],
        is_whole: bool,
    ) -> (Vec<usize>, usize) {
        let states = self.system.states.len();
        let mut found: Vec<usize> = halves.iter().flat_map(|(half, _)| half.tied()).copied().collect();
        found.extend(4 * own.start..4 * own.end);
        if halves.is_empty() {
            found.extend(4 * part.start.saturating_sub(1)..4 * part.start);
            found.extend(4 * part.end..4 * states.min(part.end + 1));
        }
        let sides = self.system.sides[own.clone()].iter().flatten();
        found.extend(sides.map(|&(entry, _)| 4 * states + entry));
        if is_whole {
            let untouched = self.touched.iter().enumerate().filter(|(_, (first, _))| *first == usize::MAX);
            found.extend(untouched.map(|(entry, _)| 4 * states + entry));
        }
        found.sort();
        found.dedup();
        let is_pivot = |&unknown: &usize| match unknown.checked_sub(4 * states) {
            None => own.contains(&(unknown / 4)),
            Some(entry) => is_whole || (part.start <= self.touched[entry].0 && self.touched[entry].1 < part.end),
        };
        let (mut unknowns, tied): (Vec<usize>, Vec<usize>) = found.into_iter().partition(is_pivot);
        let pivots = unknowns.len();
        unknowns.extend(tied);
        (unknowns, pivots)
    }

    /// Adds the curvature of states, of them and the border, and, of a part that is not halved, of them and their neighbours.
    fn add_states(
        &self,
        matrix: &mut DMatrix<f64>,
        own: &Range<usize>,
        end: Option<&Range<usize>>,
        at: impl Fn(usize) -> Option<usize>,
    ) {
        let system = self.system;
        for state in own.clone() {
            let place = 4 * (state - own.start);
            for column in 0..4 {
                for row in column..4 {
                    matrix[(place + row, place + column)] += system.states[state][(row, column)];
                }
                matrix[(place + column, place + column)] +=
                    self.damping * system.states[state][(column, column)] + 1e-12;
            }
            for &(entry, by) in &system.sides[state] {
                let row = at(4 * system.states.len() + entry).expect("an entry that is touched");
                (0..4).for_each(|column| matrix[(row, place + column)] += by[column]);
            }
        }
        let Some(part) = end else { return };
        for state in part.start.saturating_sub(1)..part.end.min(system.next.len()) {
            let [from, to] = [state, state + 1].map(|state| at(4 * state).expect("a state or a neighbour"));
            for row in 0..4 {
                for column in 0..4 {
                    let (one, other) = (from + row, to + column);
                    matrix[(one.max(other), one.min(other))] += system.next[state][(row, column)];
                }
            }
        }
    }

    /// Adds the curvature of the entries of the border that are eliminated here: among them, and with those that stay.
    fn add_border(
        &self,
        matrix: &mut DMatrix<f64>,
        unknowns: &[usize],
        pivots: usize,
        at: impl Fn(usize) -> Option<usize>,
    ) {
        let first = 4 * self.system.states.len();
        let is_any = unknowns[..pivots].iter().any(|&unknown| unknown >= first);
        let entries = unknowns.iter().enumerate().filter(|(_, unknown)| **unknown >= first && is_any);
        for (place, &unknown) in entries {
            for &(entry, value) in &self.system.border[unknown - first] {
                let Some(other) = at(first + entry) else { continue };
                if place >= pivots && other >= pivots {
                    continue;
                }
                let damping = if place == other { self.damping * value + 1e-12 } else { 0.0 };
                matrix[(place.max(other), place.min(other))] += value + damping;
            }
        }
    }
}

impl Front {
    fn tied(&self) -> &[usize] {
        &self.unknowns[self.pivots..]
    }

    /// How many unknowns it and its halves eliminate.
    fn count(&self) -> usize {
        self.pivots + self.halves.iter().map(Self::count).sum::<usize>()
    }

    /// The sum of the logarithms of its pivots.
    fn log_of_pivots(&self) -> f64 {
        let own: f64 = (0..self.pivots).map(|pivot| libm::log(self.columns[(pivot, pivot)])).sum();
        own + self.halves.iter().map(Self::log_of_pivots).sum::<f64>()
    }

    fn forward(&self, side: &mut [f64]) {
        self.halves.iter().for_each(|half| half.forward(side));
        for (pivot, column) in self.columns.column_iter().enumerate() {
            let value = side[self.unknowns[pivot]] / column[pivot];
            side[self.unknowns[pivot]] = value;
            for (&unknown, by) in self.unknowns.iter().zip(column.iter()).skip(pivot + 1) {
                side[unknown] -= by * value;
            }
        }
    }

    fn backward(&self, side: &mut [f64]) {
        for (pivot, column) in self.columns.column_iter().enumerate().rev() {
            let others = self.unknowns.iter().zip(column.iter()).skip(pivot + 1);
            let known: f64 = others.map(|(&unknown, by)| by * side[unknown]).sum();
            side[self.unknowns[pivot]] = (side[self.unknowns[pivot]] - known) / column[pivot];
        }
        self.halves.iter().for_each(|half| half.backward(side));
    }

    /// Writes the covariances of its states, from the covariance of the unknowns that it is tied to.
    fn spread(&self, tied: &DMatrix<f64>, states: &mut [Matrix4<f64>]) {
        let (pivots, size) = (self.pivots, self.unknowns.len());
        let factor = self.columns.rows(0, pivots);
        // The inverse of the factor, and how the tied unknowns move those that are eliminated.
        let inverse = factor.solve_lower_triangular(&DMatrix::identity(pivots, pivots)).expect("pivots are positive");
        let moves = self.columns.rows(pivots, size - pivots) * &inverse;
        let mixed = -(tied * &moves);
        let own = inverse.tr_mul(&inverse) - moves.tr_mul(&mixed);
        let mut joint = DMatrix::zeros(size, size);
        joint.view_mut((0, 0), (pivots, pivots)).copy_from(&own);
        joint.view_mut((pivots, 0), (size - pivots, pivots)).copy_from(&mixed);
        joint.view_mut((0, pivots), (pivots, size - pivots)).copy_from(&mixed.transpose());
        joint.view_mut((pivots, pivots), (size - pivots, size - pivots)).copy_from(tied);
        let of_states = 4 * states.len();
        let own_states = self.unknowns[..pivots].iter().take_while(|&&unknown| unknown < of_states);
        for (number, unknown) in own_states.step_by(4).enumerate() {
            states[unknown / 4] = joint.fixed_view::<4, 4>(4 * number, 4 * number).into_owned();
        }
        for half in &self.halves {
            let (own, kept) = self.unknowns.split_at(pivots);
            let at = |unknown: &usize| {
                own.binary_search(unknown)
                    .unwrap_or_else(|_| pivots + kept.binary_search(unknown).unwrap_or_default())
            };
            let places: Vec<usize> = half.tied().iter().map(at).collect();
            let of_half =
                DMatrix::from_fn(places.len(), places.len(), |row, column| joint[(places[row], places[column])]);
            half.spread(&of_half, states);
        }
    }
}
