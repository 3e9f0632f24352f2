//! The region of the nodes.

mod border;

use serde::{Deserialize, Serialize};
use sextant_channel::{Bounds, Polygon, Position};
use sextant_kernel::SettingError;

/// A region of the plane or of space, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum RegionConfig {
    /// A disc at the height of its centre.
    Disc {
        /// Centre (m).
        center_m: Position,
        /// Radius (m).
        radius_m: f64,
    },
    /// An upright rectangle of the plane.
    Rectangle {
        /// Corner with the smallest x and y (m).
        min_m: Position,
        /// Opposite corner, at the same height (m).
        max_m: Position,
    },
    /// A polygon of the plane, convex or not.
    Polygon {
        /// Corners in order, clockwise or counterclockwise; the sides do not cross (m).
        corners_m: Vec<[f64; 2]>,
        /// Height of the plane (m).
        #[serde(default)]
        z_m: f64,
    },
    /// A ball.
    Ball {
        /// Centre (m).
        center_m: Position,
        /// Radius (m).
        radius_m: f64,
    },
    /// An upright box of space.
    Box {
        /// Corner with the smallest x, y and z (m).
        min_m: Position,
        /// Opposite corner (m).
        max_m: Position,
    },
    /// An upright cylinder.
    Cylinder {
        /// Middle of the bottom face (m).
        base_m: Position,
        /// Radius (m).
        radius_m: f64,
        /// Height (m).
        height_m: f64,
    },
}

impl RegionConfig {
    /// The same region, so much higher (m).
    pub(super) fn raised(&self, by_m: f64) -> Self {
        let up = Position::new(0.0, 0.0, by_m);
        match self.clone() {
            Self::Disc { center_m, radius_m } => Self::Disc { center_m: center_m + up, radius_m },
            Self::Rectangle { min_m, max_m } => Self::Rectangle { min_m: min_m + up, max_m: max_m + up },
            Self::Polygon { corners_m, z_m } => Self::Polygon { corners_m, z_m: z_m + by_m },
            Self::Ball { center_m, radius_m } => Self::Ball { center_m: center_m + up, radius_m },
            Self::Box { min_m, max_m } => Self::Box { min_m: min_m + up, max_m: max_m + up },
            Self::Cylinder { base_m, radius_m, height_m } => {
                Self::Cylinder { base_m: base_m + up, radius_m, height_m }
            }
        }
    }
}

/// A region of the plane or of space. Its border belongs to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    shape: Shape,
    bounds: Bounds,
}

#[derive(Clone, Debug, PartialEq)]
enum Shape {
    /// The whole box of the bounds.
    Bounds,
    /// Within `radius_m` of the upright axis through `center`.
    Round {
        center: Position,
        radius_m: f64,
    },
    Ball {
        center: Position,
        radius_m: f64,
    },
    Polygon(Polygon),
}

impl TryFrom<&RegionConfig> for Region {
    type Error = SettingError;

    fn try_from(config: &RegionConfig) -> Result<Self, SettingError> {
        match *config {
            RegionConfig::Disc { center_m, radius_m } => {
                disc(center_m, radius_m).map_err(|error| error.within("disc"))
            }
            RegionConfig::Rectangle { min_m, max_m } => {
                rectangle(min_m, max_m).map_err(|error| error.within("rectangle"))
            }
            RegionConfig::Box { min_m, max_m } => upright_box(min_m, max_m).map_err(|error| error.within("box")),
            RegionConfig::Polygon { ref corners_m, z_m } => {
                polygon(corners_m, z_m).map_err(|error| error.within("polygon"))
            }
            RegionConfig::Ball { center_m, radius_m } => {
                ball(center_m, radius_m).map_err(|error| error.within("ball"))
            }
            RegionConfig::Cylinder { base_m, radius_m, height_m } => {
                cylinder(base_m, radius_m, height_m).map_err(|error| error.within("cylinder"))
            }
        }
    }
}

