//! The grid on which likelihoods are computed.

use std::ops::Range;

use sextant_channel::{Position, Stop};

use crate::error::MapError;
use crate::log_facts::SoughtHeights;
use crate::numerics::whole;

/// Bytes per vertex of a window, for its log-likelihood.
const OCTETS_PER_VERTEX: f64 = 8.0;

/// Where the lattice lies relative to the world's origin, in steps: powers of the golden ratio. Nodes on round
/// coordinates are then never exactly on a vertex, which would make every estimator look better than it is.
const PHASE: [f64; 3] = [0.381_966_011_250_105, 0.236_067_977_499_79, 0.145_898_033_750_315];

/// A cubic lattice of vertices: `origin + step · (i, j, k)` with i, j, k below the counts. A planar lattice is
/// one vertex high. The linear index of a vertex is `(k · ny + j) · nx + i`.
#[derive(Clone, Debug, PartialEq)]
pub struct Lattice {
    origin: Position,
    step_m: f64,
    /// Vertices per metre.
    per_m: f64,
    counts: [usize; 3],
}

impl Lattice {
    /// The lattice of `counts` vertices `step_m` apart, the first of them at `origin`.
    ///
    /// # Panics
    /// If the step is not above zero or a count is zero.
    #[must_use]
    pub fn new(origin: Position, step_m: f64, counts: [usize; 3]) -> Self {
        assert!(step_m > 0.0 && counts.iter().all(|&count| count > 0), "a lattice has a step and vertices");
        Self { origin, step_m, per_m: 1.0 / step_m, counts }
    }

    /// The lattice that holds every place within `range_m` of a stop. Its vertices are a subset of a fixed lattice in
    /// the world (at odd fractions of a step), so a longer survey has the same vertices and more.
    ///
    /// `z_range_m` bounds the heights. Without it, the lattice is planar at the height of the stops if their heights
    /// differ by at most a twentieth of `range_m`. Otherwise it extends `range_m` below and above them. A height
    /// range smaller than one step has one layer of vertices, in its middle.
    ///
    /// # Errors
    /// [`MapError::GridTooLarge`] if the window of one node, at most `2 range_m` wide, needs more than
    /// `allowed_bytes`; nothing is allocated then. [`MapError::NoStops`] if there are no stops.
    pub fn covering(
        stops: &[Stop],
        range_m: f64,
        step_m: f64,
        z_range_m: Option<[f64; 2]>,
        allowed_bytes: u64,
    ) -> Result<Self, MapError> {
        let first = stops.first().ok_or(MapError::NoStops)?;
        let mut low: [f64; 3] = first.position.into();
        let mut high = low;
        for stop in stops {
            for (axis, value) in <[f64; 3]>::from(stop.position).into_iter().enumerate() {
                low[axis] = low[axis].min(value);
                high[axis] = high[axis].max(value);
            }
        }
        for axis in 0..2 {
            low[axis] -= range_m;
            high[axis] += range_m;
        }
        let heights = SoughtHeights::of(stops, z_range_m, range_m).ok_or(MapError::NoStops)?;
        (low[2], high[2]) = (heights.low_m, heights.high_m);
        let size =
            |step: f64| Size::of([0, 1, 2].map(|axis| extent(low[axis], high[axis], step, axis).1), range_m, step);
        let needed = size(step_m);
        if !needed.fits(allowed_bytes) {
            return Err(needed.refusal(step_m, allowed_bytes, &size));
        }
        let axes = [0, 1, 2].map(|axis| extent(low[axis], high[axis], step_m, axis));
        Ok(Self {
            origin: axes.map(|(origin, _)| origin).into(),
            step_m,
            per_m: 1.0 / step_m,
            counts: axes.map(|(_, count)| whole(count)),
        })
    }

    /// The first vertex.
    #[must_use]
    pub fn origin(&self) -> Position {
        self.origin
    }

    /// Distance of neighbouring vertices (m).
    #[must_use]
    pub fn step_m(&self) -> f64 {
        self.step_m
    }

    /// Vertices along x, y, z.
    #[must_use]
    pub fn counts(&self) -> [usize; 3] {
        self.counts
    }

    /// Number of vertices.
    #[must_use]
    pub fn len(&self) -> u64 {
        self.counts.iter().map(|&count| count as u64).product()
    }

