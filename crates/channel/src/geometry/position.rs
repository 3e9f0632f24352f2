//! Positions in the world frame.

use std::fmt;
use std::ops::{Add, Mul, Sub};

#[cfg(feature = "config")]
use serde::{Deserialize, Serialize};

/// A place, or a displacement between two places, in the world frame (m): x east, y north, z up.
/// A planar scene has z = 0. Written as `[x, y]` or `[x, y, z]`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "config", derive(Serialize, Deserialize), serde(from = "Written", into = "[f64; 3]"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(with = "Vec<f64>", extend("minItems" = 2, "maxItems" = 3)))]
pub struct Position {
    /// East (m).
    pub x_m: f64,
    /// North (m).
    pub y_m: f64,
    /// Up (m).
    pub z_m: f64,
}

#[cfg(feature = "config")]
#[derive(Deserialize)]
#[serde(untagged, expecting = "a place `[x, y]` or `[x, y, z]` in metres")]
enum Written {
    Planar([f64; 2]),
    Spatial([f64; 3]),
}

#[cfg(feature = "config")]
impl From<Written> for Position {
    fn from(written: Written) -> Self {
        match written {
            Written::Planar([x, y]) => Self::new(x, y, 0.0),
            Written::Spatial([x, y, z]) => Self::new(x, y, z),
        }
    }
}

impl From<Position> for [f64; 3] {
    fn from(p: Position) -> Self {
        [p.x_m, p.y_m, p.z_m]
    }
}

impl From<[f64; 3]> for Position {
    fn from([x, y, z]: [f64; 3]) -> Self {
        Self::new(x, y, z)
    }
}

impl Position {
    /// The origin of the world frame.
    pub const ORIGIN: Self = Self::new(0.0, 0.0, 0.0);

    /// The place (x, y, z) (m).
    #[must_use]
    #[inline]
    pub const fn new(x_m: f64, y_m: f64, z_m: f64) -> Self {
        Self { x_m, y_m, z_m }
    }

    /// Scalar product.
    #[must_use]
    #[inline]
    pub fn dot(self, other: Self) -> f64 {
        self.x_m * other.x_m + self.y_m * other.y_m + self.z_m * other.z_m
    }

    /// Vector product.
    #[must_use]
    pub fn cross(self, other: Self) -> Self {
        Self::new(
            self.y_m * other.z_m - self.z_m * other.y_m,
            self.z_m * other.x_m - self.x_m * other.z_m,
            self.x_m * other.y_m - self.y_m * other.x_m,
        )
    }

    /// Length of the displacement (m).
    #[must_use]
    #[inline]
    pub fn length_m(self) -> f64 {
        self.dot(self).sqrt()
    }

    /// Distance to `other` (m).
    #[must_use]
    #[inline]
    pub fn distance_m(self, other: Self) -> f64 {
        (self - other).length_m()
    }

    /// The displacement, turned counterclockwise about the vertical axis.
    #[must_use]
    pub fn turned(self, turn_rad: f64) -> Self {
        if turn_rad.abs() <= 0.0 {
            return self;
        }
        let (sin, cos) = (libm::sin(turn_rad), libm::cos(turn_rad));
        Self::new(cos * self.x_m - sin * self.y_m, sin * self.x_m + cos * self.y_m, self.z_m)
    }

    /// Largest coordinate of any place in a network, as an absolute value (m).
    pub const FARTHEST_M: f64 = 1e9;

    /// Whether all coordinates are numbers and at most [`FARTHEST_M`](Self::FARTHEST_M) from zero.
    #[must_use]
    pub fn is_within_reason(self) -> bool {
        [self.x_m, self.y_m, self.z_m].iter().all(|coordinate_m| coordinate_m.abs() <= Self::FARTHEST_M)
    }

    /// Whether all coordinates are finite.
    #[must_use]
    pub fn is_finite(self) -> bool {
        self.x_m.is_finite() && self.y_m.is_finite() && self.z_m.is_finite()
    }
}

impl Add for Position {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self::new(self.x_m + other.x_m, self.y_m + other.y_m, self.z_m + other.z_m)
    }
}

impl Sub for Position {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        Self::new(self.x_m - other.x_m, self.y_m - other.y_m, self.z_m - other.z_m)
    }
}

impl Mul<f64> for Position {
    type Output = Self;

    #[inline]
    fn mul(self, factor: f64) -> Self {
        Self::new(self.x_m * factor, self.y_m * factor, self.z_m * factor)
    }
}

impl fmt::Display for Position {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "({}, {}, {})", self.x_m, self.y_m, self.z_m)
    }
}
