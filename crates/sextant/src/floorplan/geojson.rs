//! GeoJSON: lines and the borders of areas are walls.

use std::fs;
use std::path::Path;

use serde_json::Value;
use sextant_channel::WallConfig;
use sextant_kernel::text::counted;

use super::error::FloorPlanError;
use sextant_logs::LocalPlane;

use super::{FloorPlan, FloorPlanOptions, LengthUnit, to_mm};

/// Places farther apart than this are not degrees of one building (°).
const MOST_DEGREES: f64 = 0.5;
/// Length of a degree of latitude (m): WGS 84 at 45°.
const DEGREE_M: f64 = 111_131.7;

/// Reads lines (`LineString`, `MultiLineString`) and areas (`Polygon`, `MultiPolygon`). The properties `name`, `thickness_m`,
/// `height_m`, `bottom_m` and `material` of a feature are those of its walls. Coordinates are longitude and latitude (RFC 7946),
/// unless an option, the member `crs` or numbers too large for degrees say that they are lengths.
pub(super) fn read(path: &Path, options: &FloorPlanOptions) -> Result<FloorPlan, FloorPlanError> {
    let text = fs::read_to_string(path)
        .map_err(|why| FloorPlanError::Read { path: path.to_owned(), why: why.to_string() })?;
    plan(path, &text, options)
}

/// A line with the properties of its feature.
struct Line {
    points: Vec<[f64; 2]>,
    properties: Value,
}

/// What a file has.
struct Drawn {
    root: Value,
    lines: Vec<Line>,
    /// Features that are neither lines nor areas.
    others: usize,
}

fn drawn(text: &str) -> Result<Drawn, String> {
    let root: Value = serde_json::from_str(text).map_err(|why| format!("it is no JSON: {why}"))?;
    let mut lines = Vec::new();
    let mut others = 0;
    match root["type"].as_str() {
        Some("FeatureCollection") => {
            let features = root["features"].as_array().ok_or("it has no list `features`")?;
            for feature in features {
                take(&feature["geometry"], &feature["properties"], &mut lines, &mut others)?;
            }
        }
        Some("Feature") => take(&root["geometry"], &root["properties"], &mut lines, &mut others)?,
        Some(_) => take(&root, &Value::Null, &mut lines, &mut others)?,
        None => return Err("it has no key `type`: it is no GeoJSON".to_owned()),
    }
    Ok(Drawn { root, lines, others })
}

/// The plan in the text of the file `path`.
fn plan(path: &Path, text: &str, options: &FloorPlanOptions) -> Result<FloorPlan, FloorPlanError> {
    let owned = || path.to_owned();
    let Drawn { root, mut lines, others } =
        drawn(text).map_err(|problem| FloorPlanError::Content { path: owned(), problem })?;
    let mut plan = FloorPlan::default();
    if others > 0 {
        plan.notes.push(format!("{} are neither lines nor areas, and are left out", counted(others, "feature")));
    }
    let (note, is_by_degrees) = to_metres(&mut lines, options, &root)
        .map_err(|problem| FloorPlanError::NotDegrees { path: owned(), problem })?;
    plan.is_by_degrees = is_by_degrees;
    plan.notes.push(note);
    for (number, Line { mut points, properties }) in lines.into_iter().enumerate() {
        points.dedup_by(|a, b| libm::hypot(a[0] - b[0], a[1] - b[1]) < 1e-3);
        let number_of = |key: &str, usual: f64| properties[key].as_f64().unwrap_or(usual);
        let text_of = |key: &str| properties[key].as_str().map(str::to_owned);
        let wall = WallConfig {
            name: text_of("name"),
            thickness_m: number_of("thickness_m", options.thickness_m),
            bottom_m: number_of("bottom_m", 0.0),
            height_m: number_of("height_m", options.height_m),
            material: Some(text_of("material").unwrap_or_else(|| options.material.clone())),
            ..options.wall(points.iter().map(|point| point.map(to_mm)).collect())
        };
        match wall.obstacles(0) {
            _ if plan.add_pillar(&wall, options) => {}
            Ok(_) => plan.walls.push(wall),
            Err(why) => plan.notes.push(format!("line {number} is left out: {why}")),
        }
    }
    Ok(plan)
}