impl Region {
    /// Whether `p` is in the region: on its plane if it is planar.
    #[must_use]
    pub fn contains(&self, p: Position) -> bool {
        self.bounds.contains(p)
            && match &self.shape {
                Shape::Bounds => true,
                Shape::Round { center, radius_m } => libm::hypot(p.x_m - center.x_m, p.y_m - center.y_m) <= *radius_m,
                Shape::Ball { center, radius_m } => p.distance_m(*center) <= *radius_m,
                Shape::Polygon(polygon) => polygon.contains([p.x_m, p.y_m]),
            }
    }

    /// The smallest upright box around the region.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Its outline, if it is a polygon.
    #[must_use]
    pub fn polygon(&self) -> Option<&Polygon> {
        match &self.shape {
            Shape::Polygon(polygon) => Some(polygon),
            Shape::Bounds | Shape::Round { .. } | Shape::Ball { .. } => None,
        }
    }

    /// Whether the region lies in a horizontal plane.
    #[must_use]
    pub fn is_planar(&self) -> bool {
        self.bounds.min.z_m >= self.bounds.max.z_m
    }
}

fn finite(key: &str, place: Position) -> Result<Position, SettingError> {
    if place.is_finite() {
        return Ok(place);
    }
    let [x, y, z] = place.into();
    Err(SettingError::new(key, format!("[{x}, {y}, {z}]"), "finite coordinates in metres"))
}

fn disc(center: Position, radius_m: f64) -> Result<Region, SettingError> {
    let center = finite("center_m", center)?;
    let radius_m = SettingError::positive("radius_m", radius_m)?;
    let reach = Position::new(radius_m, radius_m, 0.0);
    let bounds = Bounds { min: center - reach, max: center + reach };
    Ok(Region { shape: Shape::Round { center, radius_m }, bounds })
}

fn ball(center: Position, radius_m: f64) -> Result<Region, SettingError> {
    let center = finite("center_m", center)?;
    let radius_m = SettingError::positive("radius_m", radius_m)?;
    let bounds = Bounds { min: center, max: center }.grown(radius_m);
    Ok(Region { shape: Shape::Ball { center, radius_m }, bounds })
}

/// The rectangle between two corners, both at the same height.
fn rectangle(min: Position, max: Position) -> Result<Region, SettingError> {
    let (min, max) = (finite("min_m", min)?, finite("max_m", max)?);
    let size = max - min;
    if size.x_m > 0.0 && size.y_m > 0.0 && size.z_m.abs() <= 0.0 {
        return Ok(Region { shape: Shape::Bounds, bounds: Bounds { min, max } });
    }
    let [x, y, z] = max.into();
    Err(SettingError::new("max_m", format!("[{x}, {y}, {z}]"), "more than `min_m` in x and y, at the same z"))
}

/// The box between two corners, one above the other.
fn upright_box(min: Position, max: Position) -> Result<Region, SettingError> {
    let (min, max) = (finite("min_m", min)?, finite("max_m", max)?);
    let size = max - min;
    if size.x_m > 0.0 && size.y_m > 0.0 && size.z_m > 0.0 {
        return Ok(Region { shape: Shape::Bounds, bounds: Bounds { min, max } });
    }
    let [x, y, z] = max.into();
    Err(SettingError::new("max_m", format!("[{x}, {y}, {z}]"), "more than `min_m` in x, y and z"))
}

fn cylinder(base: Position, radius_m: f64, height_m: f64) -> Result<Region, SettingError> {
    let base = finite("base_m", base)?;
    let radius_m = SettingError::positive("radius_m", radius_m)?;
    let height_m = SettingError::positive("height_m", height_m)?;
    Ok(Region {
        shape: Shape::Round { center: base, radius_m },
        bounds: Bounds {
            min: base - Position::new(radius_m, radius_m, 0.0),
            max: base + Position::new(radius_m, radius_m, height_m),
        },
    })
}

