//! The script for Rerun. Its blueprint files are binary and belong to one version of Rerun, so a script makes it.

use serde_json::json;
use sextant_channel::Bounds;

use super::Layout;

/// The script; what it shows is between the marks.
const SCRIPT: &str = include_str!("show.rerun.py");
/// Where the description of the recording goes.
const MARK: &str = "SHOWN = {}";

impl Layout<'_> {
    /// A Python script that shows the recording in Rerun, with a blueprint.
    #[must_use]
    pub fn rerun(&self) -> String {
        let of_robots = self.topics("foxglove.PointCloud").filter(|topic| topic.starts_with("/robot/"));
        let places = self.topics("foxglove.PointCloud").filter(|topic| topic.starts_with("/application/"));
        let hidden = self.drawn.maps.iter().skip(1).map(|(name, _)| format!("/map/{name}"));
        let paths = self.topics("foxglove.PosesInFrame").map(str::to_owned);
        let unnamed = (!self.shows_names()).then(|| "/world/names".to_owned());
        let Bounds { min, max } = self.bounds();
        let (middle, size) = ((min + max) * 0.5, max - min);
        let far_m = size.x_m.max(size.y_m).max(size.z_m).max(1.0);
        let (aside, above) = if self.is_flat() { (0.2, 1.2) } else { (1.0, 0.8) };
        let shown = json!({
            "middle": [middle.x_m, middle.y_m, middle.z_m],
            "eye": [middle.x_m, middle.y_m - aside * far_m, middle.z_m + above * far_m],
            "recording": self.file,
            "robots": self.drawn.paths.iter().map(|(name, _)| name).collect::<Vec<_>>(),
            "kept": of_robots.chain(places).collect::<Vec<_>>(),
            "scenes": self.topics("foxglove.SceneUpdate").collect::<Vec<_>>(),
            "hidden": hidden.chain(paths).chain(unnamed).collect::<Vec<_>>(),
            "has_log": self.has("/log"),
            "has_metrics": self.has("/metrics"),
        });
        let shown = serde_json::to_string_pretty(&shown).expect("a layout has texts for keys");
        // The words of JSON for truth are names in Python.
        let shown = shown.replace(": true", ": True").replace(": false", ": False");
        SCRIPT.replace(MARK, &format!("SHOWN = {shown}"))
    }
}
