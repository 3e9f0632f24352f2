//! `sextant reproduce`: the thesis' tables and figures, published beside ours.

use std::io::{self, Write};
use std::num::NonZeroU32;
use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::options::{Format, Printing, Work};
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::reproduce::{
    CHAPTER_3, Experiment, Line, Runs, find, write_csv, write_figures, write_pictures, write_scenarios,
};
use crate::sweep::write_table;
use crate::text::{Align, columns};

/// What `sextant reproduce` is told.
#[derive(Clone, Debug, Args)]
pub struct Arguments {
    /// Numbers of tables or figures, as `--list` shows them
    #[arg(value_name = "ID", required_unless_present_any = ["all", "list"])]
    pub ids: Vec<String>,
    /// Everything
    #[arg(long, conflicts_with = "ids")]
    pub all: bool,
    /// Print what there is and which scenarios it runs
    #[arg(long)]
    pub list: bool,
    /// Runs of each scenario, with the seeds 1, 2, ..
    #[arg(long, value_name = "N", default_value = "10")]
    pub runs: NonZeroU32,
    /// The folder for tables, figures and the scenarios that were run; it is made if it is not there
    #[arg(long, value_name = "DIR", default_value = "reproduction")]
    pub out: PathBuf,
    /// How results are printed.
    #[command(flatten)]
    pub printing: Printing,
    /// How the work is done.
    #[command(flatten)]
    pub work: Work,
}

pub(crate) fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    if arguments.list {
        return Ok(list(&mut stdout)?);
    }
    let experiments = chosen(arguments)?;
    arguments.work.start_threads()?;
    let interrupt = Interrupt::install()?;
    let out = &arguments.out;
    let scenarios = out.join("scenarios");
    write_scenarios(&scenarios)?;
    let runs = Runs::make(&experiments, &scenarios, arguments.runs, &interrupt, arguments.work.quiet)?;
    for (scenario, plan, rows) in runs.scenarios() {
        let name = scenario.trim_end_matches(".toml").replace('/', "-");
        write_table(&out.join(format!("runs-{name}.csv")), plan, rows)?;
    }
    let names: Vec<_> = runs.scenarios().map(|(scenario, ..)| scenario).collect();
    write_pictures(&names, &scenarios, &out.join("figures"), &interrupt)?;
    let mut printed = Vec::new();
    for experiment in &experiments {
        let lines = experiment.lines(&runs);
        write_csv(&out.join(format!("{}.csv", experiment.id)), &lines)?;
        write_figures(experiment, &runs, out)?;
        printed.push((*experiment, lines));
    }
    match arguments.printing.format {
        Format::Text => {
            for (experiment, lines) in &printed {
                print(experiment, lines, arguments.runs, &mut stdout)?;
            }
            writeln!(stdout, "tables, figures and scenarios: {}", out.display())?;
        }
        Format::Json => writeln!(stdout, "{:#}", json(&printed, arguments.runs))?,
    }
    let failures = runs.failures();
    match failures.first() {
        None => Ok(()),
        Some(first) => Err(Failure::failed(format!("{} runs failed; the first: {first}", failures.len()))),
    }
}

fn chosen(arguments: &Arguments) -> Result<Vec<&'static Experiment>, Failure> {
    if arguments.all {
        return Ok(CHAPTER_3.iter().collect());
    }
    let experiment = |id: &String| {
        find(id).ok_or_else(|| {
            let ids: Vec<_> = CHAPTER_3.iter().map(|experiment| experiment.id).collect();
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
    for experiment in CHAPTER_3 {
        let scenarios = experiment.scenarios().join(", ");
        let scenarios = if scenarios.is_empty() { "none".to_owned() } else { scenarios };
        rows.push(vec![experiment.id.to_owned(), experiment.title.to_owned(), scenarios]);
    }
    columns(&rows, &[Align::Left; 3], stdout)
}

fn print(experiment: &Experiment, lines: &[Line], runs: NonZeroU32, stdout: &mut impl Write) -> io::Result<()> {
    writeln!(stdout, "{} {}\n", experiment.id, experiment.title)?;
    let ours = format!("ours (mean, 95 % interval, {runs} runs)");
    let mut rows = vec![vec![String::new(), "published".to_owned(), ours]];
    rows.extend(lines.iter().map(|line| line.cells().to_vec()));
    columns(&rows, &[Align::Left, Align::Right, Align::Right], stdout)?;
    writeln!(stdout)?;
    for note in experiment.notes {
        writeln!(stdout, "  {note}")?;
    }
    writeln!(stdout)
}

fn json(printed: &[(&Experiment, Vec<Line>)], runs: NonZeroU32) -> Value {
    let experiments = printed.iter().map(|(experiment, lines)| {
        json!({
            "id": experiment.id,
            "title": experiment.title,
            "lines": lines.iter().map(Line::json).collect::<Vec<_>>(),
            "notes": experiment.notes,
        })
    });
    json!({"reproduction": {"runs": runs, "experiments": experiments.collect::<Vec<_>>()}})
}
