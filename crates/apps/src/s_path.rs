//! A fixed S path.

use serde::{Deserialize, Serialize};
use sextant_channel::{Bounds, Position};
use sextant_kernel::SettingError;
use sextant_sim::layout::{Region, RegionConfig};
use sextant_sim::{Controller, RobotCommand, Situation, StopsLeftOut};

use crate::itinerary::{Itinerary, MAX_STOPS, Then};
use crate::route::{number, whole};
use crate::surroundings::Surroundings;

/// Lengths are equal if they differ by less than this share of a step.
const ROUNDING: f64 = 1e-9;

/// A fixed S path over a region, as written in a scenario (thesis, section 3.4).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SPathConfig {
    /// The path covers the bounding box of this region; of a polygon, only what is inside.
    pub region: RegionConfig,
    /// Distance between lanes (m).
    pub lane_spacing_m: f64,
    /// Distance between stops along the path (m).
    #[serde(default = "default_stop_spacing_m")]
    pub stop_spacing_m: f64,
    /// How far the path extends beyond the bounding box, or the polygon, on each side (m).
    #[serde(default)]
    pub overshoot_m: f64,
    /// Height of the path (m). If absent, the height of the robot's start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height_m: Option<f64>,
}

fn default_stop_spacing_m() -> f64 {
    1.0
}

impl SPathConfig {
    /// A path over `region` with the given distance between lanes (m), and defaults for all other settings.
    #[must_use]
    pub fn new(region: RegionConfig, lane_spacing_m: f64) -> Self {
        let stop_spacing_m = default_stop_spacing_m();
        Self { region, lane_spacing_m, stop_spacing_m, overshoot_m: 0.0, height_m: None }
    }
}

/// Drives lanes along y, forth and back, over the bounding box of a region, beginning at the corner nearest to the
/// robot's start. Parts of lanes outside of a polygon are left out. Stops at equal distances along the path. Stops inside an obstacle are left out, and the way round
/// the obstacle is planned.
#[derive(Clone, Debug)]
pub struct SPath {
    itinerary: Itinerary,
}

impl SPath {
    /// The path that `config` describes.
    ///
    /// # Errors
    /// If a value is invalid, or no stop can be reached.
    pub fn plan(config: &SPathConfig, surroundings: &Surroundings<'_>) -> Result<Self, SettingError> {
        let region = Region::try_from(&config.region).map_err(|error| error.within("region"))?;
        let lane_spacing_m = SettingError::positive("lane_spacing_m", config.lane_spacing_m)?;
        let stop_spacing_m = SettingError::positive("stop_spacing_m", config.stop_spacing_m)?;
        let overshoot_m = SettingError::not_negative("overshoot_m", config.overshoot_m)?;
        let bounds = region.bounds().grown(overshoot_m);
        let z_m = SettingError::finite("height_m", config.height_m.unwrap_or(surroundings.start.z_m))?;
        let size = bounds.max - bounds.min;
        let length_m = (size.x_m / lane_spacing_m + 1.0) * size.y_m + size.x_m;
        if length_m / stop_spacing_m > MAX_STOPS {
            let found = format!("{stop_spacing_m}, which makes {:.0} stops", length_m / stop_spacing_m);
            return Err(SettingError::new(
                "stop_spacing_m",
                found,
                format!("a spacing that makes at most {MAX_STOPS:.0} stops"),
            ));
        }
        if size.x_m / lane_spacing_m > MAX_STOPS {
            let found = format!("{lane_spacing_m}, which makes {:.0} lanes", size.x_m / lane_spacing_m);
            return Err(SettingError::new(
                "lane_spacing_m",
                found,
                format!("a spacing that makes at most {MAX_STOPS:.0} lanes"),
            ));
        }
        let corners = corners(bounds, lane_spacing_m, Position { z_m, ..surroundings.start });
        let mut places = stops_along(&corners, stop_spacing_m);
        if let Some(polygon) = region.polygon() {
            let within_m = overshoot_m + ROUNDING * stop_spacing_m;
            places.retain(|(place, _)| {
                let place = [place.x_m, place.y_m];
                polygon.contains(place) || polygon.nearest_on_side(place).1 <= within_m
            });
        }
        let itinerary = Itinerary::through(places, surroundings)?;
        Ok(Self { itinerary })
    }
}