fn take(geometry: &Value, properties: &Value, lines: &mut Vec<Line>, others: &mut usize) -> Result<(), String> {
    let coordinates = &geometry["coordinates"];
    let list = |value: &Value| value.as_array().cloned().ok_or("found coordinates that are no list");
    let mut add = |line: &Value| -> Result<(), String> {
        let point = |point: &Value| {
            let numbers = point[0].as_f64().zip(point[1].as_f64());
            numbers.map(|(x, y)| [x, y]).ok_or("found a place that is not two numbers")
        };
        let points = list(line)?.iter().map(point).collect::<Result<_, _>>()?;
        lines.push(Line { points, properties: properties.clone() });
        Ok(())
    };
    match geometry["type"].as_str() {
        Some("LineString") => add(coordinates)?,
        Some("MultiLineString" | "Polygon") => list(coordinates)?.iter().try_for_each(add)?,
        Some("MultiPolygon") => {
            for polygon in list(coordinates)? {
                list(&polygon)?.iter().try_for_each(&mut add)?;
            }
        }
        Some("GeometryCollection") => {
            let parts = geometry["geometries"].as_array().ok_or("a collection has no list `geometries`")?;
            for part in parts {
                take(part, properties, lines, others)?;
            }
        }
        _ => *others += 1,
    }
    Ok(())
}

