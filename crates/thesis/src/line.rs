//! One line of a reproduced table.

use std::path::Path;

use serde_json::{Map, Value, json};

use super::agreement::Agreement;
use super::finding::Finding;
use super::ours::Ours;
use super::published::Published;
use sextant_recording::output::{CsvFile, EmptyCell, OutputError};
use sextant_study::sweep::Mean;

/// A published value beside ours.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Its description.
    pub what: String,
    /// The published value; `None` if the thesis states none.
    pub published: Option<Published>,
    /// The unit of our value, and of the published one if it is a number.
    pub unit: String,
    /// Our value.
    pub ours: Ours,
}

/// What is printed where the thesis gives no value.
const NOT_STATED: &str = "not stated";

impl Line {
    /// The verdict in words: of a conclusion whether it holds, of a published number how near ours is. `None` if the thesis
    /// states no number, or all runs failed.
    #[must_use]
    pub fn verdict(&self) -> Option<&'static str> {
        match &self.ours {
            Ours::Finding(finding) => Some(finding.verdict.words()),
            ours => Some(Agreement::of(&self.published.as_ref()?.value, ours)?.words()),
        }
    }

    /// The number of runs that our value is over, if it is over runs.
    #[must_use]
    pub fn runs(&self) -> Option<usize> {
        match &self.ours {
            Ours::Mean(mean) => Some(mean.runs),
            Ours::Share(share) => Some(share.runs),
            Ours::Finding(finding) => Some(finding.margin.runs),
            Ours::Never | Ours::Exact(_) | Ours::Choice { .. } | Ours::Missing => None,
        }
    }

    /// The cells of the printed table: description, published value, source, our value, verdict.
    #[must_use]
    pub fn cells(&self) -> [String; 5] {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
        let ours = match &self.ours {
            Ours::Mean(mean) => mean.text(&self.unit),
            Ours::Share(share) => share.text(),
            Ours::Never => "in no run".to_owned(),
            Ours::Exact(value) => format!("{value:.4}{unit}"),
            Ours::Choice { best, as_good } => choice(best, as_good),
            Ours::Finding(finding) => format!("margin {}", finding.margin.text(&self.unit)),
            Ours::Missing => "no run succeeded".to_owned(),
        };
        let (published, source) = match &self.published {
            None => (NOT_STATED.to_owned(), String::new()),
            Some(Published { value, source }) if matches!(self.ours, Ours::Finding(_)) => {
                (value.clone(), source.clone())
            }
            Some(Published { value, source }) => (format!("{value}{unit}"), source.clone()),
        };
        [self.what.clone(), published, source, ours, self.verdict().unwrap_or_default().to_owned()]
    }

    /// The line as a JSON object.
    #[must_use]
    pub fn json(&self) -> Value {
        let mut json = Map::new();
        json.insert("what".to_owned(), json!(self.what));
        json.insert("unit".to_owned(), json!(self.unit));
        if let Some(Published { value, source }) = &self.published {
            json.insert("published".to_owned(), json!(value));
            json.insert("source".to_owned(), json!(source));
        }
        match &self.ours {
            Ours::Mean(mean) => json.extend(mean.json()),
            Ours::Share(share) => json.extend([
                ("mean".to_owned(), json!(100.0 * share.share())),
                ("interval_95".to_owned(), json!(share.interval_95.map(|end| 100.0 * end))),
                ("runs".to_owned(), json!(share.runs)),
            ]),
            Ours::Never => json.extend([("result".to_owned(), json!("in no run"))]),
            Ours::Exact(value) => json.extend([("mean".to_owned(), json!(value))]),
            Ours::Choice { best, as_good } => {
                json.extend([("result".to_owned(), json!(choice(best, as_good)))]);
            }
            Ours::Finding(Finding { verdict, margin, .. }) => {
                json.extend([
                    ("result".to_owned(), json!(verdict.words())),
                    ("margin".to_owned(), margin.json().into()),
                ]);
            }
            Ours::Missing => json.extend([("runs".to_owned(), json!(0))]),
        }
        if let Some(verdict) = self.verdict() {
            json.insert("verdict".to_owned(), json!(verdict));
        }
        Value::Object(json)
    }

    fn record(&self) -> [String; 9] {
        let numbers = |Mean { mean, half_width_95, runs }: &Mean| {
            let half_width = half_width_95.map_or_else(String::new, |half_width| half_width.to_string());
            [mean.to_string(), half_width, runs.to_string()]
        };
        let none = || [const { String::new() }; 3];
        let (numbers, result) = match &self.ours {
            Ours::Mean(mean) => (numbers(mean), String::new()),
            Ours::Share(share) => {
                ([(100.0 * share.share()).to_string(), String::new(), share.runs.to_string()], share.text())
            }
            Ours::Never => (none(), "in no run".to_owned()),
            Ours::Exact(value) => ([value.to_string(), String::new(), String::new()], String::new()),
            Ours::Choice { best, as_good } => (none(), choice(best, as_good)),
            Ours::Finding(finding) => (numbers(&finding.margin), finding.verdict.words().to_owned()),
            Ours::Missing => ([String::new(), String::new(), "0".to_owned()], String::new()),
        };
        let (published, source) = match &self.published {
            Some(Published { value, source }) => (value.clone(), source.clone()),
            None => (String::new(), String::new()),
        };
        let [mean, half_width, runs] = numbers;
        let verdict = self.verdict().unwrap_or_default().to_owned();
        [self.what.clone(), published, self.unit.clone(), mean, half_width, runs, result, source, verdict]
    }
}

