//! `sextant sweep`: runs one scenario with many settings and seeds.

mod column_list;
mod existing;

use std::io::{self, Write};
use std::num::NonZeroU32;
use std::ops::Range;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Map, Value, json};

use super::options::{Format, Overrides, Printing, Work};
use super::outputs::{keep_logs, reads_sweep};
use super::plan_flags::PlanFlags;
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::terminal::{Watcher, stdout};
use existing::Start;
use sextant::columns::{Align, columns};
use sextant::summary::Measure;
use sextant_kernel::text::counted;
use sextant_recording::admission::{OutputKind, Outputs, Replace};
use sextant_study::sweep::{
    Column, Mean, RunRow, Shard, Sweep, SweepError, TableFormat, clear_parts, extend, rows_of, write_table,
};

/// Arguments of `sextant sweep`.
#[derive(Clone, Debug, Args)]
pub(crate) struct Arguments {
    /// The scenario; its table `[sweep]` lists the settings that vary. Or the folder of a plan
    #[arg(value_name = "SCENARIO.toml|PLAN", required_unless_present = "columns")]
    pub(crate) scenario: Option<PathBuf>,
    /// Random seed of the first run of each cell; overrides that of the scenario
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// Settings that override those of the scenario.
    #[command(flatten)]
    pub(crate) overrides: Overrides,
    /// The table to write, TABLE.csv or TABLE.parquet, with one row for each cell, run and map [default: SCENARIO.csv in
    /// the working folder]. If it has some runs of this sweep, only the others are run and added
    #[arg(long, value_name = "TABLE")]
    pub(crate) out: Option<PathBuf>,
    /// Runs of each cell, with the seeds seed, seed + 1, ..; overrides that of the scenario. More than a table has extend it
    #[arg(long, value_name = "N")]
    pub(crate) runs: Option<NonZeroU32>,
    /// Do only part I of N of the work (I from 1 to N). The tables of all parts together have all rows
    #[arg(long, value_name = "I/N", default_value = "1/1")]
    pub(crate) shard: Shard,
    /// Continue a sweep that was interrupted. Of a plan: submit what is missing or failed
    #[arg(long)]
    pub(crate) resume: bool,
    /// Replace the table if it exists, or a plan with all that was done of it
    #[arg(long)]
    pub(crate) force: bool,
    /// Print what the columns of the table mean, of this scenario or of all, and run nothing
    #[arg(long)]
    pub(crate) columns: bool,
    /// Print the plan, and run nothing
    #[arg(long)]
    pub(crate) dry_run: bool,
    /// How results are printed.
    #[command(flatten)]
    pub(crate) printing: Printing,
    /// How the work is done.
    #[command(flatten)]
    pub(crate) work: Work,
    /// Plans.
    #[command(flatten)]
    pub(crate) campaign: PlanFlags,
}

impl Arguments {
    /// The file of the table.
    #[must_use]
    pub(crate) fn table(&self) -> PathBuf {
        let default = || {
            let scenario = self.scenario.as_deref().and_then(Path::file_stem);
            let mut name = scenario.unwrap_or_default().to_owned();
            name.push(self.shard.suffix());
            name.push(".csv");
            PathBuf::from(name)
        };
        self.out.clone().unwrap_or_else(default)
    }
}

pub(crate) fn execute(arguments: &Arguments, interrupt: &Interrupt) -> Result<(), Failure> {
    arguments.work.start_threads()?;
    let Some(scenario) = &arguments.scenario else {
        return Ok(column_list::print(None, arguments.printing)?);
    };
    let out = arguments.table();
    TableFormat::of(&out)?;
    let plan = Sweep::read(scenario, &arguments.overrides.set, arguments.seed, arguments.runs)?;
    if arguments.columns {
        return Ok(column_list::print(Some(&plan), arguments.printing)?);
    }
    let mut stdout = stdout();
    if arguments.dry_run {
        return Ok(print_plan(&plan, &out, &mut stdout)?);
    }
    let mut outputs = Outputs::new(Replace::Any);
    reads_sweep(&mut outputs, &plan);
    outputs.writes("--out", &out, OutputKind::Table).keep_inputs()?;
    keep_logs(None, [("--out", out.as_path())])?;
    let rows = match existing::start(arguments, &plan, &out)? {
        Start::Finished(rows) => rows,
        Start::Run(known) => swept(arguments, &plan, known, &out, interrupt)?,
    };
    Ok(Results { plan: &plan, rows: &rows }.tell(&out, arguments.printing.format, &mut stdout)?)
}

