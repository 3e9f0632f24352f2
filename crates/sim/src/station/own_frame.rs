//! The frame of coordinates of a robot's odometry, in which it writes its log.

use serde::{Deserialize, Serialize};
use sextant_channel::Position;
use sextant_kernel::SettingError;

/// The frame of coordinates in which a robot writes its stops and contacts, as written in a scenario. A place of the world
/// is mirrored at the x axis if `mirrored`, then turned about the origin, then shifted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct OwnFrameConfig {
    /// Where the origin of the world is in the frame of the robot (m).
    pub offset_m: Position,
    /// Angle by which the log is turned counterclockwise, seen from above (degrees): -360 to 360.
    pub turn_deg: f64,
    /// Whether the log is a mirror image of the world, seen from above.
    pub mirrored: bool,
}

impl OwnFrameConfig {
    /// Whether it is the frame of the world.
    #[must_use]
    pub fn is_world(&self) -> bool {
        *self == Self::default()
    }
}

/// The frame of coordinates in which a robot writes its log.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OwnFrame {
    offset: Position,
    turn_rad: f64,
    mirrored: bool,
}

impl TryFrom<OwnFrameConfig> for OwnFrame {
    type Error = SettingError;

    fn try_from(config: OwnFrameConfig) -> Result<Self, SettingError> {
        if !config.offset_m.is_finite() {
            let [x, y, z] = config.offset_m.into();
            return Err(SettingError::new("offset_m", format!("[{x}, {y}, {z}]"), "finite coordinates"));
        }
        let turn_deg = SettingError::in_range("turn_deg", config.turn_deg, -360.0, 360.0)?;
        Ok(Self { offset: config.offset_m, turn_rad: turn_deg.to_radians(), mirrored: config.mirrored })
    }
}

impl OwnFrame {
    /// Where a place of the world is in this frame. The frame of the world changes no bit.
    #[must_use]
    pub fn of_world(&self, place: Position) -> Position {
        if *self == Self::default() {
            return place;
        }
        let y_m = if self.mirrored { -place.y_m } else { place.y_m };
        Position { y_m, ..place }.turned(self.turn_rad) + self.offset
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_mirrored_then_turned_then_shifted() {
        let config = OwnFrameConfig { offset_m: Position::new(10.0, 20.0, 1.0), turn_deg: 90.0, mirrored: true };
        let frame = OwnFrame::try_from(config).expect("good settings");
        let found = frame.of_world(Position::new(3.0, 4.0, 0.5));
        assert!(found.distance_m(Position::new(14.0, 23.0, 1.5)) < 1e-12, "{found}");
        assert!(!config.is_world());
        let place = Position::new(0.1, 0.2, 0.3);
        assert_eq!(OwnFrame::default().of_world(place), place);
    }

    #[test]
    fn invalid_frames_are_refused_at_their_keys() {
        let refused = |config: OwnFrameConfig| OwnFrame::try_from(config).expect_err("bad settings").key;
        let world = OwnFrameConfig::default();
        assert_eq!(refused(OwnFrameConfig { turn_deg: 361.0, ..world }), "turn_deg");
        let nowhere = Position::new(f64::NAN, 0.0, 0.0);
        assert_eq!(refused(OwnFrameConfig { offset_m: nowhere, ..world }), "offset_m");
    }
}
