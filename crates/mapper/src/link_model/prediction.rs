//! How each margin is predicted from those of its neighbours.

use fearless_simd::f32x8;
use fearless_simd::prelude::*;
use sextant_kernel::maths::ln_each;

use super::geometry::{Arrangement, COLUMNS, Lane, NEIGHBOURS, single};
use super::law::Law;
use super::receiver::Site;

/// How one margin is predicted from those before it.
pub(super) struct Prediction {
    neighbours: usize,
    at: [u32; NEIGHBOURS],
    /// What a margin of each neighbour adds to the prediction, in standard deviations of its error.
    weights: [f32; NEIGHBOURS],
    /// One over the standard deviation of the error.
    precision: f32,
    /// The margin minus its prediction, without the slope, in standard deviations.
    margin: f32,
    /// What a margin of 1 of the law is in it, in standard deviations.
    pub(super) unit: f32,
    /// The logarithm of the distance of the law minus its prediction, in standard deviations.
    level: f32,
}

/// The error of a prediction at the vertices of a block, of nodes with so many amplitudes.
#[derive(Clone, Copy)]
pub(super) struct ErrorsAtBlock<S: Simd, const COUNT: usize> {
    pub(super) error: f32x8<S>,
    /// What an amplitude of 1 is in it.
    pub(super) columns: [f32x8<S>; COUNT],
    /// What a margin of 1 is in it.
    pub(super) unit: f32,
}

impl Prediction {
    /// The errors at the vertices of a block, in which the place has the columns `own`, under a law with this slope.
    #[inline(always)]
    pub(super) fn errors<S: Simd, const COUNT: usize>(
        &self,
        simd: S,
        slope: f32,
        own: &[Lane; COLUMNS],
        block: &[[Lane; COLUMNS]],
    ) -> ErrorsAtBlock<S, COUNT> {
        let splat = |value: f32| f32x8::splat(simd, value);
        let precision = splat(self.precision);
        let mut columns: [f32x8<S>; COUNT] = std::array::from_fn(|column| own[column].load(simd) * precision);
        for (&at, &weight) in self.at.iter().zip(&self.weights).take(self.neighbours) {
            let weight = splat(weight);
            for (column, other) in columns.iter_mut().zip(&block[at as usize]) {
                *column -= weight * other.load(simd);
            }
        }
        let error = splat(self.margin) + splat(slope) * columns[0];
        columns[0] -= splat(self.level);
        ErrorsAtBlock { error, columns, unit: self.unit }
    }
}

/// The product of the first `count` entries.
fn dot(first: &[f64], second: &[f64], count: usize) -> f64 {
    first.iter().zip(second).take(count).map(|(a, b)| a * b).sum()
}

/// The predictions, and the sum of the logarithms of the standard deviations of their errors. `correlations` are those over the
/// distances of the arrangement.
pub(super) fn predictions(
    law: &Law,
    mut correlations: &[f64],
    arrangement: &Arrangement,
    sites: &[Site],
) -> (Vec<Prediction>, f64) {
    let variance = law.shadowing * law.shadowing;
    let common = law.offset * law.offset;
    let shared = law.shared * variance;
    let covariance = |correlation: f64| common + shared * correlation;
    let level = law.at_one_metre();
    let log_distance = libm::log(law.distance_m);
    let at = |position: usize| sites[arrangement.order[position]];
    let mut deviations = Vec::with_capacity(sites.len());
    let each = arrangement.neighbours.iter().enumerate().map(|(position, neighbours)| {
        let site = at(position);
        let count = if law.has_independent_links() { 0 } else { neighbours.at.len() };
        let (own, rest) = correlations.split_at(neighbours.distances_m.len());
        correlations = rest;
        let (to, mut between) = own.split_at(count);
        // Cholesky factor of the covariance of the neighbours; weights solve it for the covariance with them.
        let mut factor = [[0.0f64; NEIGHBOURS]; NEIGHBOURS];
        let mut half = [0.0f64; NEIGHBOURS];
        let mut left = variance + common + site.variance;
        for row in 0..count {
            let (along_row, rest) = between.split_at(row);
            between = rest;
            for column in 0..=row {
                let own = if row == column {
                    variance + common + at(neighbours.at[row]).variance
                } else {
                    covariance(along_row[column])
                };
                let sum = own - dot(&factor[row], &factor[column], column);
                factor[row][column] =
                    if row == column { sum.max(1e-12).sqrt() } else { sum / factor[column][column] };
            }
            half[row] = (covariance(to[row]) - dot(&factor[row], &half, row)) / factor[row][row];
            left -= half[row] * half[row];
        }
        let mut exact = [0.0f64; NEIGHBOURS];
        for row in (0..count).rev() {
            let mut sum = half[row];
            for k in row + 1..count {
                sum -= factor[k][row] * exact[k];
            }
            exact[row] = sum / factor[row][row];
        }
        let deviation = left.max(1e-9).sqrt();
        deviations.push(deviation);
        let mut prediction = Prediction {
            neighbours: count,
            at: [0; NEIGHBOURS],
            weights: exact.map(|weight| single(weight / deviation)),
            precision: single(1.0 / deviation),
            margin: 0.0,
            unit: 0.0,
            level: 0.0,
        };
        let mut margin = site.margin - level;
        let mut share = 1.0;
        for (slot, &neighbour) in neighbours.at.iter().take(count).enumerate() {
            prediction.at[slot] = u32::try_from(neighbour).expect("a node has few links");
            margin -= exact[slot] * (at(neighbour).margin - level);
            share -= exact[slot];
        }
        prediction.margin = single(margin / deviation);
        prediction.unit = single(share / deviation);
        prediction.level = single(share * log_distance / deviation);
        prediction
    });
    let predictions = each.collect();
    ln_each(&mut deviations);
    (predictions, deviations.iter().sum())
}
