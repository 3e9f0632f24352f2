//! `sextant sweep`: runs one scenario with many settings and seeds.

mod column_list;
mod existing;
mod results;

pub(super) use results::Results;

use std::io::{self, Write};
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};

use clap::Args;

use super::options::{Overrides, Printing, Work};
use super::outputs::{keep_logs, reads_sweep};
use super::plan_flags::PlanFlags;
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::terminal::{Watcher, stdout, warn};
use existing::Start;
use sextant::scenario::ScenarioErrors;
use sextant_kernel::text::counted;
use sextant_recording::admission::{OutputKind, Outputs, Replace};
use sextant_study::sweep::{
    Shard, Sweep, SweepError, SweptRows, TableFormat, TableRows, clear_parts, extend, write_table,
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
    /// Do only part I of N of the work (I from 1 to N): each N-th survey from the I-th on. The tables of all parts together
    /// have all rows
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

    /// The sweep of `scenario`. Warns of what its settings leave out.
    pub(super) fn sweep(&self, scenario: &Path) -> Result<Sweep, ScenarioErrors> {
        let sweep = Sweep::read(scenario, &self.overrides.set, self.seed, self.runs)?;
        sweep.left_out()?.iter().for_each(|left_out| warn(left_out));
        Ok(sweep)
    }
}

pub(crate) fn execute(arguments: &Arguments, interrupt: &Interrupt) -> Result<(), Failure> {
    arguments.work.start_threads()?;
    let Some(scenario) = &arguments.scenario else {
        return Ok(column_list::print(None, arguments.printing)?);
    };
    let out = arguments.table();
    TableFormat::of(&out)?;
    let plan = arguments.sweep(scenario)?;
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
    let format = arguments.printing.format;
    match existing::start(arguments, &plan, &out)? {
        Start::Finished(rows) => Results { plan: &plan, rows: &rows }.tell(&out, format, &mut stdout),
        Start::Run(known) => {
            let rows = swept(arguments, &plan, known, &out, interrupt)?;
            let told = Results { plan: &plan, rows: &rows }.tell(&out, format, &mut stdout);
            clear_parts(&out)?;
            told
        }
    }
}

/// Runs what is not `known`, and writes the table of all rows.
fn swept<'a>(
    arguments: &Arguments,
    plan: &'a Sweep,
    known: Option<TableRows<'a>>,
    out: &Path,
    interrupt: &Interrupt,
) -> Result<SweptRows<'a>, Failure> {
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