impl Controller for SPath {
    fn decide(&mut self, situation: &Situation<'_>) -> RobotCommand {
        self.itinerary.decide(situation)
    }

    fn left_out(&self) -> StopsLeftOut {
        self.itinerary.left_out()
    }
}

/// Corners of the S path, beginning at the corner of the bounds nearest to `start`. The lanes are centred in the
/// bounds.
fn corners(bounds: Bounds, lane_spacing_m: f64, start: Position) -> Vec<Position> {
    let Bounds { min, max } = bounds;
    let width_m = max.x_m - min.x_m;
    let lanes = whole(width_m / lane_spacing_m * (1.0 + ROUNDING)) + 1;
    let first_m = min.x_m + 0.5 * (width_m - number(lanes - 1) * lane_spacing_m);
    let middle = bounds.center();
    let mut corners = Vec::new();
    for lane in 0..lanes {
        let lane = if start.x_m <= middle.x_m { lane } else { lanes - 1 - lane };
        let x_m = first_m + number(lane) * lane_spacing_m;
        let mut ends = [min.y_m, max.y_m];
        if (start.y_m > middle.y_m) != (corners.len() % 4 == 2) {
            ends.reverse();
        }
        corners.extend(ends.map(|y_m| Position::new(x_m, y_m, start.z_m)));
    }
    corners
}

/// Stops at equal distances along a path, and the corners of the path between them.
fn stops_along(corners: &[Position], spacing_m: f64) -> Vec<(Position, Then)> {
    let mut places = vec![(corners[0], Then::Listen)];
    // Length of the path since the last stop [m].
    let mut since_m = 0.0;
    for side in corners.windows(2) {
        let (from, length_m) = (side[0], side[0].distance_m(side[1]));
        let direction = (side[1] - from) * (1.0 / length_m);
        let mut along_m = spacing_m - since_m;
        while along_m <= length_m + ROUNDING * spacing_m {
            places.push((from + direction * along_m.min(length_m), Then::Listen));
            along_m += spacing_m;
        }
        since_m = (length_m - (along_m - spacing_m)).max(0.0);
        if since_m > ROUNDING * spacing_m {
            places.push((side[1], Then::Pass));
        }
    }
    // Corners after the last stop are not needed.
    while places.last().is_some_and(|(_, then)| *then == Then::Pass) {
        places.pop();
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_s_path_is_as_long_as_its_lanes_and_the_ways_between_them() {
        let bounds = Bounds { min: Position::ORIGIN, max: Position::new(10.0, 7.0, 0.0) };
        for start in [Position::ORIGIN, Position::new(10.0, 7.0, 0.0), Position::new(0.0, 7.0, 0.0)] {
            let corners = corners(bounds, 2.5, start);
            assert_eq!(corners[0], start, "the path begins at the nearest corner");
            let length_m: f64 = corners.windows(2).map(|side| side[0].distance_m(side[1])).sum();
            assert!((length_m - (5.0 * 7.0 + 4.0 * 2.5)).abs() < 1e-12, "{length_m}");
            let stops = stops_along(&corners, 1.0);
            assert_eq!(stops.iter().filter(|(_, then)| *then == Then::Listen).count(), 46);
        }
    }

    #[test]
    fn lanes_that_do_not_fill_the_bounds_are_centred() {
        let bounds = Bounds { min: Position::ORIGIN, max: Position::new(10.0, 1.0, 0.0) };
        let xs: Vec<f64> = corners(bounds, 4.0, Position::ORIGIN).iter().map(|corner| corner.x_m).collect();
        assert_eq!(xs, [1.0, 1.0, 5.0, 5.0, 9.0, 9.0]);
    }
}
