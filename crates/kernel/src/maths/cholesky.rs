//! The Cholesky factor of a symmetric matrix, and solutions by it, in blocks that stay in registers.
//!
//! Each entry is worked out in the order of the method by columns (Golub and Van Loan 2013, algorithm 4.2.3), so that blocks change
//! no digit.

use super::with_widest_vectors;
use crate::watch::{Interrupted, Unwatched, Watch};

/// Columns of a block, and rows.
const BLOCK: usize = 4;

/// Replaces the lower triangle of a symmetric matrix, `size` columns after each other, by its Cholesky factor. `false` if it is not
/// positive definite; the columns are then of no use. What is above the diagonal is neither read nor of use afterwards.
///
/// # Panics
/// If `columns` are not `size` times `size` numbers.
#[must_use]
pub fn cholesky(columns: &mut [f64], size: usize) -> bool {
    matches!(cholesky_watched(columns, size, &Unwatched), Ok(true))
}

/// The same for large matrices: `watch` advances by each column, and may end the work.
///
/// # Errors
/// If `watch` ends the work.
///
/// # Panics
/// If `columns` are not `size` times `size` numbers.
pub fn cholesky_watched(columns: &mut [f64], size: usize, watch: &dyn Watch) -> Result<bool, Interrupted> {
    assert_eq!(columns.len(), size * size, "a matrix of {size} columns");
    with_widest_vectors(
        #[inline(always)]
        || factorise(columns, size, watch),
    )
}

#[inline(always)]
fn factorise(columns: &mut [f64], size: usize, watch: &dyn Watch) -> Result<bool, Interrupted> {
    for first in (0..size).step_by(BLOCK) {
        watch.check()?;
        let width = BLOCK.min(size - first);
        let (known, rest) = columns.split_at_mut(first * size);
        let block = &mut rest[..width * size];
        subtract(known, |k| &known[k * size + first..], block, [size, first], width);
        for j in 0..width {
            let (before, own) = block.split_at_mut(j * size);
            let own = &mut own[first + j..size];
            for k in 0..j {
                let column = &before[k * size + first + j..][..own.len()];
                let factor = column[0];
                own.iter_mut().zip(column).for_each(|(own, entry)| *own -= entry * factor);
            }
            let diagonal = own[0];
            if diagonal.is_nan() || diagonal <= 0.0 {
                return Ok(false);
            }
            let root = diagonal.sqrt();
            own[0] = root;
            own[1..].iter_mut().for_each(|entry| *entry /= root);
        }
        watch.advance(width as u64);
    }
    Ok(true)
}

/// Replaces right sides, one after the other with `size` numbers each, by the solutions x of L x = b, with the lower triangle L of
/// `columns`.
///
/// # Panics
/// If `columns` are not `size` times `size` numbers, or the right sides not a multiple of `size`.
pub fn solve_lower(columns: &[f64], size: usize, right_sides: &mut [f64]) {
    assert_eq!(columns.len(), size * size, "a matrix of {size} columns");
    if size == 0 {
        return;
    }
    assert!(right_sides.len().is_multiple_of(size), "right sides of {size} numbers");
    with_widest_vectors(
        #[inline(always)]
        || substitute(columns, size, right_sides),
    );
}

#[inline(always)]
fn substitute(columns: &[f64], size: usize, right_sides: &mut [f64]) {
    let mut multipliers: Vec<[f64; BLOCK]> = vec![[0.0; BLOCK]; size];
    for sides in right_sides.chunks_mut(BLOCK * size) {
        let width = sides.len() / size;
        for first in (0..size).step_by(BLOCK) {
            let end = size.min(first + BLOCK);
            for (side, values) in sides.chunks_exact_mut(size).enumerate() {
                for k in first..end {
                    let value = values[k] / columns[k * size + k];
                    values[k] = value;
                    multipliers[k][side] = value;
                    for row in k + 1..end {
                        values[row] -= columns[k * size + row] * value;
                    }
                }
            }
            // The rows below take in what these have found.
            let found = &columns[first * size..end * size];
            subtract_below(found, &multipliers[first..end], sides, [size, end], width);
        }
    }
}

/// Subtracts the products of `known` columns and `multipliers` from the first `width` columns of a block, from row `first` on.
#[inline(always)]
fn subtract<'a>(
    known: &[f64],
    multipliers: impl Fn(usize) -> &'a [f64],
    block: &mut [f64],
    [size, first]: [usize; 2],
    width: usize,
) {
    let mut row = first;
    if width == BLOCK {
        while row + BLOCK <= size {
            let mut tile = load(block, size, row);
            for (k, column) in known.chunks_exact(size).enumerate() {
                take(&mut tile, entries(column, row), entries(multipliers(k), 0));
            }
            store(&tile, block, size, row);
            row += BLOCK;
        }
    }
    for (k, column) in known.chunks_exact(size).enumerate() {
        let multipliers = multipliers(k);
        for (own, multiplier) in block.chunks_exact_mut(size).zip(&multipliers[..width]) {
            let both = own[row..].iter_mut().zip(&column[row..]);
            both.for_each(|(own, entry)| *own -= entry * multiplier);
        }
    }
}

