//! `sextant sweep`: runs one scenario with many settings and seeds.

use std::io::{self, Write};
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Map, Value, json};

use super::options::{Format, Printing, ScenarioSource, Work};
use super::plan_flags::PlanFlags;
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::terminal::Watcher;
use sextant::columns::{Align, columns};
use sextant::summary::Measure;
use sextant::sweep::{Column, Row, Shard, Sweep, SweepError, TableFormat, clear_parts, run, write_table};
use sextant_kernel::text::counted;

/// Arguments of `sextant sweep`.
#[derive(Clone, Debug, Args)]
pub(crate) struct Arguments {
    /// The scenario; its table `[sweep]` lists the settings that vary. Or the folder of a plan.
    #[command(flatten)]
    pub(crate) source: ScenarioSource,
    /// The table to write, TABLE.csv or TABLE.parquet, with one row per cell and run [default: SCENARIO.csv in the
    /// working folder]
    #[arg(long, value_name = "TABLE")]
    pub(crate) out: Option<PathBuf>,
    /// Runs of each cell, with the seeds seed, seed + 1, ..; overrides that of the scenario
    #[arg(long, value_name = "N")]
    pub(crate) runs: Option<NonZeroU32>,
    /// Do only part I of N of the work (I from 1 to N). The tables of all parts together have all rows
    #[arg(long, value_name = "I/N", default_value = "1/1")]
    pub(crate) shard: Shard,
    /// Continue a sweep that was interrupted. Of a plan: submit what is missing or failed
    #[arg(long)]
    pub(crate) resume: bool,
    /// Replace a plan that exists, with all that was done of it
    #[arg(long)]
    pub(crate) force: bool,
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
            let mut name = self.source.scenario.file_stem().unwrap_or_default().to_owned();
            name.push(self.shard.suffix());
            name.push(".csv");
            PathBuf::from(name)
        };
        self.out.clone().unwrap_or_else(default)
    }
}

pub(crate) fn execute(arguments: &Arguments, interrupt: &Interrupt) -> Result<(), Failure> {
    arguments.work.start_threads()?;
    let (source, out) = (&arguments.source, arguments.table());
    TableFormat::of(&out)?;
    let plan = Sweep::read(&source.scenario, &source.overrides.set, source.seed, arguments.runs)?;
    let mut stdout = io::stdout().lock();
    if arguments.dry_run {
        return Ok(print_plan(&plan, &out, &mut stdout)?);
    }
    let _keeper = interrupt.keep();
    let watcher = Watcher::new(interrupt, arguments.work.quiet);
    let rows = run(&plan, arguments.shard, &out, arguments.resume, &watcher);
    watcher.clear();
    let rows = match rows {
        Err(SweepError::Interrupted(_)) => {
            arguments.work.note("finished runs are kept; continue with --resume");
            return Err(Failure::Interrupted);
        }
        other => other?,
    };
    write_table(&out, &plan, &rows)?;
    clear_parts(&out)?;
    Ok(Results { plan: &plan, rows: &rows }.tell(&out, arguments.printing.format, &mut stdout)?)
}

fn print_plan(plan: &Sweep, out: &Path, stdout: &mut impl Write) -> io::Result<()> {
    let runs = plan.runs() as usize;
    let last_seed = plan.seed().wrapping_add(u64::from(plan.runs()) - 1);
    writeln!(
        stdout,
        "{} of {} with the seeds {} to {last_seed}: {}, {} simulated",
        counted(plan.cells().len(), "cell"),
        counted(runs, "run"),
        plan.seed(),
        counted(plan.cells().len() * runs, "row"),
        counted(plan.survey_count(), "survey"),
    )?;
    writeln!(stdout, "table: {}\n", out.display())?;
    for (i, cell) in plan.cells().iter().enumerate() {
        let flags: Vec<_> = cell.settings.iter().map(|setting| setting.line()).collect();
        writeln!(stdout, "{i:>4}  {}", if flags.is_empty() { "as written".to_owned() } else { flags.join("  ") })?;
    }
    Ok(())
}

