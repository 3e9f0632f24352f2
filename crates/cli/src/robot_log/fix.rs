//! Fixes of a satellite receiver in a file: latitude and longitude with a time.

use sextant_channel::Position;
use sextant_kernel::SimTime;

use super::local_plane::LocalPlane;
use super::path::Pose;

/// Where a receiver was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fix {
    pub(super) time: SimTime,
    pub(super) lat_deg: f64,
    pub(super) lon_deg: f64,
    /// Above the sea (m), if it is known.
    pub(super) height_m: Option<f64>,
}

/// Puts fixes into the plane around the first of them.
#[derive(Default)]
pub(super) struct Track {
    pub(super) plane: Option<LocalPlane>,
    pub(super) poses: Vec<Pose>,
    /// Of the last fix that has one (m).
    height_m: Option<f64>,
}

impl Track {
    /// Adds a fix. One without a height is as high as the one before it.
    ///
    /// # Errors
    /// If it is no place on the earth, near a pole or far from the first one.
    pub(super) fn add(&mut self, fix: Fix) -> Result<(), String> {
        let Fix { time, lat_deg, lon_deg, height_m } = fix;
        let largest_deg = LocalPlane::LARGEST_LAT_DEG;
        // A comparison with NaN is false.
        if !(lat_deg.abs() <= largest_deg && lon_deg.abs() <= 180.0) {
            return Err(format!(
                "found latitude {lat_deg} and longitude {lon_deg}; allowed: degrees north from -{largest_deg} to {largest_deg} \
                 and degrees east from -180 to 180"
            ));
        }
        self.height_m = height_m.or(self.height_m);
        let height_m = self.height_m.or(self.plane.map(|plane| plane.origin().height_m)).unwrap_or(0.0);
        let plane = self.plane.get_or_insert_with(|| LocalPlane::new(lat_deg, lon_deg, height_m));
        if plane.distance_m(lat_deg, lon_deg, height_m) > LocalPlane::RADIUS_M {
            let origin = plane.origin();
            return Err(format!(
                "found latitude {lat_deg} and longitude {lon_deg}; allowed: a place at most {} km from the first one at {}, {}",
                LocalPlane::RADIUS_M / 1e3,
                origin.lat_deg,
                origin.lon_deg
            ));
        }
        let position: Position = plane.to_local(lat_deg, lon_deg, height_m);
        self.poses.push(Pose { time, position });
        Ok(())
    }
}