/// Runs what is not `known`, and writes the table of all rows.
fn swept(
    arguments: &Arguments,
    plan: &Sweep,
    known: Vec<RunRow>,
    out: &Path,
    interrupt: &Interrupt,
) -> Result<Vec<RunRow>, Failure> {
    let _keeper = interrupt.keep();
    let watcher = Watcher::new(interrupt, arguments.work.quiet);
    let rows = extend(plan, known, arguments.shard, out, arguments.resume, &watcher);
    watcher.clear();
    let rows = match rows {
        Err(SweepError::Interrupted(_)) => {
            arguments.work.note("finished runs are kept; continue with --resume");
            return Err(Failure::Interrupted);
        }
        other => other?,
    };
    write_table(out, plan, &rows)?;
    clear_parts(out)?;
    Ok(rows)
}

fn print_plan(plan: &Sweep, out: &Path, stdout: &mut impl Write) -> io::Result<()> {
    let runs = plan.runs() as usize;
    let last_seed = plan.seed_of(plan.runs() - 1);
    writeln!(
        stdout,
        "{} of {} with the seeds {} to {last_seed}: {}, {} simulated",
        counted(plan.cells().len(), "cell"),
        counted(runs, "run"),
        plan.seed(),
        counted(plan.cells().len() * runs, "run"),
        counted(plan.survey_count(), "survey"),
    )?;
    writeln!(stdout, "table: {}\n", out.display())?;
    for (i, cell) in plan.cells().iter().enumerate() {
        let flags: Vec<_> = cell.settings.iter().map(|setting| setting.line()).collect();
        writeln!(stdout, "{i:>4}  {}", if flags.is_empty() { "as written".to_owned() } else { flags.join("  ") })?;
    }
    Ok(())
}

/// Of a large sweep, so many cells are printed.
const MOST_CELLS: usize = 100;

/// The rows of a sweep, summarised for each cell.
pub(super) struct Results<'a> {
    pub(super) plan: &'a Sweep,
    pub(super) rows: &'a [RunRow],
}

