//! The axes of a survey, and places in them.

use sextant_channel::Position;

use super::rectangle::Rectangle;

/// Coordinates are multiples of about this share of the diagonal: so the places of a log that was turned are the same to the
/// last bit.
const GRAIN: f64 = -38.0;
/// Places within this share of the diagonal follow each other by what was heard there. It suits no lattice.
const ALIKE: f64 = 0.000_927;
/// Where the borders lie between coordinates that are alike.
const PHASE: f64 = 0.381_966;

/// Axes that turn, move and are mirrored with the stops of a log. Heights are those of the log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SurveyAxes {
    /// Where they begin, and unit vectors along them, in the log.
    origin: [f64; 2],
    along: [[f64; 2]; 2],
    /// Coordinates are multiples of it; 0 if they are not rounded (m).
    grain_m: f64,
    diagonal_m: f64,
}

impl SurveyAxes {
    /// Those of the log itself.
    pub(super) fn of_log(diagonal_m: f64) -> Self {
        Self { origin: [0.0; 2], along: [[1.0, 0.0], [0.0, 1.0]], grain_m: 0.0, diagonal_m }
    }

    /// Those of a rectangle.
    pub(super) fn of(rectangle: &Rectangle) -> Self {
        let diagonal_m = rectangle.diagonal_m();
        // Of a diagonal that is a power of two, rounding must not decide which.
        let grain_m = if diagonal_m > 0.0 { libm::exp2(libm::log2(1.37 * diagonal_m).floor() + GRAIN) } else { 0.0 };
        Self { origin: rectangle.middle, along: rectangle.axes, grain_m, diagonal_m }
    }

    /// `place` of the log in these axes.
    pub(super) fn place(&self, place: Position) -> Position {
        let [x_m, y_m] = self.point([place.x_m, place.y_m]);
        Position { x_m, y_m, z_m: place.z_m }
    }

    /// The same, seen from above.
    pub(super) fn point(&self, [x_m, y_m]: [f64; 2]) -> [f64; 2] {
        let apart = [x_m - self.origin[0], y_m - self.origin[1]];
        self.along.map(|axis| {
            let along_m = axis[0] * apart[0] + axis[1] * apart[1];
            if self.grain_m > 0.0 { (along_m / self.grain_m).round() * self.grain_m } else { along_m }
        })
    }

    /// A place in these axes in the log.
    pub(super) fn back(&self, place: Position) -> Position {
        let [x, y] = self.along;
        let at = |k: usize| self.origin[k] + (x[k] * place.x_m + y[k] * place.y_m);
        Position { x_m: at(0), y_m: at(1), z_m: place.z_m }
    }

    /// A covariance in these axes in the log (m²).
    pub(super) fn covariance_back(&self, covariance: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
        let [x, y] = self.along;
        let turn = [[x[0], y[0], 0.0], [x[1], y[1], 0.0], [0.0, 0.0, 1.0]];
        let entry = |row: usize, column: usize| {
            let pairs = (0..3).flat_map(|k| (0..3).map(move |l| (k, l)));
            pairs.map(|(k, l)| turn[row][k] * covariance[k][l] * turn[column][l]).sum()
        };
        [0, 1, 2].map(|row| [0, 1, 2].map(|column| entry(row, column)))
    }

    /// Whole numbers by which places in these axes are put in order: along x, then y, then z, where they are not alike.
    pub(super) fn rank(&self, place: Position) -> [i64; 3] {
        let alike_m = if self.diagonal_m > 0.0 { ALIKE * self.diagonal_m } else { 1.0 };
        <[f64; 3]>::from(place).map(|along_m| steps(along_m / alike_m + PHASE))
    }

    /// Whether `place` in these axes is farther from the middle of the rectangle than so many diagonals, along an axis.
    pub(super) fn is_beyond(&self, place: Position, diagonals: f64) -> bool {
        self.diagonal_m > 0.0 && place.x_m.abs().max(place.y_m.abs()) > diagonals * self.diagonal_m
    }
}

/// The whole number at or below a number.
#[expect(clippy::cast_possible_truncation, reason = "coordinates are within reason, and a cast is bounded")]
fn steps(value: f64) -> i64 {
    value.floor() as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axes() -> SurveyAxes {
        let rectangle = Rectangle { middle: [3.0, -2.0], axes: [[0.6, 0.8], [0.8, -0.6]], widths_m: [12.0, 5.0] };
        SurveyAxes::of(&rectangle)
    }

    #[test]
    fn a_place_comes_back_to_where_it_was() {
        let place = Position::new(7.3, 1.1, 2.5);
        assert!(axes().back(axes().place(place)).distance_m(place) < 1e-7);
        assert!(axes().place(Position::new(3.0, -2.0, 0.0)).length_m() < 1e-12);
    }

    #[test]
    fn a_covariance_is_that_of_the_turned_places() {
        // Along the first axis, (0.6, 0.8), with a variance of 4.
        let found = axes().covariance_back([[4.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
        let expected = [[1.44, 1.92, 0.0], [1.92, 2.56, 0.0], [0.0, 0.0, 1.0]];
        for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }
}
