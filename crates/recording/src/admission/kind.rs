//! What an output is, and whether a file is an earlier output of this program: its content tells.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;

use serde::Deserialize;
use serde::de::IgnoredAny;

use crate::capture::technologies::is_of_simulation;
use crate::container::sink::has_own_library;
use crate::output::{PART, RECOVERING};

/// What a command writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputKind<'a> {
    /// The recording of a run.
    Recording,
    /// The readable part of a broken recording.
    RecoveredRecording,
    /// The results as one JSON object.
    Summary,
    /// A map as CSV or GeoJSON.
    Map,
    /// A path or a track that was estimated, as CSV or TUM.
    Path,
    /// The frames of a run for protocol analysers.
    Capture,
    /// A report for browsers.
    Report,
    /// A picture, as SVG or PNG.
    Picture,
    /// A table of measures: it may be the work of days, and is never replaced without being asked for.
    Table,
    /// The differences between runs, as a table with the header of this text.
    Differences(&'a [u8]),
    /// A text that people change: only the same text is replaced.
    Text(&'a [u8]),
}

/// So many octets at the start of a file tell what it is.
const HEAD: u64 = 8192;

/// How a map begins.
const MAP_HEADER: &str = "node,x_m,y_m,z_m,ties,infeasible,concern";

/// What a path or a track has in the header that begins with its times.
const PATH_COLUMNS: &str = ",x_m,y_m,z_m,cov_xx_m2,cov_xy_m2,cov_yy_m2,";

/// How an estimated path in the form of TUM begins.
pub const TUM_PATH: &str = "# estimated by sextant: time x y z qx qy qz qw\n";

/// What ends the title of a report.
pub const REPORT_TITLE: &str = "Sextant report</title>";

/// Who made a picture, in a PNG file.
pub const PICTURE_SOFTWARE: &str = "sextant";

/// The background with which each SVG picture begins.
const SVG_PAPER: &str = "<rect x=\"0\" y=\"0\" width=";

impl OutputKind<'_> {
    /// What it is called: `an earlier recording`.
    #[must_use]
    pub fn earlier(self) -> &'static str {
        match self {
            Self::Recording | Self::RecoveredRecording => "an earlier recording",
            Self::Summary => "an earlier summary",
            Self::Map => "an earlier map",
            Self::Path => "an earlier path",
            Self::Capture => "an earlier capture of a simulation",
            Self::Report => "an earlier report",
            Self::Picture => "an earlier picture",
            Self::Table => "a table that may be replaced",
            Self::Differences(_) => "an earlier table of differences",
            Self::Text(_) => "the same text",
        }
    }

    /// What is added to the name of the file while it is written, if that is long work.
    pub(super) fn part_suffix(self) -> Option<&'static str> {
        match self {
            Self::Recording | Self::Capture => Some(PART),
            Self::RecoveredRecording => Some(RECOVERING),
            Self::Summary
            | Self::Map
            | Self::Path
            | Self::Report
            | Self::Picture
            | Self::Table
            | Self::Differences(_)
            | Self::Text(_) => None,
        }
    }

    /// Whether the file at `path` is an earlier output of this kind.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn is_ours(self, path: &Path) -> io::Result<bool> {
        let mut head = Vec::new();
        File::open(path)?.take(HEAD).read_to_end(&mut head)?;
        let text = String::from_utf8_lossy(&head);
        let json = || File::open(path).map(BufReader::new);
        Ok(match self {
            Self::Recording | Self::RecoveredRecording => has_own_library(&head),
            Self::Summary => {
                json().is_ok_and(|json| serde_json::from_reader(json).is_ok_and(|any: AnySummary| any.is_one()))
            }
            Self::Map if text.starts_with('{') => {
                json().is_ok_and(|json| serde_json::from_reader(json).is_ok_and(|any: AnyCollection| any.is_map()))
            }
            Self::Map => text.starts_with(MAP_HEADER),
            Self::Path => {
                let header = text.lines().next().unwrap_or_default();
                text.starts_with(TUM_PATH) || header.starts_with("t_s,") && header.contains(PATH_COLUMNS)
            }
            Self::Capture => is_of_simulation(&head),
            Self::Report => text.contains(REPORT_TITLE),
            Self::Picture => is_own_svg(&text) || is_own_png(&head),
            Self::Table => false,
            Self::Differences(own) => {
                own.split_inclusive(|octet| *octet == b'\n').next().is_some_and(|header| head.starts_with(header))
            }
            Self::Text(own) => std::fs::read(path)? == own,
        })
    }
}

/// What each summary has.
#[derive(Deserialize)]
struct AnySummary {
    timing: AnyTiming,
    scenario: Option<AnyScenario>,
    gathering: Option<IgnoredAny>,
    maps: Option<Vec<IgnoredAny>>,
}

#[derive(Deserialize)]
struct AnyTiming {
    #[serde(rename = "wall_s")]
    _wall_s: f64,
}

#[derive(Deserialize)]
struct AnyScenario {
    #[serde(rename = "sha256")]
    _sha256: String,
}

