//! The silence of all stops on grids that all nodes of a log share.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::sync::{Arc, PoisonError, RwLock};

use sextant_channel::Position;

use super::evidence::StrengthEvidence;
use crate::log_facts::SoughtHeights;
use crate::log_facts::search_box::SearchBox;
use crate::numerics::whole;

/// Vertices of a tile along each axis, in the plane and in space.
const EDGES: [[i64; 3]; 2] = [[8, 8, 1], [4, 4, 4]];
/// Steps are not finer than this (m).
const SMALLEST_STEP_M: f64 = 1e-6;
/// Layers over the sought heights at least.
const LAYERS: f64 = 10.0;
/// So many tiles are kept (100 MB); further ones are computed each time.
const MOST_TILES: usize = 200_000;

/// The log-probability that no stop hears a node, on grids whose vertices lie at multiples of their steps: each grid has half the
/// vertices of the next finer one along each axis. A tile of it is computed when a node first needs it.
pub(super) struct SilentField<'a> {
    pub(super) evidence: &'a StrengthEvidence,
    stops: &'a [Position],
    step_m: f64,
    heights: SoughtHeights,
    tiles: RwLock<BTreeMap<TileKey, Arc<[f64]>>>,
}

type TileKey = (u32, [i64; 3]);

/// A box of vertices of one grid.
#[derive(Clone, Debug)]
pub(super) struct GridPart {
    /// How often the finest step was doubled.
    doublings: u32,
    steps_m: [f64; 3],
    spans: [RangeInclusive<i64>; 3],
}

impl GridPart {
    /// Number of vertices.
    pub(super) fn len(&self) -> usize {
        self.spans.iter().map(|span| whole((span.end() - span.start() + 1) as f64)).product()
    }

    /// Distances of the vertices along the axes (m): 0 for the height if all have one.
    pub(super) fn steps_m(&self) -> [f64; 3] {
        self.steps_m
    }

    pub(super) fn is_as_fine_as(&self, other: &Self) -> bool {
        self.doublings == other.doublings
    }
}

impl<'a> SilentField<'a> {
    /// The silence of `stops` on grids whose finest step is `step_m`, for nodes at these heights.
    pub(super) fn new(
        evidence: &'a StrengthEvidence,
        stops: &'a [Position],
        step_m: f64,
        heights: SoughtHeights,
    ) -> Self {
        // All receptions at one place leave no reach.
        Self { evidence, stops, step_m: step_m.max(SMALLEST_STEP_M), heights, tiles: RwLock::default() }
    }

    /// The finest grid with at most `most` steps along each axis of a box; none that is coarser than `coarsest`, if that is given.
    pub(super) fn part(&self, within: &SearchBox, most: u32, coarsest: Option<&GridPart>) -> GridPart {
        let widest_m = (0..2).map(|axis| within.high[axis] - within.low[axis]).fold(0.0, f64::max);
        let mut doublings = 0;
        let mut step_m = self.step_m;
        while widest_m > f64::from(most) * step_m && coarsest.is_none_or(|part| doublings < part.doublings) {
            doublings += 1;
            step_m *= 2.0;
        }
        let steps_m = [step_m, step_m, step_m.min((self.heights.high_m - self.heights.low_m) / LAYERS)];
        let spans = [0, 1, 2].map(|axis| {
            if steps_m[axis] <= 0.0 {
                return 0..=0;
            }
            let ends = [within.low, within.high].map(|end| end[axis] / steps_m[axis]);
            match (number(ends[0].ceil()), number(ends[1].floor())) {
                (first, last) if first <= last => first..=last,
                // No vertex lies between the ends.
                _ => {
                    let nearest = number((0.5 * (ends[0] + ends[1])).round());
                    nearest..=nearest
                }
            }
        });
        GridPart { doublings, steps_m, spans }
    }

    /// Calls `visit` with each vertex of a part and the log-probability of silence there, tile by tile.
    pub(super) fn each(&self, part: &GridPart, mut visit: impl FnMut(Position, f64)) {
        let edge = EDGES[usize::from(part.steps_m[2] > 0.0)];
        let tiles = [0, 1, 2].map(|axis| {
            part.spans[axis].start().div_euclid(edge[axis])..=part.spans[axis].end().div_euclid(edge[axis])
        });
        for k in tiles[2].clone() {
            for j in tiles[1].clone() {
                for i in tiles[0].clone() {
                    let key = (part.doublings, [i, j, k]);
                    let first = [i * edge[0], j * edge[1], k * edge[2]];
                    let silence = self.tile(key, first, edge, part.steps_m);
                    let mut silence = silence.iter();
                    for z in first[2]..first[2] + edge[2] {
                        for y in first[1]..first[1] + edge[1] {
                            for x in first[0]..first[0] + edge[0] {
                                let Some(&value) = silence.next() else { return };
                                if [x, y, z].iter().zip(&part.spans).all(|(at, span)| span.contains(at)) {
                                    visit(self.place([x, y, z], part.steps_m), value);
                                }
                            }
                        }
                    }
                }
            }
        }
    }

    fn place(&self, [x, y, z]: [i64; 3], steps_m: [f64; 3]) -> Position {
        let height_m = if steps_m[2] > 0.0 { z as f64 * steps_m[2] } else { self.heights.low_m };
        Position::new(x as f64 * steps_m[0], y as f64 * steps_m[1], height_m)
    }

    fn tile(&self, key: TileKey, first: [i64; 3], edge: [i64; 3], steps_m: [f64; 3]) -> Arc<[f64]> {
        if let Some(tile) = self.tiles.read().unwrap_or_else(PoisonError::into_inner).get(&key) {
            return Arc::clone(tile);
        }
        let last = [0, 1, 2].map(|axis| first[axis] + edge[axis] - 1);
        let near = self.evidence.near(self.stops, self.place(first, steps_m), self.place(last, steps_m));
        let mut silence = Vec::with_capacity(whole((edge[0] * edge[1] * edge[2]) as f64));
        for z in first[2]..=last[2] {
            for y in first[1]..=last[1] {
                for x in first[0]..=last[0] {
                    silence.push(self.evidence.ln_silence(&near, self.place([x, y, z], steps_m)));
                }
            }
        }
        let silence: Arc<[f64]> = silence.into();
        let mut tiles = self.tiles.write().unwrap_or_else(PoisonError::into_inner);
        if tiles.len() < MOST_TILES {
            tiles.insert(key, Arc::clone(&silence));
        }
        silence
    }
}

/// The number of a vertex.
#[expect(
    clippy::cast_possible_truncation,
    reason = "boxes are far smaller than 2⁶³ steps; a cast beyond it saturates"
)]
fn number(along: f64) -> i64 {
    along as i64
}
