//! The path of a robot and the places of nodes together: what of the path the evidence moves, and where the nodes are then.

mod chain;
mod climb;
mod drive;
mod drive_problem;
mod framed;
mod held_out;
mod keyframes;
mod odometry;
mod on_path;
mod packet_path;
mod packet_problem;
mod reception_curve;
mod report;
mod track;

use std::str::FromStr;

pub use drive::{EstimatedPath, PathPose};
pub use held_out::estimate_path;
pub use on_path::{OnEstimatedPath, PathErrorConfig, PathUse};
pub use report::{ContradictedPlace, FrameOfNodes, HeldOut, LateClock, PathFit, PathRanges};
pub use track::{
    DoubtedReceiver, OnRobot, PlaceUnit, RangeFault, TagReading, TagValue, Track, TrackFit, TrackHeight, TrackMotion,
    TrackPose, TrackRangeLaw, TrackSettings, TrackStrengthLaw, track,
};

/// How wrong odometry is: standard deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathError {
    /// Of the share by which all of the path is too long.
    pub scale: f64,
    /// Of how much the heading drifts to one side (rad/m).
    pub drift_rad_per_m: f64,
    /// Of how much the heading wanders (rad over a metre; it grows with the root of the length).
    pub heading_rad_per_root_m: f64,
    /// Of how much the place wanders (m over a metre; it grows with the root of the length).
    pub position_m_per_root_m: f64,
}

impl Default for PathError {
    /// Wheels and a gyroscope of a common robot.
    fn default() -> Self {
        Self { scale: 0.01, drift_rad_per_m: 0.01, heading_rad_per_root_m: 0.005, position_m_per_root_m: 0.02 }
    }
}

impl PathError {
    /// The same with a drift and a wander that are multiplied. The scale is what it was: a log does not tell it.
    fn wandering(self, factor: f64) -> Self {
        Self {
            drift_rad_per_m: self.drift_rad_per_m * factor,
            heading_rad_per_root_m: self.heading_rad_per_root_m * factor,
            position_m_per_root_m: self.position_m_per_root_m * factor,
            ..self
        }
    }
}

impl FromStr for PathError {
    type Err = String;

    /// Reads `scale=1%,heading=0.01,wander=0.005,position=0.02`: what is absent has its default.
    fn from_str(text: &str) -> Result<Self, String> {
        let mut error = Self::default();
        for part in text.split(',') {
            let (key, written) = part.split_once('=').unwrap_or((part, ""));
            let (number, unit) = match written.trim().strip_suffix('%') {
                Some(percent) => (percent, 0.01),
                None => (written.trim().trim_end_matches("/m"), 1.0),
            };
            let value = number.parse::<f64>().ok().map(|value| value * unit);
            let value = value.filter(|value| (0.0..=1.0).contains(value)).ok_or_else(|| {
                format!("found `{part}`; allowed: KEY=NUMBER from 0 to 1 (scale also as 1%), joined by commas")
            })?;
            match key.trim() {
                "scale" => error.scale = value,
                "heading" => error.drift_rad_per_m = value,
                "wander" => error.heading_rad_per_root_m = value,
                "position" => error.position_m_per_root_m = value,
                other => return Err(format!("unknown key `{other}`; allowed: scale, heading, wander, position")),
            }
        }
        Ok(error)
    }
}

#[cfg(test)]
mod tests;
