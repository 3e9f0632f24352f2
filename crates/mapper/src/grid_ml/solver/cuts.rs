//! Upper bounds of the likelihoods of many vertices from the curvature at one of them.
//!
//! Let d be the distance of a vertex from a stop, and S(d) a trapezoid. Within R of the stop `ln S(d)`, which is
//! `ln(slope (R - d))` beyond the plateau, is concave in the place of the vertex. There it bends down by at least
//! `1 / ((R - d) max(R - d, d))` in each direction. `ln(1 - S(d))` grows with d, is concave in d beyond the plateau,
//! and d bends up by at most `1 / d`. So the value and the gradient of the log-likelihood at one vertex, and a bound of
//! its bend on the way to the farthest one, bound it at all of them: one pass over the stops for many vertices.
//!
//! The sums are in single precision, and each error is on the safe side. A distance is off by less than `apart_m`. The
//! value and the slope that follow from it are exactly those of a curve that is moved by as much. The curves are moved
//! beforehand by twice that towards higher likelihoods, so the curve that is bounded is nowhere below the one of the
//! profile. What remains is the direction of a gradient, which is off by less than `4 apart_m / d`, and the rounding of
//! the sums. A floor of S raises the first curve by the floor, because `slope (R - d) + floor` is at least the clamped
//! S. It ends the second curve where S reaches the floor.

use sextant_channel::Position;
use wide::f32x4;

use super::curve::ReceptionCurve;
use super::places::PlaceLanes;
use super::product::{GROUP, GROUPS, LEAST, LaneProduct};
use super::screen::{APART, PER_FACTOR, ROUNDING};
use super::single::single;

/// Relative error of a sum of a chunk of terms, and of the terms.
const PER_SUM: f64 = 1e-5;

/// Absolute error of a logarithm.
const PER_LOGARITHM: f64 = 1e-6;

/// Nearer to a stop than this share of R, the direction to it is not used.
const NEAR: f64 = 0.01;

/// Nearer to R than this share of it, the likelihood counts as that at this place, which is higher.
const RIM: f64 = 1e-3;

/// A paraboloid above the log-likelihood, about a vertex.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    vertex: [f64; 3],
    top: f64,
    slope: [f64; 3],
    bend: f64,
}

impl Cut {
    /// The most that the log-likelihood at a place may be, of those within the reach for which the cut was made.
    #[inline(always)]
    pub(super) fn at(&self, place: [f64; 3]) -> f64 {
        let (mut along, mut square) = (0.0, 0.0);
        for ((place, vertex), slope) in place.into_iter().zip(self.vertex).zip(self.slope) {
            let apart = place - vertex;
            along += slope * apart;
            square += apart * apart;
        }
        self.top + along + 0.5 * self.bend * square
    }
}

/// Memory for cuts, used again for each batch of vertices.
#[derive(Debug, Default)]
pub(super) struct Narrowing {
    pub(super) cuts: Cuts,
    /// The most that each log-likelihood may be.
    pub(super) limits: Vec<f64>,
}

/// The stops that determine the likelihoods of a node, in the form for cuts.
#[derive(Debug, Default)]
pub(super) struct Cuts {
    heard: PlaceLanes,
    silent: PlaceLanes,
    middle: Position,
    /// Error of a distance (m).
    apart_m: f64,
}

/// What one stop contributes, a few stops side by side.
struct Term {
    factor: f32x4,
    /// The gradient over the way from the stop to the vertex (1/m2).
    pull: f32x4,
    /// Bound of the bend (1/m2).
    bend: f32x4,
}

/// The sum over stops of one kind.
#[derive(Default)]
struct Sum {
    product: LaneProduct,
    slope: [f64; 3],
    pull: f64,
    bend: f64,
}

impl Cuts {
    /// Takes the stops that heard a node and those that did not, for vertices in the box with these corners.
    pub(super) fn look_at(
        &mut self,
        curve: &ReceptionCurve,
        heard: &[Position],
        silent: &[Position],
        corners: [[f64; 3]; 2],
    ) {
        let [low, high] = corners;
        self.middle = Position::from([0, 1, 2].map(|axis| 0.5 * (low[axis] + high[axis])));
        self.apart_m = APART * (0..3).fold(curve.range_m, |sum, axis| sum + high[axis] - low[axis]);
        self.heard.set(heard.iter(), self.middle);
        self.silent.set(silent.iter(), self.middle);
    }

