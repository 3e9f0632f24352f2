//! Classical multidimensional scaling: places from distances between all pairs (Torgerson 1952).

use nalgebra::DMatrix;
use sextant_channel::Position;
use sextant_kernel::Seed;

use crate::purpose;

/// Up to this size the whole spectrum is computed.
const SMALL: usize = 64;
/// Dimensions of the subspace beyond those wanted.
const SPARE: usize = 8;
/// Rounds of the subspace iteration, at most.
const ROUNDS: u32 = 500;

/// The places in two or three `dimensions` whose distances are nearest to `distances` in the sense of classical scaling:
/// the leading eigenvectors of `B = −½ J D∘D J`, J taking the mean off, times the square roots of their eigenvalues (zero
/// for negative ones). Exact, up to rotation and reflection, for Euclidean distances. Costs O(N²) a round.
pub(super) fn classical_mds(distances: &DMatrix<f64>, dimensions: usize) -> Vec<Position> {
    let squares = distances.map(|distance| -0.5 * distance * distance);
    let (values, vectors) = leading(&squares, dimensions.min(distances.nrows()));
    let coordinate = |node: usize, axis: usize| {
        if axis < values.len() { vectors[(node, axis)] * values[axis].max(0.0).sqrt() } else { 0.0 }
    };
    (0..distances.nrows())
        .map(|node| Position::new(coordinate(node, 0), coordinate(node, 1), coordinate(node, 2)))
        .collect()
}

/// `J A J X`.
fn centred_product(matrix: &DMatrix<f64>, block: &DMatrix<f64>) -> DMatrix<f64> {
    centred(matrix * centred(block.clone()))
}

fn centred(mut block: DMatrix<f64>) -> DMatrix<f64> {
    for mut column in block.column_iter_mut() {
        let mean = column.mean();
        column.add_scalar_mut(-mean);
    }
    block
}

/// The `count` greatest eigenvalues of `J A J`, A being symmetric, and their vectors; each vector's entry of largest
/// magnitude is positive.
fn leading(matrix: &DMatrix<f64>, count: usize) -> (Vec<f64>, DMatrix<f64>) {
    let size = matrix.nrows();
    let (values, mut vectors) = if size <= SMALL.max(count + SPARE) {
        let whole = centred_product(matrix, &DMatrix::identity(size, size));
        sorted(&((&whole + whole.transpose()) * 0.5), count)
    } else {
        iterated(matrix, count)
    };
    for mut column in vectors.column_iter_mut() {
        let largest = column.iter().copied().fold(0.0, |a: f64, b: f64| if b.abs() > a.abs() { b } else { a });
        if largest < 0.0 {
            column.neg_mut();
        }
    }
    (values, vectors)
}

/// The `count` greatest eigenvalues of a symmetric matrix and their vectors.
fn sorted(matrix: &DMatrix<f64>, count: usize) -> (Vec<f64>, DMatrix<f64>) {
    let eigen = matrix.clone().symmetric_eigen();
    let mut order: Vec<usize> = (0..matrix.nrows()).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]).then(a.cmp(&b)));
    order.truncate(count);
    (order.iter().map(|&i| eigen.eigenvalues[i]).collect(), eigen.eigenvectors.select_columns(&order))
}

/// Subspace iteration with Rayleigh-Ritz (Rutishauser 1970) from a fixed random start. The subspace holds the
/// eigenvalues of largest magnitude; graph distances have few and small negative ones, and the spare dimensions hold
/// these.
fn iterated(matrix: &DMatrix<f64>, count: usize) -> (Vec<f64>, DMatrix<f64>) {
    let (size, width) = (matrix.nrows(), count + SPARE);
    let start = |row: usize, column: usize| Seed(0).normal(purpose::MAPPER, [2, row as u64, column as u64]);
    let mut basis = centred(DMatrix::from_fn(size, width, start)).qr().q();
    let mut result = (vec![0.0; count], basis.columns(0, count).into_owned());
    for _ in 0..ROUNDS {
        let image = centred_product(matrix, &basis);
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
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_kernel::Purpose;

    fn places(count: u64, height: f64) -> Vec<Position> {
        let draw = |i, axis| 30.0 * Seed(12).uniform(Purpose::new(8), [i, axis, 6]);
        (0..count).map(|i| Position::new(draw(i, 0), draw(i, 1), height * draw(i, 2))).collect()
    }

    fn distances(places: &[Position]) -> DMatrix<f64> {
        DMatrix::from_fn(places.len(), places.len(), |i, j| places[i].distance_m(places[j]))
    }

    #[test]
    fn euclidean_distances_are_recovered_exactly() {
        for (count, height, dimensions) in [(9, 0.0, 2), (60, 1.0, 3), (150, 0.0, 2), (150, 0.3, 3)] {
            let exact = distances(&places(count, height));
            let found = distances(&classical_mds(&exact, dimensions));
            let worst = (found - exact).amax();
            assert!(worst < 1e-9, "{count} nodes: {worst}");
        }
    }

    #[test]
    fn iterated_eigenvalues_are_those_of_the_whole_spectrum() {
        // Distances along a grid's edges are not Euclidean: B has negative eigenvalues too.
        let grid: Vec<(f64, f64)> = (0..180).map(|i| (f64::from(i % 18), f64::from(i / 18))).collect();
        let edges =
            |i: usize, j: usize| -0.5 * ((grid[i].0 - grid[j].0).abs() + (grid[i].1 - grid[j].1).abs()).powi(2);
        let squares = DMatrix::from_fn(180, 180, edges);
        let whole = centred_product(&squares, &DMatrix::identity(180, 180));
        let (expected, vectors) = sorted(&whole, 3);
        let (found, iterated) = iterated(&squares, 3);
        for axis in 0..3 {
            assert!((found[axis] / expected[axis] - 1.0).abs() < 1e-10, "{found:?} {expected:?}");
            assert!((iterated.column(axis).dot(&vectors.column(axis)).abs() - 1.0).abs() < 1e-9);
        }
    }
}
