//! What figures need of the summary in a recording.

use serde::Deserialize;

/// The summary of a run, as far as it is read back.
#[derive(Debug, Default, Deserialize)]
pub(crate) struct RecordedSummary {
    #[serde(default)]
    pub(crate) maps: Vec<RecordedMap>,
}

/// A map in the summary.
#[derive(Debug, Deserialize)]
pub(crate) struct RecordedMap {
    name: Option<String>,
    algorithm: String,
    #[serde(default)]
    pub(crate) sector_displacement: Vec<f64>,
    #[serde(default)]
    pub(crate) calibration: RecordedCalibration,
}

/// What self-calibration found.
#[derive(Debug, Default, Deserialize)]
pub(crate) struct RecordedCalibration {
    #[serde(default)]
    pub(crate) obstacles: Vec<ClaimedObstacle>,
}

/// An obstacle that a map claims, because packets are lost behind it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct ClaimedObstacle {
    /// Whether the log is sure of it.
    pub sure: bool,
    /// Rectangles that make it up: least x, least y, largest x, largest y (m).
    pub rectangles_m: Vec<[f64; 4]>,
}

impl RecordedMap {
    /// Its name in tables and figures.
    pub(crate) fn name(&self) -> String {
        self.name.as_ref().unwrap_or(&self.algorithm).clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_are_read_with_or_without_obstacles() {
        let json = r#"{"maps": [{"algorithm": "ml-tm"}, {"algorithm": "self-calibrated", "name": "mine", "calibration":
            {"rounds": 3, "obstacles": [{"sure": true, "rectangles_m": [[0.0, 1.0, 2.5, 3.0]]}]}}]}"#;
        let summary: RecordedSummary = serde_json::from_str(json).unwrap();
        let found: Vec<_> = summary.maps.iter().map(|map| (map.name(), map.calibration.obstacles.len())).collect();
        assert_eq!(found, [("ml-tm".to_owned(), 0), ("mine".to_owned(), 1)]);
        let claim = ClaimedObstacle { sure: true, rectangles_m: vec![[0.0, 1.0, 2.5, 3.0]] };
        assert_eq!(summary.maps[1].calibration.obstacles, [claim]);
    }
}
