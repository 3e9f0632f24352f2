//! The bins of distance of the vertices of a window, from each stop that tells something.

use sextant_channel::Position;
use sextant_kernel::maths::with_widest_vectors;

use super::model::{BINS, Model};
use super::window::VertexWindow;

/// Values by bin.
pub(super) type ByBin = [f64; 256];
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

/// The bins of the vertices over one link.
#[derive(Clone, Copy, Debug)]
pub(super) struct BinsOfLink<'a> {
    pub(super) of_vertex: &'a [u8],
    /// The lowest and the highest.
    pub(super) ends: [u8; 2],
}

impl LinkBins {
    /// Begins with the links of a window.
    pub(super) fn clear(&mut self, window: &VertexWindow) {
        self.bins.clear();
        self.vertices = window.len();
    }

    /// Adds a link to a stop at `place`, and returns its bins.
    pub(super) fn add(&mut self, window: &VertexWindow, model: &Model, place: Position) -> BinsOfLink<'_> {
        let Self { bins, along, squares, .. } = self;
        let [xs, ys, zs] = window.coordinates();
        let square = |from_m: f64| move |to_m: &f64| (to_m - from_m) * (to_m - from_m);
        along.clear();
        along.extend(xs.iter().map(square(place.x_m)));
        squares.clear();
        for up in zs.iter().map(square(place.z_m)) {
            for across in ys.iter().map(square(place.y_m)) {
                squares.extend(along.iter().map(|along| along + across + up));
            }
        }
        let (per_m, last) = (model.bins_per_m(), (model.bins() - 1) as f64);
        let from = bins.len();
        bins.resize(from + squares.len(), 0);
        let pairs = bins[from..].iter_mut().zip(&*squares);
        with_widest_vectors(|| pairs.for_each(|(bin, square)| *bin = whole((square.sqrt() * per_m).min(last))));
        BinsOfLink::new(&bins[from..])
    }

    /// The bins over the links that were added, in this order.
    pub(super) fn links(&self) -> impl Iterator<Item = BinsOfLink<'_>> {
        self.bins.chunks_exact(self.vertices.max(1)).map(BinsOfLink::new)
    }
}

impl<'a> BinsOfLink<'a> {
    fn new(of_vertex: &'a [u8]) -> Self {
        let ends = of_vertex.iter().fold([u8::MAX, 0], |[low, high], &bin| [low.min(bin), high.max(bin)]);
        Self { of_vertex, ends }
    }

    /// All bins between the ends.
    pub(super) fn all(&self) -> std::ops::RangeInclusive<usize> {
        usize::from(self.ends[0])..=usize::from(self.ends[1])
    }

    /// A value for each bin between the ends.
    #[inline]
    pub(super) fn table(&self, mut value: impl FnMut(usize) -> f64) -> ByBin {
        let mut table = [0.0; 256];
        self.all().for_each(|bin| table[bin] = value(bin));
        table
    }
}

/// The integer below a number from 0 to 255.
#[inline]
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
            assert_eq!([exact, exact + 0.3, exact + 0.5, exact + 0.9, (exact + 1.0).next_down()].map(whole), [value; 5]);
        }
    }
}
