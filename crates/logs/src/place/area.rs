//! The area that holds the nodes, as corners in a CSV file or as a polygon in a GeoJSON file.

use std::path::Path;

use serde_json::Value;
use sextant_mapper::Area;

use super::local_plane::LocalPlane;
use super::place_columns::{COLUMNS, Frame, Places};
use crate::csv::table::Table;
use crate::error::robot_log_error::RobotLogError;

/// What a GeoJSON file of an area may hold.
const POLYGON: &str = "one Polygon without holes, alone, in a Feature or in a FeatureCollection";

/// Reads the area in the file `path`: its corners in order, one a row (`x_m,y_m`), or a polygon in GeoJSON (RFC 7946),
/// whose coordinates are x and y in metres. If the places of the log are in a `plane`, rows are `lat,lon` instead, and
/// coordinates are longitude and latitude.
///
/// # Errors
/// If the file cannot be read, has an invalid row or no polygon, or the corners form no area.
pub fn read_area(path: &Path, plane: Option<&LocalPlane>) -> Result<Area, RobotLogError> {
    let refused = |why: String| RobotLogError::Area { path: path.to_owned(), why };
    let content = sextant_kernel::read_at_most(path, sextant_kernel::LARGEST_FILE)
        .map_err(|why| RobotLogError::read(path, why))?;
    let text = content.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&content);
    let corners = if text.trim_ascii_start().starts_with(b"{") {
        let value: Value = serde_json::from_slice(text).map_err(|why| refused(format!("not JSON: {why}")))?;
        let ring = ring(&value).map_err(refused)?;
        match plane {
            None => ring,
            Some(plane) => {
                let corner = |[lon_deg, lat_deg]: [f64; 2]| on_plane(plane, lat_deg, lon_deg);
                ring.into_iter().map(corner).collect::<Result<_, _>>().map_err(refused)?
            }
        }
    } else {
        rows(path, plane)?
    };
    Area::polygon(&corners).map_err(|error| refused(error.to_string()))
}

/// The corners in the rows of a CSV file.
fn rows(path: &Path, plane: Option<&LocalPlane>) -> Result<Vec<[f64; 2]>, RobotLogError> {
    let table = Table::open(path, &[], &COLUMNS)?;
    let places = Places::of(&table, Frame::of(plane), &mut Vec::new())?;
    let mut plane = plane.copied();
    let mut corners = Vec::new();
    table.rows(|row| {
        let corner = places.read(row, &mut plane)?;
        corners.push([corner.x_m, corner.y_m]);
        Ok(())
    })?;
    Ok(corners)
}

/// The place in `plane` of a latitude and a longitude (degrees).
fn on_plane(plane: &LocalPlane, lat_deg: f64, lon_deg: f64) -> Result<[f64; 2], String> {
    let is_place = lat_deg.abs() <= LocalPlane::LARGEST_LAT_DEG && lon_deg.abs() <= 180.0;
    let place = is_place.then(|| plane.to_local(lat_deg, lon_deg, plane.origin().height_m));
    match place.filter(|place| libm::hypot(place.x_m, place.y_m) <= LocalPlane::RADIUS_M) {
        Some(place) => Ok([place.x_m, place.y_m]),
        None => Err(format!(
            "latitude {lat_deg} and longitude {lon_deg}; allowed: degrees within {} km of the log",
            LocalPlane::RADIUS_M / 1e3
        )),
    }
}

/// The outer ring of the polygon in a GeoJSON object.
fn ring(object: &Value) -> Result<Vec<[f64; 2]>, String> {
    let of_one = |key: &str| match object[key].as_array().map(Vec::as_slice) {
        Some([one]) => Ok(one),
        Some(many) => Err(format!("found {} entries in `{key}`; allowed: {POLYGON}", many.len())),
        None => Err(format!("found no list `{key}`; allowed: {POLYGON}")),
    };
    match object["type"].as_str() {
        Some("FeatureCollection") => ring(of_one("features")?),
        Some("Feature") => ring(&object["geometry"]),
        Some("Polygon") => of_one("coordinates").and_then(corners),
        Some(other) => Err(format!("found `{other}`; allowed: {POLYGON}")),
        None => Err(format!("found no `type`; allowed: {POLYGON}")),
    }
}

