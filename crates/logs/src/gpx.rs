//! Paths in GPX (version 1.0 or 1.1, topografix.com): the points of its tracks.

use std::path::Path as FilePath;

use roxmltree::{Document, Node};

use super::error::RobotLogError;
use super::fix::{Fix, Track};
use super::instant;
use super::paths::Paths;

/// Reads the path in the file `path`: the track points in their order. Points without a time are skipped, and
/// those without a fix if `skips_no_fix`.
pub(super) fn read(path: &FilePath, skips_no_fix: bool, notes: &mut Vec<String>) -> Result<Paths, RobotLogError> {
    let text = sextant_kernel::read_text_at_most(path, sextant_kernel::LARGEST_FILE)
        .map_err(|why| RobotLogError::read(path, why))?;
    let wrong = |line: usize, problem: String| RobotLogError::line(path, line, problem);
    let text = text.trim_start_matches('\u{feff}');
    let document = Document::parse(text).map_err(|why| wrong(why.pos().row as usize, why.to_string()))?;
    let line = |node: Node<'_, '_>| document.text_pos_at(node.range().start).row as usize;
    let points = document.descendants().filter(|node| node.tag_name().name() == "trkpt");
    let mut track = Track::new(skips_no_fix);
    let (mut placed, mut timeless) = (0_u64, 0_u64);
    for point in points {
        match fix(point) {
            Ok(Some(fix)) => {
                track.add(fix, line(point)).map_err(|problem| wrong(line(point), problem))?;
                placed += 1;
            }
            Ok(None) => timeless += 1,
            Err(problem) => return Err(wrong(line(point), problem)),
        }
    }
    let file = path.file_name().unwrap_or_default().to_string_lossy();
    if placed == 0 {
        let problem =
            if timeless > 0 { "no point of its tracks has a time" } else { "it has no track points (`trkpt`)" };
        return Err(wrong(1, problem.to_owned()));
    }
    if timeless > 0 {
        notes.push(format!("{file}: {timeless} points without a time are skipped"));
    }
    track.finish(path, notes)
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
    // A receiver without a fix may write an empty angle or NaN.
    let angle = |name: &str| match point.attribute(name).map(str::trim) {
        Some(text) if text.is_empty() || text.eq_ignore_ascii_case("nan") => Ok(f64::NAN),
        text => number(name, text),
    };
    let [lat_deg, lon_deg] = ["lat", "lon"].map(angle);
    Ok(Some(Fix { time, lat_deg: lat_deg?, lon_deg: lon_deg?, height_m }))
}
