//! One line of a reproduced table.

use std::path::Path;

use serde_json::{Map, Value, json};

use super::agreement::Agreement;
use super::better::Better;
use super::finding::Finding;
use super::finding::Verdict;
use super::ours::{Ours, choice};
use super::published::{Published, PublishedRange};
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
    /// Which values are better, if it is an error or a time of the method of the thesis, or a share that it wants.
    pub better: Option<Better>,
    /// Our value.
    pub ours: Ours,
    /// The reading that comes nearest, if the verdict depends on it.
    pub reading: Option<NamedReading>,
}

/// A reading of what the thesis leaves open, and our value under it.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedReading {
    /// The reading in words.
    pub name: String,
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
            Ours::Finding(_) if self.reading.is_some() => Some(Verdict::HoldsForReading.words()),
            Ours::Finding(finding) => Some(finding.verdict.words()),
            _ => self.agreement().map(Agreement::words),
        }
    }

    /// How near our value is to a published number; `None` for a conclusion, or if there is no number.
    #[must_use]
    pub fn agreement(&self) -> Option<Agreement> {
        let published = &self.published.as_ref()?.value;
        let agreement = Agreement::of(published, &self.ours)?;
        if agreement.is_near() {
            return Some(agreement);
        }
        if self.reading.is_some() {
            return Some(Agreement::ForReading);
        }
        let beaten = PublishedRange::read(published).zip(self.ours.number()).zip(self.better);
        let is_better = beaten.is_some_and(|((range, value), better)| range.is_beaten_by(value, better));
        Some(if is_better { Agreement::Better } else { agreement })
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
        let ours = self.ours.text(&self.unit);
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
        if let Some(NamedReading { name, ours }) = &self.reading {
            json.insert("reading".to_owned(), json!({"name": name, "ours": ours.text(&self.unit)}));
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
    use super::*;
    use sextant_study::sweep::Share;

    #[test]
    fn a_line_shows_both_values_in_the_same_unit() {
        let mean = Mean { mean: 6.013, half_width_95: Some(0.284), runs: 5 };
        let published = Some(Published::new("5", "table 3.6"));
        let line = Line {
            what: "ML-TM".into(),
            published,
            unit: "%".into(),
            better: None,
            ours: Ours::Mean(mean),
            reading: None,
        };
        assert_eq!(line.cells(), ["ML-TM", "5 %", "table 3.6", "6.01 ± 0.28 %", "within a factor 2"]);
        assert_eq!(line.record(), ["ML-TM", "5", "%", "6.013", "0.284", "5", "", "table 3.6", "within a factor 2"]);
        let none = Line { published: None, ours: Ours::Missing, ..line };
        assert_eq!(none.cells(), ["ML-TM", "not stated", "", "no run succeeded", ""]);
        assert_eq!(none.json(), json!({"what": "ML-TM", "unit": "%", "runs": 0}));
    }

    #[test]
    fn a_reading_or_a_better_value_changes_the_verdict_of_a_number_that_is_far() {
        let mean = |mean: f64| Ours::Mean(Mean { mean, half_width_95: Some(0.1), runs: 5 });
        let published = Some(Published::new("10", "table 3.6"));
        let line = |ours: Ours| Line {
            what: "error".into(),
            published: published.clone(),
            unit: "%".into(),
            better: Some(Better::Less),
            ours,
            reading: None,
        };
        let verdict = |line: Line| line.verdict().unwrap();
        assert_eq!(verdict(line(mean(7.0))), "better than published");
        assert_eq!(verdict(line(mean(13.0))), "within a factor 2");
        assert_eq!(verdict(Line { better: Some(Better::More), ..line(mean(13.0)) }), "better than published");
        assert_eq!(verdict(Line { better: None, ..line(mean(7.0)) }), "within a factor 2");
        let reading = Some(NamedReading { name: "anchors: 2 %".into(), ours: mean(9.5) });
        assert_eq!(verdict(Line { reading: reading.clone(), ..line(mean(30.0)) }), "within 20 % for a reading");
        assert_eq!(verdict(Line { reading, ..line(mean(9.0)) }), "within 20 %");
    }

    #[test]
    fn a_share_of_the_runs_shows_how_many_they_are() {
        let ours = Ours::Share(Share::of(&[1.0, 1.0, 0.0, 1.0]).unwrap());
        let line =
            Line { what: "captured".into(), published: None, unit: "%".into(), better: None, ours, reading: None };
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
        let line = Line {
            what: "a < b".into(),
            published,
            unit: "points".into(),
            better: None,
            ours: Ours::Finding(finding),
            reading: None,
        };
        let shown = "margin -1.50 ± 0.25 points";
        assert_eq!(line.cells(), ["a < b", "6 < 19 < 50 %", "table 3.6", shown, "does not hold"]);
        assert_eq!(
            line.record(),
            ["a < b", "6 < 19 < 50 %", "points", "-1.5", "0.25", "3", "does not hold", "table 3.6", "does not hold"]
        );
        assert_eq!(line.json()["margin"], json!({"mean": -1.5, "runs": 3, "half_width_95": 0.25}));
    }
}
