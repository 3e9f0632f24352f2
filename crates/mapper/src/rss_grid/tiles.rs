//! The grid in tiles, and the tiles in blocks, with the log-likelihood of silence.

use std::ops::Range;
use std::sync::OnceLock;

use rayon::prelude::*;
use sextant_channel::Position;
use sextant_kernel::{Interrupted, Watch};

use crate::lattice::Lattice;

/// Number of vertices of a tile along x, y and z, in a plane and in space. It is also the number of tiles of a block.
const EDGES: [[usize; 3]; 2] = [[8, 8, 1], [4, 4, 4]];

/// A box of vertices.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileBox {
    /// Indices along x, y and z: from the first to before the last.
    first: [usize; 3],
    end: [usize; 3],
    pub(super) low: Position,
    pub(super) high: Position,
}

impl TileBox {
    /// The part of the lattice from `first` on, `edge` vertices wide or less at the border.
    fn new(lattice: &Lattice, first: [usize; 3], edge: [usize; 3]) -> Self {
        let end = [0, 1, 2].map(|axis| (first[axis] + edge[axis]).min(lattice.counts()[axis]));
        Self { first, end, low: lattice.position(first), high: lattice.position(end.map(|end| end - 1)) }
    }

    /// Index ranges along an axis.
    pub(super) fn span(&self, axis: usize) -> Range<usize> {
        self.first[axis]..self.end[axis]
    }

    /// A lower and an upper bound of the distances from its vertices to a place (m).
    pub(super) fn distances_m(&self, place: Position) -> [f64; 2] {
        let (low, high, place): ([f64; 3], [f64; 3], [f64; 3]) = (self.low.into(), self.high.into(), place.into());
        let (mut near, mut far) = (0.0, 0.0);
        for axis in 0..3 {
            let outside = (low[axis] - place[axis]).max(place[axis] - high[axis]).max(0.0);
            let across = (place[axis] - low[axis]).max(high[axis] - place[axis]);
            near += outside * outside;
            far += across * across;
        }
        [near.sqrt(), far.sqrt()]
    }
}

/// The content of tiles: the likelihood of the silence of all stops at the vertices of a lattice.
pub(super) trait Silence: Sync {
    /// The lattice.
    fn lattice(&self) -> &Lattice;

    /// The watch that may end the work.
    fn watch(&self) -> &dyn Watch;

    /// The log-likelihood of silence at each vertex of a part of the lattice, x running fastest.
    fn silence(&self, part: &TileBox) -> Box<[f64]>;

    /// An upper bound of the log-likelihood of silence at any vertex of a part of the lattice.
    fn silence_bound(&self, part: &TileBox) -> f64;
}

/// A grid in tiles. The log-likelihood of silence is computed when a search first needs it, and kept.
pub(super) struct Tiles {
    edge: [usize; 3],
    /// Numbers of tiles and of blocks along x, y and z.
    counts: [usize; 3],
    block_counts: [usize; 3],
    /// For each block, an upper bound of the log-likelihood of silence at its vertices.
    block_bounds: Vec<f64>,
    bounds: Vec<OnceLock<f64>>,
    silence: Vec<OnceLock<Box<[f64]>>>,
}

impl Tiles {
    pub(super) fn new(search: &impl Silence) -> Result<Self, Interrupted> {
        let lattice = search.lattice();
        let edge = EDGES[usize::from(lattice.counts()[2] > 1)];
        let counts = [0, 1, 2].map(|axis| lattice.counts()[axis].div_ceil(edge[axis]));
        let block_counts = [0, 1, 2].map(|axis| counts[axis].div_ceil(edge[axis]));
        let tiles = counts.iter().product();
        let mut this = Self {
            edge,
            counts,
            block_counts,
            block_bounds: Vec::new(),
            bounds: (0..tiles).map(|_| OnceLock::new()).collect(),
            silence: (0..tiles).map(|_| OnceLock::new()).collect(),
        };
        let bounds: Result<Vec<f64>, Interrupted> = (0..block_counts.iter().product())
            .into_par_iter()
            .map(|block| {
                search.watch().check()?;
                Ok(search.silence_bound(&this.block(lattice, unlinear(block, block_counts))))
            })
            .collect();
        this.block_bounds = bounds?;
        Ok(this)
    }

    /// The blocks that hold a vertex of a box of vertices, with their silence bounds.
    pub(super) fn blocks<'a>(
        &'a self,
        lattice: &'a Lattice,
        spans: &[Range<usize>; 3],
    ) -> impl Iterator<Item = ([usize; 3], TileBox, f64)> + 'a {
        let edge = [0, 1, 2].map(|axis| self.edge[axis] * self.edge[axis]);
        cells(spans, edge).map(move |block| {
            (block, self.block(lattice, block), self.block_bounds[linear(block, self.block_counts)])
        })
    }

    fn block(&self, lattice: &Lattice, block: [usize; 3]) -> TileBox {
        let edge = [0, 1, 2].map(|axis| self.edge[axis] * self.edge[axis]);
        TileBox::new(lattice, [0, 1, 2].map(|axis| block[axis] * edge[axis]), edge)
    }

    /// The tiles of a block that hold a vertex of a box of vertices, by number, with their silence bounds.
    pub(super) fn of_block<'a>(
        &'a self,
        search: &'a impl Silence,
        block: [usize; 3],
        spans: &[Range<usize>; 3],
    ) -> impl Iterator<Item = (usize, TileBox, f64)> + 'a {
        let part = self.block(search.lattice(), block);
        let spans = [0, 1, 2].map(|axis| {
            let span = part.span(axis);
            spans[axis].start.max(span.start)..spans[axis].end.min(span.end)
        });
        cells(&spans, self.edge).map(move |tile| {
            let part = TileBox::new(search.lattice(), [0, 1, 2].map(|axis| tile[axis] * self.edge[axis]), self.edge);
            let number = linear(tile, self.counts);
            (number, part, *self.bounds[number].get_or_init(|| search.silence_bound(&part)))
        })
    }

    /// The log-likelihood of silence at the vertices of the tile of a number, x running fastest.
    pub(super) fn silence(&self, search: &impl Silence, number: usize, part: &TileBox) -> &[f64] {
        self.silence[number].get_or_init(|| search.silence(part))
    }
}

/// The cells `edge` vertices wide that hold a vertex of a box of vertices, x running fastest.
fn cells(spans: &[Range<usize>; 3], edge: [usize; 3]) -> impl Iterator<Item = [usize; 3]> + use<> {
    let is_empty = spans.iter().any(Range::is_empty);
    let [xs, ys, zs] = [0, 1, 2].map(|axis| {
        let Range { start, end } = spans[axis];
        if is_empty { 0..0 } else { start / edge[axis]..end.div_ceil(edge[axis]) }
    });
    zs.flat_map(move |z| {
        let xs = xs.clone();
        ys.clone().flat_map(move |y| xs.clone().map(move |x| [x, y, z]))
    })
}

fn linear([x, y, z]: [usize; 3], [columns, rows, _]: [usize; 3]) -> usize {
    (z * rows + y) * columns + x
}

fn unlinear(index: usize, [columns, rows, _]: [usize; 3]) -> [usize; 3] {
    [index % columns, index / columns % rows, index / (columns * rows)]
}
