//! Upper bounds of likelihoods in single precision: which vertices deserve an exact look.
//!
//! Where only the highest likelihood is wanted, all but a few vertices are ruled out here, with twice the factors an
//! instruction of the exact product. Every rounding is on the safe side: a distance is taken to be off by [`APART`]
//! of the extent of the scene, in the direction that raises the factor, and what is left of rounding, below
//! [`PER_FACTOR`] a factor, is added at the end. A vertex ruled out is therefore certainly below the highest.

use sextant_channel::Position;
use wide::f32x4;

use super::curve::ReceptionCurve;
use super::evidence::PacketEvidence;
use super::places::{LANES, PlaceLanes};
use super::product::{GROUP, GROUPS, LEAST, LaneProduct};
use super::single::single;
use super::wedges::Coverage;

/// Error of a distance over the largest coordinate: sixteen roundings.
pub(super) const APART: f64 = 1e-6;

/// Relative error of a factor but for its distance, and of the products: eight roundings.
pub(super) const PER_FACTOR: f64 = 5e-7;

/// Absolute error of a probability.
pub(super) const ROUNDING: f32 = 2e-7;

/// Most packets at one stop; a log with more is scored without bounds.
const MOST_PACKETS: u32 = 64;

/// Memory for bounds, used again for each batch of vertices.
#[derive(Debug, Default)]
pub(crate) struct Screen {
    /// For each vertex, a number that grows with its bound; see [`key`].
    keys: Vec<f64>,
    heard: PlaceLanes,
    silent: PlaceLanes,
    /// What the keys are above a bound's logarithm [bit]: at most the rounding errors, less the factors of the
    /// stops that fill up vectors.
    offset: f64,
}

/// The evidence on a node, and the vertices to be bounded.
pub(crate) struct BoundScene<'s> {
    pub(crate) curve: &'s ReceptionCurve,
    pub(crate) evidence: &'s PacketEvidence,
    pub(crate) silent: &'s [Position],
    /// What sectors cover, if silence elsewhere says nothing.
    pub(crate) coverage: Option<Coverage<'s>>,
    /// Coordinates of the vertices.
    pub(crate) vertices: [&'s [f64]; 3],
    /// Bounding box of the vertices.
    pub(crate) corners: [[f64; 3]; 2],
}

/// A profile in single precision, shifted so that it is never below (or never above) the exact one.
#[derive(Clone, Copy)]
struct Moved<'c> {
    range_m: f32x4,
    slope: f32x4,
    top: f32x4,
    floor: f32x4,
    table: &'c [[f32; 2]],
    per_m: f32,
    rise: f32x4,
}

impl<'c> Moved<'c> {
    /// The curve for distances that are off by up to `apart_m`: at least the exact one if it is above zero, at most
    /// if it is below.
    fn new(curve: &'c ReceptionCurve, apart_m: f64) -> Self {
        let rise = single(apart_m * curve.steepest_per_m) + if apart_m > 0.0 { ROUNDING } else { -ROUNDING };
        Self {
            range_m: f32x4::splat(single(curve.range_m + apart_m)),
            slope: f32x4::splat(single(curve.slope)),
            top: f32x4::splat(single(curve.top)),
            floor: f32x4::splat(single(curve.floor)),
            table: &curve.table_single,
            per_m: single(1.0 / curve.step_m),
            rise: f32x4::splat(rise),
        }
    }

    #[inline(always)]
    fn trapezoid(&self, square: f32x4) -> f32x4 {
        ((self.range_m - square.sqrt()) * self.slope).fast_min(self.top).fast_max(self.floor)
    }

    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "an index of a table")]
    #[expect(clippy::cast_sign_loss, reason = "distances are not negative")]
    fn interpolated(&self, square: f32x4) -> f32x4 {
        let d = square.sqrt();
        let [mut value, mut increment] = [[0.0; LANES]; 2];
        let mut fraction = (d * self.per_m).to_array();
        for lane in 0..LANES {
            let below = (fraction[lane] as usize).min(self.table.len() - 1);
            [value[lane], increment[lane]] = self.table[below];
            fraction[lane] -= below as f32;
        }
        let s = f32x4::from(value) + f32x4::from(increment) * f32x4::from(fraction) + self.rise;
        // Nothing is received beyond the range.
        d.simd_lt(self.range_m).select(s, f32x4::ZERO).fast_min(self.top).fast_max(self.floor)
    }

    fn at(&self, square: f32x4) -> f32x4 {
        if self.table.is_empty() { self.trapezoid(square) } else { self.interpolated(square) }
    }
}

