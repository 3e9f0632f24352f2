//! Polygons of the plane.

use sextant_kernel::SettingError;

use crate::geometry::position::Position;

/// The most corners that a polygon may have: its sides are checked in pairs.
const MOST_CORNERS: usize = 10_000;

/// A polygon of the plane, convex or not. Its sides do not cross; they may touch, so that a slit can lead to a hole.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    corners: Vec<[f64; 2]>,
}

impl Polygon {
    /// The polygon with these `corners` (m), in order; the last side leads back to the first corner.
    ///
    /// # Errors
    /// `corners_m` if there are fewer than three corners or too many, two sides cross, or there is no area between them;
    /// `corners_m[i]` if a corner is not finite.
    pub fn new(corners: &[[f64; 2]]) -> Result<Self, SettingError> {
        if !(3..=MOST_CORNERS).contains(&corners.len()) {
            let allowed = if corners.len() < 3 {
                "at least 3 corners".to_owned()
            } else {
                format!("at most {MOST_CORNERS} corners")
            };
            return Err(SettingError::new("corners_m", format!("{} corners", corners.len()), allowed));
        }
        for (i, [x, y]) in corners.iter().enumerate() {
            if !(x.is_finite() && y.is_finite()) {
                return Err(SettingError::new(
                    format!("corners_m[{i}]"),
                    format!("[{x}, {y}]"),
                    "finite coordinates in metres",
                ));
            }
        }
        let polygon = Self { corners: corners.to_vec() };
        if let Some((a, b)) = polygon.crossing_sides() {
            let found = format!("a polygon whose sides {a} and {b} cross");
            return Err(SettingError::new("corners_m", found, "corners in order, without crossing sides"));
        }
        if polygon.area_m2() <= 0.0 {
            return Err(SettingError::new("corners_m", "a polygon without area", "corners that are not on one line"));
        }
        Ok(polygon)
    }

    /// The corners (m).
    #[must_use]
    pub fn corners(&self) -> &[[f64; 2]] {
        &self.corners
    }

    /// The sides, each from one corner to the next.
    pub fn sides(&self) -> impl Iterator<Item = ([f64; 2], [f64; 2])> {
        sides(&self.corners)
    }

    /// The polygon whose corners are where `change` puts these. The change must keep what is inside, inside: a turn, a shift, a
    /// mirror image, a scale.
    #[must_use]
    pub fn moved(&self, change: impl Fn([f64; 2]) -> [f64; 2]) -> Self {
        Self { corners: self.corners.iter().map(|&corner| change(corner)).collect() }
    }

    /// The area between the sides (m²).
    #[must_use]
    pub fn area_m2(&self) -> f64 {
        area_m2(&self.corners)
    }

    /// Whether a ray from `p` to the east crosses an odd number of sides (Shimrat 1962, Algorithm 112). Places on a side
    /// may be on either side of it.
    #[must_use]
    pub fn contains(&self, p: [f64; 2]) -> bool {
        let crossed = |([ax, ay], [bx, by]): &([f64; 2], [f64; 2])| {
            (*ay > p[1]) != (*by > p[1]) && p[0] < ax + (p[1] - ay) / (by - ay) * (bx - ax)
        };
        self.sides().filter(crossed).count() % 2 == 1
    }

    /// The place on a side that is nearest to `p`, and its distance (m).
    #[must_use]
    pub fn nearest_on_side(&self, p: [f64; 2]) -> ([f64; 2], f64) {
        let nearer = |a: ([f64; 2], f64), b: ([f64; 2], f64)| if b.1 < a.1 { b } else { a };
        self.sides().map(|(a, b)| nearest_on_line(p, a, b)).reduce(nearer).expect("a polygon has sides")
    }

    /// Two sides that cross, if any.
    fn crossing_sides(&self) -> Option<(usize, usize)> {
        let sides: Vec<_> = self.sides().collect();
        let apart = |a: f64, b: f64| (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0);
        (0..sides.len()).flat_map(|i| (i + 1..sides.len()).map(move |j| (i, j))).find(|&(i, j)| {
            let ((a, b), (c, d)) = (sides[i], sides[j]);
            apart(turn(a, b, c), turn(a, b, d)) && apart(turn(c, d, a), turn(c, d, b))
        })
    }
}

