//! Paths in GPX (version 1.0 or 1.1, topografix.com): the points of its tracks.

use std::path::Path as FilePath;

use roxmltree::{Document, Node};

use super::fix::{Fix, FixTrack};
use super::paths::Paths;
use crate::error::robot_log_error::RobotLogError;
use crate::time::instant;
use crate::time::time_zone::TimeZone;

/// Reads the path in the file `path`: the track points in their order. Points without a time are skipped, and
/// those without a fix if `skips_no_fix`.
pub(crate) fn read(path: &FilePath, skips_no_fix: bool, notes: &mut Vec<String>) -> Result<Paths, RobotLogError> {
    let text = sextant_kernel::read_text_at_most(path, sextant_kernel::LARGEST_FILE)
        .map_err(|why| RobotLogError::read(path, why))?;
    let wrong = |line: usize, problem: String| RobotLogError::line(path, line, problem);
    let text = text.trim_start_matches('\u{feff}');
    if let Some(line) = line_of_long_tag(text) {
        return Err(wrong(line, format!("it has a tag of more than {LONGEST_TAG} octets")));
    }
    let document = Document::parse(text).map_err(|why| wrong(why.pos().row as usize, why.to_string()))?;
    let line = |node: Node<'_, '_>| document.text_pos_at(node.range().start).row as usize;
    let points = document.descendants().filter(|node| node.tag_name().name() == "trkpt");
    let mut track = FixTrack::new(skips_no_fix);
    let (mut placed, mut timeless) = (0_u64, 0_u64);
    for point in points {
        match fix(point) {
            Ok(Some(fix)) => {
                track.add(fix, line(point));
                placed += 1;
            }
            Ok(None) => timeless += 1,
            Err(problem) => {
                track.refuse(line(point), problem);
                placed += 1;
            }
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

/// The longest tag that is read (octets). The reader of XML compares each attribute of a tag with each other one.
const LONGEST_TAG: usize = 1 << 14;

/// The line of the first tag that is longer.
fn line_of_long_tag(text: &str) -> Option<usize> {
    // They may have quotes in any number.
    let others = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")];
    let mut at = 0;
    while let Some(before) = text[at..].find('<') {
        let start = at + before;
        let markup = &text[start..];
        at = start
            + match others.iter().find(|(opening, _)| markup.starts_with(opening)) {
                Some((_, end)) => markup.find(end)?,
                None => match tag_length(markup) {
                    Some(length) => length,
                    None if markup.len() > LONGEST_TAG => return Some(1 + text[..start].matches('\n').count()),
                    None => return None,
                },
            };
    }
    None
}

/// How long the tag is that `markup` begins with; `None` if it does not end.
fn tag_length(markup: &str) -> Option<usize> {
    let mut quote = None;
    markup.bytes().take(LONGEST_TAG).position(|octet| {
        match quote {
            Some(quoted) if octet == quoted => quote = None,
            None if octet == b'"' || octet == b'\'' => quote = Some(octet),
            _ => {}
        }
        octet == b'>' && quote.is_none()
    })
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
    let time = instant::parse_date(time, Some(TimeZone::UTC))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_tags_are_found_and_other_long_texts_are_not() {
        let attributes = |count: usize| (0..count).map(|at| format!(" a{at}=\">'\"")).collect::<String>();
        let in_tag = |count| format!("<?xml version=\"1.0\"?>\n<gpx>\n<trkpt{}>", attributes(count));
        assert_eq!(line_of_long_tag(&in_tag(1000)), None);
        assert_eq!(line_of_long_tag(&in_tag(2000)), Some(3));
        let long = "it's <b ".repeat(9000);
        for text in
            [format!("<gpx><!-- {long} --></gpx>"), format!("<a><![CDATA[{long}]]></a>"), format!("<?a {long}?>")]
        {
            assert_eq!(line_of_long_tag(&text), None);
        }
        // The reader of XML says what is wrong with them.
        for text in ["<gpx", "<gpx a=\"", "<!-- ", "a", ""] {
            assert_eq!(line_of_long_tag(text), None, "{text}");
        }
    }
}
