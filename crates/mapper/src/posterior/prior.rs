//! What is known of the places of nodes before anything is heard.

use sextant_channel::{Polygon, Position};
use sextant_kernel::SettingError;

/// What is known of the places of nodes before anything is heard.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlacePrior {
    /// The area that holds all nodes.
    pub area: Option<Area>,
    /// Length l of the law exp(−d / l) of the distance d to the nearest stop (m), above 0.
    ///
    /// Of all laws with the same mean distance it says the least (maximum entropy: Jaynes, 1957), and a node that is
    /// farther away than thought costs one unit of the logarithm for each length, so that what was heard can outweigh a
    /// wrong guess.
    pub near_stops_m: Option<f64>,
}

impl PlacePrior {
    /// Nodes are within `area`, and near stops with the length `near_stops_m`, as far as these are given.
    ///
    /// # Errors
    /// `near_stops_m` if it is not above 0.
    pub fn new(area: Option<Area>, near_stops_m: Option<f64>) -> Result<Self, SettingError> {
        let near_stops_m =
            near_stops_m.map(|length_m| SettingError::positive("near_stops_m", length_m)).transpose()?;
        Ok(Self { area, near_stops_m })
    }

    /// Natural logarithm of the density of nodes at `place`, which is `nearest_stop_m` from the nearest stop, up to a
    /// constant: minus infinity outside the area, otherwise at most 0.
    #[must_use]
    pub(crate) fn log_density(&self, place: Position, nearest_stop_m: f64) -> f64 {
        if self.area.as_ref().is_some_and(|area| !area.contains(place)) {
            return f64::NEG_INFINITY;
        }
        self.near_stops_m.map_or(0.0, |length_m| -nearest_stop_m / length_m)
    }
}

/// Places within this share of the extent of an area from its border are on the border.
const ON_BORDER: f64 = 1e-9;

/// An area of the plane, whose border belongs to it. Heights do not count.
#[derive(Clone, Debug, PartialEq)]
pub struct Area {
    polygon: Polygon,
    low: [f64; 2],
    high: [f64; 2],
    /// Places this near to a side are on it (m).
    on_border_m: f64,
}

impl Area {
    /// The polygon with these `corners` (m) in order, convex or not. The first corner may be repeated at the end.
    ///
    /// # Errors
    /// `corners_m` if there are fewer than three corners or too many, two sides cross, or there is no area between them;
    /// `corners_m[i]` if a corner is not finite or too far away.
    pub fn polygon(corners: &[[f64; 2]]) -> Result<Self, SettingError> {
        let corners = match corners {
            [first, between @ .., last] if first.map(f64::to_bits) == last.map(f64::to_bits) => {
                &corners[..=between.len()]
            }
            corners => corners,
        };
        let is_far = |[x, y]: &[f64; 2]| !Position::new(*x, *y, 0.0).is_within_reason();
        if let Some(i) = corners.iter().position(is_far) {
            let [x, y] = corners[i];
            let allowed = format!("coordinates from {:e} to {:e} m", -Position::FARTHEST_M, Position::FARTHEST_M);
            return Err(SettingError::new(format!("corners_m[{i}]"), format!("[{x}, {y}]"), allowed));
        }
        Ok(Self::of(Polygon::new(corners)?))
    }

    fn of(polygon: Polygon) -> Self {
        let corners = polygon.corners();
        let fold = |from: f64, pick: fn(f64, f64) -> f64| {
            [0, 1].map(|axis| corners.iter().map(|corner| corner[axis]).fold(from, pick))
        };
        let (low, high) = (fold(f64::INFINITY, f64::min), fold(f64::NEG_INFINITY, f64::max));
        // Far from the origin, coordinates themselves are rounded.
        let extent_m = [low, high].concat().into_iter().map(f64::abs).fold(high[0] - low[0], f64::max);
        Self { low, high, on_border_m: ON_BORDER * extent_m.max(high[1] - low[1]), polygon }
    }

    /// The rectangle between two corners (m), the lower left one first.
    ///
    /// # Errors
    /// `area` if the second corner is not above and to the right of the first, or one is not finite or too far away.
    pub fn rectangle(low: [f64; 2], high: [f64; 2]) -> Result<Self, SettingError> {
        let [[x0, y0], [x1, y1]] = [low, high];
        if x1 > x0 && y1 > y0 {
            return Self::polygon(&[low, [x1, y0], high, [x0, y1]]);
        }
        let found = format!("{x0},{y0},{x1},{y1}");
        Err(SettingError::new("area", found, "x0,y0,x1,y1 in metres with x1 above x0 and y1 above y0"))
    }

    /// Whether `place` is in the area or on its border. Its height does not count.
    #[must_use]
    pub fn contains(&self, place: Position) -> bool {
        let p = [place.x_m, place.y_m];
        let margin_m = self.on_border_m;
        let is_near = |axis: usize| p[axis] >= self.low[axis] - margin_m && p[axis] <= self.high[axis] + margin_m;
        is_near(0) && is_near(1) && (self.polygon.contains(p) || self.polygon.nearest_on_side(p).1 <= margin_m)
    }

