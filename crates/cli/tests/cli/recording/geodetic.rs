//! Logs and maps by latitude and longitude.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use serde_json::Value;
use sextant_channel::Position;
use sextant_logs::{self as robot_log, LocalPlane, ReadOptions};
use tempfile::TempDir;

use crate::program::{Said, call};

/// Fiji: the survey crosses 180 degrees.
const ORIGIN: [f64; 3] = [-16.8, 179.9999, 30.0];
const NODES: [(&str, f64, f64); 4] = [("a", 1.0, 1.0), ("b", 5.0, 1.0), ("c", 2.0, 4.0), ("d", 6.0, 4.0)];

fn plane() -> LocalPlane {
    LocalPlane::new(ORIGIN[0], ORIGIN[1], ORIGIN[2])
}

/// A survey on three lanes, ten times as large as the places of the nodes: in metres (`metres`), and by latitude, longitude and
/// altitude (`degrees`). Nodes are heard within 20 m.
fn survey() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let mut receptions = "node,stop,received,sent\n".to_owned();
    let (mut metres, mut degrees) = ("stop,t_s,x_m,y_m\n".to_owned(), "stop,t_s,lat,lon,alt_m\n".to_owned());
    for stop in 0..27 {
        let (x_m, y_m) = (f64::from(stop % 9) * 10.0, f64::from(stop / 9) * 25.0);
        let place = plane().to_geodetic(Position::new(x_m, y_m, 0.0));
        writeln!(metres, "{stop},{stop},{x_m},{y_m}").unwrap();
        writeln!(degrees, "{stop},{stop},{},{},{}", place.lat_deg, place.lon_deg, place.height_m).unwrap();
        for (name, node_x, node_y) in NODES {
            if f64::hypot(x_m - 10.0 * node_x, y_m - 10.0 * node_y) <= 20.0 {
                writeln!(receptions, "{name},{stop},1,1").unwrap();
            }
        }
    }
    let mut truth = "node,lat,lon\n".to_owned();
    for (name, x_m, y_m) in NODES {
        let place = plane().to_geodetic(Position::new(10.0 * x_m, 10.0 * y_m, 0.0));
        writeln!(truth, "{name},{},{}", place.lat_deg, place.lon_deg).unwrap();
    }
    for (log, stops) in [("metres", metres), ("degrees", degrees)] {
        std::fs::create_dir(folder.path().join(log)).unwrap();
        std::fs::write(folder.path().join(log).join("stops.csv"), stops).unwrap();
        std::fs::write(folder.path().join(log).join("receptions.csv"), &receptions).unwrap();
    }
    std::fs::write(folder.path().join("truth.csv"), truth).unwrap();
    folder
}

/// Runs `sextant map WORDS --profile fitted` in `folder`; returns exit code, standard output and standard error.
fn map(folder: &Path, words: &[&str]) -> (i32, String, String) {
    call(folder, &[&["map"], words, &["--profile", "fitted"]].concat()).all()
}

/// The rows of a CSV file by the names of their columns.
fn rows(path: &Path) -> Vec<BTreeMap<String, String>> {
    let text = std::fs::read_to_string(path).unwrap();
    let cells = |line: &str| line.split(',').map(|cell| cell.trim_matches('"').to_owned()).collect::<Vec<_>>();
    let mut lines = text.lines();
    let header = cells(lines.next().unwrap());
    lines.map(|line| header.iter().cloned().zip(cells(line)).collect()).collect()
}

#[test]
fn a_survey_by_latitude_and_longitude_gives_the_map_of_the_same_survey_in_metres() {
    let folder = survey();
    let (code, stdout, stderr) =
        map(folder.path(), &["degrees", "--truth", "truth.csv", "--out", "degrees.csv", "--format", "json"]);
    assert_eq!(code, 0, "{stderr}");
    let summary: Value = serde_json::from_str(&stdout).unwrap();
    assert!(summary["maps"][0]["position_error_m"]["mean"].as_f64().unwrap() < 6.0, "{summary:#}");
    assert_eq!(map(folder.path(), &["metres", "--out", "metres.csv"]).0, 0);
    let number = |row: &BTreeMap<String, String>, name: &str| row[name].parse::<f64>().unwrap();
    let (degrees, metres) = (rows(&folder.path().join("degrees.csv")), rows(&folder.path().join("metres.csv")));
    assert_eq!((degrees.len(), metres.len()), (4, 4));
    for (by_degrees, in_metres) in degrees.iter().zip(&metres) {
        let place = |row| Position::new(number(row, "x_m"), number(row, "y_m"), number(row, "z_m"));
        assert!(place(by_degrees).distance_m(place(in_metres)) < 0.1, "{by_degrees:?} {in_metres:?}");
        let found =
            plane().to_local(number(by_degrees, "lat"), number(by_degrees, "lon"), number(by_degrees, "alt_m"));
        assert!(found.distance_m(place(by_degrees)) < 1e-3, "{by_degrees:?}");
        assert!(!in_metres.contains_key("lat"));
    }
    // The map is a table of places that can be read again.
    assert_eq!(robot_log::read_map(&folder.path().join("degrees.csv")).unwrap().len(), 4);
}