impl AnySummary {
    fn is_one(&self) -> bool {
        let Self { timing: AnyTiming { .. }, scenario, gathering, maps } = self;
        scenario.is_some() || gathering.is_some() || maps.is_some()
    }
}

/// What each map as GeoJSON has.
#[derive(Deserialize)]
struct AnyCollection {
    features: Vec<AnyFeature>,
}

#[derive(Deserialize)]
struct AnyFeature {
    #[serde(rename = "properties")]
    _properties: AnyProperties,
}

#[derive(Deserialize)]
struct AnyProperties {
    #[serde(rename = "node")]
    _node: String,
    #[serde(rename = "x_m")]
    _x_m: f64,
    #[serde(rename = "y_m")]
    _y_m: f64,
}

impl AnyCollection {
    fn is_map(&self) -> bool {
        !self.features.is_empty()
    }
}

/// The view box has ten units a pixel, and white paper comes first.
fn is_own_svg(text: &str) -> bool {
    let Some((svg, rest)) = text.split_once(">\n") else { return false };
    let attribute = |name: &str| svg.split_once(&format!(" {name}=\""))?.1.split_once('"').map(|(value, _)| value);
    let sizes = attribute("width").zip(attribute("height")).zip(attribute("viewBox"));
    let is_scaled = sizes.is_some_and(|((width, height), view)| view == format!("0 0 {width}0 {height}0"));
    svg.starts_with("<svg ") && is_scaled && rest.starts_with(SVG_PAPER)
}

/// The text `Software` names this program.
fn is_own_png(head: &[u8]) -> bool {
    let text = format!("tEXtSoftware\0{PICTURE_SOFTWARE}");
    head.starts_with(b"\x89PNG\r\n\x1a\n") && head.windows(text.len()).any(|window| window == text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn foreign_files_are_not_taken_for_ours() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        let foreign: [&[u8]; 12] = [
            b"",
            b"\x89MCAP0\r\n",
            b"\x89MCAP0\r\n\x01\x12\0\0\0\0\0\0\0\x04\0\0\0ros2\x06\0\0\0rosbag",
            b"{}",
            br#"{"timing": {"wall_s": 3}}"#,
            br#"{"scenario": {"sha256": "a"}, "maps": []}"#,
            br#"{"type": "FeatureCollection", "features": []}"#,
            br#"{"type": "FeatureCollection", "features": [{"properties": {"name": "lake"}}]}"#,
            b"node,x_m,y_m,z_m\na,1,2,3\n",
            b"\x4d\x3c\xb2\xa1\x02\0\x04\0\0\0\0\0\0\0\0\0\xff\xff\0\0\x1b\x01\0\0\0\xf1\x53\x65",
            b"<svg width=\"10\" height=\"10\" viewBox=\"0 0 10 10\">\n<rect x=\"0\" y=\"0\" width=\"1\"/></svg>",
            b"<html><title>Report</title></html>",
        ];
        use OutputKind::{Capture, Map, Path, Picture, Recording, Report, Summary, Table, Text};
        for content in foreign {
            std::fs::write(&path, content).unwrap();
            for kind in [Recording, Summary, Map, Path, Capture, Report, Picture, Table, Text(b"other")] {
                assert!(!kind.is_ours(&path).unwrap(), "{kind:?}: {}", String::from_utf8_lossy(content));
            }
        }
    }

    #[test]
    fn outputs_of_this_program_are_recognised() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        let capture = |stamp: &[u8; 4]| {
            [&b"\x4d\x3c\xb2\xa1\x02\0\x04\0\0\0\0\0\0\0\0\0\xff\xff\0\0\x1b\x01\0\0"[..], stamp].concat()
        };
        for (kind, content) in [
            (OutputKind::Summary, br#"{"timing": {"wall_s": 3}, "maps": [{}]}"#.to_vec()),
            (
                OutputKind::Summary,
                br#"{"scenario": {"name": "a", "sha256": "b"}, "timing": {"wall_s": 3, "x": 1}}"#.to_vec(),
            ),
            (OutputKind::Map, b"node,x_m,y_m,z_m,ties,infeasible,concern,lat,lon\n".to_vec()),
            (OutputKind::Map, br#"{"features": [{"properties": {"node": "a", "x_m": 1, "y_m": 2}}]}"#.to_vec()),
            (OutputKind::Path, b"t_s,robot,x_m,y_m,z_m,cov_xx_m2,cov_xy_m2,cov_yy_m2,turn_rad\n".to_vec()),
            (OutputKind::Path, TUM_PATH.as_bytes().to_vec()),
            (OutputKind::Capture, capture(&[5, 0, 0, 0])),
            (OutputKind::Picture, b"\x89PNG\r\n\x1a\n\0\0\0\x10tEXtSoftware\0sextant".to_vec()),
            (OutputKind::Text(b"same"), b"same".to_vec()),
        ] {
            std::fs::write(&path, content).unwrap();
            assert!(kind.is_ours(&path).unwrap(), "{kind:?}");
        }
    }
}