    /// The bound about `vertex`, for vertices within `reach_m` of it, all of them within R of every stop that heard the
    /// node. The profile must be a trapezoid with a floor below its top.
    pub(super) fn cut(&self, curve: &ReceptionCurve, vertex: Position, reach_m: f64) -> Cut {
        let spread = f32x4::splat(single(reach_m + 3.0 * self.apart_m));
        let heard = self.heard_sum(curve, vertex, spread);
        let silent = self.silent_sum(curve, vertex, spread);
        let top = single(curve.top).max(LEAST);
        let nothing = (1.0 + ROUNDING - single(curve.floor)).max(LEAST);
        let filling =
            self.heard.filling() * libm::log(f64::from(top)) + self.silent.filling() * libm::log(f64::from(nothing));
        let factors = (self.heard.count + self.silent.count + 64) as f64;
        let direction = (4.0 * self.apart_m + PER_SUM * curve.range_m) * reach_m * (silent.pull - heard.pull);
        Cut {
            vertex: vertex.into(),
            top: heard.product.ln() + silent.product.ln() - filling
                + factors * PER_FACTOR
                + direction
                + PER_LOGARITHM,
            slope: [0, 1, 2].map(|axis| heard.slope[axis] + silent.slope[axis]),
            bend: silent.bend * (1.0 + 2.0 * PER_SUM) + heard.bend * (1.0 - 2.0 * PER_SUM),
        }
    }

    /// Stops that heard the node: `ln(slope (R - d))`, at most `ln top`.
    fn heard_sum(&self, curve: &ReceptionCurve, vertex: Position, spread: f32x4) -> Sum {
        let end = curve.range_m + curve.floor / curve.slope + 2.0 * self.apart_m;
        let start = f32x4::splat(single(end - curve.top / curve.slope));
        let (least, rim) = (RIM * curve.range_m, f32x4::splat(single(end - RIM * curve.range_m)));
        let (end, least) = (f32x4::splat(single(end)), f32x4::splat(single(least)));
        let near = f32x4::splat(single(NEAR * curve.range_m));
        let (slope, top) = (f32x4::splat(single(curve.slope)), f32x4::splat(single(curve.top)));
        // Only stops that fill up a vector are farther.
        let far = end + end;
        self.sum(&self.heard, vertex, |d| {
            let gap = (end - d).fast_max(least);
            let s = gap * slope;
            let is_sloped = s.simd_lt(top) & d.simd_gt(near) & d.simd_lt(far);
            let low = d - spread;
            let room = end - low;
            let is_bent = is_sloped & low.simd_gt(start) & d.simd_lt(rim);
            Term {
                factor: is_sloped.select(s, top),
                pull: is_sloped.select(-f32x4::ONE / (gap * d), f32x4::ZERO),
                bend: is_bent.select(-f32x4::ONE / (room * room.fast_max(d + spread)), f32x4::ZERO),
            }
        })
    }

    /// Stops that did not hear the node: `ln(1 - S(d))`, which counts as that at the farthest vertex where the way there
    /// may touch the plateau.
    fn silent_sum(&self, curve: &ReceptionCurve, vertex: Position, spread: f32x4) -> Sum {
        let start = (curve.range_m - curve.top / curve.slope).max(NEAR * curve.range_m) + 2.0 * self.apart_m;
        let start = f32x4::splat(single(start));
        let end = f32x4::splat(single(curve.range_m - 2.0 * self.apart_m));
        let (slope, top) = (f32x4::splat(single(curve.slope)), f32x4::splat(single(curve.top)));
        let floor = f32x4::splat(single(curve.floor));
        let one = f32x4::splat(1.0 + ROUNDING);
        self.sum(&self.silent, vertex, |d| {
            let low = d - spread;
            let touches = low.simd_lt(start);
            let s = ((end - touches.select(d + spread, d)) * slope).fast_min(top).fast_max(floor);
            let factor = one - s;
            let is_rising = touches.select(f32x4::ZERO, s.simd_gt(floor));
            let pull = is_rising.select(slope / (factor * d), f32x4::ZERO);
            Term { factor, pull, bend: is_rising.select(pull * d / low, f32x4::ZERO) }
        })
    }

