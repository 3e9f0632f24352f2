//! Which part of a lattice row lies in every one of several balls, in single precision.
//!
//! The ends of the part are known but for an error, which is stated. Where a ball is hardly touched nothing is said, and
//! the caller has to look closer.

use sextant_channel::Position;
use wide::f32x4;

use super::places::{LANES, PlaceLanes};
use super::receiver::ReceivingStop;
use super::screen::APART;
use super::single::single;

/// Error of the square of a half-length over the square of the largest coordinate. A rounding is 6e-8: three of them in
/// each of two differences, which squaring doubles, one in each square, three in their sum; and some to spare.
const PER_SQUARE: f64 = 1.5e-6;

/// If the half-length is below this share of the radius, nothing is said.
const GRAZING: f64 = 0.02;

/// Balls of one radius round some receptions, as seen from the middle of a box.
#[derive(Debug, Default)]
pub(super) struct Balls {
    places: PlaceLanes,
    middle: Position,
    radius_m: f64,
    /// Error of a coordinate (m), and of the square of a half-length (m2).
    apart_m: f64,
    apart_squared: f64,
}

/// The part of a row that lies in all balls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum RowInBalls {
    /// Nothing.
    Nothing,
    /// From one coordinate to another, nothing if the second is lower (m).
    Interval {
        low: f64,
        high: f64,
        /// Error of both.
        error_m: f64,
    },
    /// A ball is hardly touched.
    Grazed,
}

impl Balls {
    /// Takes the balls round `receivers`, for rows through the box with these corners.
    pub(super) fn set(&mut self, receivers: &[ReceivingStop], radius_m: f64, [low, high]: [[f64; 3]; 2]) {
        self.middle = Position::from([0, 1, 2].map(|axis| 0.5 * (low[axis] + high[axis])));
        self.radius_m = radius_m;
        let extent_m = (0..3).fold(2.0 * radius_m, |sum, axis| sum + high[axis] - low[axis]);
        (self.apart_m, self.apart_squared) = (APART * extent_m, PER_SQUARE * extent_m * extent_m);
        // Vectors are filled up with the last ball, which changes nothing.
        let missing = receivers.len().next_multiple_of(LANES) - receivers.len();
        let filling = receivers.last().into_iter().cycle().take(missing);
        self.places.set(receivers.iter().chain(filling).map(|receiver| &receiver.place), self.middle);
    }

    /// The part of the row through y and z.
    pub(super) fn row(&self, y: f64, z: f64) -> RowInBalls {
        let reach = f32x4::splat(single(self.radius_m * self.radius_m));
        let (y, z) = (f32x4::splat(single(y - self.middle.y_m)), f32x4::splat(single(z - self.middle.z_m)));
        let square = |place: &[f32x4; 3]| {
            let (dy, dz) = (y - place[1], z - place[2]);
            reach - dy * dy - dz * dz
        };
        let (low, high, shortest) = self.part(0, square);
        if shortest < -self.apart_squared {
            RowInBalls::Nothing
        } else if shortest < (GRAZING * self.radius_m).powi(2).max(2.0 * self.apart_squared) {
            RowInBalls::Grazed
        } else {
            let error_m = self.apart_squared / shortest.sqrt() + 2.0 * self.apart_m;
            RowInBalls::Interval { low: low + self.middle.x_m, high: high + self.middle.x_m, error_m }
        }
    }

    /// An interval of y that holds all rows at the height z that pass through every ball; `None` if there are none.
    pub(super) fn layer(&self, z: f64) -> Option<(f64, f64)> {
        let reach = f32x4::splat(single(self.radius_m * self.radius_m + self.apart_squared));
        let z = f32x4::splat(single(z - self.middle.z_m));
        let (low, high, shortest) = self.part(1, |place| reach - (z - place[2]) * (z - place[2]));
        let (low, high) = (low - 2.0 * self.apart_m, high + 2.0 * self.apart_m);
        let holds_rows = shortest >= -self.apart_squared && low <= high;
        holds_rows.then_some((low + self.middle.y_m, high + self.middle.y_m))
    }

    /// The interval along `axis` from the highest lower end to the lowest upper end of the balls, and the lowest square
    /// of a half-length.
    #[inline(always)]
    fn part(&self, axis: usize, square: impl Fn(&[f32x4; 3]) -> f32x4) -> (f64, f64, f64) {
        let (mut low, mut high) = (f32x4::splat(f32::NEG_INFINITY), f32x4::splat(f32::INFINITY));
        let mut shortest = high;
        for place in &self.places.coordinates {
            let square = square(place);
            let half = square.fast_max(f32x4::ZERO).sqrt();
            low = low.fast_max(place[axis] - half);
            high = high.fast_min(place[axis] + half);
            shortest = shortest.fast_min(square);
        }
        let low = low.to_array().into_iter().fold(f32::NEG_INFINITY, f32::max);
        let least = |lanes: f32x4| f64::from(lanes.to_array().into_iter().fold(f32::INFINITY, f32::min));
        (f64::from(low), least(high), least(shortest))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const R: f64 = 10.0;

    proptest! {
        #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn the_part_of_a_row_is_that_in_double_precision_but_for_the_error(
            places in prop::collection::vec((-R..R, -R..R, -R..R).prop_map(<[f64; 3]>::from), 1..12),
            (y, z) in (-3.0..3.0_f64, -3.0..3.0_f64),
            away_m in prop_oneof![Just(0.0), Just(5e5)],
        ) {
            let away = Position::new(away_m, away_m, 0.0);
            let receivers: Vec<ReceivingStop> = places
                .iter()
                .map(|&place| ReceivingStop { place: Position::from(place) + away, packets: 1, sector: None })
                .collect();
            let corner = 3.0;
            let mut balls = Balls::default();
            balls.set(&receivers, R, [[away_m - corner, away_m - corner, -corner], [away_m + corner, away_m + corner, corner]]);
            let (mut low, mut high, mut shortest) = (f64::NEG_INFINITY, f64::INFINITY, f64::INFINITY);
            for [px, py, pz] in places {
                let square = R * R - (y - py).powi(2) - (z - pz).powi(2);
                low = low.max(px - square.max(0.0).sqrt());
                high = high.min(px + square.max(0.0).sqrt());
                shortest = shortest.min(square);
            }
            match balls.row(away_m + y, z) {
                RowInBalls::Nothing => prop_assert!(shortest < 0.0),
                RowInBalls::Grazed => prop_assert!(shortest < 0.05),
                RowInBalls::Interval { low: found_low, high: found_high, error_m } => {
                    prop_assert!(shortest > 0.03 && error_m < 0.02, "{} {}", shortest, error_m);
                    prop_assert!((found_low - away_m - low).abs() <= error_m + 1e-9);
                    prop_assert!((found_high - away_m - high).abs() <= error_m + 1e-9);
                }
            }
            if shortest >= 0.0 && low <= high {
                let (first, last) = balls.layer(z).expect("the row is in the layer");
                prop_assert!(first <= away_m + y + 1e-9 && away_m + y <= last + 1e-9);
            }
        }
    }
}
