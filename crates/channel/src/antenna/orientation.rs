//! How an antenna is turned in the world.

use sextant_kernel::SettingError;

use crate::geometry::position::Position;

/// The largest angle (degrees): ten turns. Far larger ones would leave no digits for the widths of sectors.
const MOST_DEG: f64 = 3600.0;

/// How an antenna is turned, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OrientationConfig {
    /// Rotation about the vertical axis, counterclockwise seen from above (degrees).
    #[cfg_attr(feature = "config", serde(default))]
    pub yaw_deg: f64,
    /// Tilt of the forward axis above the horizontal plane (degrees).
    #[cfg_attr(feature = "config", serde(default))]
    pub pitch_deg: f64,
    /// Rotation about the forward axis, the left side up (degrees).
    #[cfg_attr(feature = "config", serde(default))]
    pub roll_deg: f64,
}

/// How an antenna is turned in the world. The frame of an antenna has x forward (azimuth 0), y left (azimuth 90°) and
/// z up. It is first rolled about x, then pitched, then yawed about the vertical.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orientation {
    forward: Position,
    left: Position,
    up: Position,
    /// Yaw, pitch and roll (rad).
    angles_rad: [f64; 3],
}

impl Default for Orientation {
    fn default() -> Self {
        Self::LEVEL
    }
}

impl TryFrom<OrientationConfig> for Orientation {
    type Error = SettingError;

    fn try_from(config: OrientationConfig) -> Result<Self, SettingError> {
        let OrientationConfig { yaw_deg, pitch_deg, roll_deg } = config;
        let radians =
            |key, deg| SettingError::in_range(key, deg, -MOST_DEG, MOST_DEG).map(|deg: f64| deg.to_radians());
        Ok(Self::new(radians("yaw_deg", yaw_deg)?, radians("pitch_deg", pitch_deg)?, radians("roll_deg", roll_deg)?))
    }
}

impl Orientation {
    /// Forward is x, up is z: the frame of the antenna is that of the world.
    pub const LEVEL: Self = Self {
        forward: Position::new(1.0, 0.0, 0.0),
        left: Position::new(0.0, 1.0, 0.0),
        up: Position::new(0.0, 0.0, 1.0),
        angles_rad: [0.0; 3],
    };

    /// Turned by `yaw_rad` counterclockwise about the vertical, tilted up by `pitch_rad`, and rolled about the forward
    /// axis by `roll_rad`, the left side up.
    #[must_use]
    pub fn new(yaw_rad: f64, pitch_rad: f64, roll_rad: f64) -> Self {
        let (sy, cy) = libm::sincos(yaw_rad);
        let (sp, cp) = libm::sincos(pitch_rad);
        let (sr, cr) = libm::sincos(roll_rad);
        let forward = Position::new(cy * cp, sy * cp, sp);
        let (left, up) = (Position::new(-sy, cy, 0.0), Position::new(-cy * sp, -sy * sp, cp));
        let angles_rad = [yaw_rad, pitch_rad, roll_rad];
        Self { forward, left: left * cr + up * sr, up: up * cr - left * sr, angles_rad }
    }

    /// Yaw, pitch and roll (rad), as they were given.
    #[must_use]
    pub fn angles_rad(&self) -> [f64; 3] {
        self.angles_rad
    }

    /// The settings from which it is read again.
    #[must_use]
    pub fn config(&self) -> OrientationConfig {
        let [yaw_deg, pitch_deg, roll_deg] = self.angles_rad.map(degrees);
        OrientationConfig { yaw_deg, pitch_deg, roll_deg }
    }

    /// Turned about the vertical only, counterclockwise by `yaw_rad`.
    #[must_use]
    pub fn heading(yaw_rad: f64) -> Self {
        Self::new(yaw_rad, 0.0, 0.0)
    }

    /// A direction of the world in the frame of the antenna.
    #[must_use]
    #[inline]
    pub fn to_antenna_frame(&self, direction: Position) -> Position {
        Position::new(self.forward.dot(direction), self.left.dot(direction), self.up.dot(direction))
    }
}