impl Results<'_> {
    /// Prints them; they are in the table `out`.
    pub(super) fn tell(&self, out: &Path, format: Format, stdout: &mut impl Write) -> io::Result<()> {
        match format {
            Format::Text => self.print(out, stdout),
            Format::Json => writeln!(stdout, "{:#}", self.json()),
        }
    }

    /// The means of a measure with their intervals by cell, all in the unit that suits the largest of them: `6.0 ± 0.3 %`;
    /// `-` without a value.
    fn written(&self, path: &str) -> Vec<String> {
        let mean = |cell: usize| self.plan.mean(self.rows, cell, self.measure(path)?);
        let means: Vec<Option<Mean>> = self.shown().map(mean).collect();
        let largest = means.iter().flatten().map(|mean| mean.mean.abs()).fold(0.0, f64::max);
        let (factor, unit) = self.measure(path).map_or((1.0, ""), |measure| measure.unit().for_size(largest));
        let text = |mean: Option<Mean>| mean.map_or_else(|| "-".to_owned(), |mean| mean.times(factor).rounded(unit));
        means.into_iter().map(text).collect()
    }

    fn measure(&self, path: &str) -> Option<&Measure> {
        self.plan.measures().iter().find(|measure| measure.path() == path)
    }

    /// The cells that are printed.
    fn shown(&self) -> Range<usize> {
        0..self.plan.cells().len().min(MOST_CELLS)
    }

    /// The names of the measures of whole runs that are printed, with their paths: those of which any cell has a value.
    fn printed(&self) -> Vec<(String, String)> {
        let measures = [
            ("path", "gathering.path_length_m"),
            ("PRR", "mac.prr"),
            ("throughput", "mac.throughput_bit_per_s"),
            ("mean delay", "mac.delay_s.mean"),
            ("detections", "sensing.detections"),
        ];
        let measures = measures.map(|(name, path)| (name.to_owned(), path.to_owned()));
        measures.into_iter().filter(|(_, path)| self.has(path)).collect()
    }

    /// The same of the measures of applications.
    fn printed_of_applications(&self) -> Vec<(String, String)> {
        let of = |name: &String| {
            [("captured", "captured"), ("arrived", "arrived"), ("time", "time_s")]
                .map(|(what, path)| (format!("{name}: {what}"), format!("applications.{name}.{path}")))
        };
        self.plan.applications().iter().flat_map(of).filter(|(_, path)| self.has(path)).collect()
    }

    /// Whether any cell has a value of a measure.
    fn has(&self, path: &str) -> bool {
        let Some(measure) = self.measure(path) else { return false };
        (0..self.plan.cells().len()).any(|i| self.plan.mean(self.rows, i, measure).is_some())
    }

    fn print(&self, out: &Path, stdout: &mut impl Write) -> io::Result<()> {
        let cells = self.shown();
        let count = |i: usize| rows_of(self.rows, i).iter().filter(|row| row.outcome.is_ok()).count();
        let mut named = vec![
            ("cell".to_owned(), cells.clone().map(|i| i.to_string()).collect()),
            ("runs".to_owned(), cells.clone().map(|i| count(i).to_string()).collect()),
        ];
        let mut add = |name: String, path: &str| named.push((name, self.written(path)));
        self.printed().iter().for_each(|(name, path)| add(name.clone(), path));
        for map in self.plan.maps() {
            add(format!("{map}: connectivity error"), &format!("maps.{map}.connectivity_error"));
            add(format!("{map}: mean error"), &format!("maps.{map}.position_error_m.mean"));
        }
        self.printed_of_applications().iter().for_each(|(name, path)| add(name.clone(), path));
        for (i, name) in shortened(self.plan.keys()).enumerate() {
            named.push((name, cells.clone().map(|cell| self.plan.values(cell)[i].clone()).collect()));
        }
        let align = vec![Align::Right; named.len()];
        let header = named.iter().map(|(name, _)| name.clone()).collect();
        let row = |i: usize| named.iter().map(|(_, texts): &(String, Vec<String>)| texts[i].clone()).collect();
        let rows: Vec<_> = [header].into_iter().chain(cells.map(row)).collect();
        columns(&rows, &align, stdout)?;
        let left_out = self.plan.cells().len() - self.shown().len();
        if left_out > 0 {
            writeln!(stdout, "and {} that are in the table only", counted(left_out, "cell"))?;
        }
        let failed = failed(self.rows);
        let failures = if failed > 0 { format!(", {failed} of them failed (column error)") } else { String::new() };
        writeln!(stdout, "\n{}: {}{failures}", out.display(), counted(self.rows.len(), "run"))
    }

    fn json(&self) -> Value {
        let cells = self.plan.cells().iter().enumerate().map(|(i, cell)| {
            let settings: Map<_, _> =
                cell.settings.iter().map(|setting| (setting.key.clone(), json!(setting.value))).collect();
            let mut means = Map::new();
            for measure in self.plan.measures() {
                if let Some(mean) = self.plan.mean(self.rows, i, measure) {
                    means.insert(measure.name(), mean.json().into());
                }
            }
            json!({"cell": i, "settings": settings, "failed": failed(rows_of(self.rows, i)), "measures": means})
        });
        json!({"sweep": {"runs": self.plan.runs(), "seed": self.plan.seed(), "rows": self.rows.len(),
                         "cells": cells.collect::<Vec<_>>()}})
    }
}

fn failed(rows: &[RunRow]) -> usize {
    rows.iter().filter(|row| row.outcome.is_err()).count()
}

/// The shortest end of each key that no other key has: `p0` for `maps.0.algorithm.ml_tm.profile.trapezoid.p0`.
fn shortened(keys: &[Column]) -> impl Iterator<Item = String> {
    let is_end_of = |end: &str, key: &str| key == end || key.ends_with(&format!(".{end}"));
    keys.iter().map(move |Column { name, .. }| {
        let ends = name.rmatch_indices('.').map(|(dot, _)| &name[dot + 1..]);
        let alone = |end: &&str| keys.iter().filter(|other| is_end_of(end, &other.name)).count() == 1;
        ends.into_iter().find(alone).unwrap_or(name).to_owned()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_study::sweep::ColumnKind;

    #[test]
    fn keys_are_shortened_but_stay_distinct() {
        let keys = ["a.b.p0", "a.c.range_m", "a.d.range_m", "seed"].map(|key| Column::new(key, ColumnKind::Real));
        assert_eq!(shortened(&keys).collect::<Vec<_>>(), ["p0", "c.range_m", "d.range_m", "seed"]);
    }
}
