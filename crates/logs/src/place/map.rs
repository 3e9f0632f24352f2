//! A map as a file.

use std::collections::BTreeMap;
use std::path::Path;

use sextant_channel::Position;
use sextant_mapper::{Concern, CoordinateFrame, TopologyMap};

use super::geojson;
use super::local_plane::LocalPlane;
use super::truth::read_places;
use crate::csv::output::Output;
use crate::error::robot_log_error::RobotLogError;
use crate::options::field_names::FieldNames;

/// The entries of the symmetric covariance of a place that are written: row, column, and name of the column of a map.
pub const COVARIANCE: [(usize, usize, &str); 6] = [
    (0, 0, "cov_xx_m2"),
    (0, 1, "cov_xy_m2"),
    (0, 2, "cov_xz_m2"),
    (1, 1, "cov_yy_m2"),
    (1, 2, "cov_yz_m2"),
    (2, 2, "cov_zz_m2"),
];

/// Reads the positions (m) in a file that [`write_map`] wrote, or in a table `node,x_m,y_m[,z_m]`, by name of node.
///
/// # Errors
/// If the file cannot be read or has an invalid row; the error names file, line and column.
pub fn read_map(path: &Path) -> Result<BTreeMap<String, Position>, RobotLogError> {
    let covariance = COVARIANCE.map(|(_, _, name)| name);
    let other = ["ties", "infeasible", "concern"].into_iter().chain(covariance);
    // A map has both kinds of places if its log has; that is no news.
    Ok(read_places(path, &FieldNames::default(), None, &other.collect::<Vec<_>>(), &mut Vec::new())?.places)
}

/// Writes the mapped nodes to the file `path`, with the columns `node,x_m,y_m,z_m,ties,infeasible,concern` and the
/// covariance (m²) if the map has one. `concern` is why a place is not reliable, empty for most nodes. Unmapped nodes have
/// no row. `names` are the names of the nodes in the log. If the places of the log are in `plane`, the columns `lat,lon`
/// follow the places, and `alt_m` if the log has heights above the sea. If the name of the file ends in `.geojson`, it gets
/// a GeoJSON text instead.
///
/// # Errors
/// If the file cannot be written, or GeoJSON is asked for and the places on the earth are unknown.
pub fn write_map(
    path: &Path,
    names: &[String],
    map: &TopologyMap,
    plane: Option<&LocalPlane>,
) -> Result<(), RobotLogError> {
    let plane = plane.filter(|_| !matches!(map.frame, CoordinateFrame::Relative(_)));
    if geojson::is_named(path) {
        let plane = plane.ok_or_else(|| RobotLogError::NotOnEarth { path: path.to_owned() })?;
        return geojson::write(path, names, map, plane);
    }
    let with_covariance = map.estimates.iter().flatten().any(|estimate| estimate.covariance.is_some());
    let mut header = vec!["node", "x_m", "y_m", "z_m", "ties", "infeasible", "concern"];
    if with_covariance {
        header.extend(COVARIANCE.map(|(_, _, name)| name));
    }
    if let Some(plane) = plane {
        header.extend(["lat", "lon"]);
        header.extend(plane.has_altitude().then_some("alt_m"));
    }
    let mut output = Output::new(&header);
    for (name, estimate) in names.iter().zip(&map.estimates) {
        let Some(estimate) = estimate else { continue };
        output.text(name).position(estimate.position).text(&estimate.ties.to_string());
        output.text(if estimate.infeasible { "1" } else { "0" });
        output.text(estimate.concern.map_or("", Concern::name));
        for (row, column, _) in COVARIANCE.iter().filter(|_| with_covariance) {
            match estimate.covariance {
                Some(covariance) => output.number(covariance[*row][*column]),
                None => output.text(""),
            };
        }
        if let Some(plane) = plane {
            let place = plane.to_geodetic(estimate.position).rounded();
            output.number(place.lat_deg).number(place.lon_deg);
            if plane.has_altitude() {
                output.number(place.height_m);
            }
        }
        output.end();
    }
    output.save(path)
}