/// Subtracts the products of a few `known` columns and their multipliers from right sides, from row `first` on.
#[inline(always)]
fn subtract_below(
    known: &[f64],
    multipliers: &[[f64; BLOCK]],
    sides: &mut [f64],
    [size, first]: [usize; 2],
    width: usize,
) {
    if width == BLOCK {
        subtract(known, |k| &multipliers[k], sides, [size, first], width);
        return;
    }
    for (side, values) in sides.chunks_exact_mut(size).enumerate() {
        for (column, multipliers) in known.chunks_exact(size).zip(multipliers) {
            let both = values[first..].iter_mut().zip(&column[first..]);
            both.for_each(|(own, entry)| *own -= entry * multipliers[side]);
        }
    }
}

type Tile = [[f64; BLOCK]; BLOCK];

#[inline(always)]
fn take(tile: &mut Tile, column: [f64; BLOCK], multipliers: [f64; BLOCK]) {
    for (own, multiplier) in tile.iter_mut().zip(&multipliers) {
        for (own, entry) in own.iter_mut().zip(&column) {
            *own -= entry * multiplier;
        }
    }
}

#[inline(always)]
fn entries(column: &[f64], row: usize) -> [f64; BLOCK] {
    column[row..row + BLOCK].try_into().unwrap_or([0.0; BLOCK])
}

#[inline(always)]
fn load(block: &[f64], size: usize, row: usize) -> Tile {
    [0, 1, 2, 3].map(|column| entries(&block[column * size..], row))
}

#[inline(always)]
fn store(tile: &Tile, block: &mut [f64], size: usize, row: usize) {
    for (column, own) in tile.iter().enumerate() {
        block[column * size + row..][..BLOCK].copy_from_slice(own);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A positive definite matrix, and right sides.
    fn matrix(size: usize) -> Vec<f64> {
        let entry = |i: usize, j: usize| {
            let apart = i.abs_diff(j) as f64;
            libm::exp(-0.1 * apart) + 0.01 * libm::cos((i * j) as f64) + if i == j { 0.5 } else { 0.0 }
        };
        (0..size * size).map(|at| entry(at / size, at % size)).collect()
    }

    /// The method by columns, as in the book.
    fn literal(columns: &mut [f64], size: usize) {
        for j in 0..size {
            for k in 0..j {
                let factor = columns[k * size + j];
                for row in j..size {
                    columns[j * size + row] -= columns[k * size + row] * factor;
                }
            }
            let root = columns[j * size + j].sqrt();
            columns[j * size + j] = root;
            for row in j + 1..size {
                columns[j * size + row] /= root;
            }
        }
    }

    fn lower(columns: &[f64], size: usize) -> Vec<u64> {
        let below = (0..size * size).filter(|at| at % size >= at / size);
        below.map(|at| columns[at].to_bits()).collect()
    }

    #[test]
    fn blocks_change_no_digit_and_the_factor_times_itself_is_the_matrix() {
        for size in [0, 1, 2, 3, 4, 5, 7, 8, 13, 16, 31] {
            let (mut factor, mut columns) = (matrix(size), matrix(size));
            assert!(cholesky(&mut factor, size), "{size}");
            literal(&mut columns, size);
            assert_eq!(lower(&factor, size), lower(&columns, size), "{size}");
            let whole = matrix(size);
            for j in 0..size {
                for i in j..size {
                    let product: f64 = (0..=j).map(|k| factor[k * size + i] * factor[k * size + j]).sum();
                    assert!((product - whole[j * size + i]).abs() < 1e-12, "{size}: {i}, {j}");
                }
            }
        }
    }

    #[test]
    fn right_sides_are_solved_one_like_many() {
        for size in [1, 2, 4, 6, 9, 12] {
            let mut factor = matrix(size);
            assert!(cholesky(&mut factor, size));
            for count in 1..7 {
                let sides: Vec<f64> = (0..count * size).map(|at| libm::sin(at as f64)).collect();
                let mut solved = sides.clone();
                solve_lower(&factor, size, &mut solved);
                for (side, solution) in sides.chunks_exact(size).zip(solved.chunks_exact(size)) {
                    let mut alone = side.to_vec();
                    solve_lower(&factor, size, &mut alone);
                    assert_eq!(alone, solution, "{size}, {count}");
                    for (row, value) in side.iter().enumerate() {
                        let product: f64 = (0..=row).map(|k| factor[k * size + row] * solution[k]).sum();
                        assert!((product - value).abs() < 1e-12, "{size}, {count}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_has_no_factor() {
        assert!(!cholesky(&mut [1.0, 2.0, 2.0, 1.0], 2));
        assert!(!cholesky(&mut [f64::NAN], 1));
        assert!(!cholesky(&mut [0.0], 1));
    }
}