/// The sides between corners in order, each from one corner to the next.
fn sides(corners: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> {
    corners.iter().copied().zip(corners.iter().copied().cycle().skip(1))
}

/// The area between corners in order (m²).
pub(crate) fn area_m2(corners: &[[f64; 2]]) -> f64 {
    0.5 * sides(corners).map(|([ax, ay], [bx, by])| ax * by - bx * ay).sum::<f64>().abs()
}

/// Twice the area of the triangle a, b, c: positive if it turns left.
fn turn([ax, ay]: [f64; 2], [bx, by]: [f64; 2], [cx, cy]: [f64; 2]) -> f64 {
    (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
}

/// The place on the line from `a` to `b` that is nearest to `p`, and its distance (m). The ends may be one place.
#[must_use]
pub fn nearest_on_line(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> ([f64; 2], f64) {
    let [p, a, b] = [p, a, b].map(|[x_m, y_m]| Position::new(x_m, y_m, 0.0));
    let side = b - a;
    let squared = side.dot(side);
    let share = if squared > 0.0 { ((p - a).dot(side) / squared).clamp(0.0, 1.0) } else { 0.0 };
    let at = a + side * share;
    ([at.x_m, at.y_m], p.distance_m(at))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of side 4 without a slot of 2 by 3 from above.
    const LETTER_U: [[f64; 2]; 8] =
        [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [3.0, 4.0], [3.0, 1.0], [1.0, 1.0], [1.0, 4.0], [0.0, 4.0]];

    #[test]
    fn the_slot_of_a_letter_u_is_outside() {
        let letter_u = Polygon::new(&LETTER_U).unwrap();
        assert!((letter_u.area_m2() - 10.0).abs() < 1e-12);
        for (p, is_in) in [([0.5, 3.0], true), ([2.0, 0.5], true), ([2.0, 3.0], false), ([5.0, 2.0], false)] {
            assert_eq!(letter_u.contains(p), is_in, "{p:?}");
        }
    }

    #[test]
    fn the_nearest_place_on_a_side_may_be_a_corner() {
        let letter_u = Polygon::new(&LETTER_U).unwrap();
        for (p, nearest, distance_m) in [
            ([1.5, 2.0], [1.0, 2.0], 0.5),
            ([7.0, 8.0], [4.0, 4.0], 5.0),
            ([2.0, 0.75], [2.0, 1.0], 0.25),
            ([4.0, 2.0], [4.0, 2.0], 0.0),
        ] {
            let (at, found_m) = letter_u.nearest_on_side(p);
            assert!((at[0] - nearest[0]).hypot(at[1] - nearest[1]) < 1e-12, "{at:?}");
            assert!((found_m - distance_m).abs() < 1e-12, "{found_m} m");
        }
    }

    #[test]
    fn a_polygon_without_area_or_with_crossing_sides_is_rejected() {
        let refused = |corners: &[[f64; 2]]| Polygon::new(corners).unwrap_err().to_string();
        let bow_tie = refused(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]);
        assert!(bow_tie.contains("sides 0 and 2 cross"), "{bow_tie}");
        let line = refused(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]);
        assert!(line.contains("without area"), "{line}");
        assert!(refused(&LETTER_U[..2]).contains("is 2 corners; allowed: at least 3"), "{}", refused(&LETTER_U[..2]));
        assert!(refused(&vec![[0.0, 0.0]; MOST_CORNERS + 1]).contains("at most 10000"));
        let infinite = refused(&[[0.0, 0.0], [f64::INFINITY, 1.0], [2.0, 2.0]]);
        assert!(infinite.contains("corners_m[1]"), "{infinite}");
    }

    #[test]
    fn a_slit_may_lead_to_a_hole() {
        let ring = Polygon::new(&[
            [0.0, 0.0],
            [6.0, 0.0],
            [6.0, 6.0],
            [0.0, 6.0],
            [0.0, 0.0],
            [2.0, 2.0],
            [2.0, 4.0],
            [4.0, 4.0],
            [4.0, 2.0],
            [2.0, 2.0],
        ])
        .unwrap();
        assert!((ring.area_m2() - 32.0).abs() < 1e-12);
        assert!(ring.contains([1.0, 3.0]) && ring.contains([5.0, 3.0]) && !ring.contains([3.0, 3.0]));
    }
}
