//! Classical multidimensional scaling: places from distances between all pairs (Torgerson 1952).

use nalgebra::DMatrix;
use sextant_channel::Position;
use sextant_kernel::{Interrupted, Seed, Watch, Work};

use super::eigenpairs::{self, SPARE};
use crate::purpose;

/// Up to this size all eigenvalues are computed.
const SMALL: usize = 64;
/// Usual number of rounds of the subspace iteration.
const ROUNDS: u32 = 50;

/// The places in two or three `dimensions` whose distances are nearest to `distances` in the sense of classical
/// scaling: the leading eigenvectors of `B = −½ J D∘D J`, where J subtracts the mean, times the square roots of their
/// eigenvalues (zero for negative ones). Exact, up to rotation and reflection, for Euclidean distances. Costs O(N²)
/// per round. `algorithm` is the name for progress messages.
///
/// # Errors
/// If `watch` ends the work.
pub(super) fn classical_mds(
    mut distances: DMatrix<f64>,
    algorithm: &'static str,
    dimensions: usize,
    watch: &dyn Watch,
) -> Result<Vec<Position>, Interrupted> {
    let nodes = distances.nrows();
    #[expect(clippy::cast_precision_loss, reason = "numbers for people")]
    let operations = (nodes * nodes * (dimensions + SPARE)) as f64 * f64::from(ROUNDS);
    watch.begin(Work { name: algorithm, unit: "round", steps: ROUNDS.into(), operations });
    // Squared in place, because these are the largest matrices.
    distances.apply(|distance| *distance = -0.5 * *distance * *distance);
    let (values, vectors) = leading(&distances, dimensions.min(nodes), watch)?;
    let coordinate = |node: usize, axis: usize| {
        if axis < values.len() { vectors[(node, axis)] * values[axis].max(0.0).sqrt() } else { 0.0 }
    };
    Ok((0..nodes).map(|node| Position::new(coordinate(node, 0), coordinate(node, 1), coordinate(node, 2))).collect())
}

/// `J A J X`.
fn centred_product(
    matrix: &DMatrix<f64>,
    block: &DMatrix<f64>,
    watch: &dyn Watch,
) -> Result<DMatrix<f64>, Interrupted> {
    Ok(centred(eigenpairs::product(matrix, &centred(block.clone()), watch)?))
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
fn leading(matrix: &DMatrix<f64>, count: usize, watch: &dyn Watch) -> Result<(Vec<f64>, DMatrix<f64>), Interrupted> {
    let size = matrix.nrows();
    let (values, mut vectors) = if size <= SMALL.max(count + SPARE) {
        let whole = centred_product(matrix, &DMatrix::identity(size, size), watch)?;
        eigenpairs::sorted(&((&whole + whole.transpose()) * 0.5), count)
    } else {
        iterated(matrix, count, watch)?
    };
    for mut column in vectors.column_iter_mut() {
        let largest = column.iter().copied().fold(0.0, |a: f64, b: f64| if b.abs() > a.abs() { b } else { a });
        if largest < 0.0 {
            column.neg_mut();
        }
    }
    Ok((values, vectors))
}

/// The same from a fixed random start. Graph distances have few and small negative eigenvalues, for which the spare
/// dimensions are enough.
fn iterated(matrix: &DMatrix<f64>, count: usize, watch: &dyn Watch) -> Result<(Vec<f64>, DMatrix<f64>), Interrupted> {
    let start = |row: usize, column: usize| Seed(0).normal(purpose::MAPPER, [2, row as u64, column as u64]);
    let start = centred(DMatrix::from_fn(matrix.nrows(), count + SPARE, start));
    eigenpairs::iterated(start, count, |basis| {
        let image = centred_product(matrix, basis, watch)?;
        watch.advance(1);
        Ok(image)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_kernel::{Purpose, Unwatched};

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
            let found = distances(&classical_mds(exact.clone(), "mds-map", dimensions, &Unwatched).unwrap());
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
        let whole = centred_product(&squares, &DMatrix::identity(180, 180), &Unwatched).unwrap();
        let (expected, vectors) = eigenpairs::sorted(&whole, 3);
        let (found, iterated) = iterated(&squares, 3, &Unwatched).unwrap();
        for axis in 0..3 {
            assert!((found[axis] / expected[axis] - 1.0).abs() < 1e-10, "{found:?} {expected:?}");
            assert!((iterated.column(axis).dot(&vectors.column(axis)).abs() - 1.0).abs() < 1e-9);
        }
    }
}