/// The best setting, and those that are as good.
fn choice(best: &str, as_good: &[String]) -> String {
    if as_good.is_empty() {
        best.to_owned()
    } else {
        format!("{best} (not significantly better than {})", as_good.join(", "))
    }
}

/// Writes lines as CSV with the columns what, published, unit, mean, `half_width_95`, runs, result, source, verdict. For a
/// conclusion, the result is the verdict and the mean is the margin. Values that the thesis does not state are empty, and
/// so is the verdict of such a line.
///
/// # Errors
/// If the file cannot be written.
pub fn write_csv<'a>(path: &Path, lines: impl IntoIterator<Item = &'a Line>) -> Result<(), OutputError> {
    let header = ["what", "published", "unit", "mean", "half_width_95", "runs", "result", "source", "verdict"];
    let mut file = CsvFile::new(header, EmptyCell::Bare);
    lines.into_iter().for_each(|line| file.row(line.record()));
    file.save(path)
}

#[cfg(test)]
mod tests {
    use super::super::finding::Verdict;
    use super::*;
    use sextant_study::sweep::Share;

    #[test]
    fn a_line_shows_both_values_in_the_same_unit() {
        let mean = Mean { mean: 6.013, half_width_95: Some(0.284), runs: 5 };
        let published = Some(Published::new("5", "table 3.6"));
        let line = Line { what: "ML-TM".into(), published, unit: "%".into(), ours: Ours::Mean(mean) };
        assert_eq!(line.cells(), ["ML-TM", "5 %", "table 3.6", "6.01 ± 0.28 %", "within a factor 2"]);
        assert_eq!(line.record(), ["ML-TM", "5", "%", "6.013", "0.284", "5", "", "table 3.6", "within a factor 2"]);
        let none = Line { published: None, ours: Ours::Missing, ..line };
        assert_eq!(none.cells(), ["ML-TM", "not stated", "", "no run succeeded", ""]);
        assert_eq!(none.json(), json!({"what": "ML-TM", "unit": "%", "runs": 0}));
    }

    #[test]
    fn a_share_of_the_runs_shows_how_many_they_are() {
        let ours = Ours::Share(Share::of(&[1.0, 1.0, 0.0, 1.0]).unwrap());
        let line = Line { what: "captured".into(), published: None, unit: "%".into(), ours };
        let shown = "75 % (3 of 4 runs, 19 to 99 %)";
        assert_eq!(line.cells(), ["captured", "not stated", "", shown, ""]);
        assert_eq!(line.record(), ["captured", "", "%", "75", "", "4", shown, "", ""]);
        assert_eq!((&line.json()["mean"], &line.json()["runs"]), (&json!(75.0), &json!(4)));
        let never = Line { ours: Ours::Never, ..line };
        assert_eq!(never.cells()[3], "in no run");
        assert_eq!(never.record(), ["captured", "", "%", "", "", "", "in no run", "", ""]);
    }

    #[test]
    fn a_conclusion_shows_its_verdict_and_its_margin() {
        let margin = Mean { mean: -1.5, half_width_95: Some(0.25), runs: 3 };
        let finding = Finding { verdict: Verdict::DoesNotHold, margin, unit: "points" };
        let published = Some(Published::new("6 < 19 < 50 %", "table 3.6"));
        let line = Line { what: "a < b".into(), published, unit: "points".into(), ours: Ours::Finding(finding) };
        let shown = "margin -1.50 ± 0.25 points";
        assert_eq!(line.cells(), ["a < b", "6 < 19 < 50 %", "table 3.6", shown, "does not hold"]);
        assert_eq!(
            line.record(),
            ["a < b", "6 < 19 < 50 %", "points", "-1.5", "0.25", "3", "does not hold", "table 3.6", "does not hold"]
        );
        assert_eq!(line.json()["margin"], json!({"mean": -1.5, "runs": 3, "half_width_95": 0.25}));
    }
}