/// Turns coordinates into metres, degrees into the plane of the options or from their middle on. Says what they were, and whether they
/// were degrees.
///
/// # Errors
/// If they cannot be degrees of this place.
fn to_metres(lines: &mut [Line], options: &FloorPlanOptions, root: &Value) -> Result<(String, bool), String> {
    let [x_m, y_m] = options.origin_m.unwrap_or_default();
    let points = || lines.iter().flat_map(|line| line.points.iter());
    let low = points().fold([f64::MAX; 2], |low, point| [0, 1].map(|axis| low[axis].min(point[axis])));
    let high = points().fold([f64::MIN; 2], |high, point| [0, 1].map(|axis| high[axis].max(point[axis])));
    let is_on_earth = high[0].abs().max(low[0].abs()) <= 180.0 && high[1].abs().max(low[1].abs()) <= 90.0;
    // Of GeoJSON before RFC 7946.
    let system = root["crs"]["properties"]["name"].as_str();
    let projected = system.filter(|name| !["CRS84", "4326", "4979"].iter().any(|degrees| name.contains(degrees)));
    let lengths = match (options.unit, projected) {
        (Some(unit), _) => Some((unit, "as given".to_owned())),
        (None, Some(system)) => Some((LengthUnit::Metre, format!("by their reference system {system}"))),
        (None, None) if !is_on_earth => Some((LengthUnit::Metre, "because degrees are not so large".to_owned())),
        (None, None) => None,
    };
    let [width, height] = [0, 1].map(|axis| high[axis] - low[axis]);
    let [longitude, latitude] = [0, 1].map(|axis| 0.5 * (low[axis] + high[axis]));
    if let (None, Some(plane)) = (&lengths, options.plane) {
        // Degrees that are far from the log are lengths, or of another place.
        if plane.distance_m(latitude, longitude, plane.origin().height_m) > LocalPlane::RADIUS_M {
            return Err(format!(
                "it is at longitude {longitude:.4} and latitude {latitude:.4}, far from the places of the log"
            ));
        }
        for point in lines.iter_mut().flat_map(|line| line.points.iter_mut()) {
            let place = plane.to_local(point[1], point[0], plane.origin().height_m);
            *point = [x_m + place.x_m, y_m + place.y_m];
        }
        return Ok(("coordinates are longitude and latitude, in the plane of the log".to_owned(), true));
    }
    let is_by_degrees = lengths.is_none();
    let (scale, middle, note) = if let Some((unit, why)) = lengths {
        ([unit.metres(); 2], [0.0, 0.0], format!("coordinates are {}, {why}", unit.name()))
    } else if width.max(height) < MOST_DEGREES {
        let note = format!("coordinates are longitude and latitude: zero is at {longitude:.7}, {latitude:.7}");
        ([DEGREE_M * libm::cos(latitude.to_radians()), DEGREE_M], [longitude, latitude], note)
    } else {
        return Err(format!(
            "its coordinates are {width:.3} by {height:.3} degrees (RFC 7946), too large for a building"
        ));
    };
    for point in lines.iter_mut().flat_map(|line| line.points.iter_mut()) {
        *point = [x_m + (point[0] - middle[0]) * scale[0], y_m + (point[1] - middle[1]) * scale[1]];
    }
    Ok((note, is_by_degrees))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_text(text: &str, options: &FloorPlanOptions) -> Result<FloorPlan, String> {
        plan(Path::new("plan.geojson"), text, options).map_err(|why| why.to_string())
    }

    #[test]
    fn lines_and_areas_are_walls() {
        let text = r#"{"type": "FeatureCollection", "features": [
            {"type": "Feature", "properties": {"name": "north", "material": "glass", "thickness_m": 0.02},
             "geometry": {"type": "LineString", "coordinates": [[0, 0], [12, 0, 7]]}},
            {"type": "Feature", "properties": null,
             "geometry": {"type": "Polygon", "coordinates": [[[0, 2], [12, 2], [12, 8], [0, 8], [0, 2]]]}},
            {"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [1, 1]}}]}"#;
        // Twelve degrees are no building.
        let why = read_text(text, &FloorPlanOptions::default()).unwrap_err();
        assert!(why.contains("12.000 by 8.000 degrees") && why.contains("option `unit` says their unit"), "{why}");
        let in_metres = FloorPlanOptions { unit: Some(LengthUnit::Metre), ..FloorPlanOptions::default() };
        let plan = read_text(text, &in_metres).unwrap();
        assert_eq!(plan.walls.len(), 2);
        assert_eq!(
            (plan.walls[0].name.as_deref(), plan.walls[0].material.as_deref()),
            (Some("north"), Some("glass"))
        );
        assert!((plan.walls[0].thickness_m - 0.02).abs() < 1e-12 && (plan.length_m() - 48.0).abs() < 1e-9);
        assert!(
            plan.notes.iter().any(|note| note.contains("1 feature"))
                && plan.notes.iter().any(|note| note.contains("metres"))
        );
    }

    #[test]
    fn small_closed_shapes_are_pillars_and_a_reference_system_counts() {
        let text = r#"{"type": "FeatureCollection", "crs": {"properties": {"name": "urn:ogc:def:crs:EPSG::25832"}}, "features": [
            {"type": "Feature", "properties": {"name": "hall"},
             "geometry": {"type": "Polygon", "coordinates": [[[0, 0], [9, 0], [9, 8], [0, 8], [0, 0]],
              [[2, 2], [2.3, 2], [2.3, 2.3], [2, 2.3], [2, 2]]]}},
            {"type": "Feature", "properties": {"name": "shaft", "material": "metal", "bottom_m": 1, "height_m": 2},
             "geometry": {"type": "LineString", "coordinates": [[5, 5], [5.1, 5], [5.1, 5.05], [5, 5]]}}]}"#;
        let plan = read_text(text, &FloorPlanOptions::default()).unwrap();
        assert!(plan.notes.iter().any(|note| note.contains("EPSG::25832")), "{:?}", plan.notes);
        assert_eq!((plan.walls.len(), plan.blocks.len()), (1, 2), "{plan:?}");
        let shaft = sextant_channel::Obstacle::try_from(plan.blocks[1].clone()).unwrap();
        assert_eq!((shaft.name(), shaft.material().map(|material| material.name)), (Some("shaft"), Some("metal")));
        let bounds = shaft.shape().bounds();
        assert_eq!((bounds.min, bounds.max), ([5.0, 5.0, 1.0].into(), [5.1, 5.05, 3.0].into()));
    }

    #[test]
    fn degrees_become_metres_round_their_middle() {
        let text = r#"{"type": "LineString", "coordinates": [[8.0, 48.0], [8.001, 48.0]]}"#;
        let plan = read_text(text, &FloorPlanOptions::default()).unwrap();
        assert!((plan.length_m() - 111.13 * 48.0_f64.to_radians().cos()).abs() < 0.1, "{}", plan.length_m());
        assert!((plan.walls[0].points_m[0][0] + plan.walls[0].points_m[1][0]).abs() < 2e-3);
        let in_plane =
            FloorPlanOptions { plane: Some(LocalPlane::new(48.0, 8.0, 300.0)), ..FloorPlanOptions::default() };
        let plan = read_text(text, &in_plane).unwrap();
        let [[x_m, y_m], [end_m, _]] = plan.walls[0].points_m[..] else { panic!("two corners") };
        assert!(x_m.abs() < 2e-3 && y_m.abs() < 2e-3 && (end_m - 74.6).abs() < 0.2, "{:?}", plan.walls[0]);
        let elsewhere =
            FloorPlanOptions { plane: Some(LocalPlane::new(-33.0, 18.0, 0.0)), ..FloorPlanOptions::default() };
        assert!(
            read_text(text, &elsewhere)
                .unwrap_err()
                .contains("far from the places of the log; if its coordinates are lengths")
        );
        for (text, problem) in [
            ("{", "no JSON"),
            ("{}", "no key `type`"),
            (r#"{"type": "FeatureCollection"}"#, "no list `features`"),
            (r#"{"type": "LineString", "coordinates": [["a", 1]]}"#, "not two numbers"),
        ] {
            let found = read_text(text, &FloorPlanOptions::default()).unwrap_err();
            assert!(found.contains(problem), "{found}");
        }
    }
}
