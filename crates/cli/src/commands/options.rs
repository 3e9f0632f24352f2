//! Flags that several commands share.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use serde::Serialize;

use super::with_flags;
use crate::diagnostic::Failure;
use crate::terminal::{Stdout, say, stdout, warn};
use sextant::MOST_THREADS;
use sextant::scenario::{Scenario, ScenarioErrors};
use sextant::summary::{self, Summary};
use sextant_figure::FileFormat;
use sextant_recording::admission::{OutputKind, Outputs};

/// How results are printed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// A table for people
    #[default]
    Text,
    /// One JSON object for programs
    Json,
}

/// How results are printed.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct Printing {
    /// How results are printed
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}

impl Printing {
    /// Whether results are printed as text.
    pub(super) fn is_text(self) -> bool {
        matches!(self.format, Format::Text)
    }

    /// Prints `answer` as JSON, or as the text that `text` writes.
    pub(super) fn print<T: Serialize>(
        self,
        answer: &T,
        text: impl FnOnce(&mut Stdout) -> io::Result<()>,
    ) -> io::Result<()> {
        let mut stdout = stdout();
        match self.format {
            Format::Text => text(&mut stdout),
            Format::Json => {
                serde_json::to_writer_pretty(&mut stdout, answer).map_err(io::Error::from)?;
                writeln!(stdout)
            }
        }
    }
}

/// The format of a picture file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum PictureFormat {
    /// Vector graphics
    #[default]
    Svg,
    /// Pixels, 192 per inch
    Png,
}

impl From<PictureFormat> for FileFormat {
    fn from(format: PictureFormat) -> Self {
        match format {
            PictureFormat::Svg => Self::Svg,
            PictureFormat::Png => Self::Png,
        }
    }
}

/// Where `run` and `map` write their results.
#[derive(Clone, Debug, Args)]
pub(crate) struct Results {
    /// Also write the results to this file, as one JSON object
    #[arg(long, value_name = "FILE.json")]
    pub(crate) summary: Option<PathBuf>,
    /// How results are printed.
    #[command(flatten)]
    pub(crate) printing: Printing,
}

impl Results {
    /// Adds the file of the results to the outputs.
    pub(super) fn among(&self, outputs: &mut Outputs<'_>) {
        if let Some(path) = &self.summary {
            outputs.writes("--summary", path, OutputKind::Summary);
        }
    }

    /// Writes and prints `summary`.
    pub(super) fn tell(&self, summary: &Summary) -> Result<(), Failure> {
        if let Some(path) = &self.summary {
            summary.write(path)?;
        }
        Ok(self.printing.print(summary, |stdout| summary::write(summary, stdout))?)
    }
}

/// Starts so many threads, or one per core. Call it once per process.
pub(super) fn start_threads(threads: Option<usize>) -> Result<(), Failure> {
    let Some(threads) = threads else {
        return Ok(());
    };
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build_global()
        .map_err(|error| Failure::failed(format!("{threads} threads cannot be started: {error}")))
}

pub(super) fn threads(text: &str) -> Result<usize, String> {
    let number = text.parse().ok().filter(|number| (1..=MOST_THREADS).contains(number));
    number.ok_or_else(|| format!("expected 1 to {MOST_THREADS}"))
}

/// Options of long work.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct Work {
    /// Number of threads [default: one per core]. The results do not depend on it
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<usize>,
    /// Print no progress bar and no notes
    #[arg(long)]
    pub(crate) quiet: bool,
}

impl Work {
    /// Starts the threads. Call it once per process.
    pub(super) fn start_threads(self) -> Result<(), Failure> {
        start_threads(self.threads)
    }

    /// Prints a note on standard error, unless `--quiet` is given.
    pub(super) fn note(self, note: &str) {
        if !self.quiet {
            say(&format!("note: {}", with_flags(note)));
        }
    }
}

/// Settings that override those of a scenario.
#[derive(Clone, Debug, Args)]
pub(crate) struct Overrides {
    /// Override a setting: path.to.key=value, for example maps.0.algorithm.ml_tm.grid_step_m=0.5. The value is TOML;
    /// quotes around a text are optional. May be repeated
    #[arg(long, value_name = "K=V", value_parser = setting)]
    pub(crate) set: Vec<String>,
}

/// Checks the form of a `--set` flag before any file is read.
fn setting(text: &str) -> Result<String, &'static str> {
    match text.split_once('=') {
        Some((key, _)) if !key.trim().is_empty() => Ok(text.to_owned()),
        _ => Err("expected path.to.key=value, for example robots.0.speed_m_per_s=2"),
    }
}

/// The scenario to run, and the flags that override it.
#[derive(Clone, Debug, Args)]
pub(crate) struct ScenarioSource {
    /// The scenario file
    #[arg(value_name = "SCENARIO.toml")]
    pub(crate) scenario: PathBuf,
    /// Random seed; overrides that of the scenario. In a sweep, the seed of the first run of each cell
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// Settings that override those of the scenario.
    #[command(flatten)]
    pub(crate) overrides: Overrides,
}

impl ScenarioSource {
    /// Reads and checks the scenario.
    pub(super) fn load(&self) -> Result<Scenario, ScenarioErrors> {
        let scenario = Scenario::load_with(&self.scenario, &self.overrides.set, self.seed)?;
        scenario.file().left_out(&self.overrides.set)?.iter().for_each(|left_out| warn(left_out));
        Ok(scenario)
    }
}
