//! The least rectangle round places, seen from above.

use crate::numerics::convex_hull::hull;

/// Areas and widths that differ by less than these shares are alike: differences come from rounding, or from places that were
/// written with few digits.
const SAME_AREA: f64 = 1e-6;
const SAME_WIDTH: f64 = 1e-3;
/// Moments whose share is below this tell no direction.
const NO_MOMENT: f64 = 1e-4;

/// A place seen from above (m), and what was heard there.
pub(super) type Weighted = ([f64; 2], f64);

/// The rectangle of least area round places. One of its sides is along a side of their convex hull (Freeman and Shapira 1975).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rectangle {
    /// Its middle (m).
    pub(super) middle: [f64; 2],
    /// Unit vectors along its longer and its shorter side.
    pub(super) axes: [[f64; 2]; 2],
    /// Its widths along them (m).
    pub(super) widths_m: [f64; 2],
}

impl Rectangle {
    /// The rectangle of `places`. Its first axis is along the longer side, or along the one over which what was heard spreads
    /// more if both are alike, and each axis points to the half where more was heard: so it turns, moves and is mirrored with
    /// the places. `None` without places.
    pub(super) fn round(places: &[Weighted]) -> Option<Self> {
        let hull = hull(places.iter().map(|&(place, _)| place).collect());
        let sides = hull.iter().zip(hull.iter().cycle().skip(1)).filter_map(|(&a, &b)| unit(minus(b, a)));
        let all: Vec<Self> = sides.map(|along| Self::along(along, &hull)).collect();
        let least = all.iter().map(Self::area_m2).reduce(f64::min).unwrap_or(0.0);
        // Where several are as small, those along which the places lie count: for a square, all are the same.
        let small = all.iter().filter(|one| one.area_m2() <= least * (1.0 + SAME_AREA));
        let lengths = |one: &Self| one.moment(places, 0, 4) + one.moment(places, 1, 4);
        let best = small
            .copied()
            .reduce(|best, next| if lengths(&next) > lengths(&best) * (1.0 + SAME_AREA) { next } else { best });
        let found = match best {
            Some(best) => best,
            None => Self { middle: *hull.first()?, axes: [[1.0, 0.0], [0.0, 1.0]], widths_m: [0.0; 2] },
        };
        Some(found.longer_first(places).towards_the_heard(places))
    }

