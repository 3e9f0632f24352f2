//! One line of a reproduced table.

use std::io;
use std::path::Path;

use serde_json::{Value, json};

use crate::diagnostic::Failure;
use crate::output::write_file;
use crate::sweep::Mean;

/// What was published beside what comes out here.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// What it is.
    pub what: String,
    /// The thesis' value; empty if it gives none.
    pub published: String,
    /// The unit of both.
    pub unit: &'static str,
    /// Our value.
    pub ours: Ours,
}

/// Our value of a line.
#[derive(Clone, Debug, PartialEq)]
pub enum Ours {
    /// A mean over runs.
    Mean(Mean),
    /// A number without chance in it.
    Exact(f64),
    /// Words.
    Text(String),
    /// All runs failed.
    Missing,
}

impl Line {
    /// What, published, ours: as they stand in a table for people.
    pub(crate) fn cells(&self) -> [String; 3] {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
        let published = if self.published.is_empty() { "-".to_owned() } else { format!("{}{unit}", self.published) };
        let ours = match &self.ours {
            Ours::Mean(Mean { mean, half_width_95: Some(half_width), .. }) => {
                format!("{mean:.2} ± {half_width:.2}{unit}")
            }
            Ours::Mean(Mean { mean, half_width_95: None, .. }) => format!("{mean:.2}{unit}"),
            Ours::Exact(value) => format!("{value:.4}{unit}"),
            Ours::Text(text) => text.clone(),
            Ours::Missing => "no run succeeded".to_owned(),
        };
        [self.what.clone(), published, ours]
    }

    /// The line as a JSON object.
    pub(crate) fn json(&self) -> Value {
        let mut json = json!({"what": self.what, "unit": self.unit});
        if !self.published.is_empty() {
            json["published"] = json!(self.published);
        }
        match &self.ours {
            Ours::Mean(Mean { mean, half_width_95, runs }) => {
                (json["mean"], json["runs"]) = (json!(mean), json!(runs));
                if let Some(half_width_95) = half_width_95 {
                    json["half_width_95"] = json!(half_width_95);
                }
            }
            Ours::Exact(value) => json["mean"] = json!(value),
            Ours::Text(text) => json["result"] = json!(text),
            Ours::Missing => json["runs"] = json!(0),
        }
        json
    }

    fn record(&self) -> [String; 7] {
        let number = |number: Option<f64>| number.map_or_else(String::new, |number| number.to_string());
        let [mean, half_width, runs, result] = match &self.ours {
            Ours::Mean(Mean { mean, half_width_95, runs }) => {
                [mean.to_string(), number(*half_width_95), runs.to_string(), String::new()]
            }
            Ours::Exact(value) => [value.to_string(), String::new(), String::new(), String::new()],
            Ours::Text(text) => [String::new(), String::new(), String::new(), text.clone()],
            Ours::Missing => [String::new(), String::new(), "0".to_owned(), String::new()],
        };
        [self.what.clone(), self.published.clone(), self.unit.to_owned(), mean, half_width, runs, result]
    }
}

/// Writes lines as CSV, with columns what, published, unit, mean, `half_width_95`, runs, result.
///
/// # Errors
/// If the file cannot be written.
pub fn write_csv(path: &Path, lines: &[Line]) -> Result<(), Failure> {
    let text = || -> io::Result<Vec<u8>> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(["what", "published", "unit", "mean", "half_width_95", "runs", "result"])?;
        for line in lines {
            writer.write_record(line.record())?;
        }
        writer.into_inner().map_err(|error| io::Error::other(error.to_string()))
    };
    write_file(path, &text().map_err(|error| Failure::unwritable(path, &error))?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_shows_published_and_ours_in_one_unit() {
        let mean = Mean { mean: 6.013, half_width_95: Some(0.284), runs: 5 };
        let line = Line { what: "ML-TM".into(), published: "5".into(), unit: "%", ours: Ours::Mean(mean) };
        assert_eq!(line.cells(), ["ML-TM", "5 %", "6.01 ± 0.28 %"]);
        assert_eq!(line.record(), ["ML-TM", "5", "%", "6.013", "0.284", "5", ""]);
        let none = Line { published: String::new(), ours: Ours::Missing, ..line };
        assert_eq!(none.cells(), ["ML-TM", "-", "no run succeeded"]);
        assert_eq!(none.json(), json!({"what": "ML-TM", "unit": "%", "runs": 0}));
    }
}