/// An angle in degrees, without the digits that a rounding of degrees to radians has added.
fn degrees(angle_rad: f64) -> f64 {
    let deg = angle_rad.to_degrees();
    let rounded = (deg * 1e9).round() / 1e9;
    if rounded.to_radians().to_bits() == angle_rad.to_bits() { rounded } else { deg }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A direction of the frame of the antenna in the world.
    fn in_world(turned: &Orientation, direction: Position) -> Position {
        turned.forward * direction.x_m + turned.left * direction.y_m + turned.up * direction.z_m
    }

    fn close(a: Position, b: Position) -> bool {
        a.distance_m(b) < 1e-12
    }

    #[test]
    fn yaw_turns_left_pitch_tilts_up_and_roll_lifts_the_left_side() {
        let turned = |yaw: f64, pitch: f64, roll: f64, p: [f64; 3]| {
            let config = OrientationConfig { yaw_deg: yaw, pitch_deg: pitch, roll_deg: roll };
            in_world(&Orientation::try_from(config).unwrap(), p.into())
        };
        assert!(close(turned(90.0, 0.0, 0.0, [1.0, 0.0, 0.0]), Position::new(0.0, 1.0, 0.0)));
        assert!(close(turned(0.0, 90.0, 0.0, [1.0, 0.0, 0.0]), Position::new(0.0, 0.0, 1.0)));
        assert!(close(turned(0.0, 0.0, 90.0, [0.0, 1.0, 0.0]), Position::new(0.0, 0.0, 1.0)));
        assert!(close(turned(90.0, 90.0, 0.0, [0.0, 0.0, 1.0]), Position::new(0.0, -1.0, 0.0)));
        assert!(close(turned(0.0, 0.0, 0.0, [0.3, 0.4, 0.5]), Position::new(0.3, 0.4, 0.5)));
    }

    #[test]
    fn the_settings_of_an_orientation_give_it_again() {
        for config in [
            OrientationConfig::default(),
            OrientationConfig { yaw_deg: 30.1, pitch_deg: -7.25, roll_deg: 400.3 },
            OrientationConfig { yaw_deg: -179.9, pitch_deg: 90.0, roll_deg: 1.0 / 3.0 },
            OrientationConfig { yaw_deg: MOST_DEG, pitch_deg: -MOST_DEG, roll_deg: MOST_DEG },
        ] {
            let turned = Orientation::try_from(config).unwrap();
            assert_eq!(Orientation::try_from(turned.config()).unwrap(), turned);
        }
        let written = Orientation::heading(12.3_f64.to_radians()).config();
        assert_eq!(written, OrientationConfig { yaw_deg: 12.3, pitch_deg: 0.0, roll_deg: 0.0 });
    }

    #[test]
    fn angles_of_many_turns_are_refused_at_their_key() {
        for deg in [3601.0, -1e20, f64::NAN] {
            let config = OrientationConfig { yaw_deg: deg, ..OrientationConfig::default() };
            assert_eq!(Orientation::try_from(config).unwrap_err().key, "yaw_deg");
        }
    }

    proptest! {
        #[test]
        fn rotations_keep_angles_and_have_an_inverse(
            yaw in -10.0..10.0_f64, pitch in -10.0..10.0_f64, roll in -10.0..10.0_f64,
            a in prop::array::uniform3(-1.0..1.0_f64), b in prop::array::uniform3(-1.0..1.0_f64),
        ) {
            let turned = Orientation::new(yaw, pitch, roll);
            let (a, b) = (Position::from(a), Position::from(b));
            let (x, y) = (turned.to_antenna_frame(a), turned.to_antenna_frame(b));
            prop_assert!((x.dot(y) - a.dot(b)).abs() < 1e-12);
            prop_assert!(close(x.cross(y), turned.to_antenna_frame(a.cross(b))));
            prop_assert!(close(in_world(&turned, x), a));
        }
    }
}
