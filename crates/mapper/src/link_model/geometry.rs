//! Distances and directions from possible places of a node to the places of its links.

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch, f32x8, f64x4};
use sextant_channel::Position;
use sextant_kernel::maths::ln_each_single;

use super::links::HeardLink;

/// Vertices that are treated together: their sums and all that they are made of stay in the registers and the nearest memory.
pub(super) const BLOCK: usize = 8;
/// What is known at a vertex of a place: logarithm of the distance, cosine and sine of the direction and of twice the
/// direction.
pub(super) const COLUMNS: usize = 5;
/// A place is compared with at most so many neighbours.
pub(super) const NEIGHBOURS: usize = 8;

/// The values of a column at the vertices of a block.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(super) struct Lane([f32; BLOCK]);

impl Lane {
    pub(super) const ZERO: Self = Self([0.0; BLOCK]);

    #[inline(always)]
    pub(super) fn of<S: Simd>(values: f32x8<S>) -> Self {
        Self(values.into())
    }

    #[inline(always)]
    pub(super) fn load<S: Simd>(&self, simd: S) -> f32x8<S> {
        self.0.simd_into(simd)
    }

    /// The values at the first half of the vertices, or at the second, in double precision.
    #[inline(always)]
    pub(super) fn half<S: Simd>(&self, simd: S, number: usize) -> f64x4<S> {
        <[f64; BLOCK / 2]>::simd_into(std::array::from_fn(|lane| f64::from(self.0[number * BLOCK / 2 + lane])), simd)
    }
}

/// Where the places of a node's links lie relative to each other. The shadowing at a place is predicted from at most
/// [`NEIGHBOURS`] nearest places before it (Vecchia 1988), in an order in which each next place is the one farthest from all
/// before it, which makes few neighbours enough (Guinness 2018).
#[derive(Clone, Debug)]
pub(super) struct Arrangement {
    /// Index of the link at each position of the order.
    pub(super) order: Vec<usize>,
    /// The neighbours of each, as positions of the order, and the distances: to them, then between them by rows below the
    /// diagonal (m).
    pub(super) neighbours: Vec<LinkNeighbours>,
}

#[derive(Clone, Debug, Default)]
pub(super) struct LinkNeighbours {
    pub(super) at: Vec<usize>,
    pub(super) distances_m: Vec<f64>,
}

impl Arrangement {
    /// The arrangement of `links`, of which there may be a few hundred. Links that share nothing need no neighbours and no order.
    pub(super) fn of(links: &[HeardLink], places: &[Position], needs_neighbours: bool) -> Self {
        if !needs_neighbours {
            return Self {
                order: (0..links.len()).collect(),
                neighbours: vec![LinkNeighbours::default(); links.len()],
            };
        }
        let at: Vec<Position> = links.iter().map(|link| places[link.place]).collect();
        let order = farthest_first(&at);
        let mut near: Vec<(f64, usize)> = Vec::new();
        let neighbours = order.iter().enumerate().map(|(position, &link)| {
            near.clear();
            near.extend(
                order[..position].iter().enumerate().map(|(before, &other)| (at[link].distance_m(at[other]), before)),
            );
            keep_nearest(&mut near);
            let mut distances_m: Vec<f64> = near.iter().map(|&(distance_m, _)| distance_m).collect();
            for (row, &(_, first)) in near.iter().enumerate() {
                let between = near[..row].iter().map(|&(_, second)| at[order[first]].distance_m(at[order[second]]));
                distances_m.extend(between);
            }
            LinkNeighbours { at: near.iter().map(|&(_, before)| before).collect(), distances_m }
        });
        Self { neighbours: neighbours.collect(), order }
    }
}

/// Keeps the [`NEIGHBOURS`] nearest of places, which are given by their distances and ranks (m), the nearest first. Where
/// distances are alike, as on a lattice, the ranks count, and not how the distances were rounded.
pub(super) fn keep_nearest(near: &mut Vec<(f64, usize)>) {
    let key = |&(distance_m, rank): &(f64, usize)| (about(distance_m), rank);
    if near.len() > NEIGHBOURS {
        near.select_nth_unstable_by_key(NEIGHBOURS, key);
        near.truncate(NEIGHBOURS);
    }
    near.sort_unstable_by_key(key);
}

/// Distances within this share of each other are alike.
const ALIKE: f64 = 1e-3;

/// A number that grows with a distance, and is the same for distances that are alike: its exponent and ten binary digits. Round
/// distances are not at the border between two numbers.
fn about(distance_m: f64) -> u32 {
    single(distance_m * 1.000_37).to_bits() >> 13
}

/// `value` in single precision, which has enough digits for logarithms, directions and margins.
#[expect(clippy::cast_possible_truncation, reason = "rounding is what is wanted")]
pub(super) fn single(value: f64) -> f32 {
    value as f32
}

/// An order of the places in which each next one is the farthest from those before it. The first is the one nearest to the
/// middle of all.
fn farthest_first(at: &[Position]) -> Vec<usize> {
    let Some(share) = (!at.is_empty()).then(|| 1.0 / at.len() as f64) else { return Vec::new() };
    let middle = at.iter().fold(Position::ORIGIN, |sum, &place| sum + place) * share;
    let mut nearest_m = vec![f64::INFINITY; at.len()];
    let mut is_left = vec![true; at.len()];
    // Of places that are alike, the first counts, whatever rounding says.
    let from_middle = |place: usize| at[place].distance_m(middle);
    let first = (0..at.len())
        .reduce(|best, other| if from_middle(other) < from_middle(best) * (1.0 - ALIKE) { other } else { best });
    let mut next = first;
    let mut order = Vec::with_capacity(at.len());
    while let Some(link) = next {
        order.push(link);
        is_left[link] = false;
        next = None;
        let mut farthest_m = 0.0;
        for other in 0..at.len() {
            if is_left[other] {
                nearest_m[other] = nearest_m[other].min(at[other].distance_m(at[link]));
                if nearest_m[other] > farthest_m * (1.0 + ALIKE) || next.is_none() {
                    (farthest_m, next) = (nearest_m[other], Some(other));
                }
            }
        }
    }
    order
}

