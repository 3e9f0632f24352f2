//! Matrices `s A + t I` with one symmetric A and many s and t.
//!
//! A becomes tridiagonal once, by reflections (Golub and Van Loan 2013, algorithm 8.3.1), and the right sides with it. Each of the
//! matrices is then solved in a time that is linear in its size.

use super::with_widest_vectors;

/// Right sides that are solved at a time.
const LANES: usize = 8;
/// A column whose squares below the entry beside the diagonal sum to less than this needs no reflection.
const NOTHING: f64 = 1e-280;

/// The matrices `s A + t I` of a symmetric A, and right sides.
#[derive(Clone, Debug)]
pub struct ShiftedMatrices {
    diagonal: Vec<f64>,
    beside: Vec<f64>,
    /// The right sides in the basis in which A is tridiagonal, row by row; rows are filled with zeros.
    sides: Vec<f64>,
    /// Length of a row.
    width: usize,
    count: usize,
}

/// What right sides are under the inverse of a matrix.
#[derive(Clone, Debug, PartialEq)]
pub struct InverseProducts<const FIRST: usize> {
    /// The logarithm of the determinant of the matrix M.
    pub ln_determinant: f64,
    /// bᵀ M⁻¹ b of each side b.
    pub squares: Vec<f64>,
    /// bᵀ M⁻¹ f of each side b, with each of the first sides f.
    pub with_first: [Vec<f64>; FIRST],
}

impl ShiftedMatrices {
    /// Those of the symmetric matrix of these `columns`, `size` of them after each other, with right sides of `size` numbers each.
    ///
    /// # Panics
    /// If `columns` are not `size` times `size` numbers, or the right sides not a multiple of `size`.
    #[must_use]
    pub fn new(mut columns: Vec<f64>, size: usize, right_sides: &[f64]) -> Self {
        assert_eq!(columns.len(), size * size, "a matrix of {size} columns");
        let count = right_sides.len().checked_div(size).unwrap_or(0);
        assert_eq!(right_sides.len(), count * size, "right sides of {size} numbers");
        let width = count.next_multiple_of(LANES);
        let mut sides = vec![0.0; size * width];
        for (number, side) in right_sides.chunks_exact(size.max(1)).enumerate() {
            side.iter().enumerate().for_each(|(row, value)| sides[row * width + number] = *value);
        }
        let beside = with_widest_vectors(
            #[inline(always)]
            || reflect(&mut columns, size, &mut sides, width),
        );
        let diagonal = (0..size).map(|at| columns[at * size + at]).collect();
        Self { diagonal, beside, sides, width, count }
    }

    /// The products of the right sides under the inverse of `scale` A + `shift` I. `None` if that is not positive definite.
    ///
    /// # Panics
    /// If there are fewer than `FIRST` sides.
    #[must_use]
    pub fn products<const FIRST: usize>(&self, scale: f64, shift: f64) -> Option<InverseProducts<FIRST>> {
        assert!(FIRST <= self.count, "{FIRST} of {} right sides", self.count);
        // L D Lᵀ: the pivots of D, one over each, and what is beside the diagonal of L before each row.
        let mut rows: Vec<Row<FIRST>> = Vec::with_capacity(self.diagonal.len());
        let (mut ln_determinant, mut before) = (0.0, 0.0);
        for (at, diagonal) in self.diagonal.iter().enumerate() {
            let beside = if at > 0 { scale * self.beside[at - 1] } else { 0.0 };
            let factor = beside * before;
            let pivot = scale * diagonal + shift - factor * beside;
            if pivot.is_nan() || pivot <= 0.0 {
                return None;
            }
            before = 1.0 / pivot;
            ln_determinant += libm::log(pivot);
            let own = &self.sides[at * self.width..][..FIRST];
            let last = rows.last().map_or([0.0; FIRST], |row| row.first);
            let first = std::array::from_fn(|side| own[side] - factor * last[side]);
            rows.push(Row { factor, inverse: before, first });
        }
        let mut products = InverseProducts {
            ln_determinant,
            squares: vec![0.0; self.width],
            with_first: std::array::from_fn(|_| vec![0.0; self.width]),
        };
        with_widest_vectors(
            #[inline(always)]
            || self.sum(&rows, &mut products),
        );
        products.squares.truncate(self.count);
        products.with_first.iter_mut().for_each(|with| with.truncate(self.count));
        Some(products)
    }

    #[inline(always)]
    fn sum<const FIRST: usize>(&self, rows: &[Row<FIRST>], products: &mut InverseProducts<FIRST>) {
        for begin in (0..self.width).step_by(LANES) {
            let (mut solved, mut squares, mut with) = ([0.0; LANES], [0.0; LANES], [[0.0; LANES]; FIRST]);
            for (row, sides) in rows.iter().zip(self.sides.chunks_exact(self.width)) {
                let sides = &sides[begin..begin + LANES];
                for lane in 0..LANES {
                    solved[lane] = sides[lane] - row.factor * solved[lane];
                    let scaled = solved[lane] * row.inverse;
                    squares[lane] += scaled * solved[lane];
                    for (with, first) in with.iter_mut().zip(row.first) {
                        with[lane] += scaled * first;
                    }
                }
            }
            products.squares[begin..begin + LANES].copy_from_slice(&squares);
            for (all, with) in products.with_first.iter_mut().zip(with) {
                all[begin..begin + LANES].copy_from_slice(&with);
            }
        }
    }
}