    /// Whether there is no vertex. Always false.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Half the diagonal of a cell (m). Each place within the lattice is at most this far from a vertex.
    #[must_use]
    pub fn half_diagonal_m(&self) -> f64 {
        let axes = self.counts.iter().filter(|&&count| count > 1).count();
        0.5 * self.step_m * [0.0, 1.0, std::f64::consts::SQRT_2, 3.0_f64.sqrt()][axes]
    }

    /// Place of the vertex (i, j, k).
    #[must_use]
    pub fn position(&self, [i, j, k]: [usize; 3]) -> Position {
        Position::new(self.coordinate(0, i), self.coordinate(1, j), self.coordinate(2, k))
    }

    /// Linear index of the vertex (i, j, k).
    #[must_use]
    pub fn index(&self, [i, j, k]: [usize; 3]) -> u64 {
        let [nx, ny, _] = self.counts.map(|count| count as u64);
        (k as u64 * ny + j as u64) * nx + i as u64
    }

    /// The vertex (i, j, k) of a linear index.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "an index of a vertex is below the counts")]
    pub fn vertex(&self, index: u64) -> [usize; 3] {
        let [nx, ny, _] = self.counts.map(|count| count as u64);
        [(index % nx) as usize, (index / nx % ny) as usize, (index / nx / ny) as usize]
    }

    /// Coordinate of the `i`-th vertex along an axis (m).
    pub(crate) fn coordinate(&self, axis: usize, i: usize) -> f64 {
        <[f64; 3]>::from(self.origin)[axis] + self.step_m * i as f64
    }

    /// The vertices along `axis` with coordinates in `[low, high]`, as a half-open range of indices, and whether
    /// rounding may have added a vertex at an end. Rounding never removes one.
    pub(crate) fn span(&self, axis: usize, low: f64, high: f64) -> (Range<usize>, bool) {
        self.span_within(axis, low, high, 0.0)
    }

    /// The same with ends that are off by up to `error_m`.
    pub(crate) fn span_within(&self, axis: usize, low: f64, high: f64, error_m: f64) -> (Range<usize>, bool) {
        // Rounding errors of positions, in steps, are far smaller than this.
        const SLACK: f64 = 1e-6;
        let slack = SLACK + error_m * self.per_m;
        let origin = <[f64; 3]>::from(self.origin)[axis];
        let first = (low - origin) * self.per_m;
        let last = (high - origin) * self.per_m;
        let (start, end) = (ceiling(first - slack), past(last + slack).min(self.counts[axis]));
        let in_doubt = ceiling(first + slack) != start || past(last - slack) != past(last + slack);
        (start..end.max(start), in_doubt)
    }

    /// The part of the lattice from the vertex `low` to the vertex `high`, both included.
    pub(crate) fn window(&self, low: [usize; 3], high: [usize; 3]) -> Self {
        let counts = [0, 1, 2].map(|axis| high[axis] - low[axis] + 1);
        Self { origin: self.position(low), counts, ..*self }
    }
}

/// First vertex and number of vertices along an axis.
fn extent(low: f64, high: f64, step: f64, axis: usize) -> (f64, f64) {
    let first = ((low / step - PHASE[axis]).ceil() + PHASE[axis]) * step;
    let count = ((high - first) / step).floor() + 1.0;
    if high - low < step || count < 1.0 { (0.5 * (low + high), 1.0) } else { (first, count) }
}

/// The lowest count not below `value`. It uses casts, because some processors have no instruction for rounding.
fn ceiling(value: f64) -> usize {
    let below = whole(value);
    below + usize::from((below as f64) < value)
}

/// The lowest count above `value`.
fn past(value: f64) -> usize {
    if value < 0.0 { 0 } else { whole(value).saturating_add(1) }
}

/// How large a lattice is.
struct Size {
    vertices: f64,
    bytes: f64,
}

impl Size {
    fn of(counts: [f64; 3], range_m: f64, step_m: f64) -> Self {
        let window = counts.map(|count| count.min(2.0 * range_m / step_m + 1.0));
        Self { vertices: counts.iter().product(), bytes: window.iter().product::<f64>() * OCTETS_PER_VERTEX }
    }

    /// Whether the window fits the memory and the linear indices are exact.
    fn fits(&self, allowed_bytes: u64) -> bool {
        self.bytes <= allowed_bytes as f64 && self.vertices < 9e15
    }

