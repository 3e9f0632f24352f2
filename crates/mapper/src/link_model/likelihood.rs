//! The likelihood of the places of a node under a law of links.

use std::sync::Arc;

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch, f32x8, f64x4};
use sextant_kernel::maths::{exp_each, ln_each};

use super::geometry::{Arrangement, BLOCK, COLUMNS, Columns, Lane, single};
use super::law::Law;
use super::prediction::{ErrorsAtBlock, Prediction, predictions};
use super::receiver::Site;

/// Amplitudes of a node: the deviation of its slope, and four of its dependence on direction.
const AMPLITUDES: usize = COLUMNS;
/// Products of two amplitudes, and those of two amplitudes of direction.
const PRODUCTS: usize = AMPLITUDES * (AMPLITUDES + 1) / 2;
const AMONG_DIRECTIONS: usize = PRODUCTS - AMPLITUDES;

/// What the likelihood at each vertex needs of the links: sums over them under a covariance of margins. Laws that differ in
/// margin, slope, or the deviations of slopes and directions have the same sums, so that a search weighs them at once.
///
/// Offsets, shadowing and amplitudes of direction are integrated out: a normal distribution of all margins, whose inverse is
/// sparse because each margin depends on few before it; the amplitudes by the identity of Woodbury.
#[derive(Clone, Debug)]
pub(super) struct MarginSums {
    correlations: Arc<ShadowingCorrelations>,
    /// Margin and slope of the law under which the errors of margins were taken.
    margin: f64,
    slope: f64,
    /// Sum of the logarithms of the standard deviations of the errors of predictions.
    logs: f64,
    /// Sum of the squares of what a margin of 1 is in each error.
    units: f64,
    blocks: Vec<BlockSums>,
}

/// The correlation of the shadowing over each distance of an arrangement.
#[derive(Debug)]
struct ShadowingCorrelations {
    correlation_m: f64,
    each: Vec<f64>,
}

/// Sums over links at the vertices of a block.
#[derive(Clone, Debug)]
struct BlockSums {
    /// Of squares of errors.
    squares: Lane,
    /// Of errors times what a margin of 1 is in each.
    units: Lane,
    /// Of errors times each column.
    along: [Lane; AMPLITUDES],
    /// Of columns times what a margin of 1 is in each error.
    unit_along: [Lane; AMPLITUDES],
    /// Of columns times columns, by rows up to the diagonal.
    products: [Lane; PRODUCTS],
}

impl ShadowingCorrelations {
    fn of(arrangement: &Arrangement, correlation_m: f64) -> Self {
        let distances_m = arrangement.neighbours.iter().flat_map(|neighbours| &neighbours.distances_m);
        let mut each: Vec<f64> = distances_m.map(|distance_m| -distance_m / correlation_m).collect();
        exp_each(&mut each);
        Self { correlation_m, each }
    }
}

impl MarginSums {
    /// The sums under `law`. `sites` are in the order of the links.
    pub(super) fn of(law: &Law, arrangement: &Arrangement, sites: &[Site], columns: &Columns) -> Self {
        let correlations = Arc::new(ShadowingCorrelations::of(arrangement, law.correlation_m));
        Self::with(correlations, law, arrangement, sites, columns)
    }

    /// The same of the same links under another law.
    pub(super) fn under(&self, law: &Law, arrangement: &Arrangement, sites: &[Site], columns: &Columns) -> Self {
        if law.correlation_m.to_bits() == self.correlations.correlation_m.to_bits() {
            Self::with(Arc::clone(&self.correlations), law, arrangement, sites, columns)
        } else {
            Self::of(law, arrangement, sites, columns)
        }
    }

    fn with(
        correlations: Arc<ShadowingCorrelations>,
        law: &Law,
        arrangement: &Arrangement,
        sites: &[Site],
        columns: &Columns,
    ) -> Self {
        let (predictions, logs) = predictions(law, &correlations.each, arrangement, sites);
        let slope = single(law.slope);
        let blocks = if law.direction > 0.0 {
            dispatch!(Level::new(), simd => BlockSums::of_blocks::<_, AMPLITUDES>(simd, &predictions, slope, columns))
        } else {
            dispatch!(Level::new(), simd => BlockSums::of_blocks::<_, 1>(simd, &predictions, slope, columns))
        };
        let units = predictions.iter().map(|prediction| f64::from(prediction.unit).powi(2)).sum();
        Self { correlations, margin: law.margin, slope: law.slope, logs, units, blocks }
    }