/// The rows of a sweep, summarised for each cell.
pub(super) struct Results<'a> {
    pub(super) plan: &'a Sweep,
    pub(super) rows: &'a [Row],
}

impl Results<'_> {
    /// Prints them; they are in the table `out`.
    pub(super) fn tell(&self, out: &Path, format: Format, stdout: &mut impl Write) -> io::Result<()> {
        match format {
            Format::Text => self.print(out, stdout),
            Format::Json => writeln!(stdout, "{:#}", self.json()),
        }
    }

    /// The mean of a measure with its interval, in the unit of the printed table: `6.0 ± 0.3 %`; `-` without a value.
    fn written(&self, cell: usize, path: &str) -> String {
        let mean = self.measure(path).and_then(|measure| {
            let (factor, unit) = measure.unit().for_people();
            Some(self.plan.mean(self.rows, cell, measure)?.times(factor).text(unit))
        });
        mean.unwrap_or_else(|| "-".to_owned())
    }

    fn measure(&self, path: &str) -> Option<&Measure> {
        self.plan.measures().iter().find(|measure| measure.path() == path)
    }

    fn failed(&self, cell: Option<usize>) -> usize {
        let rows = self.rows.iter().filter(|row| cell.is_none_or(|cell| row.cell == cell));
        rows.filter(|row| row.outcome.is_err()).count()
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
        let mut header = vec!["cell".to_owned(), "runs".to_owned()];
        let of_run = self.printed();
        header.extend(of_run.iter().map(|(name, _)| name.clone()));
        for map in self.plan.maps() {
            header.extend([format!("{map}: connectivity error"), format!("{map}: mean error")]);
        }
        let of_applications = self.printed_of_applications();
        header.extend(of_applications.iter().map(|(name, _)| name.clone()));
        header.extend(shortened(self.plan.keys()));
        let align = vec![Align::Right; header.len()];
        let mut rows = vec![header];
        for i in 0..self.plan.cells().len() {
            let count = self.rows.iter().filter(|row| row.cell == i).count() - self.failed(Some(i));
            let mut row = vec![i.to_string(), count.to_string()];
            row.extend(of_run.iter().map(|(_, path)| self.written(i, path)));
            for map in self.plan.maps() {
                for number in ["connectivity_error", "position_error_m.mean"] {
                    row.push(self.written(i, &format!("maps.{map}.{number}")));
                }
            }
            row.extend(of_applications.iter().map(|(_, path)| self.written(i, path)));
            row.extend(self.plan.values(i));
            rows.push(row);
        }
        columns(&rows, &align, stdout)?;
        let failed = self.failed(None);
        let failures = if failed > 0 { format!(", {failed} of them failed (column error)") } else { String::new() };
        writeln!(stdout, "\n{}: {}{failures}", out.display(), counted(self.rows.len(), "row"))
    }

    fn json(&self) -> Value {
        let cells = self.plan.cells().iter().enumerate().map(|(i, cell)| {
            let settings: Map<_, _> =
                cell.settings.iter().map(|setting| (setting.key.clone(), json!(setting.value))).collect();
            let mut means = Map::new();
            for measure in self.plan.measures() {
                if let Some(mean) = self.plan.mean(self.rows, i, measure) {
                    means.insert(measure.column(), mean.json().into());
                }
            }
            json!({"cell": i, "settings": settings, "failed": self.failed(Some(i)), "measures": means})
        });
        json!({"sweep": {"runs": self.plan.runs(), "seed": self.plan.seed(), "rows": self.rows.len(),
                         "cells": cells.collect::<Vec<_>>()}})
    }
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
    use sextant::sweep::Kind;

    #[test]
    fn keys_are_shortened_but_stay_distinct() {
        let keys = ["a.b.p0", "a.c.range_m", "a.d.range_m", "seed"].map(|key| Column::new(key, Kind::Real));
        assert_eq!(shortened(&keys).collect::<Vec<_>>(), ["p0", "c.range_m", "d.range_m", "seed"]);
    }
}
