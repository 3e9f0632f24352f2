//! The bins of distance of the vertices of a window, from each stop that tells something.

use sextant_channel::Position;
use sextant_kernel::maths::with_widest_vectors;

use super::model::{BINS, Model};
use super::window::VertexWindow;

const _: () = assert!(BINS <= 256, "a bin is an octet");

/// Added to a number, its digits after the point are lost, and the integer is in the last bits.
const ROUND: f64 = 4_503_599_627_370_496.0;

/// The bins of the vertices, link by link.
#[derive(Debug, Default)]
pub(super) struct LinkBins {
    bins: Vec<u8>,
    vertices: usize,
    /// Memory for squares along x, and of distances.
    along: Vec<f64>,
    squares: Vec<f64>,
}

impl LinkBins {
    /// Begins with the links of a window.
    pub(super) fn clear(&mut self, window: &VertexWindow) {
        self.bins.clear();
        self.vertices = window.len();
    }

    /// Adds a link to a stop at `place`, and returns the bin of each vertex.
    pub(super) fn add(&mut self, window: &VertexWindow, model: &Model, place: Position) -> &[u8] {
        let Self { bins, vertices, along, squares } = self;
        let [xs, ys, zs] = window.coordinates();
        let square = |from_m: f64, to_m: f64| (to_m - from_m) * (to_m - from_m);
        along.clear();
        along.extend(xs.iter().map(|x_m| square(place.x_m, *x_m)));
        squares.resize(*vertices, 0.0);
        let mut rows = squares.chunks_exact_mut(xs.len());
        for up in zs.iter().map(|z_m| square(place.z_m, *z_m)) {
            for (y_m, row) in ys.iter().zip(rows.by_ref()) {
                let across = square(place.y_m, *y_m);
                for (sum, along) in row.iter_mut().zip(&*along) {
                    *sum = along + across + up;
                }
            }
        }
        let from = bins.len();
        bins.resize(from + *vertices, 0);
        let (per_m, last) = (model.bins_per_m(), (model.bins() - 1) as f64);
        with_widest_vectors(
            #[inline(always)]
            || number(&mut bins[from..], squares, per_m, last),
        );
        &self.bins[from..]
    }

    /// The bins of the vertices over the links that were added, in this order.
    pub(super) fn links(&self) -> impl Iterator<Item = &[u8]> {
        self.bins.chunks_exact(self.vertices.max(1))
    }
}

/// The bins of distances with these squares (m²).
#[inline(always)]
fn number(bins: &mut [u8], squares: &[f64], per_m: f64, last: f64) {
    for (bin, square) in bins.iter_mut().zip(squares) {
        *bin = whole((square.sqrt() * per_m).min(last));
    }
}

/// The integer below a number from 0 to 255.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "the integer is in the last bits")]
fn whole(value: f64) -> u8 {
    let rounded = value + ROUND;
    (rounded.to_bits() - u64::from(rounded - ROUND > value)) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_are_those_below() {
        for value in 0..=255_u8 {
            let exact = f64::from(value);
            assert_eq!(
                [exact, exact + 0.3, exact + 0.5, exact + 0.9, (exact + 1.0).next_down()].map(whole),
                [value; 5]
            );
        }
    }
}
