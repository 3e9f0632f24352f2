//! What a grid leaves open: a vertex stands for its cell.

use crate::lattice::Lattice;

/// The cell that a vertex of a grid stands for.
///
/// A posterior on a grid is known at its vertices. A node is somewhere in the cell of one of them, so that its variance along an
/// axis is that of the vertices and `h² / 12` more, where h is the width of the cell: no estimate is better than its grid.
/// All estimators with a grid add it by this file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Cell {
    /// Width along each axis (m); 0 along an axis with one vertex, where the place is given.
    widths_m: [f64; 3],
}

impl Cell {
    /// A cell with these widths (m).
    pub(crate) fn new(widths_m: [f64; 3]) -> Self {
        Self { widths_m }
    }

    /// The cell of a lattice.
    pub(crate) fn of(lattice: &Lattice) -> Self {
        Self::new(lattice.counts().map(|count| if count > 1 { lattice.step_m() } else { 0.0 }))
    }

    /// The covariance of a node from that of the vertices (m²).
    pub(crate) fn spread(&self, mut covariance: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
        for (axis, width_m) in self.widths_m.into_iter().enumerate() {
            covariance[axis][axis] += width_m * width_m / 12.0;
        }
        covariance
    }
}

#[cfg(test)]
mod tests {
    use sextant_channel::Position;

    use super::*;

    #[test]
    fn one_vertex_leaves_its_whole_cell_open_but_no_height_in_a_plane() {
        // The variance of a uniform law of width 0.6.
        let of_cell = 0.03;
        for (counts, height) in [([9, 9, 1], 0.0), ([9, 9, 4], of_cell)] {
            let spread = Cell::of(&Lattice::new(Position::ORIGIN, 0.6, counts)).spread([[0.0; 3]; 3]);
            let expected = [[of_cell, 0.0, 0.0], [0.0, of_cell, 0.0], [0.0, 0.0, height]];
            for (found, expected) in spread.iter().flatten().zip(expected.iter().flatten()) {
                assert!((found - expected).abs() < 1e-15, "{spread:?}");
            }
        }
    }
}
