//! The layout for Foxglove: version 1 of its layout files, as the Python package `foxglove-sdk` writes them.

use serde_json::{Map, Value, json};
use sextant_channel::Bounds;

use super::Layout;

/// At most this many curves are in the plot.
const MOST_CURVES: usize = 8;

impl Layout<'_> {
    /// The layout as a JSON file that Foxglove imports: a 3D panel, a plot, a log and a table.
    #[must_use]
    pub fn foxglove(&self) -> String {
        let split = |direction: &str, items: &[(f64, Value)]| {
            let items: Vec<_> = items
                .iter()
                .map(|(proportion, content)| json!({ "proportion": proportion, "content": content }))
                .collect();
            json!({ "type": "split", "direction": direction, "items": items })
        };
        let below = [(2.0, self.plot()), (1.0, log()), (1.0, self.table())];
        let content = split("row", &[(2.0, self.three_dee()), (1.0, split("column", &below))]);
        let layout = json!({ "version": 1, "content": content });
        serde_json::to_string_pretty(&layout).expect("a layout has texts for keys") + "\n"
    }

    fn three_dee(&self) -> Value {
        let Bounds { min, max } = self.bounds();
        let (middle, size) = ((min + max) * 0.5, max - min);
        let distance = 1.5 * size.x_m.max(size.y_m).max(size.z_m).max(1.0);
        let tilt_deg = if self.is_flat() { 0.0 } else { 60.0 };
        let config = json!({
            "cameraState": {
                "distance": distance,
                "perspective": !self.is_flat(),
                "phi": tilt_deg,
                "target": [0.0, 0.0, 0.0],
                "targetOffset": [middle.x_m, middle.y_m, middle.z_m],
                "thetaOffset": if self.is_flat() { 0.0 } else { 45.0 },
                "fovy": 45.0,
                "near": 0.1,
                "far": 100.0 * distance,
            },
            "followTf": "world",
            "fixedFrame": "world",
            "followMode": "follow-none",
            "scene": { "transforms": { "axisSize": 1.0, "showLabel": true, "enablePreloading": true } },
            "layers": { "grid": { "layerId": "foxglove.Grid", "label": "Grid", "visible": true, "size": distance } },
            "topics": self.settings(),
        });
        panel("ThreeDee", "World", config)
    }

    /// How each topic with a drawing is shown.
    fn settings(&self) -> Value {
        let mut settings = Map::new();
        for topic in self.topics("foxglove.SceneUpdate") {
            let visible = topic != "/world/names" || self.shows_names();
            settings.insert(topic.to_owned(), json!({ "visible": visible }));
        }
        for topic in self.topics("foxglove.PointCloud") {
            settings.insert(topic.to_owned(), self.cloud(topic));
        }
        for topic in self.topics("foxglove.PosesInFrame") {
            settings.insert(topic.to_owned(), json!({ "visible": false, "type": "line", "lineWidth": 0.1 }));
        }
        for (i, topic) in self.topics("foxglove.Grid").enumerate() {
            let of_field = topic.starts_with("/world/fields/");
            let field = if of_field { "value" } else { "log_likelihood" };
            let colors = json!({
                "visible": of_field && i == 0, "colorMode": "colormap", "colorMap": "turbo", "colorField": field,
                "drawBehind": true,
            });
            settings.insert(topic.to_owned(), colors);
        }
        Value::Object(settings)
    }

    /// How a cloud is shown: stops stay for as long as the recording lasts.
    fn cloud(&self, topic: &str) -> Value {
        let colored = |field: &str, size: u8| {
            json!({
                "visible": true, "pointSize": size, "pointShape": "circle", "colorMode": "colormap",
                "colorMap": "turbo", "colorField": field,
            })
        };
        let flat = |color: &str, size: u8| json!({ "visible": true, "pointSize": size, "pointShape": "circle", "colorMode": "flat", "flatColor": color });
        if topic.starts_with("/map/") {
            let mut settings = colored("error", 8);
            settings["visible"] = json!(self.first_map().as_deref() == Some(topic));
            settings
        } else if topic.starts_with("/robot/") {
            let lasts_s = self.inspection.end_s.unwrap_or(0.0) - self.inspection.start_s.unwrap_or(0.0);
            let mut settings = colored("heard", 5);
            settings["decayTime"] = json!(lasts_s.ceil());
            settings
        } else if topic.starts_with("/application/") {
            flat("#d62728ff", 10)
        } else if topic == "/world/sinks" {
            flat("#1f77b4ff", 12)
        } else {
            flat("#7f7f7fff", 6)
        }
    }

    fn plot(&self) -> Value {
        let series = |value: String, label: &str| json!({ "value": value, "enabled": true, "timestampMethod": "receiveTime", "label": label, "showLine": true });
        let mut curves = Vec::new();
        if self.has("/stops") {
            curves.push(series("/stops.receptions".to_owned(), "nodes heard"));
        }
        for application in &self.drawn.applications {
            for (name, _) in &application.series {
                let name = format!("{}/{name}", application.name);
                curves.push(series(format!("/metrics{{name==\"{name}\"}}.value"), &name));
            }
        }
        curves.truncate(MOST_CURVES);
        panel(
            "Plot",
            "Over time",
            json!({ "paths": curves, "isSynced": true, "xAxisVal": "timestamp", "showLegend": true, "legendDisplay": "top" }),
        )
    }

    fn table(&self) -> Value {
        let estimates = self.topics("sextant.Estimate").next();
        let topic =
            ["/stops", "/mac/frames"].into_iter().find(|topic| self.has(topic)).or(estimates).unwrap_or("/nodes");
        panel("Table", topic, json!({ "topicPath": topic }))
    }
}

fn log() -> Value {
    panel("Log", "Log", json!({ "topicToRender": "/log", "minLogLevel": 1, "searchTerms": [] }))
}

fn panel(kind: &str, title: &str, config: Value) -> Value {
    json!({ "type": "panel", "panelType": kind, "title": title, "version": 1, "config": config })
}
