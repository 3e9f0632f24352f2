//! Normal equations of a chain of states with a border: each state is tied to the next, and all of them to a few parameters.
//!
//! The states are eliminated one by one along the chain, so that the work grows with their number times the square of the border.

use nalgebra::{DMatrix, DVector, Dyn, Matrix4, OMatrix, U4, Vector4};

pub(super) type Side = OMatrix<f64, U4, Dyn>;

/// The slope of a sum and its curvature, by states and border.
#[derive(Clone, Debug)]
pub(super) struct ChainSystem {
    pub(super) states: Vec<Matrix4<f64>>,
    /// Between each state and the next.
    pub(super) next: Vec<Matrix4<f64>>,
    /// Between each state and the border.
    pub(super) sides: Vec<Side>,
    pub(super) slopes: Vec<Vector4<f64>>,
    pub(super) border: DMatrix<f64>,
    pub(super) border_slope: DVector<f64>,
}

/// A step of states and border.
#[derive(Clone, Debug)]
pub(super) struct ChainStep {
    pub(super) states: Vec<Vector4<f64>>,
    pub(super) border: DVector<f64>,
}

/// The system with its states eliminated.
pub(super) struct Eliminated {
    inverse: Vec<Matrix4<f64>>,
    next: Vec<Matrix4<f64>>,
    sides: Vec<Side>,
    slopes: Vec<Vector4<f64>>,
    border: nalgebra::Cholesky<f64, Dyn>,
    border_slope: DVector<f64>,
    /// Logarithm of the determinant of the whole curvature.
    pub(super) log_determinant: f64,
}

impl ChainSystem {
    /// Nothing yet, of so many states and a border of this width.
    pub(super) fn zeros(states: usize, border: usize) -> Self {
        Self {
            states: vec![Matrix4::zeros(); states],
            next: vec![Matrix4::zeros(); states.saturating_sub(1)],
            sides: vec![Side::zeros(border); states],
            slopes: vec![Vector4::zeros(); states],
            border: DMatrix::zeros(border, border),
            border_slope: DVector::zeros(border),
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
        for &(entry, by) in by_border {
            let mut column = self.sides[at].column_mut(entry);
            column += by_state * (by * weight);
            if let Some(by_next) = by_next {
                let mut column = self.sides[at + 1].column_mut(entry);
                column += by_next * (by * weight);
            }
            self.border_slope[entry] += by * slope;
            for &(other, by_other) in by_border {
                self.border[(entry, other)] += by * by_other * weight;
            }
        }
    }

    /// Eliminates the states, with the diagonals enlarged by `damping`; `None` if the curvature is not positive.
    pub(super) fn eliminated(&self, damping: f64) -> Option<Eliminated> {
        let damped = |mut block: Matrix4<f64>, of: &Matrix4<f64>| {
            for at in 0..4 {
                block[(at, at)] += damping * of[(at, at)] + 1e-12;
            }
            block
        };
        let width = self.border.nrows();
        let mut border = self.border.clone();
        for at in 0..width {
            border[(at, at)] += damping * self.border[(at, at)] + 1e-12;
        }
        let (mut sides, mut slopes) = (self.sides.clone(), self.slopes.clone());
        let mut border_slope = self.border_slope.clone();
        let mut inverses = Vec::with_capacity(self.states.len());
        let mut log_determinant = 0.0;
        let mut state = self.states.first().map(|first| damped(*first, first))?;
        for at in 0..self.states.len() {
            let factor = state.cholesky()?;
            log_determinant += 2.0 * factor.l().diagonal().map(libm::log).sum();
            let inverse = factor.inverse();
            let of_side = inverse * &sides[at];
            let of_slope = inverse * slopes[at];
            take_product(&mut border, &sides[at], &of_side);
            border_slope.gemv_tr(-1.0, &sides[at], &of_slope, 1.0);
            if let Some(next) = self.next.get(at) {
                let link = next.transpose();
                state = damped(self.states[at + 1], &self.states[at + 1]) - link * inverse * next;
                sides[at + 1] -= link * &of_side;
                slopes[at + 1] -= link * of_slope;
            }
            inverses.push(inverse);
        }
        let border = border.cholesky()?;
        log_determinant += 2.0 * border.l_dirty().diagonal().map(libm::log).sum();
        Some(Eliminated {
            inverse: inverses,
            next: self.next.clone(),
            sides,
            slopes,
            border,
            border_slope,
            log_determinant,
        })
    }
}

/// Takes `aᵀb`, which is symmetric, off the lower triangle of a matrix: the one that Cholesky's method reads.
fn take_product(from: &mut DMatrix<f64>, a: &Side, b: &Side) {
    let width = from.nrows();
    let columns = from.as_mut_slice().chunks_exact_mut(width).zip(b.as_slice().chunks_exact(4));
    for (at, (column, b)) in columns.enumerate() {
        for (entry, a) in column[at..].iter_mut().zip(a.as_slice()[4 * at..].chunks_exact(4)) {
            *entry -= a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
        }
    }
}

impl Eliminated {
    /// The step to the top of the parabola.
    pub(super) fn step(&self) -> ChainStep {
        let border = self.border.solve(&self.border_slope);
        let mut states = vec![Vector4::zeros(); self.inverse.len()];
        for at in (0..self.inverse.len()).rev() {
            let mut slope = self.slopes[at] - &self.sides[at] * &border;
            if let Some(next) = self.next.get(at) {
                slope -= next * states[at + 1];
            }
            states[at] = self.inverse[at] * slope;
        }
        ChainStep { states, border }
    }