    /// The least rectangle with a side along a unit vector.
    fn along(x: [f64; 2], hull: &[[f64; 2]]) -> Self {
        let axes = [x, [-x[1], x[0]]];
        let ends = axes.map(|axis| {
            let along = hull.iter().map(|&corner| dot(axis, minus(corner, hull[0])));
            along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)))
        });
        let [u, v] = ends.map(|(low, high)| 0.5 * (low + high));
        let middle = [0, 1].map(|k| hull[0][k] + axes[0][k] * u + axes[1][k] * v);
        Self { middle, axes, widths_m: ends.map(|(low, high)| high - low) }
    }

    fn area_m2(&self) -> f64 {
        self.widths_m[0] * self.widths_m[1]
    }

    /// Length of its diagonal (m).
    pub(super) fn diagonal_m(&self) -> f64 {
        libm::hypot(self.widths_m[0], self.widths_m[1])
    }

    /// The mean power of the distances from the middle along an axis, of what was heard, in shares of the diagonal.
    fn moment(&self, places: &[Weighted], axis: usize, power: i32) -> f64 {
        let diagonal_m = self.diagonal_m().max(f64::MIN_POSITIVE);
        let total: f64 = places.iter().map(|&(_, weight)| weight).sum();
        let of = |&(place, weight): &Weighted| {
            weight / total * (dot(self.axes[axis], minus(place, self.middle)) / diagonal_m).powi(power)
        };
        places.iter().map(of).sum()
    }

    fn longer_first(self, places: &[Weighted]) -> Self {
        let [x, y] = self.widths_m;
        let is_second_longer = if (x - y).abs() > SAME_WIDTH * x.max(y) {
            y > x
        } else {
            self.moment(places, 1, 2) - self.moment(places, 0, 2) > NO_MOMENT
        };
        if is_second_longer { Self { axes: [self.axes[1], self.axes[0]], widths_m: [y, x], ..self } } else { self }
    }

    fn towards_the_heard(self, places: &[Weighted]) -> Self {
        let [x, y] = self.axes;
        // Without any moment, x points as the larger of its coordinates does, and y to the left of it: on a line, nothing tells
        // one side from the other.
        let x = self.pointed(places, 0, if x[0].abs() >= x[1].abs() { x[0] } else { x[1] });
        let y = self.pointed(places, 1, cross(x, y));
        Self { axes: [x, y], ..self }
    }

    /// An axis that points to the half where more was heard, or else so that `usual` is above zero.
    fn pointed(&self, places: &[Weighted], axis: usize, usual: f64) -> [f64; 2] {
        let moments = [1, 3].map(|power| self.moment(places, axis, power));
        let way = moments.into_iter().find(|moment| moment.abs() > NO_MOMENT).unwrap_or(usual);
        if way < 0.0 { self.axes[axis].map(|along| -along) } else { self.axes[axis] }
    }
}

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn unit(way: [f64; 2]) -> Option<[f64; 2]> {
    let length = libm::hypot(way[0], way[1]);
    (length > 0.0).then(|| way.map(|along| along / length))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A lattice of 7 by 4 places, in which more was heard in the upper left.
    fn lattice() -> Vec<Weighted> {
        let weight = |i: u32, j: u32| 1.0 + f64::from(6 - i) + 2.0 * f64::from(j);
        (0..28).map(|k| (k % 7, k / 7)).map(|(i, j)| ([f64::from(i), f64::from(j)], weight(i, j))).collect()
    }

    #[test]
    fn a_lattice_has_its_own_axes_that_point_to_where_more_was_heard() {
        let found = Rectangle::round(&lattice()).unwrap();
        assert_eq!((found.middle, found.widths_m), ([3.0, 1.5], [6.0, 3.0]));
        assert_eq!(found.axes, [[-1.0, 0.0], [0.0, 1.0]]);
    }

    #[test]
    fn a_turned_lattice_has_turned_axes_and_a_mirrored_one_mirrored_ones() {
        let (sin, cos) = libm::sincos(0.6);
        let turned = |[x, y]: [f64; 2]| [cos * x - sin * y + 40.0, sin * x + cos * y - 7.0];
        let places: Vec<Weighted> = lattice().into_iter().map(|(place, weight)| (turned(place), weight)).collect();
        let found = Rectangle::round(&places).unwrap();
        for (axis, expected) in found.axes.into_iter().zip([[-cos, -sin], [-sin, cos]]) {
            assert!(dot(axis, expected) > 1.0 - 1e-12, "{axis:?} {expected:?}");
        }
        let mirrored: Vec<Weighted> = lattice().into_iter().map(|([x, y], weight)| ([y, x], weight)).collect();
        assert_eq!(Rectangle::round(&mirrored).unwrap().axes, [[0.0, -1.0], [1.0, 0.0]]);
    }

    #[test]
    fn places_on_a_line_and_one_place_have_a_rectangle_too() {
        let line: Vec<Weighted> = (0..5).map(|i| ([f64::from(i), 2.0 * f64::from(i)], f64::from(i))).collect();
        let found = Rectangle::round(&line).unwrap();
        assert!(found.widths_m[1].abs() < 1e-12 && (found.widths_m[0] - 20.0_f64.sqrt() * 2.0).abs() < 1e-12);
        assert!(found.axes[0][1] > 0.0, "{:?}", found.axes);
        assert!(Rectangle::round(&[([3.0, 4.0], 1.0)]).unwrap().diagonal_m() <= 0.0);
        assert_eq!(Rectangle::round(&[]), None);
    }
}
