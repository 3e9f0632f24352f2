//! Odometry: where a robot believes to be, and how the truth differs.

use serde::{Deserialize, Serialize};
use sextant_channel::Position;
use sextant_kernel::SettingError;

use super::motion::{Curve, Pose, Trip};

/// Shortest true way, as a share of the believed one: noise never moves a robot backwards.
const LEAST_SHARE: f64 = 1e-3;

/// Errors of a robot's odometry, as written in a scenario; exact if absent. The robot believes to drive as it decides;
/// the true way differs. Reception logs hold what the robot believes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct OdometryConfig {
    /// Share by which the true way is longer than the believed one: -0.5 to 0.5.
    pub scale_error: f64,
    /// Angle by which the robot turns to the left, without noticing it, for each metre of way seen from above
    /// (rad/m): -1 to 1.
    pub heading_drift_rad_per_m: f64,
    /// Standard deviation of the true length of a way of 1 m (m/√m); it grows with the square root of the way: 0 to 1.
    pub length_noise_m_per_sqrt_m: f64,
    /// Standard deviation of the true heading after a way of 1 m (rad/√m); it grows with the square root of the way:
    /// 0 to 1.
    pub heading_noise_rad_per_sqrt_m: f64,
}

/// The odometry of a robot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Odometry {
    config: OdometryConfig,
}

impl TryFrom<OdometryConfig> for Odometry {
    type Error = SettingError;

    fn try_from(config: OdometryConfig) -> Result<Self, SettingError> {
        let OdometryConfig {
            scale_error,
            heading_drift_rad_per_m,
            length_noise_m_per_sqrt_m,
            heading_noise_rad_per_sqrt_m,
        } = config;
        SettingError::in_range("scale_error", scale_error, -0.5, 0.5)?;
        SettingError::in_range("heading_drift_rad_per_m", heading_drift_rad_per_m, -1.0, 1.0)?;
        SettingError::in_range("length_noise_m_per_sqrt_m", length_noise_m_per_sqrt_m, 0.0, 1.0)?;
        SettingError::in_range("heading_noise_rad_per_sqrt_m", heading_noise_rad_per_sqrt_m, 0.0, 1.0)?;
        Ok(Self { config })
    }
}

/// Two independent standard normal numbers: the luck of one drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Luck {
    pub(crate) length: f64,
    pub(crate) heading: f64,
}

impl Odometry {
    /// Whether the robot knows where it is.
    #[must_use]
    pub(crate) fn is_exact(&self) -> bool {
        self.config == OdometryConfig::default()
    }

