//! `sextant reproduce`: the tables and figures of the thesis, with published values and ours.

use std::io::{self, Write};
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use super::options::{Format, Printing, Work};
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::terminal::Watcher;
use sextant::columns::{Align, columns};
use sextant::sweep::write_table;
use sextant_kernel::text::counted;
use sextant_thesis::{
    Experiment, Line, ReproductionError, Runs, experiments, write_csv, write_figures, write_pictures, write_scenarios,
};

/// Arguments of `sextant reproduce`.
#[derive(Clone, Debug, Args)]
pub(crate) struct Arguments {
    /// Numbers of tables or figures, as listed by `--list`
    #[arg(value_name = "ID", required_unless_present_any = ["all", "list"])]
    pub(crate) ids: Vec<String>,
    /// Reproduce all tables and figures
    #[arg(long, conflicts_with = "ids")]
    pub(crate) all: bool,
    /// List the tables and figures, and the scenarios that they run
    #[arg(long)]
    pub(crate) list: bool,
    /// Runs of each scenario, with the seeds 1, 2, ..
    #[arg(long, value_name = "N", default_value = "10")]
    pub(crate) runs: NonZeroU32,
    /// The folder for tables, figures and the scenarios that were run. It is created if it does not exist
    #[arg(long, value_name = "DIR", default_value = "reproduction")]
    pub(crate) out: PathBuf,
    /// How results are printed.
    #[command(flatten)]
    pub(crate) printing: Printing,
    /// How the work is done.
    #[command(flatten)]
    pub(crate) work: Work,
}

pub(crate) fn execute(arguments: &Arguments, interrupt: &Interrupt) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    if arguments.list {
        return Ok(list(&mut stdout)?);
    }
    let experiments = chosen(arguments)?;
    arguments.work.start_threads()?;
    let _keeper = interrupt.keep();
    let watcher = Watcher::new(interrupt, arguments.work.quiet);
    let out = &arguments.out;
    let scenarios = out.join("scenarios");
    write_scenarios(&scenarios)?;
    let mut runs = Runs::new(scenarios.clone(), arguments.runs);
    let mut finished = Vec::new();
    let mut outcome = Ok(());
    for experiment in &experiments {
        let tell = |size: &str| arguments.work.note(&format!("{}: {size}", experiment.id));
        let new = runs.make(&experiment.scenarios(), tell, &watcher);
        watcher.clear();
        write_runs(&runs, &experiment.scenarios(), out)?;
        let new = match new {
            Ok(new) => new,
            Err(failure) => {
                outcome = Err(failure);
                break;
            }
        };
        let results = Results::of(experiment, &runs);
        write_csv(&out.join(format!("{}.csv", experiment.id)), results.lines.iter().chain(&results.conclusions))?;
        write_figures(experiment, &runs, out)?;
        if arguments.printing.format == Format::Text {
            results.print(arguments.runs, &mut stdout)?;
        }
        finished.push(results);
        outcome = write_pictures(&new, &scenarios, &out.join("figures"), interrupt);
        if outcome.is_err() {
            break;
        }
    }
    match arguments.printing.format {
        Format::Text => writeln!(stdout, "tables, figures and scenarios: {}", out.display())?,
        Format::Json => writeln!(stdout, "{:#}", json(&finished, arguments.runs))?,
    }
    if matches!(outcome, Err(ReproductionError::Interrupted(_))) {
        let (done, all) = (finished.len(), counted(experiments.len(), "experiment"));
        arguments
            .work
            .note(&format!("{done} of {all} are done; finished runs of the next are in `{}`", out.display()));
    }
    outcome?;
    let failures = runs.failures();
    match failures.first() {
        None => Ok(()),
        Some(first) => Err(Failure::failed(format!("{} failed; the first: {first}", counted(failures.len(), "run")))),
    }
}

/// Writes the table of the finished runs of each of `scenarios`.
fn write_runs(runs: &Runs, scenarios: &[&str], out: &Path) -> Result<(), Failure> {
    for (scenario, plan, rows) in runs.scenarios().filter(|(scenario, ..)| scenarios.contains(scenario)) {
        let name = scenario.trim_end_matches(".toml").replace('/', "-");
        write_table(&out.join(format!("runs-{name}.csv")), plan, rows)?;
    }
    Ok(())
}

fn chosen(arguments: &Arguments) -> Result<Vec<Experiment>, Failure> {
    if arguments.all {
        return Ok(experiments());
    }
    let experiment = |id: &String| {
        experiments().into_iter().find(|experiment| experiment.id == *id).ok_or_else(|| {
            let ids: Vec<_> = experiments().into_iter().map(|experiment| experiment.id).collect();
            Failure::bad_input_with_help(
                format!("there is no table or figure `{id}`"),
                format!("allowed: {}, or --all", ids.join(", ")),
            )
        })
    };
    arguments.ids.iter().map(experiment).collect()
}

fn list(stdout: &mut impl Write) -> io::Result<()> {
    let mut rows = vec![["id", "what", "scenarios"].map(str::to_owned).to_vec()];
    for experiment in experiments() {
        let scenarios = experiment.scenarios().join(", ");
        let scenarios = if scenarios.is_empty() { "none".to_owned() } else { scenarios };
        rows.push(vec![experiment.id, experiment.title, scenarios]);
    }
    columns(&rows, &[Align::Left; 3], stdout)
}

/// The results of an experiment.
struct Results<'a> {
    experiment: &'a Experiment,
    lines: Vec<Line>,
    conclusions: Vec<Line>,
}

impl<'a> Results<'a> {
    fn of(experiment: &'a Experiment, runs: &Runs) -> Self {
        Self { experiment, lines: experiment.lines(runs), conclusions: experiment.conclusions(runs) }
    }

    fn print(&self, runs: NonZeroU32, stdout: &mut impl Write) -> io::Result<()> {
        writeln!(stdout, "{} {}\n", self.experiment.id, self.experiment.title)?;
        let align = [Align::Left, Align::Right, Align::Left, Align::Right];
        let mut table = |header: [&str; 4], lines: &[Line]| {
            let mut rows = vec![header.map(str::to_owned).to_vec()];
            rows.extend(lines.iter().map(|line| line.cells().to_vec()));
            columns(&rows, &align, stdout)?;
            writeln!(stdout)
        };
        table(
            ["", "published", "in", &format!("ours (mean, 95 % interval, {})", counted(runs.get() as usize, "run"))],
            &self.lines,
        )?;
        if !self.conclusions.is_empty() {
            table(["conclusion", "published", "in", "ours"], &self.conclusions)?;
            writeln!(stdout, "  {MARGIN}")?;
        }
        for note in &self.experiment.notes {
            writeln!(stdout, "  {note}")?;
        }
        writeln!(stdout)
    }

    fn json(&self) -> Value {
        json!({
            "id": self.experiment.id,
            "title": self.experiment.title,
            "lines": self.lines.iter().chain(&self.conclusions).map(Line::json).collect::<Vec<_>>(),
            "notes": self.experiment.notes,
        })
    }
}

const MARGIN: &str = "A margin is the mean difference between runs of the same seed, in the comparison that decides the \
                      result, with its 95 % confidence interval. A margin above 0 supports the conclusion; if the \
                      interval contains 0, it cannot be told whether the conclusion holds.";

fn json(finished: &[Results<'_>], runs: NonZeroU32) -> Value {
    let experiments: Vec<_> = finished.iter().map(Results::json).collect();
    json!({"reproduction": {"runs": runs, "experiments": experiments}})
}