    /// The logarithm of the likelihood at each vertex, up to a constant that is the same for all laws. `law` has the
    /// covariance and the distance of the one of the sums.
    pub(super) fn log_likelihoods(&self, law: &Law, out: &mut Vec<f64>) {
        out.clear();
        let mut deviations = [law.direction; AMPLITUDES];
        deviations[0] = law.slope_deviation();
        let changed = ChangedLaw { higher: law.margin - self.margin, steeper: law.slope - self.slope, deviations };
        let mut determinants = Vec::with_capacity(self.blocks.len() * BLOCK);
        dispatch!(Level::new(), simd => self.without_amplitudes(simd, &changed, out, &mut determinants));
        ln_each(&mut determinants);
        for (log, determinant) in out.iter_mut().zip(&determinants) {
            *log = -0.5 * (*log + determinant) - self.logs;
        }
    }

    /// The squares of the errors at each vertex without the amplitudes, and the determinants of these.
    #[inline(always)]
    fn without_amplitudes<S: Simd>(
        &self,
        simd: S,
        changed: &ChangedLaw,
        quadratics: &mut Vec<f64>,
        determinants: &mut Vec<f64>,
    ) {
        for block in &self.blocks {
            for number in 0..2 {
                let half = block.half(simd, number);
                let WithoutAmplitudes { quadratic, determinant } = half.without_amplitudes(simd, self.units, changed);
                quadratics.extend(<[f64; 4]>::from(quadratic));
                determinants.extend(<[f64; 4]>::from(determinant));
            }
        }
    }
}

/// What a law changes in the errors of margins, and the deviations of the amplitudes.
struct ChangedLaw {
    higher: f64,
    steeper: f64,
    deviations: [f64; AMPLITUDES],
}

/// What some vertices have without their amplitudes.
struct WithoutAmplitudes<S: Simd> {
    /// The squares of the errors.
    quadratic: f64x4<S>,
    /// Determinant of the amplitudes.
    determinant: f64x4<S>,
}

/// The sums at half of the vertices of a block, in double precision.
struct HalfBlockSums<S: Simd> {
    squares: f64x4<S>,
    units: f64x4<S>,
    along: [f64x4<S>; AMPLITUDES],
    unit_along: [f64x4<S>; AMPLITUDES],
    products: [f64x4<S>; PRODUCTS],
}

impl<S: Simd> HalfBlockSums<S> {
    /// What the amplitudes, whose standard deviations are `s`, leave of the squares of errors:
    /// `squares − gᵀ(S⁻² + M)⁻¹g`, and `det(I + SMS)`, where S is diagonal. `units` are the squares of what a margin of 1 is.
    #[inline(always)]
    fn without_amplitudes(self, simd: S, units: f64, law: &ChangedLaw) -> WithoutAmplitudes<S> {
        let ChangedLaw { higher, steeper, deviations: s } = law;
        let splat = |value: f64| f64x4::splat(simd, value);
        let (higher, steeper) = (splat(*higher), splat(*steeper));
        let Self { squares, units: own_units, mut along, unit_along, products } = self;
        let (zero, one, two) = (splat(0.0), splat(1.0), splat(2.0));
        let mut quadratic = squares
            + higher * (higher * splat(units) - two * own_units)
            + steeper * (steeper * products[0] + two * along[0] - two * higher * unit_along[0]);
        for (row, along) in along.iter_mut().enumerate() {
            *along += steeper * products[row * (row + 1) / 2] - higher * unit_along[row];
        }
        // The factors L and D of I + SMS = LDLᵀ, row by row, and the solution of Lx = Sg.
        let mut factor = [[zero; AMPLITUDES]; AMPLITUDES];
        let mut inverse = [zero; AMPLITUDES];
        let mut solved = [zero; AMPLITUDES];
        let mut determinant = one;
        let mut product = 0;
        for row in 0..AMPLITUDES {
            let mut scaled = [zero; AMPLITUDES];
            let mut own = splat(s[row]) * along[row];
            for column in 0..=row {
                let mut sum = splat(s[row] * s[column]) * products[product];
                product += 1;
                for k in 0..column {
                    sum -= scaled[k] * factor[column][k];
                }
                if row == column {
                    let pivot = sum + one;
                    determinant *= pivot;
                    inverse[row] = one / pivot;
                } else {
                    scaled[column] = sum;
                    factor[row][column] = sum * inverse[column];
                    own -= factor[row][column] * solved[column];
                }
            }
            solved[row] = own;
            quadratic -= own * own * inverse[row];
        }
        WithoutAmplitudes { quadratic, determinant }
    }
}

