//! Cholesky's method on a small dense matrix, of which only the first columns are eliminated.

use nalgebra::DMatrix;

/// So many columns are eliminated at a time.
const PANEL: usize = 4;

/// Eliminates the first `pivots` columns of a symmetric matrix, of which the lower triangle is given: they become those of the factor,
/// and the rest of the triangle what is left. `None` if a pivot is not positive.
pub(super) fn eliminate(matrix: &mut DMatrix<f64>, pivots: usize) -> Option<()> {
    let size = matrix.nrows();
    let data = matrix.as_mut_slice();
    for first in (0..pivots).step_by(PANEL) {
        let end = pivots.min(first + PANEL);
        for pivot in first..end {
            let (before, column) = data.split_at_mut(pivot * size);
            let column = &mut column[pivot..size];
            for other in before.chunks_exact(size).skip(first) {
                take(column, other[pivot], &other[pivot..]);
            }
            let root = column[0].sqrt();
            // Also if it is not a number.
            if !(root > 0.0 && root.is_finite()) {
                return None;
            }
            column.iter_mut().for_each(|entry| *entry /= root);
        }
        let (panel, rest) = data.split_at_mut(end * size);
        let panel = &panel[first * size..];
        for (column, at) in rest.chunks_exact_mut(size).zip(end..) {
            let column = &mut column[at..];
            if end - first == PANEL {
                take_panel(column, panel, size, at);
            } else {
                panel.chunks_exact(size).for_each(|other| take(column, other[at], &other[at..]));
            }
        }
    }
    Some(())
}

/// Takes a multiple of a column off another one.
fn take(column: &mut [f64], times: f64, other: &[f64]) {
    column.iter_mut().zip(other).for_each(|(entry, other)| *entry -= times * other);
}

/// Takes multiples of the columns of a panel off a column, from its entry `at` on.
fn take_panel(column: &mut [f64], panel: &[f64], size: usize, at: usize) {
    let of = |number: usize| &panel[number * size + at..(number + 1) * size];
    let [a, b, c, d] = [of(0), of(1), of(2), of(3)];
    let times = [a[0], b[0], c[0], d[0]];
    for ((((entry, a), b), c), d) in column.iter_mut().zip(a).zip(b).zip(c).zip(d) {
        *entry -= (times[0] * a + times[1] * b) + (times[2] * c + times[3] * d);
    }
}