    /// The covariance of each state, and of the border.
    pub(super) fn covariances(&self) -> (Vec<Matrix4<f64>>, DMatrix<f64>) {
        let border = self.border.inverse();
        let mut states = vec![Matrix4::zeros(); self.inverse.len()];
        let mut with_border: Side = Side::zeros(border.nrows());
        for at in (0..self.inverse.len()).rev() {
            let inverse = self.inverse[at];
            let side = &self.sides[at];
            // What the state takes from the next one and from the border, which vary together.
            let mut to_border: Side = side * &border;
            let mut own = side * &border * side.transpose();
            if let Some(next) = self.next.get(at) {
                let cross = next * &with_border * side.transpose();
                own += next * states[at + 1] * next.transpose() + cross + cross.transpose();
                to_border += next * &with_border;
            }
            states[at] = inverse + inverse * own * inverse;
            with_border = -(inverse * to_border);
        }
        (states, border)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_kernel::{Purpose, Seed};

    #[test]
    fn step_and_covariances_are_those_of_the_whole_matrix() {
        const STATES: usize = 5;
        const BORDER: usize = 3;
        let draw = |a: usize, b: usize| Seed(3).normal(Purpose::new(8), [a as u64, b as u64, 0]);
        let mut system = ChainSystem::zeros(STATES, BORDER);
        let size = 4 * STATES + BORDER;
        let (mut whole, mut slope) = (DMatrix::zeros(size, size), DVector::zeros(size));
        for residual in 0..80 {
            let at = residual % STATES;
            let vector = |shift: usize| Vector4::from_fn(|row, _| draw(residual, shift + row));
            let next = (at + 1 < STATES).then(|| vector(10));
            let by_border = [(residual % BORDER, draw(residual, 20)), ((residual + 1) % BORDER, draw(residual, 21))];
            let (weight, by) = (1.0 + draw(residual, 30).abs(), draw(residual, 31));
            system.add(at, vector(0), next, &by_border, weight, by);
            let mut row = DVector::zeros(size);
            row.rows_mut(4 * at, 4).copy_from(&vector(0));
            if let Some(next) = next {
                row.rows_mut(4 * at + 4, 4).copy_from(&next);
            }
            for (entry, value) in by_border {
                row[4 * STATES + entry] += value;
            }
            whole += &row * row.transpose() * weight;
            slope += row * by;
        }
        let eliminated = system.eliminated(0.0).unwrap();
        let inverse = whole.clone().try_inverse().unwrap();
        let expected = &inverse * slope;
        let step = eliminated.step();
        for (at, state) in step.states.iter().enumerate() {
            assert!((state - expected.rows(4 * at, 4)).norm() < 1e-7);
        }
        assert!((step.border - expected.rows(4 * STATES, BORDER)).norm() < 1e-7);
        assert!((eliminated.log_determinant - libm::log(whole.determinant())).abs() < 1e-7);
        let (states, border) = eliminated.covariances();
        for (at, state) in states.iter().enumerate() {
            assert!((state - inverse.view((4 * at, 4 * at), (4, 4))).norm() < 1e-7, "{at}");
        }
        assert!((border - inverse.view((4 * STATES, 4 * STATES), (BORDER, BORDER))).norm() < 1e-7);
    }
}