    /// The true way of a robot that is at `from` and looks `turn_rad` to the left of where it believes, if it believes
    /// to drive `believed`. Both ways take the same time.
    ///
    /// The drift and the noise of the heading turn it evenly along the way, so the true way of a straight drive is an
    /// arc.
    pub(crate) fn truth(&self, believed: &Trip, from: Position, turn_rad: f64, luck: Luck) -> Trip {
        let OdometryConfig {
            scale_error,
            heading_drift_rad_per_m,
            length_noise_m_per_sqrt_m,
            heading_noise_rad_per_sqrt_m,
        } = self.config;
        let believed_curve = believed.curve();
        let Curve { length_m, climb_m, turn_rad: believed_turn_rad } = believed_curve;
        let level_m = believed_curve.level_m();
        let noise_m = length_noise_m_per_sqrt_m * length_m.sqrt() * luck.length;
        let share = (1.0 + scale_error + noise_m / length_m).max(LEAST_SHARE);
        let drift_rad =
            heading_drift_rad_per_m * level_m + heading_noise_rad_per_sqrt_m * level_m.sqrt() * luck.heading;
        let curve =
            Curve { length_m: share * length_m, climb_m: share * climb_m, turn_rad: believed_turn_rad + drift_rad };
        let from = Pose { position: from, heading_rad: believed.from.heading_rad + turn_rad };
        let speed_m_per_s = share * believed.speed_m_per_s;
        let trip = if curve.turn_rad.abs() > 0.0 {
            Trip::along(curve, from, believed.start, speed_m_per_s)
        } else {
            let step = (believed.to.position - believed.from.position).turned(turn_rad) * share;
            let straight = Trip::straight(from, from.position + step, believed.start, speed_m_per_s);
            Trip { from, to: Pose { heading_rad: from.heading_rad, ..straight.to }, ..straight }
        };
        Trip { end: believed.end, ..trip }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_kernel::SimTime;
    use std::f64::consts::FRAC_PI_2;

    const NO_LUCK: Luck = Luck { length: 0.0, heading: 0.0 };
    const NORTH: Pose = Pose { position: Position::ORIGIN, heading_rad: FRAC_PI_2 };

    fn odometry(config: OdometryConfig) -> Odometry {
        Odometry::try_from(config).unwrap()
    }

    fn assert_near(found: Position, expected: [f64; 3]) {
        assert!(found.distance_m(expected.into()) < 1e-12, "{found}, not {expected:?}");
    }

    #[test]
    fn an_error_of_scale_lengthens_each_way() {
        let odometry = odometry(OdometryConfig { scale_error: 0.1, ..OdometryConfig::default() });
        let believed = Trip::straight(NORTH, Position::new(3.0, 4.0, 2.0), SimTime::ZERO, 0.5);
        let truth = odometry.truth(&believed, Position::new(7.0, 0.0, 0.0), 0.0, NO_LUCK);
        assert_near(truth.to.position, [10.3, 4.4, 2.2]);
        assert_eq!(truth.end, believed.end);
        assert!((truth.length_m - 1.1 * believed.length_m).abs() < 1e-12);
        // A robot that looks to the left of where it believes drives there.
        let truth = odometry.truth(&believed, Position::ORIGIN, FRAC_PI_2, NO_LUCK);
        assert_near(truth.to.position, [-4.4, 3.3, 2.2]);
        assert!((truth.to.heading_rad - believed.to.heading_rad - FRAC_PI_2).abs() < 1e-12);
    }

    #[test]
    fn a_drift_of_the_heading_bends_a_straight_way_into_an_arc() {
        let odometry = odometry(OdometryConfig { heading_drift_rad_per_m: 0.25, ..OdometryConfig::default() });
        // A circle of radius 4 m to the left: 6 m along x turn the heading by 1.5 rad.
        let believed = Trip::straight(NORTH, Position::new(6.0, 0.0, 0.0), SimTime::ZERO, 1.0);
        let truth = odometry.truth(&believed, Position::ORIGIN, 0.0, NO_LUCK);
        assert_near(truth.to.position, [4.0 * 1.5_f64.sin(), 4.0 * (1.0 - 1.5_f64.cos()), 0.0]);
        assert!((truth.to.heading_rad - 1.5).abs() < 1e-12);
        // A climb does not turn the robot.
        let climb = Trip::straight(NORTH, Position::new(0.0, 0.0, 6.0), SimTime::ZERO, 1.0);
        assert_near(odometry.truth(&climb, Position::ORIGIN, 0.0, NO_LUCK).to.position, [0.0, 0.0, 6.0]);
    }

    #[test]
    fn noise_grows_with_the_square_root_of_the_way() {
        let config = OdometryConfig {
            length_noise_m_per_sqrt_m: 0.02,
            heading_noise_rad_per_sqrt_m: 0.01,
            ..OdometryConfig::default()
        };
        let believed = Trip::straight(NORTH, Position::new(9.0, 0.0, 0.0), SimTime::ZERO, 1.0);
        let luck = Luck { length: 1.0, heading: -2.0 };
        let truth = odometry(config).truth(&believed, Position::ORIGIN, 0.0, luck);
        assert!((truth.length_m - 9.06).abs() < 1e-12);
        assert!((truth.turn_rad + 0.06).abs() < 1e-12);
        let backwards = Luck { length: -1e6, heading: 0.0 };
        assert!(odometry(config).truth(&believed, Position::ORIGIN, 0.0, backwards).length_m > 0.0);
    }

    #[test]
    fn invalid_numbers_are_rejected_at_their_keys() {
        let refused = |config: OdometryConfig| Odometry::try_from(config).unwrap_err().key;
        let exact = OdometryConfig::default();
        assert!(odometry(exact).is_exact());
        assert_eq!(refused(OdometryConfig { scale_error: f64::NAN, ..exact }), "scale_error");
        assert_eq!(refused(OdometryConfig { heading_drift_rad_per_m: -2.0, ..exact }), "heading_drift_rad_per_m");
        let negative = OdometryConfig { length_noise_m_per_sqrt_m: -0.1, ..exact };
        assert_eq!(refused(negative), "length_noise_m_per_sqrt_m");
        let infinite = OdometryConfig { heading_noise_rad_per_sqrt_m: f64::INFINITY, ..exact };
        assert_eq!(refused(infinite), "heading_noise_rad_per_sqrt_m");
    }
}
