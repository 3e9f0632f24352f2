//! A map as GeoJSON (RFC 7946), for geographic information systems.

use std::path::Path;

use serde_json::{Map, Value, json};
use sextant_mapper::{Concern, Estimate, TopologyMap};

use super::local_plane::LocalPlane;
use crate::error::robot_log_error::RobotLogError;
use sextant_recording::output::write_whole;

/// 95 % quantile of the chi-squared law with two degrees of freedom.
const CHI_SQUARED_95: f64 = 5.991_464_547_107_982;

/// Whether a file of this name is GeoJSON.
pub(crate) fn is_named(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("geojson"))
}

/// Writes the mapped nodes as a collection of points. The properties of each are its name, its place in the plane (m), why it
/// is not reliable if it is not, and the ellipse that holds the node with 95 %, if the map has a covariance.
pub(crate) fn write(
    path: &Path,
    names: &[String],
    map: &TopologyMap,
    plane: &LocalPlane,
) -> Result<(), RobotLogError> {
    let features: Vec<Value> = names
        .iter()
        .zip(&map.estimates)
        .filter_map(|(name, estimate)| Some(feature(name, estimate.as_ref()?, plane)))
        .collect();
    let collection = json!({ "type": "FeatureCollection", "features": features });
    write_whole(path, format!("{collection:#}\n").as_bytes()).map_err(|why| RobotLogError::write(path, why))
}

fn feature(name: &str, estimate: &Estimate, plane: &LocalPlane) -> Value {
    let place = plane.to_geodetic(estimate.position).rounded();
    // RFC 7946, section 3.1.1: longitude first.
    let mut coordinates = vec![place.lon_deg, place.lat_deg];
    coordinates.extend(plane.has_altitude().then_some(place.height_m));
    let mut properties = Map::new();
    properties.insert("node".to_owned(), name.into());
    let own = estimate.position;
    for (key, value) in [("x_m", own.x_m), ("y_m", own.y_m), ("z_m", own.z_m)] {
        properties.insert(key.to_owned(), value.into());
    }
    if let Some(concern) = estimate.concern {
        properties.insert("concern".to_owned(), Concern::name(concern).into());
    }
    if let Some(ellipse) = Ellipse::of_95(estimate) {
        for (key, value) in [
            ("ellipse_95_major_m", ellipse.major_m),
            ("ellipse_95_minor_m", ellipse.minor_m),
            ("ellipse_95_azimuth_deg", ellipse.azimuth_deg),
        ] {
            properties.insert(key.to_owned(), value.into());
        }
    }
    json!({
        "type": "Feature",
        "geometry": { "type": "Point", "coordinates": coordinates },
        "properties": properties,
    })
}

/// The ellipse on the ground that holds a node with 95 %.
struct Ellipse {
    /// Semi-axes (m).
    major_m: f64,
    minor_m: f64,
    /// Direction of the major axis, clockwise from north, from 0 to 180 (degrees).
    azimuth_deg: f64,
}

impl Ellipse {
    /// From the covariance of east and north, as in [`Region`](sextant_mapper::Region).
    fn of_95(estimate: &Estimate) -> Option<Self> {
        let covariance = estimate.covariance?;
        let (xx, yy, xy) = (covariance[0][0], covariance[1][1], covariance[0][1]);
        let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let spread = libm::hypot(half, xy);
        let axis = |variance: f64| (CHI_SQUARED_95 * variance.max(0.0)).sqrt();
        // Half the angle of the vector (xx − yy, 2 xy) is that of the major axis from east.
        let from_east = 0.5 * libm::atan2(xy, half).to_degrees();
        Some(Self {
            major_m: axis(mean + spread),
            minor_m: axis(mean - spread),
            azimuth_deg: (90.0 - from_east).rem_euclid(180.0),
        })
    }
}
