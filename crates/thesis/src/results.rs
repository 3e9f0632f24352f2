//! The results of an experiment.

use std::path::Path;

use serde_json::{Value, json};

use super::experiment::Experiment;
use super::line::{Line, write_csv};
use super::picture::Picture;
use super::readings::Readings;
use super::runs::Runs;
use super::variant::Variant;
use sextant_kernel::text::counted;
use sextant_recording::output::OutputError;

/// The results of an experiment.
#[derive(Clone, Debug)]
pub struct Results {
    /// Number of the table or figure, or a word.
    pub id: String,
    /// Its title.
    pub title: String,
    /// The chapter of the thesis.
    pub chapter: u8,
    /// The scenarios, each with the number of its runs.
    pub scenarios: Vec<(String, u32)>,
    /// The lines of its table.
    pub lines: Vec<Line>,
    /// The lines of its conclusions.
    pub conclusions: Vec<Line>,
    /// How far both depend on what the thesis leaves open.
    pub readings: Readings,
    /// Its figures: name of the file without extension, and title.
    pub figures: Vec<(String, String)>,
    /// Its pictures of one run.
    pub pictures: Vec<Picture>,
    /// Notes on different definitions, and on what the thesis does not say.
    pub notes: Vec<String>,
}

impl Results {
    /// The results of `experiment` from `runs`.
    #[must_use]
    pub fn of(experiment: &Experiment, runs: &Runs) -> Self {
        let quantities = experiment.lines.iter();
        let mut lines: Vec<Line> = quantities.map(|quantity| quantity.line(quantity.ours.ours(runs))).collect();
        let mut conclusions = experiment.conclusions(runs);
        let readings = Readings::of(experiment, runs);
        readings.name_in(&mut lines, &mut conclusions);
        let made = |variant: Variant| (variant.scenario.clone(), runs.made(&variant));
        Self {
            id: experiment.id.clone(),
            title: experiment.title.clone(),
            chapter: experiment.chapter,
            scenarios: experiment.shipped().into_iter().map(made).collect(),
            lines: experiment.shown(lines),
            conclusions,
            readings,
            figures: experiment.charts.iter().map(|chart| (chart.name.clone(), chart.title.clone())).collect(),
            pictures: experiment.pictures.clone(),
            notes: experiment.notes.clone(),
        }
    }

    /// Its lines and conclusions.
    pub fn all(&self) -> impl Iterator<Item = &Line> {
        self.lines.iter().chain(&self.conclusions)
    }

    /// How many runs of each scenario there are: `10 runs`, or `5 to 10 runs`.
    #[must_use]
    pub fn runs(&self) -> String {
        let counts = || self.scenarios.iter().map(|&(_, count)| count);
        match (counts().min(), counts().max()) {
            (None, _) => "no runs needed".to_owned(),
            (Some(least), Some(most)) if least < most => format!("{least} to {most} runs"),
            (_, most) => counted(most.unwrap_or(0) as usize, "run"),
        }
    }

    /// Writes the table `ID.csv` into the folder `out`, and `ID-readings.csv` if there are readings.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write_csv(&self, out: &Path) -> Result<(), OutputError> {
        if !self.readings.is_empty() {
            self.readings.write_csv(&out.join(format!("{}-readings.csv", self.id)))?;
        }
        write_csv(&out.join(format!("{}.csv", self.id)), self.all())
    }

    pub(crate) fn json(&self) -> Value {
        let scenarios = self.scenarios.iter().map(|(scenario, runs)| json!({"scenario": scenario, "runs": runs}));
        json!({
            "id": self.id,
            "title": self.title,
            "chapter": self.chapter,
            "scenarios": scenarios.collect::<Vec<_>>(),
            "lines": self.all().map(Line::json).collect::<Vec<_>>(),
            "figures": self.figures.iter().map(|(name, title)| json!({"file": format!("{name}.svg"), "title": title})).collect::<Vec<_>>(),
            "pictures": self.pictures.iter().map(|of| json!({"file": of.file(), "title": of.title})).collect::<Vec<_>>(),
            "notes": self.notes,
        })
    }
}
