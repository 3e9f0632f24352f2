//! Paths in GPX (version 1.0 or 1.1, topografix.com): the points of its tracks.

use std::path::Path as FilePath;

use roxmltree::{Document, Node};

use super::error::RobotLogError;
use super::fix::{Fix, Track};
use super::instant;
use super::path::Path;
use super::paths::Paths;

/// Reads the path in the file `path`: the track points in their order. Points without a time are skipped.
pub(super) fn read(path: &FilePath, notes: &mut Vec<String>) -> Result<Paths, RobotLogError> {
    let text = std::fs::read_to_string(path).map_err(|why| RobotLogError::read(path, why))?;
    let wrong = |line: usize, problem: String| RobotLogError::Row { path: path.to_owned(), line, problem };
    let text = text.trim_start_matches('\u{feff}');
    let document = Document::parse(text).map_err(|why| wrong(why.pos().row as usize, why.to_string()))?;
    let line = |node: Node<'_, '_>| document.text_pos_at(node.range().start).row as usize;
    let points = document.descendants().filter(|node| node.tag_name().name() == "trkpt");
    let mut track = Track::default();
    let mut lines = Vec::new();
    let mut timeless = 0_u64;
    for point in points {
        match fix(point) {
            Ok(Some(fix)) => track.add(fix).map_err(|problem| wrong(line(point), problem))?,
            Ok(None) => {
                timeless += 1;
                continue;
            }
            Err(problem) => return Err(wrong(line(point), problem)),
        }
        lines.push(line(point));
    }
    let file = path.file_name().unwrap_or_default().to_string_lossy();
    if track.poses.is_empty() {
        let problem =
            if timeless > 0 { "no point of its tracks has a time" } else { "it has no track points (`trkpt`)" };
        return Err(wrong(1, problem.to_owned()));
    }
    if timeless > 0 {
        notes.push(format!("{file}: {timeless} points without a time are skipped"));
    }
    let plane = track.plane;
    let path = Path::new(track.poses).map_err(|why| match why.index() {
        Some(index) => wrong(lines[index], why.to_string()),
        None => RobotLogError::Path { path: path.to_owned(), why },
    })?;
    Ok(Paths::of_one(path, plane))
}

/// What a track point says; `None` if it has no time.
fn fix(point: Node<'_, '_>) -> Result<Option<Fix>, String> {
    let child = |name: &str| {
        let child = point.children().find(|child| child.tag_name().name() == name);
        child.and_then(|child| child.text()).map(str::trim).filter(|text| !text.is_empty())
    };
    let number = |what: &str, text: Option<&str>| {
        let number = text.and_then(|text| text.trim().parse().ok()).filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| format!("`{what}` is `{}`; allowed: a number", text.unwrap_or("")))
    };
    let Some(time) = child("time") else { return Ok(None) };
    // GPX: times are UTC, also where the zone is left out.
    let time = instant::parse_date(time, true)
        .ok_or_else(|| format!("`time` is `{time}`; allowed: a time as 2026-11-22T15:04:05Z"))?;
    let height_m = child("ele").map(|text| number("ele", Some(text))).transpose()?;
    let [lat_deg, lon_deg] = ["lat", "lon"].map(|name| number(name, point.attribute(name)));
    Ok(Some(Fix { time, lat_deg: lat_deg?, lon_deg: lon_deg?, height_m }))
}