#[test]
fn a_map_as_geojson_has_points_with_longitude_first() {
    let folder = survey();
    let (code, _, stderr) = map(folder.path(), &["degrees", "--out", "map.geojson", "--quiet"]);
    assert_eq!((code, stderr.as_str()), (0, ""));
    let text = std::fs::read_to_string(folder.path().join("map.geojson")).unwrap();
    let collection: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(collection["type"], "FeatureCollection");
    let features = collection["features"].as_array().unwrap();
    assert_eq!(features.len(), 4);
    let mut sides = [0, 0];
    for (feature, (name, x_m, y_m)) in features.iter().zip(NODES) {
        assert_eq!((&feature["type"], &feature["geometry"]["type"]), (&"Feature".into(), &"Point".into()));
        let coordinates: Vec<f64> = feature["geometry"]["coordinates"]
            .as_array()
            .unwrap()
            .iter()
            .map(|value| value.as_f64().unwrap())
            .collect();
        let [lon, lat, alt] = coordinates[..] else { panic!("{coordinates:?}") };
        assert!((-180.0..=180.0).contains(&lon) && (lat - ORIGIN[0]).abs() < 0.01 && (alt - 30.0).abs() < 1.0);
        sides[usize::from(lon > 0.0)] += 1;
        let properties = &feature["properties"];
        assert_eq!(properties["node"], name);
        let place = plane().to_local(lat, lon, alt);
        assert!(place.distance_m(Position::new(10.0 * x_m, 10.0 * y_m, 0.0)) < 12.0, "{place}");
        assert!((place.x_m - properties["x_m"].as_f64().unwrap()).abs() < 1e-3);
        let number = |key: &str| properties[key].as_f64().unwrap();
        assert!(number("ellipse_95_major_m") >= number("ellipse_95_minor_m") && number("ellipse_95_minor_m") > 0.0);
        assert!((0.0..180.0).contains(&number("ellipse_95_azimuth_deg")));
    }
    // Nodes on both sides of 180 degrees.
    assert!(sides[0] > 0 && sides[1] > 0, "{sides:?}");
}

#[test]
fn places_of_another_kind_are_errors_that_say_so() {
    let folder = survey();
    let (code, _, stderr) = map(folder.path(), &["metres", "--out", "map.geojson"]);
    assert_eq!(code, 2, "{stderr}");
    assert!(stderr.contains("GeoJSON has latitudes and longitudes"), "{stderr}");
    assert!(!folder.path().join("map.geojson").exists());
    let (code, _, stderr) = map(folder.path(), &["metres", "--truth", "truth.csv"]);
    assert_eq!(code, 2, "{stderr}");
    assert!(stderr.contains("the places of the log are in metres"), "{stderr}");
    std::fs::write(folder.path().join("plane.csv"), "node,x_m,y_m\na,1,1\n").unwrap();
    let (code, _, stderr) = map(folder.path(), &["degrees", "--truth", "plane.csv"]);
    assert_eq!(code, 2, "{stderr}");
    assert!(stderr.contains("the places of the log are by latitude"), "{stderr}");
}

/// The error message of a log with these stops, or its notes.
fn read(stops: &str) -> Result<Vec<String>, String> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("stops.csv"), stops).unwrap();
    std::fs::write(folder.path().join("receptions.csv"), "node,stop,received\nlamp,A,0\n").unwrap();
    let log = robot_log::read(folder.path(), &ReadOptions::default());
    log.map(|log| log.notes).map_err(|error| error.to_string())
}

#[test]
fn places_that_are_none_are_errors() {
    for (stops, expected) in [
        (
            "stop,lat,lon\nA,90,0\n",
            "column `lat`: found `90`; allowed: degrees north from -89.9 to 89.9, because at a pole",
        ),
        ("stop,lat,lon\nA,-89.95,0\n", "column `lat`: found `-89.95`"),
        ("stop,lat,lon\nA,nan,0\n", "column `lat`: found `nan`; allowed: a finite number"),
        ("stop,lat,lon\nA,50,180.5\n", "column `lon`: found `180.5`; allowed: degrees east from -180 to 180"),
        (
            "stop,lat,lon\nA,50,3\nB,0,0\n",
            "line 3, column `lat`: found `0`; allowed: a place at most 100 km from the first one at 50, 3",
        ),
        ("stop,lat,lon\nA,0,0\nB,0,180\n", "line 3, column `lat`: found `0`; allowed: a place at most 100 km"),
        (
            "stop,lat\nA,50\n",
            "line 1: column `lon` is missing; places need the columns x_m,y_m[,z_m] or lat,lon[,alt_m]",
        ),
        ("stop,lat,lon,alt\nA,50,3,1\n", "unknown column `alt`; did you mean `alt_m`?"),
        ("stop,lat,lon,alt_m\nA,50,3,\n", "column `alt_m`: found ``; allowed: a number of metres"),
    ] {
        let message = read(stops).unwrap_err();
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn of_two_kinds_of_places_those_in_metres_count() {
    let notes = read("stop,t_s,x_m,y_m,lat,lon\nA,0,1,2,50,3\n").unwrap();
    assert_eq!(notes, ["stops.csv: `lat`, `lon` ignored, because the places are read from x_m, y_m"]);
    let notes = read("stop,t_s,lat,lon,alt_m,z_m\nA,0,50,3,120,1.5\n").unwrap();
    assert_eq!(notes, ["stops.csv: `alt_m` ignored, because the places are read from lat, lon"]);
}

#[test]
fn heights_are_above_the_first_stop_or_as_given() {
    let heights = |stops: &str| {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("stops.csv"), stops).unwrap();
        std::fs::write(folder.path().join("receptions.csv"), "node,stop,received\nlamp,A,0\n").unwrap();
        let log = robot_log::read(folder.path(), &ReadOptions::default()).unwrap().log;
        log.stops().iter().map(|stop| stop.position.z_m).collect::<Vec<_>>()
    };
    assert_eq!(heights("stop,lat,lon,alt_m\nA,50,3,120\nB,50,3.001,122.5\n"), [0.0, 2.5]);
    assert_eq!(heights("stop,lat,lon,z_m\nA,50,3,1.5\nB,50,3.001,4\n"), [1.5, 4.0]);
    assert_eq!(heights("stop,lat,lon\nA,50,3\nB,50,3.001\n"), [0.0, 0.0]);
}
