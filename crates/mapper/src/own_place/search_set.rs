//! The vertices among which a node is sought.

use std::ops::Range;

use sextant_channel::Position;

use crate::lattice::Lattice;

/// A box of vertices: their indices along each axis.
pub(super) type VertexBox = [Range<usize>; 3];

/// Vertices along each side of a block.
pub(super) const BLOCK: usize = 4;

/// Boxes of vertices, which may overlap. Each vertex counts once.
#[derive(Debug)]
pub(super) struct SearchSet {
    boxes: Vec<VertexBox>,
}

impl SearchSet {
    /// The box of the vertices within a distance (m) of each place, along each axis; `None` if there are none.
    pub(super) fn intersection(lattice: &Lattice, balls: impl Iterator<Item = (Position, f64)>) -> Option<Self> {
        let (mut low, mut high) = ([f64::NEG_INFINITY; 3], [f64::INFINITY; 3]);
        for (place, reach_m) in balls {
            for (axis, value) in <[f64; 3]>::from(place).into_iter().enumerate() {
                low[axis] = low[axis].max(value - reach_m);
                high[axis] = high[axis].min(value + reach_m);
            }
        }
        let cells = [0, 1, 2].map(|axis| lattice.span(axis, low[axis], high[axis]).0);
        (size(&cells) > 0).then(|| Self { boxes: vec![cells] })
    }

    /// The boxes round the places, or the box that holds all if it has no more vertices.
    pub(super) fn union(lattice: &Lattice, balls: impl Iterator<Item = (Position, f64)>) -> Self {
        let cells = |(place, reach_m): (Position, f64)| {
            let place: [f64; 3] = place.into();
            [0, 1, 2].map(|axis| lattice.span(axis, place[axis] - reach_m, place[axis] + reach_m).0)
        };
        let boxes: Vec<VertexBox> = balls.map(cells).filter(|cells| size(cells) > 0).collect();
        let hull = [0, 1, 2].map(|axis| {
            let start = boxes.iter().map(|cells| cells[axis].start).min().unwrap_or(0);
            start..boxes.iter().map(|cells| cells[axis].end).max().unwrap_or(0)
        });
        let separate: u64 = boxes.iter().map(size).sum();
        Self { boxes: if size(&hull) <= separate { vec![hull] } else { boxes } }
    }

    /// Its only box, if it is one.
    pub(super) fn cells(&self) -> Option<&VertexBox> {
        if let [cells] = &self.boxes[..] { Some(cells) } else { None }
    }

    /// Number of vertices at every `stride`-th index of each axis; vertices of several boxes count several times.
    pub(super) fn len(&self, stride: usize) -> u64 {
        let count =
            |cells: &VertexBox| cells.iter().map(|range| strided(range, stride).len() as u64).product::<u64>();
        self.boxes.iter().map(count).sum()
    }

    /// The blocks of the boxes, each with the number of its box.
    pub(super) fn blocks(&self) -> impl Iterator<Item = (usize, VertexBox)> {
        self.boxes.iter().enumerate().flat_map(|(number, cells)| {
            let along = |axis: usize| {
                let end = cells[axis].end;
                cells[axis].clone().step_by(BLOCK).map(move |start| start..end.min(start + BLOCK))
            };
            let layers = along(2).flat_map(move |z| along(1).map(move |y| (y, z.clone())));
            layers.flat_map(move |(y, z)| along(0).map(move |x| (number, [x, y.clone(), z.clone()])))
        })
    }

    /// Calls `visit` with the index of each vertex at every `stride`-th index of each axis.
    pub(super) fn each(&self, stride: usize, mut visit: impl FnMut([usize; 3])) {
        for (number, cells) in self.boxes.iter().enumerate() {
            self.each_of(number, cells, stride, &mut visit);
        }
    }

    /// The same for a part of the box `number`.
    pub(super) fn each_of(&self, number: usize, cells: &VertexBox, stride: usize, mut visit: impl FnMut([usize; 3])) {
        for k in strided(&cells[2], stride) {
            for j in strided(&cells[1], stride) {
                for i in strided(&cells[0], stride) {
                    let vertex = [i, j, k];
                    let holds =
                        |cells: &VertexBox| cells.iter().zip(vertex).all(|(range, index)| range.contains(&index));
                    if !self.boxes[..number].iter().any(holds) {
                        visit(vertex);
                    }
                }
            }
        }
    }
}

fn size(cells: &VertexBox) -> u64 {
    cells.iter().map(|range| range.len() as u64).product()
}

/// Every `stride`-th index, with the same distance to both ends.
fn strided(range: &Range<usize>, stride: usize) -> std::iter::StepBy<Range<usize>> {
    let rest = range.len().saturating_sub(1) % stride;
    (range.start + rest / 2..range.end).step_by(stride)
}
