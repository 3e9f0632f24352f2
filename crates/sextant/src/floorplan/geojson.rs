//! GeoJSON: lines and the borders of areas are walls.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde_json::Value;
use sextant_channel::WallConfig;
use sextant_kernel::text::counted;

use sextant_logs::LocalPlane;

use super::error::FloorPlanError;
use super::reference_system::{Coordinates, ReferenceSystem};
use super::{FloorPlan, FloorPlanOptions, LengthUnit, to_mm};

/// Places farther apart than this are not degrees of one building (°).
const MOST_DEGREES: f64 = 0.5;
/// Places that are nearer to each other are one (m).
const SAME_M: f64 = 1e-3;

/// Reads lines (`LineString`, `MultiLineString`) and areas (`Polygon`, `MultiPolygon`). The properties `name`, `thickness_m`,
/// `height_m`, `bottom_m` and `material` of a feature are those of its walls. Coordinates are longitude and latitude (RFC 7946),
/// unless an option, the member `crs` or numbers too large for degrees say that they are lengths. The border of an area is closed.
pub(super) fn read(path: &Path, options: &FloorPlanOptions) -> Result<FloorPlan, FloorPlanError> {
    let text = fs::read_to_string(path)
        .map_err(|why| FloorPlanError::Read { path: path.to_owned(), why: why.to_string() })?;
    plan(path, &text, options)
}

/// A line with the properties of its feature.
struct Line {
    points: Vec<[f64; 2]>,
    /// Whether it is the border of an area.
    is_border: bool,
    properties: Value,
}

fn distance_m(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(a[0] - b[0], a[1] - b[1])
}

impl Line {
    /// Leaves out repeated places, and closes a border; whether it was open.
    fn close(&mut self) -> bool {
        self.points.dedup_by(|a, b| distance_m(*a, *b) < SAME_M);
        let Some((&first, rest)) = self.points.split_first() else { return false };
        let is_open = rest.last().is_some_and(|&last| distance_m(first, last) >= SAME_M);
        if !self.is_border || rest.is_empty() {
            return false;
        }
        if !is_open {
            self.points.pop();
        }
        self.points.push(first);
        is_open
    }
}

/// Reads properties of features, and counts those that cannot be read: by key, how many, and the first one.
#[derive(Default)]
struct PropertyReader {
    unread: BTreeMap<&'static str, (usize, Value)>,
}

impl PropertyReader {
    /// A number, also one that is written as text.
    fn number(&mut self, properties: &Value, key: &'static str, usual: f64) -> f64 {
        let value = &properties[key];
        let of_text = |text: &str| text.trim().parse().ok().filter(|number: &f64| number.is_finite());
        let number = value.as_f64().or_else(|| value.as_str().and_then(of_text));
        self.count(key, value, number.is_some());
        number.unwrap_or(usual)
    }

    /// A text. A name may be a number too.
    fn text(&mut self, properties: &Value, key: &'static str) -> Option<String> {
        let value = &properties[key];
        let of_number = value.as_number().filter(|_| key == "name").map(ToString::to_string);
        let text = value.as_str().map(str::to_owned).or(of_number);
        self.count(key, value, text.is_some());
        text
    }

    fn count(&mut self, key: &'static str, value: &Value, is_read: bool) {
        if !is_read && !value.is_null() {
            self.unread.entry(key).or_insert_with(|| (0, value.clone())).0 += 1;
        }
    }

    /// What could not be read.
    fn notes(&self) -> impl Iterator<Item = String> {
        self.unread.iter().map(|(key, (count, first))| {
            let wanted = if key.ends_with("_m") { "a number of metres" } else { "text" };
            format!(
                "the property `{key}` of {} is not {wanted} (found {first}): what is usual is taken",
                counted(*count, "line")
            )
        })
    }
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
    let open = lines.iter_mut().filter_map(|line| line.close().then_some(())).count();
    if open > 0 {
        plan.notes
            .push(format!("{} of areas did not end where they began, and were closed", counted(open, "border")));
    }
    let mut reader = PropertyReader::default();
    for (number, Line { points, properties, .. }) in lines.into_iter().enumerate() {
        let wall = WallConfig {
            name: reader.text(&properties, "name"),
            thickness_m: reader.number(&properties, "thickness_m", options.thickness_m),
            bottom_m: reader.number(&properties, "bottom_m", 0.0),
            height_m: Some(reader.number(&properties, "height_m", options.height_m)),
            material: Some(reader.text(&properties, "material").unwrap_or_else(|| options.material.clone())),
            ..options.wall(points.iter().map(|point| point.map(to_mm)).collect())
        };
        match wall.obstacles(0) {
            _ if plan.add_pillar(&wall, options) => {}
            Ok(_) => plan.walls.push(wall),
            Err(why) => plan.notes.push(format!("line {number} is left out: {why}")),
        }
    }
    plan.notes.extend(reader.notes());
    Ok(plan)
}

