//! Upper bounds of likelihoods in single precision: which vertices deserve an exact look.
//!
//! Where only the highest likelihood is wanted, all but a few vertices are ruled out here, with twice the factors an
//! instruction of the exact product. Every rounding is on the safe side: a distance is taken to be off by [`APART`]
//! of the extent of the scene, in the direction that raises the factor, and what is left of rounding, below
//! [`PER_FACTOR`] a factor, is added at the end. A vertex ruled out is therefore certainly below the highest.

use sextant_channel::Position;
use wide::f32x4;

use super::curve::Curve;
use super::evidence::Evidence;
use super::single::single;
use super::wedges::Coverage;

/// Stops taken together.
const LANES: usize = 4;

/// Factors, each at least [`LEAST`], whose product is a normal number.
const GROUP: usize = 4;

/// The place of stops that only fill up a vector (m); it is beyond any range.
const NOWHERE: f32 = 1e18;

/// Lowest bound of a factor. Raising a factor keeps it an upper bound.
const LEAST: f32 = 1e-9;

/// Error of a distance over the largest coordinate: sixteen roundings.
const APART: f64 = 1e-6;

/// Relative error of a factor but for its distance, and of the products: eight roundings.
const PER_FACTOR: f64 = 5e-7;

/// Absolute error of a probability.
const ROUNDING: f32 = 2e-7;

/// Most packets at one stop; a log with more is scored without bounds.
const MOST_PACKETS: u32 = 64;

/// Memory for bounds, used again for each batch of vertices.
#[derive(Debug, Default)]
pub(crate) struct Screen {
    /// For each vertex, a number that grows with its bound; see [`key`].
    keys: Vec<f64>,
    heard: Places,
    silent: Places,
    /// What the keys are above a bound's logarithm [bit]: at most the rounding errors, less the factors of the
    /// stops that fill up vectors.
    offset: f64,
}

/// Places by coordinate, a few side by side.
#[derive(Debug, Default)]
struct Places {
    coordinates: Vec<[f32x4; 3]>,
    count: usize,
}

impl Places {
    fn set<'p>(&mut self, places: impl ExactSizeIterator<Item = &'p Position>, middle: Position) {
        self.coordinates.clear();
        self.count = places.len();
        let mut block = [[NOWHERE; LANES]; 3];
        for (i, &place) in places.enumerate() {
            for (axis, value) in <[f64; 3]>::from(place - middle).into_iter().enumerate() {
                block[axis][i % LANES] = single(value);
            }
            if i % LANES == LANES - 1 {
                self.coordinates.push(block.map(f32x4::from));
                block = [[NOWHERE; LANES]; 3];
            }
        }
        if !self.count.is_multiple_of(LANES) {
            self.coordinates.push(block.map(f32x4::from));
        }
    }

    /// Stops that only fill up a vector.
    fn filling(&self) -> f64 {
        (self.coordinates.len() * LANES - self.count) as f64
    }
}