fn corners(ring: &Value) -> Result<Vec<[f64; 2]>, String> {
    let corner = |value: &Value| {
        let number = |i: usize| value.get(i).and_then(Value::as_f64);
        let corner = number(0).zip(number(1)).map(|(x_m, y_m)| [x_m, y_m]);
        corner.ok_or_else(|| format!("found the corner {value}; allowed: a list of two or three numbers"))
    };
    let corners = ring.as_array().ok_or_else(|| format!("found the ring {ring}; allowed: a list of corners"))?;
    corners.iter().map(corner).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::folder_of;

    const RING: &str = "[[[0,0],[4,0,7],[4,2],[0,2],[0,0]]]";

    fn area(text: &str) -> Result<Area, String> {
        let folder = folder_of([("area.csv", text)]);
        read_area(&folder.path().join("area.csv"), None).map_err(|error| error.to_string())
    }

    #[test]
    fn corners_are_read_from_csv_and_from_each_form_of_geojson() {
        let csv = area("x_m,y_m\n0,0\n4,0\n4,2\n0,2\n").unwrap();
        assert_eq!((csv.bounds(), csv.corners().len()), ([[0.0, 0.0], [4.0, 2.0]], 4));
        let polygon = format!("{{\"type\":\"Polygon\",\"coordinates\":{RING}}}");
        let feature = format!("{{\"type\":\"Feature\",\"properties\":{{}},\"geometry\":{polygon}}}");
        let collection = format!("\u{feff} {{\"type\":\"FeatureCollection\",\"features\":[{feature}]}}");
        for text in [&polygon, &feature, &collection] {
            assert_eq!(area(text).unwrap(), csv, "{text}");
        }
    }

    #[test]
    fn corners_by_latitude_and_longitude_are_in_the_plane_of_the_log() {
        let plane = LocalPlane::new(50.0, 3.0, 20.0);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("area");
        let area = |text: &str| {
            std::fs::write(&path, text).unwrap();
            read_area(&path, Some(&plane)).map_err(|error| error.to_string())
        };
        let csv = area("lat,lon\n50,3\n50,3.001\n50.001,3\n").unwrap();
        // At 50 degrees north, a thousandth of a degree is 111.23 m to the north and 71.70 m to the east.
        let [_, high] = csv.bounds();
        assert!((high[0] - 71.70).abs() < 0.01 && (high[1] - 111.23).abs() < 0.01, "{high:?}");
        let polygon = "{\"type\":\"Polygon\",\"coordinates\":[[[3,50],[3.001,50],[3,50.001],[3,50]]]}";
        assert_eq!(area(polygon).unwrap(), csv);
        let far = area("lat,lon\n50,3\n3,50\n50.001,3\n").unwrap_err();
        assert!(far.contains("line 3") && far.contains("at most 100 km"), "{far}");
    }

    #[test]
    fn errors_name_what_was_found_and_what_is_allowed() {
        for (text, expected) in [
            ("x_m,y_m\n0,0\n4,0\n", "2 corners; allowed: at least 3"),
            ("x_m,y_m\n0,0\n4,x\n1,1\n", "line 3, column `y_m`: found `x`"),
            ("x_m,y_m\n0,0\n2,2\n2,0\n0,2\n", "sides 0 and 2 cross"),
            ("{", "not JSON"),
            ("{}", "found no `type`"),
            ("{\"type\":\"Point\",\"coordinates\":[0,0]}", "found `Point`; allowed: one Polygon"),
            ("{\"type\":\"FeatureCollection\",\"features\":[]}", "found 0 entries in `features`"),
            ("{\"type\":\"Polygon\",\"coordinates\":[[],[]]}", "found 2 entries in `coordinates`"),
            ("{\"type\":\"Polygon\",\"coordinates\":[[[0,\"x\"]]]}", "found the corner [0,\"x\"]"),
            ("{\"type\":\"Polygon\"}", "found no list `coordinates`"),
        ] {
            let refused = area(text).unwrap_err();
            assert!(refused.contains(expected) && refused.contains("area.csv"), "{refused}");
        }
        let missing = read_area(Path::new("nowhere/area.csv"), None).unwrap_err().to_string();
        assert!(missing.starts_with("cannot read `nowhere/area.csv`"), "{missing}");
    }
}
