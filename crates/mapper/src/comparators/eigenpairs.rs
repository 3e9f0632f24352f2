//! The greatest eigenvalues of symmetric matrices, with their eigenvectors. Large matrices are used only in products.

use nalgebra::DMatrix;
use sextant_kernel::{Interrupted, Watch};

/// Additional dimensions of the subspace.
pub(super) const SPARE: usize = 8;
/// Maximum number of rounds of the subspace iteration.
const ROUNDS: u32 = 500;
/// Number of multiplications between two checks for interruption: about a twentieth of a second.
const AT_ONCE: usize = 100_000_000;

/// The `count` greatest eigenvalues of a symmetric matrix in falling order, and their eigenvectors.
pub(super) fn sorted(matrix: &DMatrix<f64>, count: usize) -> (Vec<f64>, DMatrix<f64>) {
    let eigen = matrix.clone().symmetric_eigen();
    let mut order: Vec<usize> = (0..matrix.nrows()).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]).then(a.cmp(&b)));
    order.truncate(count);
    (order.iter().map(|&i| eigen.eigenvalues[i]).collect(), eigen.eigenvectors.select_columns(&order))
}

/// The same for a matrix that is given by its `product` with a block of vectors. The method is subspace iteration
/// with Rayleigh-Ritz (Rutishauser 1970). It starts from the block `start`, which has [`SPARE`] additional columns.
/// The subspace converges to the eigenvalues of largest magnitude. Negative eigenvalues must be few or small, because
/// they take up the spare dimensions.
///
/// # Errors
/// If `product` is interrupted.
pub(super) fn iterated(
    start: DMatrix<f64>,
    count: usize,
    product: impl Fn(&DMatrix<f64>) -> Result<DMatrix<f64>, Interrupted>,
) -> Result<(Vec<f64>, DMatrix<f64>), Interrupted> {
    let mut basis = start.qr().q();
    let mut result = (vec![0.0; count], basis.columns(0, count).into_owned());
    for _ in 0..ROUNDS {
        let image = product(&basis)?;
        let projected = basis.transpose() * &image;
        let (values, turn) = sorted(&((&projected + projected.transpose()) * 0.5), count);
        let vectors = &basis * &turn;
        // What is left of A v − λ v tells how far the pairs are from eigenpairs.
        let mut rest = &image * &turn;
        for (axis, &value) in values.iter().enumerate() {
            rest.column_mut(axis).axpy(-value, &vectors.column(axis), 1.0);
        }
        let scale = values.iter().fold(0.0, |scale: f64, value| scale.max(value.abs()));
        let done = rest.amax() <= 1e-12 * scale;
        result = (values, vectors);
        if done || image.amax() <= f64::MIN_POSITIVE {
            break;
        }
        basis = image.qr().q();
    }
    Ok(result)
}

/// `matrix · block`, computed some rows at a time.
///
/// # Errors
/// If `watch` ends the work.
pub(super) fn product(
    matrix: &DMatrix<f64>,
    block: &DMatrix<f64>,
    watch: &dyn Watch,
) -> Result<DMatrix<f64>, Interrupted> {
    in_parts(matrix.nrows(), block, watch, |first, count| matrix.rows(first, count) * block)
}

/// `matrixᵀ · block`, computed from some columns of the matrix at a time.
///
/// # Errors
/// If `watch` ends the work.
pub(super) fn transposed_product(
    matrix: &DMatrix<f64>,
    block: &DMatrix<f64>,
    watch: &dyn Watch,
) -> Result<DMatrix<f64>, Interrupted> {
    in_parts(matrix.ncols(), block, watch, |first, count| matrix.columns(first, count).transpose() * block)
}

/// The product of a matrix of `rows` rows with `block`, some rows at a time. `part(first, count)` computes `count`
/// rows, from the row `first` on.
fn in_parts(
    rows: usize,
    block: &DMatrix<f64>,
    watch: &dyn Watch,
    part: impl Fn(usize, usize) -> DMatrix<f64>,
) -> Result<DMatrix<f64>, Interrupted> {
    watch.check()?;
    let at_once = AT_ONCE.div_ceil(block.len().max(1));
    if at_once >= rows {
        return Ok(part(0, rows));
    }
    let mut product = DMatrix::zeros(rows, block.ncols());
    for first in (0..rows).step_by(at_once) {
        watch.check()?;
        let count = at_once.min(rows - first);
        product.rows_mut(first, count).copy_from(&part(first, count));
    }
    Ok(product)
}

#[cfg(test)]
mod tests {
    use sextant_kernel::{Purpose, Seed, Unwatched};

    use super::*;

    #[test]
    fn products_in_parts_are_those_of_whole_matrices() {
        let draw = |i: usize, j: usize| Seed(1).normal(Purpose::new(8), [i as u64, j as u64, 3]);
        let (tall, block) = (DMatrix::from_fn(12_000, 1000, draw), DMatrix::from_fn(1000, 11, draw));
        let parts = product(&tall, &block, &Unwatched).unwrap();
        assert!((&parts - &tall * &block).amax() < 1e-9 * parts.amax());
        let narrow = DMatrix::from_fn(12_000, 11, draw);
        let parts = transposed_product(&tall, &narrow, &Unwatched).unwrap();
        assert!((&parts - tall.transpose() * narrow).amax() < 1e-9 * parts.amax());
    }
}