fn take(geometry: &Value, properties: &Value, lines: &mut Vec<Line>, others: &mut usize) -> Result<(), String> {
    let coordinates = &geometry["coordinates"];
    let list = |value: &Value| value.as_array().cloned().ok_or("found coordinates that are no list");
    let mut add = |line: &Value, is_border: bool| -> Result<(), String> {
        let point = |point: &Value| {
            let numbers = point[0].as_f64().zip(point[1].as_f64());
            numbers.map(|(x, y)| [x, y]).ok_or("found a place that is not two numbers")
        };
        let points = list(line)?.iter().map(point).collect::<Result<_, _>>()?;
        lines.push(Line { points, is_border, properties: properties.clone() });
        Ok(())
    };
    match geometry["type"].as_str() {
        Some("LineString") => add(coordinates, false)?,
        Some("MultiLineString") => list(coordinates)?.iter().try_for_each(|line| add(line, false))?,
        Some("Polygon") => list(coordinates)?.iter().try_for_each(|border| add(border, true))?,
        Some("MultiPolygon") => {
            for polygon in list(coordinates)? {
                list(&polygon)?.iter().try_for_each(|border| add(border, true))?;
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

/// The lowest and the highest coordinates of all lines.
fn bounds(lines: &[Line]) -> [[f64; 2]; 2] {
    let points = || lines.iter().flat_map(|line| line.points.iter());
    let low = points().fold([f64::MAX; 2], |low, point| [0, 1].map(|axis| low[axis].min(point[axis])));
    let high = points().fold([f64::MIN; 2], |high, point| [0, 1].map(|axis| high[axis].max(point[axis])));
    [low, high]
}

/// The unit of coordinates that are lengths, and why they are; `None` if they are degrees.
fn lengths(
    unit: Option<LengthUnit>,
    system: Option<&ReferenceSystem>,
    [low, high]: [[f64; 2]; 2],
) -> Result<Option<(LengthUnit, String)>, String> {
    let is_on_earth = high[0].abs().max(low[0].abs()) <= 180.0 && high[1].abs().max(low[1].abs()) <= 90.0;
    let Some(system) = system else {
        let why = unit.map_or("because degrees are not so large", |_| "as given");
        let is_length = unit.is_some() || !is_on_earth;
        return Ok(is_length.then(|| (unit.unwrap_or(LengthUnit::Metre), why.to_owned())));
    };
    let name = &system.name;
    match (unit, system.coordinates) {
        (Some(unit), Coordinates::Mercator) => Ok(Some((
            unit,
            format!("as given, though lengths in {name} are stretched by one over the cosine of the latitude"),
        ))),
        (Some(unit), _) => Ok(Some((unit, "as given".to_owned()))),
        (None, Coordinates::Metres) => Ok(Some((LengthUnit::Metre, format!("by their reference system {name}")))),
        (None, Coordinates::Degrees) if is_on_earth => Ok(None),
        (None, Coordinates::Degrees) => {
            Err(format!("its coordinates are too large for degrees, though its reference system is {name}"))
        }
        (None, Coordinates::Mercator | Coordinates::Unknown) => Err(system.refusal()),
    }
}

/// Turns coordinates into metres, degrees into the plane of the options or from their middle on. Says what they were, and whether they
/// were degrees.
///
/// # Errors
/// If they cannot be degrees of this place.
fn to_metres(lines: &mut [Line], options: &FloorPlanOptions, root: &Value) -> Result<(String, bool), String> {
    let [x_m, y_m] = options.origin_m.unwrap_or_default();
    let [low, high] = bounds(lines);
    let lengths = lengths(options.unit, ReferenceSystem::of(root).as_ref(), [low, high])?;
    let places = lines.iter_mut().flat_map(|line| line.points.iter_mut());
    if let Some((unit, why)) = lengths {
        places.for_each(|point| *point = [x_m + point[0] * unit.metres(), y_m + point[1] * unit.metres()]);
        return Ok((format!("coordinates are {}, {why}", unit.name()), false));
    }
    let [width, height] = [0, 1].map(|axis| high[axis] - low[axis]);
    let [longitude, latitude] = [0, 1].map(|axis| 0.5 * (low[axis] + high[axis]));
    let (plane, note) = if let Some(plane) = options.plane {
        // Degrees that are far from the log are lengths, or of another place.
        if plane.distance_m(latitude, longitude, plane.origin().height_m) > LocalPlane::RADIUS_M {
            return Err(format!(
                "it is at longitude {longitude:.4} and latitude {latitude:.4}, far from the places of the log"
            ));
        }
        (plane, "in the plane of the log".to_owned())
    } else if width.max(height) >= MOST_DEGREES {
        return Err(format!(
            "its coordinates are {width:.3} by {height:.3} degrees (RFC 7946), too large for a building"
        ));
    } else if latitude.abs() > LocalPlane::LARGEST_LAT_DEG {
        return Err(format!(
            "it is at latitude {latitude:.4}; allowed: at most {} degrees from the equator",
            LocalPlane::LARGEST_LAT_DEG
        ));
    } else {
        (LocalPlane::new(latitude, longitude, 0.0), format!("zero is at {longitude:.7}, {latitude:.7}"))
    };
    for point in places {
        let place = plane.to_local(point[1], point[0], plane.origin().height_m);
        *point = [x_m + place.x_m, y_m + place.y_m];
    }
    Ok((format!("coordinates are longitude and latitude: {note}"), true))
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
        // A degree of longitude at 48° on WGS 84: π/180 a cos φ / sqrt(1 − e² sin² φ) = 74 625.3 m; of a sphere it is shorter.
        assert!((plan.length_m() - 74.625).abs() < 2e-3, "{}", plan.length_m());
        assert!((plan.walls[0].points_m[0][0] + plan.walls[0].points_m[1][0]).abs() < 2e-3);
        // Degrees of latitude are longer near a pole: π/180 a (1 − e²) / (1 − e² sin² φ)^(3/2) = 111 660.4 m, of longitude 19 393.5 m.
        let polar = r#"{"type": "LineString", "coordinates": [[12.0, 80.0], [12.004, 80.0], [12.004, 80.004]]}"#;
        let polar = read_text(polar, &FloorPlanOptions::default()).unwrap();
        let [a, b, c] = polar.walls[0].points_m[..] else { panic!("three corners") };
        let legs_m = [[a, b], [b, c]].map(|[a, b]| libm::hypot(a[0] - b[0], a[1] - b[1]));
        assert!((legs_m[0] - 77.574).abs() < 0.01 && (legs_m[1] - 446.642).abs() < 0.01, "{legs_m:?}");
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

    #[test]
    fn lengths_of_unknown_systems_are_refused_without_a_unit() {
        let of = |system: &str, places: &str| {
            format!(
                r#"{{"type": "LineString", "crs": {{"properties": {{"name": "{system}"}}}}, "coordinates": {places}}}"#
            )
        };
        let usual = FloorPlanOptions::default();
        let in_feet = FloorPlanOptions { unit: Some(LengthUnit::UsSurveyFoot), ..FloorPlanOptions::default() };
        let large = "[[980000, 200000], [980100, 200000]]";
        for system in ["urn:ogc:def:crs:EPSG::2263", "EPSG:3857", "site grid"] {
            let why = read_text(&of(system, large), &usual).unwrap_err();
            assert!(why.contains(system) && why.contains("EPSG:4326") && why.contains("`unit`"), "{why}");
            let feet = read_text(&of(system, large), &in_feet).unwrap();
            assert!(
                (feet.length_m() - 30.480_06).abs() < 1e-3 && !feet.is_by_degrees,
                "{system}: {}",
                feet.length_m()
            );
            let is_stretched = feet.notes.iter().any(|note| note.contains("stretched"));
            assert_eq!(is_stretched, system == "EPSG:3857", "{:?}", feet.notes);
        }
        let metres = read_text(&of("urn:ogc:def:crs:EPSG::32633", large), &usual).unwrap();
        assert!((metres.length_m() - 100.0).abs() < 1e-9);
        let degrees = read_text(&of("urn:ogc:def:crs:EPSG::4258", "[[12, 52], [12.001, 52]]"), &usual).unwrap();
        assert!((degrees.length_m() - 68.678).abs() < 0.01 && degrees.is_by_degrees, "{}", degrees.length_m());
        let why = read_text(&of("EPSG:4326", large), &usual).unwrap_err();
        assert!(why.contains("too large for degrees") && why.contains("`unit`"), "{why}");
    }

    #[test]
    fn properties_of_another_type_are_read_or_told_and_open_borders_are_closed() {
        let in_metres = FloorPlanOptions { unit: Some(LengthUnit::Metre), ..FloorPlanOptions::default() };
        let text = r#"{"type": "FeatureCollection", "features": [
            {"type": "Feature", "properties": {"name": 12, "height_m": "4", "thickness_m": " 0.3 ", "material": 7, "bottom_m": null},
             "geometry": {"type": "LineString", "coordinates": [[0, 0], [10, 0]]}},
            {"type": "Feature", "properties": {"height_m": true, "thickness_m": "thick"},
             "geometry": {"type": "Polygon", "coordinates": [[[0, 2], [4, 2], [4, 6], [0, 6]]]}}]}"#;
        let plan = read_text(text, &in_metres).unwrap();
        let [line, border] = &plan.walls[..] else { panic!("two walls") };
        assert_eq!((line.name.as_deref(), line.height_m, line.thickness_m), (Some("12"), Some(4.0), 0.3));
        assert_eq!(line.material.as_deref(), Some("brick"));
        assert_eq!((border.height_m, border.thickness_m), (Some(in_metres.height_m), in_metres.thickness_m));
        assert_eq!((border.points_m.len(), border.points_m[0]), (5, border.points_m[4]));
        let notes = plan.notes.join("\n");
        for part in [
            "1 border of areas did not end",
            "`material` of 1 line is not text (found 7)",
            "`height_m` of 1 line is not a number of metres (found true)",
            "`thickness_m` of 1 line is not a number of metres (found \"thick\")",
        ] {
            assert!(notes.contains(part), "{notes}");
        }
        assert!(!notes.contains("`bottom_m`") && !notes.contains("`name`"), "{notes}");
    }
}