    /// The sum of the terms of all `places`, by their distances from the vertex.
    #[inline(always)]
    fn sum(&self, places: &PlaceLanes, vertex: Position, term: impl Fn(f32x4) -> Term) -> Sum {
        let vertex = <[f64; 3]>::from(vertex - self.middle).map(|value| f32x4::splat(single(value)));
        let least = f32x4::splat(LEAST);
        let mut sum = Sum::default();
        for chunk in places.coordinates.chunks(GROUPS * GROUP) {
            let [mut x, mut y, mut z, mut pull, mut bend] = [f32x4::ZERO; 5];
            for group in chunk.chunks(GROUP) {
                let mut product = f32x4::ONE;
                for place in group {
                    let [dx, dy, dz] = [vertex[0] - place[0], vertex[1] - place[1], vertex[2] - place[2]];
                    let term = term((dx * dx + dy * dy + dz * dz).sqrt());
                    product *= term.factor.fast_max(least);
                    x += term.pull * dx;
                    y += term.pull * dy;
                    z += term.pull * dz;
                    pull += term.pull;
                    bend += term.bend;
                }
                sum.product.multiply(product);
            }
            sum.product.normalise();
            for (total, lanes) in sum.slope.iter_mut().zip([x, y, z]) {
                *total += f64::from(lanes.reduce_add());
            }
            sum.pull += f64::from(pull.reduce_add());
            sum.bend += f64::from(bend.reduce_add());
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::profile::{ProfileConfig, ReceptionProfile, TrapezoidConfig};

    const R: f64 = 10.0;

    fn places(count: std::ops::Range<usize>, reach_m: f64, height_m: f64) -> impl Strategy<Value = Vec<Position>> {
        let place = (-reach_m..reach_m, -reach_m..reach_m, -1.0..1.0_f64);
        prop::collection::vec(place.prop_map(move |(x, y, z)| Position::new(x, y, z * height_m)), count)
    }

    fn extent(vertices: &[Position]) -> [[f64; 3]; 2] {
        let coordinates = |axis: usize| vertices.iter().map(move |&vertex| <[f64; 3]>::from(vertex)[axis]);
        let low = [0, 1, 2].map(|axis| coordinates(axis).fold(f64::INFINITY, f64::min));
        [low, [0, 1, 2].map(|axis| coordinates(axis).fold(f64::NEG_INFINITY, f64::max))]
    }

    /// Cuts at all `vertices`, and what the literal product has there.
    fn cuts_and_values(
        profile: &ReceptionProfile,
        [vertices, heard, silent]: [&[Position]; 3],
    ) -> (Vec<Cut>, Vec<f64>) {
        let curve = ReceptionCurve::new(profile);
        let mut cuts = Cuts::default();
        cuts.look_at(&curve, heard, silent, extent(vertices));
        let farthest = |a: Position| vertices.iter().map(|b| b.distance_m(a)).fold(0.0, f64::max);
        let value = |vertex: &Position| -> f64 {
            let s = |stop: &Position| profile.probability(vertex.distance_m(*stop));
            heard.iter().map(|stop| s(stop).ln()).sum::<f64>()
                + silent.iter().map(|stop| (1.0 - s(stop)).ln()).sum::<f64>()
        };
        let cuts = vertices.iter().map(|&vertex| cuts.cut(&curve, vertex, farthest(vertex))).collect();
        (cuts, vertices.iter().map(value).collect())
    }

    fn trapezoid(config: TrapezoidConfig) -> ReceptionProfile {
        ReceptionProfile::try_from(ProfileConfig::Trapezoid(config)).expect("a good profile")
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn a_cut_is_nowhere_below_the_literal_product(
            (vertices, heard, silent) in prop_oneof![Just((0.0, 4.0)), Just((0.0, 0.6)), Just((3.0, 2.0))]
                .prop_flat_map(|(height_m, reach_m)| (
                    places(2..12, reach_m, height_m),
                    places(0..30, R, 2.0 * height_m),
                    places(0..30, 1.3 * R, 2.0 * height_m),
                )),
            p0 in 0.05..1.0,
            plateau in prop_oneof![Just(0.0), 0.0..0.97],
            floor in prop_oneof![Just(0.0), Just(1e-6), Just(0.02)],
            ceiling in prop_oneof![Just(1.0), Just(1.0 - 1e-6), Just(0.7)],
            away_m in prop_oneof![Just(0.0), Just(5e5)],
        ) {
            let config = TrapezoidConfig { p0, plateau_m: plateau * R, range_m: R, floor, ceiling };
            let away = Position::new(away_m, -away_m, 0.0);
            let [vertices, heard, silent] =
                [vertices, heard, silent].map(|all| all.into_iter().map(|place| place + away).collect::<Vec<_>>());
            let is_near = |stop: &Position| vertices.iter().all(|vertex| vertex.distance_m(*stop) < R);
            let heard: Vec<Position> = heard.into_iter().filter(is_near).collect();
            let (cuts, values) = cuts_and_values(&trapezoid(config), [&vertices, &heard, &silent]);
            for cut in cuts {
                for (&vertex, &value) in vertices.iter().zip(&values) {
                    let bound = cut.at(vertex.into());
                    prop_assert!(bound >= value, "{} below {}, {:?} at {:?}", bound, value, cut, vertex);
                }
            }
        }
    }

    #[test]
    fn a_cut_touches_the_likelihood_at_its_vertex_and_stays_close_around_it() {
        let ring = |count: u32, radius_m: f64| -> Vec<Position> {
            let angle = |i: u32| f64::from(i) * std::f64::consts::TAU / f64::from(count);
            (0..count).map(|i| Position::new(radius_m * angle(i).cos(), radius_m * angle(i).sin(), 0.0)).collect()
        };
        let vertices = [[0.0, 0.0], [0.25, 0.0], [0.0, -0.25]].map(|[x, y]| Position::new(x, y, 0.0));
        let profile = trapezoid(TrapezoidConfig::new(0.95, 2.0, R));
        let (cuts, values) = cuts_and_values(&profile, [&vertices, &ring(40, 5.0), &ring(30, 8.0)]);
        for (cut, vertex) in cuts.iter().zip(&vertices) {
            for (other, value) in vertices.iter().zip(&values) {
                let above = cut.at((*other).into()) - value;
                let allowed = 0.01 + 0.6 * vertex.distance_m(*other).powi(2);
                assert!(above >= 0.0 && above < allowed, "{above} above the likelihood at {other:?}");
            }
        }
    }
}