/// The evidence on a node, and the vertices to be bounded.
pub(crate) struct Scene<'s> {
    pub(crate) curve: &'s Curve,
    pub(crate) evidence: &'s Evidence,
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
    fn new(curve: &'c Curve, apart_m: f64) -> Self {
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
    pub(crate) fn bound(&mut self, scene: &Scene<'_>) -> bool {
        let Scene { curve, evidence, silent, coverage, vertices: [x, y, z], corners: [low, high] } = *scene;
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
            let mut bound = Bound { vertex, mantissa: [1.0; LANES], exponent: 0 };
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
                bound.raise(above.at(square), count.received);
                let covered = coverage
                    .filter(|_| count.received == 0)
                    .map(|coverage| coverage.certainly_covers(&bound.apart(&place), single(apart_m)));
                let s = below.at(square);
                bound.raise(one - covered.map_or(s, |covered| covered.select(s, below.floor)), count.missed);
            }
            self.keys.push(bound.key());
        }
        true
    }

    /// The vertices with the highest bounds, the highest first.
    pub(crate) fn highest<const N: usize>(&self) -> [usize; N] {
        let mut best = [(f64::NEG_INFINITY, 0); N];
        for (vertex, &bound) in self.keys.iter().enumerate() {
            if bound > best[N - 1].0 {
                let mut place = N - 1;
                while place > 0 && bound > best[place - 1].0 {
                    best[place] = best[place - 1];
                    place -= 1;
                }
                best[place] = (bound, vertex);
            }
        }
        best.map(|(_, vertex)| vertex)
    }

    /// The vertices whose log-likelihood may be `least` or more.
    pub(crate) fn candidates(&self, least: f64) -> impl Iterator<Item = usize> {
        let bits = least / std::f64::consts::LN_2 + self.offset;
        let whole = bits.floor();
        let threshold = if bits.is_finite() { whole + (libm::exp2(bits - whole) - 1.0) - 1e-9 } else { bits };
        self.keys.iter().enumerate().filter(move |&(_, &key)| key >= threshold).map(|(vertex, _)| vertex)
    }
}

/// Running product of the factors of one vertex, by lanes of stops: `mantissa · 2^exponent`.
struct Bound {
    vertex: [f32x4; 3],
    mantissa: [f64; LANES],
    exponent: i64,
}

impl Bound {
    /// The vertex as seen from a place.
    #[inline(always)]
    fn apart(&self, place: &[f32x4; 3]) -> [f32x4; 3] {
        [0, 1, 2].map(|axis| self.vertex[axis] - place[axis])
    }

    #[inline(always)]
    fn square(&self, place: &[f32x4; 3]) -> f32x4 {
        let [dx, dy, dz] = self.apart(place);
        dx * dx + dy * dy + dz * dz
    }

    /// Multiplies by `factor` of the squared distance to each of `places`.
    #[inline(always)]
    fn multiply(&mut self, places: &Places, factor: impl Fn(f32x4) -> f32x4) {
        self.multiply_apart(places, |_, square| factor(square));
    }

    /// Multiplies by `factor` of the vertex as seen from each of `places`, and of its squared distance.
    #[inline(always)]
    fn multiply_apart(&mut self, places: &Places, factor: impl Fn([f32x4; 3], f32x4) -> f32x4) {
        let least = f32x4::splat(LEAST);
        for chunk in places.coordinates.chunks(8 * GROUP) {
            for group in chunk.chunks(GROUP) {
                let mut product = f32x4::ONE;
                for place in group {
                    product *= factor(self.apart(place), self.square(place)).fast_max(least);
                }
                for (mantissa, product) in self.mantissa.iter_mut().zip(product.to_array()) {
                    *mantissa *= f64::from(product);
                }
            }
            self.normalise();
        }
    }

    /// Multiplies by a factor, the same in all lanes, to the power `times`.
    fn raise(&mut self, factor: f32x4, times: u32) {
        let factor = f64::from(factor.to_array()[0].max(LEAST));
        for done in 0..times {
            self.mantissa[0] *= factor;
            if done % 16 == 15 {
                self.normalise();
            }
        }
        self.normalise();
    }

    /// Moves the powers of two of the mantissas, which are normal numbers, to the exponent.
    #[inline(always)]
    fn normalise(&mut self) {
        for mantissa in &mut self.mantissa {
            let bits = mantissa.to_bits();
            self.exponent += (bits >> 52) as i64 - 1023;
            *mantissa = f64::from_bits(bits & ((1 << 52) - 1) | 1023 << 52);
        }
    }

    /// A number that grows with the product: its binary logarithm, linear between powers of two.
    fn key(mut self) -> f64 {
        let [a, b, c, d] = self.mantissa;
        self.mantissa = [(a * b) * (c * d), 1.0, 1.0, 1.0];
        self.normalise();
        self.exponent as f64 + (self.mantissa[0] - 1.0)
    }
}