fn polygon(corners: &[[f64; 2]], z_m: f64) -> Result<Region, SettingError> {
    let z_m = SettingError::finite("z_m", z_m)?;
    let polygon = Polygon::new(corners)?;
    let bounds = Bounds::of(corners.iter().map(|&[x, y]| Position::new(x, y, z_m))).expect("at least 3 corners");
    Ok(Region { shape: Shape::Polygon(polygon), bounds })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn region(text: RegionConfig) -> Result<Region, SettingError> {
        Region::try_from(&text)
    }

    /// Share of the bounding box that is in the region, on a lattice of `n` points a side.
    fn share(region: &Region, n: i32) -> f64 {
        let Bounds { min, max } = region.bounds();
        let at = |i: i32, a: f64, b: f64| a + (f64::from(i) + 0.5) / f64::from(n) * (b - a);
        let (mut inside, mut all) = (0, 0);
        for i in 0..n {
            for j in 0..n {
                for k in 0..if region.is_planar() { 1 } else { n } {
                    let z = if region.is_planar() { min.z_m } else { at(k, min.z_m, max.z_m) };
                    let p = Position::new(at(i, min.x_m, max.x_m), at(j, min.y_m, max.y_m), z);
                    inside += i32::from(region.contains(p));
                    all += 1;
                }
            }
        }
        f64::from(inside) / f64::from(all)
    }

    #[test]
    fn regions_have_the_area_or_volume_of_their_formulas() {
        use std::f64::consts::PI;
        let center_m = Position::new(3.0, -1.0, 2.0);
        let disc = region(RegionConfig::Disc { center_m, radius_m: 2.0 }).unwrap();
        assert!((share(&disc, 400) - PI / 4.0).abs() < 1e-3);
        let ball = region(RegionConfig::Ball { center_m, radius_m: 2.0 }).unwrap();
        assert!((share(&ball, 80) - PI / 6.0).abs() < 2e-3);
        let cylinder = region(RegionConfig::Cylinder { base_m: center_m, radius_m: 2.0, height_m: 5.0 }).unwrap();
        assert!((share(&cylinder, 80) - PI / 4.0).abs() < 4e-3);
        // A U: a square of side 4 without a slot of 2 by 3.
        let corners_m = vec![[0., 0.], [4., 0.], [4., 4.], [3., 4.], [3., 1.], [1., 1.], [1., 4.], [0., 4.]];
        let letter_u = region(RegionConfig::Polygon { corners_m, z_m: 0.0 }).unwrap();
        assert!((share(&letter_u, 400) - 10.0 / 16.0).abs() < 1e-12);
        assert!(!letter_u.contains(Position::new(2.0, 3.0, 0.0)));
        assert!(!letter_u.contains(Position::new(2.0, 0.5, 1.0)), "above its plane");
    }

    #[test]
    fn regions_without_area_or_volume_are_rejected_with_their_key() {
        let key = |config| region(config).unwrap_err().key;
        let origin = Position::ORIGIN;
        assert_eq!(key(RegionConfig::Disc { center_m: origin, radius_m: 0.0 }), "disc.radius_m");
        assert_eq!(key(RegionConfig::Ball { center_m: origin, radius_m: f64::NAN }), "ball.radius_m");
        assert_eq!(
            key(RegionConfig::Rectangle { min_m: origin, max_m: Position::new(1.0, 0.0, 0.0) }),
            "rectangle.max_m"
        );
        assert_eq!(key(RegionConfig::Box { min_m: origin, max_m: Position::new(1.0, 1.0, 0.0) }), "box.max_m");
        let bow_tie = vec![[0., 0.], [1., 1.], [1., 0.], [0., 1.]];
        assert_eq!(key(RegionConfig::Polygon { corners_m: bow_tie, z_m: 0.0 }), "polygon.corners_m");
        let line = vec![[0., 0.], [1., 1.], [2., 2.]];
        assert_eq!(key(RegionConfig::Polygon { corners_m: line, z_m: 0.0 }), "polygon.corners_m");
        let nan = vec![[0., 0.], [1., f64::NAN], [2., 0.]];
        assert_eq!(key(RegionConfig::Polygon { corners_m: nan, z_m: 0.0 }), "polygon.corners_m[1]");
    }
}