/// A weighted sum, and that of the squares.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct MeanSquare {
    pub(super) mean: f64,
    pub(super) square: f64,
}

/// The vertices of a block by coordinates (m), and the squares of the least distances from them that count (m²).
struct SeenBlock {
    at: [[f64; BLOCK]; 3],
    least_m2: [f32; BLOCK],
}

impl SeenBlock {
    fn of(vertices: &[Position], least_m: impl Fn(usize) -> f64) -> Self {
        // What is beyond the end is at the last vertex.
        let last = vertices.len().saturating_sub(1);
        let along = |axis: usize| std::array::from_fn(|lane| <[f64; 3]>::from(vertices[lane.min(last)])[axis]);
        let least_m2: [f32; BLOCK] =
            std::array::from_fn(|lane| single(least_m(lane.min(last)).powi(2)).max(f32::MIN_POSITIVE));
        Self { at: [along(0), along(1), along(2)], least_m2 }
    }
}

/// The columns of a place at the vertices of a block, but the logarithm of the distance, and the square of the distance (m²).
#[inline(always)]
fn columns<S: Simd>(simd: S, seen: &SeenBlock, place: Position) -> ([Lane; COLUMNS], [f32; BLOCK]) {
    let way =
        |axis: usize, along: f64| -> f32x8<S> { seen.at[axis].map(|vertex| single(along - vertex)).simd_into(simd) };
    let [x_m, y_m, z_m] = [way(0, place.x_m), way(1, place.y_m), way(2, place.z_m)];
    let flat_m2 = x_m * x_m + y_m * y_m;
    // A place right above or below has no direction.
    let is_aside = flat_m2.simd_gt(f32x8::splat(simd, LEAST_ASIDE_M2));
    let per_m = is_aside.select(f32x8::splat(simd, 1.0) / flat_m2.sqrt(), f32x8::splat(simd, 0.0));
    let [cosine, sine] = [x_m * per_m, y_m * per_m];
    let least_m2: f32x8<S> = seen.least_m2.simd_into(simd);
    let square_m2 = (flat_m2 + z_m * z_m).max(least_m2);
    let twice = cosine + cosine;
    let [of_twice, sine_of_twice] = [cosine * cosine - sine * sine, twice * sine];
    let columns = [f32x8::splat(simd, 0.0), cosine, sine, of_twice, sine_of_twice];
    (columns.map(Lane::of), square_m2.into())
}

/// Squares of distances that are less have no direction (m²).
const LEAST_ASIDE_M2: f32 = 1e-18;

/// The columns of all links at all vertices, by blocks of vertices; within a block in the order of an arrangement.
#[derive(Clone, Debug)]
pub(super) struct Columns {
    lanes: Vec<[Lane; COLUMNS]>,
    links: usize,
}

impl Columns {
    /// The columns at `vertices`. Distances from each are at least what `least_m` says of its number.
    pub(super) fn new(vertices: &[Position], places: &[Position], least_m: impl Fn(usize) -> f64) -> Self {
        dispatch!(Level::new(), simd => Self::with(simd, vertices, places, &least_m))
    }

    #[inline(always)]
    fn with<S: Simd>(simd: S, vertices: &[Position], places: &[Position], least_m: &impl Fn(usize) -> f64) -> Self {
        let mut lanes = Vec::with_capacity(vertices.len().div_ceil(BLOCK) * places.len());
        let mut squares_m2: Vec<f32> = Vec::with_capacity(BLOCK * places.len());
        for (number, block) in vertices.chunks(BLOCK).enumerate() {
            let seen = SeenBlock::of(block, |lane| least_m(number * BLOCK + lane));
            squares_m2.clear();
            let first = lanes.len();
            for &place in places {
                let (columns, square_m2) = columns(simd, &seen, place);
                squares_m2.extend(square_m2);
                lanes.push(columns);
            }
            ln_each_single(&mut squares_m2);
            for ([logarithm, ..], square) in lanes[first..].iter_mut().zip(squares_m2.as_chunks::<BLOCK>().0) {
                *logarithm = Lane(square.map(|logarithm| 0.5 * logarithm));
            }
        }
        Self { lanes, links: places.len() }
    }

    /// The sums over vertices of the logarithm of the distance to each link and of its square, weighted by the shares of vertices.
    pub(super) fn mean_logarithms(&self, shares: &[f64]) -> Vec<MeanSquare> {
        let mut sums = vec![MeanSquare::default(); self.links];
        for (block, shares) in self.blocks().zip(shares.chunks(BLOCK)) {
            if shares.iter().all(|&share| share <= 0.0) {
                continue;
            }
            for (sum, [logarithms, ..]) in sums.iter_mut().zip(block) {
                for (logarithm, share) in logarithms.0.into_iter().zip(shares) {
                    let logarithm = f64::from(logarithm);
                    sum.mean += share * logarithm;
                    sum.square += share * logarithm * logarithm;
                }
            }
        }
        sums
    }

    /// The columns of each block of vertices.
    pub(super) fn blocks(&self) -> impl ExactSizeIterator<Item = &[[Lane; COLUMNS]]> {
        self.lanes.chunks(self.links.max(1))
    }
}
