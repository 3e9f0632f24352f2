//! What is expected of a link from the other links of its node.

use sextant_channel::Position;
use sextant_kernel::maths::exp_each;

use super::geometry::{NEIGHBOURS, keep_nearest};
use super::law::Law;

/// A margin that is expected of a link.
#[derive(Clone, Copy, Debug)]
pub(super) struct ExpectedMargin {
    pub(super) margin: f64,
    /// Its standard deviation.
    pub(super) spread: f64,
}

/// A link whose margin is known, and what it has in excess of what its place tells.
#[derive(Clone, Copy, Debug)]
pub(super) struct KnownMargin {
    /// Number of the link.
    pub(super) number: usize,
    pub(super) place: Position,
    pub(super) excess: f64,
    /// Variance of the excess.
    pub(super) variance: f64,
}

/// What the links nearest to link `number` at `place` among the `known` others tell of its margin, about the one `told` by
/// the distance: offset and shared shadowing of a node are in all of them (the cavity distribution of expectation
/// propagation).
pub(super) fn conditioned(
    law: &Law,
    told: ExpectedMargin,
    number: usize,
    place: Position,
    known: &[KnownMargin],
) -> ExpectedMargin {
    let others = known.iter().enumerate().filter(|(_, link)| link.number != number);
    let mut near: Vec<(f64, usize)> = others.map(|(at, link)| (link.place.distance_m(place), at)).collect();
    keep_nearest(&mut near);
    let shadowing = law.shadowing * law.shadowing;
    let common = law.offset * law.offset;
    // The correlations with the link, then those between the others by rows.
    let mut correlations = [0.0; NEIGHBOURS * (NEIGHBOURS + 3) / 2];
    let between = near.iter().enumerate().flat_map(|(row, &(_, first))| {
        near[..=row].iter().map(move |&(_, second)| known[first].place.distance_m(known[second].place))
    });
    for (correlation, distance_m) in
        correlations.iter_mut().zip(near.iter().map(|&(distance_m, _)| distance_m).chain(between))
    {
        *correlation = -distance_m / law.correlation_m;
    }
    exp_each(&mut correlations);
    let covariance = |correlation: f64| common + law.shared * shadowing * correlation;
    let (to, mut between) = correlations.split_at(near.len());
    let alone = (1.0 - law.shared) * shadowing + 2.0 * law.direction * law.direction;
    let count = near.len();
    let mut factor = [[0.0f64; NEIGHBOURS]; NEIGHBOURS];
    let mut half = [0.0f64; NEIGHBOURS];
    let mut solved = [0.0f64; NEIGHBOURS];
    let (mut margin, mut variance) = (told.margin, told.spread * told.spread);
    for row in 0..count {
        let link = &known[near[row].1];
        let (along_row, rest) = between.split_at(row + 1);
        between = rest;
        for column in 0..=row {
            let own = covariance(along_row[column]) + if row == column { alone + link.variance } else { 0.0 };
            let sum: f64 = own - (0..column).map(|k| factor[row][k] * factor[column][k]).sum::<f64>();
            factor[row][column] = if row == column { sum.max(1e-12).sqrt() } else { sum / factor[column][column] };
        }
        let before = |values: &[f64; NEIGHBOURS]| (0..row).map(|k| factor[row][k] * values[k]).sum::<f64>();
        half[row] = (covariance(to[row]) - before(&half)) / factor[row][row];
        solved[row] = (link.excess - before(&solved)) / factor[row][row];
        margin += half[row] * solved[row];
        variance -= half[row] * half[row];
    }
    ExpectedMargin { margin, spread: variance.max(alone).max(1e-2).sqrt() }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;

    #[test]
    fn few_links_tell_what_the_whole_covariance_matrix_tells() {
        let law = Law {
            margin: 1.0,
            distance_m: 5.0,
            slope: 2.0,
            shadowing: 1.3,
            shared: 0.6,
            correlation_m: 4.0,
            offset: 0.5,
            direction: 0.2,
            slope_spread: 0.1,
        };
        let place = Position::new(1.0, 1.0, 0.0);
        let known: Vec<KnownMargin> = [[0.0, 0.0, 1.2], [3.0, 0.5, -0.4], [-1.0, 4.0, 0.7]]
            .map(|[x, y, excess]| KnownMargin { number: 7, place: Position::new(x, y, 0.0), excess, variance: 0.3 })
            .into();
        let told = ExpectedMargin { margin: 0.8, spread: law.spread() };
        let found = conditioned(&law, told, 3, place, &known);
        let shared = |a: Position, b: Position| 0.25 + 0.6 * 1.69 * (-a.distance_m(b) / 4.0).exp();
        let alone = 0.4 * 1.69 + 2.0 * 0.04;
        let matrix = DMatrix::from_fn(3, 3, |i, j| {
            shared(known[i].place, known[j].place) + if i == j { alone + 0.3 } else { 0.0 }
        });
        let with = DVector::from_fn(3, |i, _| shared(place, known[i].place));
        let weights = matrix.cholesky().unwrap().solve(&with);
        let excess = DVector::from_fn(3, |i, _| known[i].excess);
        assert!((found.margin - 0.8 - weights.dot(&excess)).abs() < 1e-12);
        let variance = law.spread().powi(2) - weights.dot(&with);
        assert!((found.spread - variance.sqrt()).abs() < 1e-12);
    }
}