    /// The place in the area that is nearest to `place`, at the same height.
    #[must_use]
    pub fn nearest(&self, place: Position) -> Position {
        if self.contains(place) {
            return place;
        }
        let ([x_m, y_m], _) = self.polygon.nearest_on_side([place.x_m, place.y_m]);
        Position { x_m, y_m, ..place }
    }

    /// The distance of `place` from the border (m). Its height does not count.
    pub(crate) fn to_border_m(&self, place: Position) -> f64 {
        self.polygon.nearest_on_side([place.x_m, place.y_m]).1
    }

    /// The smallest rectangle around the area: its lower left and its upper right corner (m).
    #[must_use]
    pub fn bounds(&self) -> [[f64; 2]; 2] {
        [self.low, self.high]
    }

    /// The same area in other axes, in which a point has the place that `change` says. Lengths must be the same.
    pub(crate) fn moved(&self, change: impl Fn([f64; 2]) -> [f64; 2]) -> Self {
        Self::of(self.polygon.moved(change))
    }

    /// The corners of the area (m), in order.
    #[must_use]
    pub fn corners(&self) -> &[[f64; 2]] {
        self.polygon.corners()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn at(x_m: f64, y_m: f64) -> Position {
        Position::new(x_m, y_m, 1.5)
    }

    /// A star with five points round (100, -50): not convex.
    fn star() -> Area {
        let corner = |i: u8| {
            let (radius_m, angle) = ([10.0, 4.0][usize::from(i % 2)], f64::from(i) * std::f64::consts::PI / 5.0);
            [100.0 + radius_m * angle.cos(), -50.0 + radius_m * angle.sin()]
        };
        Area::polygon(&(0..10).map(corner).collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn the_density_is_even_within_the_area_and_nothing_outside() {
        let prior = PlacePrior::new(Some(Area::rectangle([0.0, 0.0], [4.0, 2.0]).unwrap()), None).unwrap();
        for place in [at(1.0, 1.0), at(0.0, 0.0), at(4.0, 2.0), at(4.0, 1.3)] {
            assert!(prior.log_density(place, 7.0).abs() < 1e-15);
        }
        for place in [at(-0.1, 1.0), at(4.1, 1.0), at(2.0, 2.1), at(2.0, f64::NAN)] {
            assert!(prior.log_density(place, 0.0) < f64::MIN);
        }
    }

    #[test]
    fn the_mean_distance_from_a_straight_path_is_the_length() {
        let prior = PlacePrior::new(None, Some(2.0)).unwrap();
        // A long straight path: d is the distance aside. ∫ d exp(−d/l) / ∫ exp(−d/l) = l.
        let (mut weight, mut sum) = (0.0, 0.0);
        for i in 0..100_000 {
            let d = (f64::from(i) + 0.5) * 1e-3;
            let density = prior.log_density(at(d, 0.0), d).exp();
            weight += density;
            sum += d * density;
        }
        assert!((sum / weight - 2.0).abs() < 1e-3, "{} m", sum / weight);
    }

    #[test]
    fn bounds_and_corners_are_those_given() {
        let area = Area::polygon(&[[0.0, 0.0], [3.0, 1.0], [1.0, 5.0], [0.0, 0.0]]).unwrap();
        assert_eq!(area.bounds(), [[0.0, 0.0], [3.0, 5.0]]);
        assert_eq!(area.corners().len(), 3, "the repeated corner is left out");
    }

    #[test]
    fn invalid_areas_and_lengths_are_rejected() {
        let area = |corners: &[[f64; 2]]| Area::polygon(corners).unwrap_err().to_string();
        assert!(area(&[[0.0, 0.0], [1.0, 0.0], [0.0, 0.0]]).contains("2 corners"));
        assert!(area(&[[0.0, 0.0], [1.0, f64::NAN], [2.0, 2.0]]).contains("corners_m[1]"));
        assert!(area(&[[0.0, 0.0], [1e10, 0.0], [2.0, 2.0]]).contains("from -1e9 to 1e9"));
        assert!(area(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]]).contains("cross"));
        let rectangle = Area::rectangle([4.0, 0.0], [0.0, 2.0]).unwrap_err().to_string();
        assert!(rectangle.contains("4,0,0,2"), "{rectangle}");
        assert!(Area::rectangle([0.0, 0.0], [0.0, 2.0]).is_err());
        for length_m in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let error = PlacePrior::new(None, Some(length_m)).unwrap_err();
            assert_eq!(error.key, "near_stops_m");
        }
    }

    proptest! {
        #[test]
        fn the_nearest_place_is_in_the_area_and_no_place_of_the_area_is_nearer(
            x_m in 80.0..120.0, y_m in -70.0..-30.0, other_x_m in 90.0..110.0, other_y_m in -60.0..-40.0,
        ) {
            let (area, place, other) = (star(), at(x_m, y_m), at(other_x_m, other_y_m));
            let nearest = area.nearest(place);
            prop_assert!(area.contains(nearest));
            prop_assert_eq!(area.contains(place), nearest == place);
            if area.contains(other) {
                prop_assert!(place.distance_m(nearest) <= place.distance_m(other) + 1e-9);
            }
        }
    }
}
