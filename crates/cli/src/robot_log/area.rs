//! The area that holds the nodes, as corners in a CSV file or as a polygon in a GeoJSON file.

use std::path::Path;

use serde_json::Value;
use sextant_mapper::Area;

use super::error::RobotLogError;
use super::table::Table;

/// What a GeoJSON file of an area may hold.
const POLYGON: &str = "one Polygon without holes, alone, in a Feature or in a FeatureCollection";

/// Reads the area in the file `path`: its corners in order, one a row (`x_m,y_m`), or a polygon in GeoJSON (RFC 7946),
/// whose coordinates are x and y in metres.
///
/// # Errors
/// If the file cannot be read, has an invalid row or no polygon, or the corners form no area.
pub fn read_area(path: &Path) -> Result<Area, RobotLogError> {
    let refused = |why: String| RobotLogError::Area { path: path.to_owned(), why };
    let content = std::fs::read(path).map_err(|why| RobotLogError::read(path, why))?;
    let text = content.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&content);
    let corners = if text.trim_ascii_start().starts_with(b"{") {
        let value: Value = serde_json::from_slice(text).map_err(|why| refused(format!("not JSON: {why}")))?;
        ring(&value).map_err(refused)?
    } else {
        rows(path)?
    };
    Area::polygon(&corners).map_err(|error| refused(error.to_string()))
}

/// The corners in the rows of a CSV file.
fn rows(path: &Path) -> Result<Vec<[f64; 2]>, RobotLogError> {
    let table = Table::read(path, &["x_m", "y_m"], &["z_m"])?;
    let place = ["x_m", "y_m", "z_m"].map(|name| table.column(name));
    let mut corners = Vec::new();
    table.rows(|row| {
        let corner = row.position(place)?;
        corners.push([corner.x_m, corner.y_m]);
        Ok(())
    })?;
    Ok(corners)
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

    const RING: &str = "[[[0,0],[4,0,7],[4,2],[0,2],[0,0]]]";

    fn area(text: &str) -> Result<Area, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("area.csv");
        std::fs::write(&path, text).unwrap();
        read_area(&path).map_err(|error| error.to_string())
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
        let missing = read_area(Path::new("nowhere/area.csv")).unwrap_err().to_string();
        assert!(missing.starts_with("cannot read `nowhere/area.csv`"), "{missing}");
    }
}