    fn refusal(&self, step_m: f64, allowed_bytes: u64, size: &dyn Fn(f64) -> Self) -> MapError {
        let mut suggested = step_m;
        while suggested < f64::MAX / 4.0 && !size(suggested).fits(allowed_bytes) {
            suggested = two_digits(1.05 * suggested);
        }
        MapError::GridTooLarge {
            vertices: self.vertices,
            bytes: whole(self.bytes) as u64,
            allowed_bytes,
            step_m,
            suggested_step_m: suggested,
            memory_key: Some("max_memory_mb"),
        }
    }
}

/// `value` rounded up to two significant digits.
fn two_digits(value: f64) -> f64 {
    let unit = libm::pow(10.0, libm::log10(value).floor() - 1.0);
    let digits = (value / unit - 1e-9).ceil();
    if unit < 1.0 { digits / (1.0 / unit).round() } else { digits * unit }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stops(places: &[[f64; 3]]) -> Vec<Stop> {
        places.iter().map(|&place| Stop::at(place.into())).collect()
    }

    #[test]
    fn a_lattice_covers_the_range_of_every_stop_and_avoids_round_coordinates() {
        let lattice =
            Lattice::covering(&stops(&[[0.0, 0.0, 0.0], [30.0, 7.0, 0.0]]), 10.0, 0.25, None, 1 << 30).unwrap();
        assert_eq!(lattice.counts()[2], 1);
        let [nx, ny, _] = lattice.counts();
        let (first, last) = (lattice.position([0, 0, 0]), lattice.position([nx - 1, ny - 1, 0]));
        assert!(first.x_m >= -10.0 && first.x_m < -9.75 && last.x_m <= 40.0 && last.x_m > 39.75);
        assert!(first.y_m >= -10.0 && first.y_m < -9.75 && last.y_m <= 17.0 && last.y_m > 16.75);
        assert!(first.z_m.abs() < 1e-15);
        for i in 0..nx {
            let off_lattice = (lattice.coordinate(0, i) / 0.25).fract().abs();
            assert!(off_lattice > 0.1 && off_lattice < 0.9);
        }
        let index = lattice.index([3, 5, 0]);
        assert_eq!(lattice.vertex(index), [3, 5, 0]);
    }

    #[test]
    fn a_longer_survey_keeps_the_vertices() {
        let short = Lattice::covering(&stops(&[[0.0; 3]]), 3.0, 0.25, None, 1 << 30).unwrap();
        let long = Lattice::covering(&stops(&[[0.0; 3], [-50.3, 20.0, 0.0]]), 3.0, 0.25, None, 1 << 30).unwrap();
        let steps = (short.origin().x_m - long.origin().x_m) / 0.25;
        assert!((steps - steps.round()).abs() < 1e-9);
    }

    #[test]
    fn heights_follow_the_stops_or_the_range_given() {
        let level = stops(&[[0.0, 0.0, 0.3], [5.0, 0.0, 0.3]]);
        let count = |stops: &[Stop], range| Lattice::covering(stops, 3.0, 0.5, range, 1 << 30).unwrap().counts()[2];
        assert_eq!(count(&level, None), 1);
        assert_eq!(count(&stops(&[[0.0, 0.0, 0.0], [0.0, 0.0, 4.0]]), None), 20);
        assert_eq!(count(&level, Some([0.0, 3.0])), 6);
        let flat = Lattice::covering(&level, 3.0, 0.5, Some([0.1, 0.1]), 1 << 30).unwrap();
        assert!((flat.origin().z_m - 0.1).abs() < 1e-15 && flat.counts()[2] == 1);
    }

    #[test]
    fn a_grid_that_is_too_large_is_rejected_with_a_step_that_fits() {
        let path = stops(&[[0.0; 3], [30.0, 30.0, 0.0]]);
        let allowed = 100_000_000;
        let refused = Lattice::covering(&path, 10.0, 1e-6, None, allowed).unwrap_err();
        let MapError::GridTooLarge { vertices, bytes, suggested_step_m, .. } = refused else {
            panic!("{refused} is not about the size");
        };
        assert!(vertices > 2.4e15 && bytes > allowed);
        assert!(Lattice::covering(&path, 10.0, suggested_step_m, None, allowed).is_ok());
        assert!(Lattice::covering(&path, 10.0, 0.9 * suggested_step_m, None, allowed).is_err());
        assert_eq!(Lattice::covering(&[], 1.0, 1.0, None, 0), Err(MapError::NoStops));
    }
}