impl BlockSums {
    /// The sums at the vertices of a half, the first or the second one.
    #[inline(always)]
    fn half<S: Simd>(&self, simd: S, number: usize) -> HalfBlockSums<S> {
        let at = |sums: &Lane| sums.half(simd, number);
        HalfBlockSums {
            squares: at(&self.squares),
            units: at(&self.units),
            along: self.along.each_ref().map(at),
            unit_along: self.unit_along.each_ref().map(at),
            products: self.products.each_ref().map(at),
        }
    }

    /// The sums at each block of vertices under a law with this slope, of nodes with so many amplitudes.
    #[inline(always)]
    fn of_blocks<S: Simd, const COUNT: usize>(
        simd: S,
        predictions: &[Prediction],
        slope: f32,
        columns: &Columns,
    ) -> Vec<Self> {
        let mut errors: Vec<ErrorsAtBlock<S, COUNT>> = Vec::with_capacity(predictions.len());
        let mut blocks = Vec::with_capacity(columns.blocks().len());
        for block in columns.blocks() {
            errors.clear();
            for (prediction, own) in predictions.iter().zip(block) {
                errors.push(prediction.errors(simd, slope, own, block));
            }
            blocks.push(Self::of(simd, &errors));
        }
        blocks
    }

    /// The sums of the errors. Each loop has as many sums as there are registers.
    #[inline(always)]
    fn of<S: Simd, const COUNT: usize>(simd: S, errors: &[ErrorsAtBlock<S, COUNT>]) -> Self {
        let zero = f32x8::splat(simd, 0.0);
        let (mut among, mut steep) = ([zero; AMONG_DIRECTIONS], [zero; COUNT]);
        let (mut along, mut unit_along) = (steep, steep);
        let (mut squares, mut units) = (zero, zero);
        for ErrorsAtBlock { columns, .. } in errors {
            let mut product = 0;
            for row in 1..COUNT {
                for column in 1..=row {
                    among[product] += columns[row] * columns[column];
                    product += 1;
                }
            }
        }
        for ErrorsAtBlock { error, columns, .. } in errors {
            for row in 0..COUNT {
                steep[row] += columns[row] * columns[0];
                along[row] += columns[row] * *error;
            }
        }
        for ErrorsAtBlock { error, columns, unit } in errors {
            let unit = f32x8::splat(simd, *unit);
            squares += *error * *error;
            units += *error * unit;
            for row in 0..COUNT {
                unit_along[row] += columns[row] * unit;
            }
        }
        let mut products = [Lane::ZERO; PRODUCTS];
        for row in 0..COUNT {
            let first = row * (row + 1) / 2;
            products[first] = Lane::of(steep[row]);
            for column in 1..=row {
                products[first + column] = Lane::of(among[first - row + column - 1]);
            }
        }
        let every = |own: [f32x8<S>; COUNT]| {
            std::array::from_fn(|row| own.get(row).map_or(Lane::ZERO, |&values| Lane::of(values)))
        };
        Self {
            squares: Lane::of(squares),
            units: Lane::of(units),
            along: every(along),
            unit_along: every(unit_along),
            products,
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};
    use sextant_channel::Position;

    use super::super::links::HeardLink;
    use super::*;

    /// The same likelihood from the whole covariance matrix.
    fn literal(law: &Law, places: &[Position], sites: &[Site], vertex: Position) -> f64 {
        let bearing = |place: Position| libm::atan2(place.y_m - vertex.y_m, place.x_m - vertex.x_m);
        let variance = law.shadowing * law.shadowing;
        let covariance = DMatrix::from_fn(places.len(), places.len(), |i, j| {
            let angle = bearing(places[i]) - bearing(places[j]);
            let shared = law.shared * variance * (-places[i].distance_m(places[j]) / law.correlation_m).exp();
            let alone = if i == j { (1.0 - law.shared) * variance + sites[i].variance } else { 0.0 };
            let direction = law.direction * law.direction * (angle.cos() + (2.0 * angle).cos());
            let along = |place: Position| (vertex.distance_m(place) / law.distance_m).ln();
            let slopes = law.slope_deviation().powi(2) * along(places[i]) * along(places[j]);
            law.offset * law.offset + shared + alone + direction + slopes
        });
        let errors = DVector::from_fn(places.len(), |i, _| {
            let mean = law.margin - law.slope * (vertex.distance_m(places[i]) / law.distance_m).ln();
            sites[i].margin - mean
        });
        let factor = covariance.cholesky().unwrap();
        let half: f64 = (0..places.len()).map(|i| factor.l()[(i, i)].ln()).sum();
        -0.5 * errors.dot(&factor.solve(&errors)) - half
    }

    #[test]
    fn few_links_have_the_likelihood_of_the_whole_covariance_matrix() {
        let law = Law {
            margin: 0.7,
            distance_m: 4.0,
            slope: 1.6,
            shadowing: 1.1,
            shared: 0.7,
            correlation_m: 3.0,
            offset: 0.4,
            direction: 0.35,
            slope_spread: 0.2,
        };
        let at = [[0.0, 0.0], [3.0, 1.0], [-2.0, 4.0], [5.0, -1.0], [6.0, 6.0], [-4.0, -3.0], [1.0, 8.0]];
        let places: Vec<Position> = at.iter().map(|&[x, y]| Position::new(x, y, 0.5)).collect();
        let links: Vec<HeardLink> = (0..at.len())
            .map(|place| HeardLink { place, received: 1, sent: 2, rssi_dbm: None, outage: 0.0 })
            .collect();
        let site = |i: usize| Site { margin: 1.5 - 0.4 * i as f64, variance: 0.1 + 0.2 * i as f64 };
        let sites: Vec<Site> = (0..at.len()).map(site).collect();
        let arrangement = Arrangement::of(&links, &places, true);
        let vertices: Vec<Position> =
            (0..40).map(|i| Position::new(0.37 * f64::from(i) - 5.0, 0.21 * f64::from(i % 17), 1.0)).collect();
        let ordered: Vec<Position> = arrangement.order.iter().map(|&link| places[link]).collect();
        let columns = Columns::new(&vertices, &ordered, |_| 1e-6);
        let mut found = Vec::new();
        let sums = MarginSums::of(&law, &arrangement, &sites, &columns);
        // The sums are those of all laws of the same covariance.
        let others = [0, 1, 6, 7].map(|number| law.moved(number, 1.0).unwrap());
        let far = others[0].moved(1, -2.0).unwrap().moved(0, 3.0).unwrap();
        for law in [law, far].into_iter().chain(others) {
            sums.log_likelihoods(&law, &mut found);
            for (vertex, found) in vertices.iter().zip(&found) {
                let literal = literal(&law, &places, &sites, *vertex);
                assert!((found - literal).abs() < 1e-3, "{vertex:?}: {found} instead of {literal}");
            }
        }
        let alike = law.of_alike_nodes();
        MarginSums::of(&alike, &arrangement, &sites, &columns).log_likelihoods(&alike, &mut found);
        for (vertex, found) in vertices.iter().zip(&found) {
            let literal = literal(&alike, &places, &sites, *vertex);
            assert!((found - literal).abs() < 1e-3, "alike nodes, {vertex:?}: {found} instead of {literal}");
        }
        for number in 2..6 {
            let law = law.moved(number, 1.0).unwrap();
            sums.under(&law, &arrangement, &sites, &columns).log_likelihoods(&law, &mut found);
            let literal = literal(&law, &places, &sites, vertices[3]);
            assert!((found[3] - literal).abs() < 1e-3, "{number}: {} instead of {literal}", found[3]);
        }
    }
}
