//! Normal equations of a chain of states with a border: each state is tied to the next, and to a few of the parameters of the border.
//!
//! They are solved by Cholesky's method with nested dissection (George, "Nested dissection of a regular finite element mesh", 1973) and
//! fronts (Duff and Reid, "The multifrontal solution of indefinite sparse symmetric linear equations", 1983): the state in the middle
//! parts the chain, and an entry of the border goes with the shortest part that holds all the states which it touches. The work grows
//! with the states and with the square of what a part shares with the rest, not with the square of the border.

mod factor;
mod front;

use nalgebra::{DVector, Matrix4, Vector4};

pub(super) use self::factor::Factor;

/// The slope of a sum and its curvature, by states and border. Entries of the border are coupled only if one state touches both.
#[derive(Clone, Debug)]
pub(super) struct ChainSystem {
    pub(super) states: Vec<Matrix4<f64>>,
    pub(super) slopes: Vec<Vector4<f64>>,
    pub(super) border_slope: DVector<f64>,
    /// Between each state and the next.
    next: Vec<Matrix4<f64>>,
    /// Between each state and the entries of the border that it touches.
    sides: Vec<Vec<(usize, Vector4<f64>)>>,
    /// Between each entry of the border and itself and those after it.
    border: Vec<Vec<(usize, f64)>>,
}

/// A step of states and border.
#[derive(Clone, Debug)]
pub(super) struct ChainStep {
    pub(super) states: Vec<Vector4<f64>>,
    pub(super) border: DVector<f64>,
}

/// The place of an entry in a row, which has it from now on.
fn place_in<T: Default>(row: &mut Vec<(usize, T)>, entry: usize) -> &mut T {
    let at = row.iter().position(|(other, _)| *other == entry).unwrap_or_else(|| {
        row.push((entry, T::default()));
        row.len() - 1
    });
    &mut row[at].1
}

impl ChainSystem {
    /// Nothing yet, of so many states and a border of this width.
    pub(super) fn zeros(states: usize, border: usize) -> Self {
        Self {
            states: vec![Matrix4::zeros(); states],
            slopes: vec![Vector4::zeros(); states],
            border_slope: DVector::zeros(border),
            next: vec![Matrix4::zeros(); states.saturating_sub(1)],
            sides: vec![Vec::new(); states],
            border: vec![Vec::new(); border],
        }
    }

    /// Adds a residual of which `weight` is the curvature and `slope` the derivative of the log-posterior: derivatives by the state
    /// `at`, by the next one if it depends on that, and by entries of the border.
    pub(super) fn add(
        &mut self,
        at: usize,
        by_state: Vector4<f64>,
        by_next: Option<Vector4<f64>>,
        by_border: &[(usize, f64)],
        weight: f64,
        slope: f64,
    ) {
        self.states[at] += by_state * by_state.transpose() * weight;
        self.slopes[at] += by_state * slope;
        if let Some(by_next) = by_next {
            self.states[at + 1] += by_next * by_next.transpose() * weight;
            self.slopes[at + 1] += by_next * slope;
            self.next[at] += by_state * by_next.transpose() * weight;
        }
        for (number, &(entry, by)) in by_border.iter().enumerate() {
            self.add_to_side(at, entry, by_state * (by * weight));
            if let Some(by_next) = by_next {
                self.add_to_side(at + 1, entry, by_next * (by * weight));
            }
            self.border_slope[entry] += by * slope;
            for &(other, by_other) in &by_border[number..] {
                self.add_to_border(entry, other, by * by_other * weight);
            }
        }
    }

    /// Adds to the curvature between a state and an entry of the border.
    pub(super) fn add_to_side(&mut self, state: usize, entry: usize, by: Vector4<f64>) {
        *place_in(&mut self.sides[state], entry) += by;
    }

    /// Adds to the curvature between two entries of the border, which are touched by one state unless they are the same.
    pub(super) fn add_to_border(&mut self, entry: usize, other: usize, by: f64) {
        *place_in(&mut self.border[entry.min(other)], entry.max(other)) += by;
    }

    /// The curvature between two entries of the border.
    pub(super) fn between(&self, entry: usize, other: usize) -> f64 {
        let row = &self.border[entry.min(other)];
        row.iter().find(|(of, _)| *of == entry.max(other)).map_or(0.0, |&(_, value)| value)
    }

    /// Cholesky's factor, with the diagonal enlarged by `damping`; `None` if the curvature is not positive.
    pub(super) fn factor(&self, damping: f64) -> Option<Factor> {
        Factor::of(self, damping)
    }

    /// The step to the top of the parabola.
    pub(super) fn step(&self, factor: &Factor) -> ChainStep {
        let slopes = self.slopes.iter().flat_map(|slope| slope.iter()).chain(self.border_slope.iter());
        let mut step: Vec<f64> = slopes.copied().collect();
        factor.solve(&mut step);
        let (states, border) = step.split_at(4 * self.states.len());
        ChainStep {
            states: states.chunks_exact(4).map(Vector4::from_column_slice).collect(),
            border: DVector::from_column_slice(border),
        }
    }
}

#[cfg(test)]
mod tests;