impl Screen {
    /// Bounds the likelihoods of a scene. Returns whether it did. If not, the bounds mean nothing.
    pub(crate) fn bound(&mut self, scene: &BoundScene<'_>) -> bool {
        let BoundScene { curve, evidence, silent, coverage, vertices: [x, y, z], corners: [low, high] } = *scene;
        if evidence.counts.iter().any(|count| count.received + count.missed > MOST_PACKETS) {
            return false;
        }
        let middle = Position::from([0, 1, 2].map(|axis| 0.5 * (low[axis] + high[axis])));
        let extent_m = (0..3).fold(curve.range_m, |sum, axis| sum + high[axis] - low[axis]);
        let apart_m = APART * extent_m;
        self.heard.set(evidence.heard.iter(), middle);
        self.silent.set(silent.iter(), middle);
        let (above, below) = (Moved::new(curve, apart_m), Moved::new(curve, -apart_m));
        let one = f32x4::splat(1.0 + ROUNDING);
        let packets = evidence.counts.iter().map(|count| count.received + count.missed).sum::<u32>();
        let factors = (self.heard.count + self.silent.count + packets as usize + 64) as f64;
        let nothing = f64::from(single(curve.floor));
        let filling = self.heard.filling() * libm::log2(nothing.max(f64::from(LEAST)))
            + self.silent.filling() * libm::log2(f64::from(1.0 + ROUNDING) - nothing);
        self.offset = filling - factors * PER_FACTOR / std::f64::consts::LN_2;
        self.keys.clear();
        for ((x, y), z) in x.iter().zip(y).zip(z) {
            let vertex =
                <[f64; 3]>::from(Position::new(*x, *y, *z) - middle).map(|value| f32x4::splat(single(value)));
            let mut bound = Bound { vertex, product: LaneProduct::default() };
            if let Some(coverage) = coverage {
                bound.multiply(&self.heard, |square| above.at(square));
                bound.multiply_apart(&self.silent, |apart, square| {
                    let covered = coverage.certainly_covers(&apart, single(apart_m));
                    one - covered.select(below.at(square), below.floor)
                });
            } else if curve.is_table() {
                bound.multiply(&self.heard, |square| above.interpolated(square));
                bound.multiply(&self.silent, |square| one - below.interpolated(square));
            } else {
                bound.multiply(&self.heard, |square| above.trapezoid(square));
                bound.multiply(&self.silent, |square| one - below.trapezoid(square));
            }
            for count in &evidence.counts {
                let place = <[f64; 3]>::from(count.place - middle).map(|value| f32x4::splat(single(value)));
                let square = bound.square(&place);
                bound.product.raise(above.at(square), count.received);
                let covered = coverage
                    .filter(|_| count.received == 0)
                    .map(|coverage| coverage.certainly_covers(&bound.apart(&place), single(apart_m)));
                let s = below.at(square);
                bound.product.raise(one - covered.map_or(s, |covered| covered.select(s, below.floor)), count.missed);
            }
            self.keys.push(bound.product.key());
        }
        true
    }

    /// The vertices with the highest bounds, the highest first.
    pub(crate) fn highest<const N: usize>(&self) -> [usize; N] {
        highest(&self.keys)
    }

    /// The vertices whose log-likelihood may be `least` or more.
    pub(crate) fn candidates(&self, least: f64) -> impl Iterator<Item = usize> {
        let bits = least / std::f64::consts::LN_2 + self.offset;
        let whole = bits.floor();
        let threshold = if bits.is_finite() { whole + (libm::exp2(bits - whole) - 1.0) - 1e-9 } else { bits };
        self.keys.iter().enumerate().filter(move |&(_, &key)| key >= threshold).map(|(vertex, _)| vertex)
    }
}

/// The indices of the highest of `values`, the highest first.
pub(super) fn highest<const N: usize>(values: &[f64]) -> [usize; N] {
    let mut best = [(f64::NEG_INFINITY, 0); N];
    for (at, &value) in values.iter().enumerate() {
        if value > best[N - 1].0 {
            let mut place = N - 1;
            while place > 0 && value > best[place - 1].0 {
                best[place] = best[place - 1];
                place -= 1;
            }
            best[place] = (value, at);
        }
    }
    best.map(|(_, at)| at)
}

/// Running product of the factors of one vertex.
struct Bound {
    vertex: [f32x4; 3],
    product: LaneProduct,
}

impl Bound {
    /// The vertex as seen from a place.
    #[inline(always)]
    fn apart(&self, place: &[f32x4; 3]) -> [f32x4; 3] {
        let ([x, y, z], [at_x, at_y, at_z]) = (self.vertex, *place);
        [x - at_x, y - at_y, z - at_z]
    }

    #[inline(always)]
    fn square(&self, place: &[f32x4; 3]) -> f32x4 {
        let [dx, dy, dz] = self.apart(place);
        dx * dx + dy * dy + dz * dz
    }

    /// Multiplies by `factor` of the squared distance to each of `places`.
    #[inline(always)]
    fn multiply(&mut self, places: &PlaceLanes, factor: impl Fn(f32x4) -> f32x4) {
        self.multiply_apart(places, |_, square| factor(square));
    }

    /// Multiplies by `factor` of the vertex as seen from each of `places`, and of its squared distance.
    #[inline(always)]
    fn multiply_apart(&mut self, places: &PlaceLanes, factor: impl Fn([f32x4; 3], f32x4) -> f32x4) {
        let least = f32x4::splat(LEAST);
        for chunk in places.coordinates.chunks(GROUPS * GROUP) {
            for group in chunk.chunks(GROUP) {
                let mut product = f32x4::ONE;
                for place in group {
                    product *= factor(self.apart(place), self.square(place)).fast_max(least);
                }
                self.product.multiply(product);
            }
            self.product.normalise();
        }
    }
}
