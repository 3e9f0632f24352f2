//! The places where a node may be, on a lattice in the plane.

use sextant_channel::Position;

/// Places along the shorter and the longer side of a lattice, as the geometric mean.
const ALONG: f64 = 14.0;
/// The lattice of a survey reaches beyond the stops by this share of their extent, and that of a node beyond the stops that heard
/// it, as far as that of the survey.
const MARGIN: f64 = 0.15;
const NODE_MARGIN: f64 = 0.5;

/// Where a node may be, in the plane.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Lattice {
    pub(super) places: Vec<[f64; 2]>,
    /// Distance between neighbours (m).
    pub(super) step_m: f64,
    /// The diagonal of the box around the stops (m).
    pub(super) extent_m: f64,
    /// The ends along x and y (m).
    sides: [[f64; 2]; 2],
}

impl Lattice {
    /// The lattice around `stops`; `None` if all are at one place.
    pub(super) fn around(stops: impl Iterator<Item = Position> + Clone) -> Option<Self> {
        let sides = sides(stops);
        let extent_m = diagonal_m(sides);
        if !(extent_m.is_finite() && extent_m > 0.0) {
            return None;
        }
        Some(Self::on(sides.map(|[low, high]| [low - MARGIN * extent_m, high + MARGIN * extent_m]), extent_m))
    }

    /// The part of this lattice, made finer, in which a node may be that these stops heard: in a large field a lattice of all of it
    /// is coarser than the distances over which a node is heard.
    pub(super) fn near(&self, stops: &[Position]) -> Self {
        let heard = sides(stops.iter().copied());
        let margin_m = (NODE_MARGIN * diagonal_m(heard)).max(0.5 * self.step_m);
        let part = [0, 1].map(|axis| {
            let ([low, high], [first, last]) = (self.sides[axis], heard[axis]);
            [low.max(first - margin_m), high.min(last + margin_m)]
        });
        Self::on(part, self.extent_m * diagonal_m(part) / diagonal_m(self.sides))
    }

    fn on(sides: [[f64; 2]; 2], extent_m: f64) -> Self {
        let [width_m, depth_m] = sides.map(|[low, high]| high - low);
        let step_m = (width_m * depth_m).sqrt() / ALONG;
        let on_axis = |[low, high]: [f64; 2]| {
            let mut at = low + 0.5 * step_m;
            std::iter::from_fn(move || {
                let found = at;
                at += step_m;
                (found < high).then_some(found)
            })
        };
        let places = on_axis(sides[0]).flat_map(|x| on_axis(sides[1]).map(move |y| [x, y])).collect();
        Self { places, step_m, extent_m, sides }
    }

    /// The mean of the places, whose logarithms of probability are `ln`.
    pub(super) fn middle(&self, ln: &[f64]) -> Position {
        let highest = ln.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let (mut sum, mut total) = (Position::ORIGIN, 0.0);
        for (&[x, y], ln) in self.places.iter().zip(ln) {
            let weight = libm::exp(ln - highest);
            sum = sum + Position::new(x, y, 0.0) * weight;
            total += weight;
        }
        sum * (1.0 / total)
    }
}

/// The ends of `places` along x and y (m).
fn sides(places: impl Iterator<Item = Position> + Clone) -> [[f64; 2]; 2] {
    let along = |axis: fn(Position) -> f64| {
        let ends = [f64::INFINITY, f64::NEG_INFINITY];
        places.clone().map(axis).fold(ends, |[low, high], at| [low.min(at), high.max(at)])
    };
    [along(|at| at.x_m), along(|at| at.y_m)]
}

/// The diagonal of a box with these ends (m).
fn diagonal_m([[west, east], [south, north]]: [[f64; 2]; 2]) -> f64 {
    libm::hypot(east - west, north - south)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lattice_of_a_node_is_that_of_a_small_survey_and_finer_in_a_large_one() {
        let corners = |size_m: f64| [Position::ORIGIN, Position::new(size_m, size_m, 0.0)];
        let survey = Lattice::around(corners(100.0).into_iter()).unwrap();
        assert_eq!(survey.near(&corners(100.0)), survey);
        let part = survey.near(&corners(10.0));
        // 10 m and half of the diagonal beyond, on the side where the survey goes on; it ends 21 m beyond its stops on the other.
        let wide_m = 10.0 + 2.0 * 0.5 * 10.0 * 2.0_f64.sqrt();
        assert!((part.step_m - wide_m / ALONG).abs() < 1e-9, "{}", part.step_m);
        assert!((part.extent_m - survey.extent_m * wide_m / (100.0 + 30.0 * 2.0_f64.sqrt())).abs() < 1e-9);
    }
}