/// A row of the factors, and the first sides solved there.
struct Row<const FIRST: usize> {
    factor: f64,
    inverse: f64,
    first: [f64; FIRST],
}

/// Makes a symmetric matrix tridiagonal, and reflects the rows of right sides with it. Returns what is then beside the diagonal,
/// which is in its place.
#[inline(always)]
fn reflect(columns: &mut [f64], size: usize, sides: &mut [f64], width: usize) -> Vec<f64> {
    let mut beside = Vec::with_capacity(size);
    let (mut way, mut product, mut along) = (Vec::new(), vec![0.0; size], vec![0.0; width]);
    for k in 1..size {
        let (done, rest) = columns.split_at_mut(k * size);
        way.clear();
        way.extend_from_slice(&done[(k - 1) * size + k..]);
        let first = way[0];
        let below: f64 = way[1..].iter().map(|entry| entry * entry).sum();
        if below < NOTHING {
            beside.push(first);
            continue;
        }
        let length = (first * first + below).sqrt();
        // The sign that cancels nothing.
        beside.push(if first > 0.0 { -length } else { length });
        way[0] += if first > 0.0 { length } else { -length };
        let factor = 1.0 / (length * (length + first.abs()));
        let product = &mut product[..size - k];
        product.fill(0.0);
        for (column, entry) in rest.chunks_exact(size).zip(&way) {
            product.iter_mut().zip(&column[k..]).for_each(|(sum, value)| *sum += value * entry);
        }
        product.iter_mut().for_each(|value| *value *= factor);
        let half = 0.5 * factor * product.iter().zip(&way).map(|(a, b)| a * b).sum::<f64>();
        product.iter_mut().zip(&way).for_each(|(value, entry)| *value -= half * entry);
        for (column, (entry, value)) in rest.chunks_exact_mut(size).zip(way.iter().zip(&*product)) {
            let others = way.iter().zip(&*product);
            column[k..].iter_mut().zip(others).for_each(|(own, (a, b))| *own -= a * value + b * entry);
        }
        let rows = &mut sides[k * width..];
        along.fill(0.0);
        for (row, entry) in rows.chunks_exact(width.max(1)).zip(&way) {
            along.iter_mut().zip(row).for_each(|(sum, value)| *sum += value * entry);
        }
        for (row, entry) in rows.chunks_exact_mut(width.max(1)).zip(&way) {
            let times = factor * entry;
            row.iter_mut().zip(&along).for_each(|(own, value)| *own -= times * value);
        }
    }
    beside
}

#[cfg(test)]
mod tests {
    use super::super::{cholesky, solve_lower};
    use super::*;

    fn dot(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| a * b).sum()
    }

    #[test]
    fn products_are_those_of_the_cholesky_factor() {
        for size in [1, 2, 3, 5, 12, 31] {
            let entry =
                |i: usize, j: usize| libm::exp(-0.3 * (i.abs_diff(j) as f64)) * libm::cos(0.2 * (i * j) as f64);
            let matrix: Vec<f64> = (0..size * size).map(|at| entry(at / size, at % size)).collect();
            let sides: Vec<f64> = (0..11 * size).map(|at| libm::sin(at as f64)).collect();
            let shifted = ShiftedMatrices::new(matrix.clone(), size, &sides);
            for (scale, shift) in [(0.0, 3.0), (1.0, 20.0), (4.0, 80.0)] {
                let found = shifted.products::<2>(scale, shift).unwrap();
                let mut factor: Vec<f64> = matrix.iter().map(|value| scale * value).collect();
                (0..size).for_each(|at| factor[at * size + at] += shift);
                assert!(cholesky(&mut factor, size));
                let mut solved = sides.clone();
                solve_lower(&factor, size, &mut solved);
                let ln: f64 = (0..size).map(|at| 2.0 * libm::log(factor[at * size + at])).sum();
                assert!((found.ln_determinant - ln).abs() < 1e-12 * (1.0 + ln.abs()), "{size}");
                let solved: Vec<&[f64]> = solved.chunks_exact(size).collect();
                for (number, side) in solved.iter().enumerate() {
                    assert!((found.squares[number] - dot(side, side)).abs() < 1e-12, "{size}, {number}");
                    for (first, with_first) in solved.iter().zip(&found.with_first) {
                        assert!((with_first[number] - dot(side, first)).abs() < 1e-12, "{size}, {number}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_has_no_products() {
        let shifted = ShiftedMatrices::new(vec![0.0, 1.0, 1.0, 0.0], 2, &[1.0, 2.0]);
        assert!(shifted.products::<1>(1.0, 0.9).is_none() && shifted.products::<1>(f64::NAN, 1.0).is_none());
        assert!(shifted.products::<1>(1.0, 1.1).is_some());
    }

    #[test]
    fn entries_that_are_nearly_nothing_are_no_reason_for_a_reflection() {
        let mut matrix = vec![1e-200; 16];
        (0..4).for_each(|at| matrix[at * 5] = 1.0);
        let found = ShiftedMatrices::new(matrix, 4, &[1.0, 2.0, 3.0, 4.0]).products::<0>(1.0, 1.0).unwrap();
        assert!((found.squares[0] - 15.0).abs() < 1e-12 && found.squares.len() == 1, "{found:?}");
    }
}
