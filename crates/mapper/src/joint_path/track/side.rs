//! Receivers on a straight line: distances to them do not tell on which side of it a tag is.

use nalgebra::Matrix2;
use sextant_channel::Position;

/// Receivers this far from a line, as a share of its length, are on it.
const NEAR: f64 = 0.03;

/// A line of receivers, with the side on which a tag is taken to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Line {
    through: [f64; 2],
    /// Of length one, to that side.
    across: [f64; 2],
    /// From the first receiver to the last (m).
    length_m: f64,
}

impl Line {
    /// The line on which all of these receivers are, if they are on one; the side is that of `side`, or else the left one as seen
    /// from the first receiver along the line.
    pub(super) fn of(receivers: &[Position], side: Option<[f64; 2]>) -> Option<Self> {
        let first = receivers.first()?;
        let count = receivers.len() as f64;
        let middle = receivers.iter().fold(Position::ORIGIN, |sum, &place| sum + place) * (1.0 / count);
        let spread = receivers.iter().fold(Matrix2::zeros(), |sum, place| {
            let [x, y] = [place.x_m - middle.x_m, place.y_m - middle.y_m];
            sum + Matrix2::new(x * x, x * y, x * y, y * y)
        });
        let eigen = spread.symmetric_eigen();
        let along = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into_owned();
        let through = [middle.x_m, middle.y_m];
        let mut line = Self { through, across: [-along[1], along[0]], length_m: 0.0 };
        let of = |place: &Position| along[0] * (place.x_m - through[0]) + along[1] * (place.y_m - through[1]);
        let (low, high) = receivers
            .iter()
            .map(of)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
        let off_m = receivers.iter().map(|place| line.across_m([place.x_m, place.y_m]).abs()).fold(0.0, f64::max);
        if high - low <= 0.0 || off_m > NEAR * (high - low) {
            return None;
        }
        line.length_m = high - low;
        let is_other_side = match side {
            Some(side) => line.across_m(side) < 0.0,
            None => of(first) > 0.0,
        };
        if is_other_side {
            line.across = line.across.map(|along| -along);
        }
        Some(line)
    }

    /// How far a place is from the line (m), above 0 on the side of the tag.
    pub(super) fn across_m(&self, [x, y]: [f64; 2]) -> f64 {
        self.across[0] * (x - self.through[0]) + self.across[1] * (y - self.through[1])
    }

    /// The place, moved to the side of the tag by a share of the length of the line.
    pub(super) fn beside(&self, place: [f64; 2], share: f64) -> [f64; 2] {
        [0, 1].map(|axis| place[axis] + share * self.length_m * self.across[axis])
    }

    /// The place, or its mirror image if that is on the side of the tag.
    pub(super) fn on_side(&self, place: [f64; 2]) -> [f64; 2] {
        if self.across_m(place) < 0.0 { self.mirrored(place) } else { place }
    }

    /// The mirror image of a place.
    pub(super) fn mirrored(&self, place: [f64; 2]) -> [f64; 2] {
        let off_m = self.across_m(place);
        [0, 1].map(|axis| place[axis] - 2.0 * off_m * self.across[axis])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_mirrored_to_the_side_of_the_tag() {
        let place = |[x_m, y_m]: [f64; 2]| Position::new(x_m, y_m, 2.0);
        let row = [[0.0, 0.0], [3.0, 3.0], [8.0, 8.0]].map(place);
        let line = Line::of(&row, Some([4.0, 0.0])).unwrap();
        let near = |[x, y]: [f64; 2], [u, v]: [f64; 2]| (x - u).abs() < 1e-9 && (y - v).abs() < 1e-9;
        assert!(near(line.on_side([1.0, 5.0]), [5.0, 1.0]) && near(line.on_side([5.0, 1.0]), [5.0, 1.0]));
        let other = Line::of(&row, None).unwrap();
        assert!(near(other.on_side([5.0, 1.0]), [1.0, 5.0]), "left of the way from the first receiver");
        assert!(near(line.beside([4.0, 4.0], 0.25), [6.0, 2.0]));
        assert!(Line::of(&[row[0], row[1], place([8.0, 2.0])], None).is_none());
        assert!(Line::of(&[row[0], row[0]], None).is_none());
    }
}
