//! `sextant reproduce`: the tables and figures of the thesis, with published values and ours.

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::num::NonZeroU32;
use std::path::PathBuf;

use clap::Args;

use super::options::{Format, Printing, Work};
use super::outputs::{Replacing, admit};
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::terminal::{Watcher, stdout};
use sextant::NumberRange;
use sextant::columns::{Align, columns};
use sextant_kernel::text::counted;
use sextant_recording::admission::{OutputKind, admit_folder};
use sextant_recording::disk;
use sextant_thesis::{
    Costs, Experiment, FIGURES, Line, ReproductionError, Results, RunCounts, Runs, SHIPPED, Tally, Variant,
    by_chapter, experiments, first_seed, is_reproduction, json, usual_runs, write_figures, write_json, write_pages,
    write_pictures, write_scenarios,
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
    /// List the tables and figures: their scenarios, usual number of runs, and CPU times
    #[arg(long)]
    pub(crate) list: bool,
    /// Runs of each scenario, with the seeds 1, 2, ..; without it as many as `--list` says
    #[arg(long, value_name = "N")]
    pub(crate) runs: Option<NonZeroU32>,
    /// The seed of the first run of each scenario; without it 1
    #[arg(long, value_name = "N", conflicts_with_all = ["from", "seeds"])]
    pub(crate) seed: Option<u64>,
    /// Runs with the seeds A to B - 1, and no others
    #[arg(long, value_name = "A..B", conflicts_with_all = ["from", "runs"])]
    pub(crate) seeds: Option<NumberRange>,
    /// Run other values of what the thesis leaves open too, and show what each number depends on
    #[arg(long, conflicts_with = "from")]
    pub(crate) readings: bool,
    /// Run nothing, and take the runs from the folder of an earlier reproduction
    #[arg(long, value_name = "DIR", conflicts_with = "runs")]
    pub(crate) from: Option<PathBuf>,
    /// The folder for pages, tables, figures and the scenarios that were run. It is created if it does not exist
    #[arg(long, value_name = "DIR", default_value = "reproduction")]
    pub(crate) out: PathBuf,
    /// What may be replaced.
    #[command(flatten)]
    pub(crate) replacing: Replacing,
    /// How results are printed.
    #[command(flatten)]
    pub(crate) printing: Printing,
    /// How the work is done.
    #[command(flatten)]
    pub(crate) work: Work,
}

pub(crate) fn execute(arguments: &Arguments, interrupt: &Interrupt) -> Result<(), Failure> {
    let mut stdout = stdout();
    if arguments.list {
        return Ok(list(&mut stdout)?);
    }
    let experiments = chosen(arguments)?;
    arguments.work.start_threads()?;
    arguments.check_room()?;
    let _keeper = interrupt.keep();
    let watcher = Watcher::new(interrupt, arguments.work.quiet);
    let scenarios = arguments.from.as_ref().unwrap_or(&arguments.out).join("scenarios");
    match arguments.from {
        None => write_scenarios(&scenarios)?,
        Some(_) => {
            disk::create_folders(&arguments.out).map_err(|error| Failure::unwritable(&arguments.out, &error))?
        }
    }
    let Seeds { first, counts } = arguments.seeds()?;
    let mut runs = Runs::new(scenarios.clone(), counts, first);
    let mut finished: Vec<Results> = Vec::new();
    let mut outcome = Ok(());
    for experiment in &experiments {
        let shipped = match made(experiment, arguments, &mut runs, &watcher) {
            Ok(Some(new)) => new,
            Ok(None) => continue,
            Err(failure) => {
                outcome = Err(failure);
                break;
            }
        };
        write_figures(experiment, &runs, &arguments.out)?;
        let results = Results::of(experiment, &runs);
        results.write_csv(&arguments.out)?;
        if arguments.printing.format == Format::Text {
            print(&results, &mut stdout)?;
        }
        arguments.copy_pictures(&results)?;
        finished.push(results);
        outcome = write_pictures(&shipped, &scenarios, &arguments.out.join(FIGURES), interrupt);
        if outcome.is_err() {
            break;
        }
    }
    write_json(&finished, first, &arguments.out)?;
    write_pages(&finished, first, &arguments.out)?;
    match arguments.printing.format {
        Format::Text => {
            print_verdicts(&finished, &mut stdout)?;
            writeln!(stdout, "pages, tables, figures and scenarios: {}", arguments.out.display())?;
        }
        Format::Json => writeln!(stdout, "{:#}", json(&finished, first))?,
    }
    if matches!(outcome, Err(ReproductionError::Interrupted(_))) {
        let (done, all) = (finished.len(), counted(experiments.len(), "experiment"));
        let out = arguments.out.display();
        arguments.work.note(&format!("{done} of {all} are done; finished runs of the next are in `{out}`"));
    }
    outcome?;
    let failures = runs.failures();
    match failures.first() {
        None => Ok(()),
        Some(first) => Err(Failure::failed(format!("{} failed; the first: {first}", counted(failures.len(), "run")))),
    }
}

/// The seeds of all runs.
struct Seeds {
    /// That of the first run, if it is not that of the scenario.
    first: Option<u64>,
    /// How many there are.
    counts: RunCounts,
}

impl Arguments {
    /// The seeds of all runs.
    fn seeds(&self) -> Result<Seeds, Failure> {
        if let Some(range) = self.seeds {
            let count = u32::try_from(range.len()).ok().and_then(NonZeroU32::new);
            let count = count.ok_or_else(|| {
                let (start, end) = (range.start, range.end);
                let most = u32::MAX;
                Failure::bad_input(format!("`--seeds {start}..{end}` has too many seeds; allowed: at most {most}"))
            })?;
            return Ok(Seeds { first: Some(range.start as u64), counts: RunCounts::Each(count) });
        }
        let counts = self.runs.map_or_else(usual_runs, RunCounts::Each);
        let first = self.seed.or_else(|| first_seed(self.from.as_ref()?));
        Ok(Seeds { first, counts })
    }

    /// Copies the pictures of `results` from the folder that its runs are read from.
    fn copy_pictures(&self, results: &Results) -> Result<(), Failure> {
        let Some(from) = &self.from else { return Ok(()) };
        let mut missing = 0;
        for picture in &results.pictures {
            if !picture.copy(from, &self.out)? {
                missing += 1;
            }
        }
        if missing > 0 {
            let (id, from, missing) = (&results.id, from.display(), counted(missing, "picture"));
            self.work
                .note(&format!("{id}: without {missing}, because `{from}` does not have the figures of its runs"));
        }
        Ok(())
    }

    /// Rejects a folder with files that are not those of a reproduction, or with scenarios that were changed.
    fn check_room(&self) -> Result<(), Failure> {
        admit_folder(&self.out, self.replacing.replace(), || is_reproduction(&self.out))?;
        let mut outputs = self.replacing.outputs();
        if self.from.is_none() {
            let scenarios = self.out.join("scenarios");
            let each = SHIPPED.iter().map(|(name, text)| (scenarios.join(name), OutputKind::Text(text.as_bytes())));
            each.for_each(|(path, kind)| {
                outputs.writes("", &path, kind);
            });
        }
        admit(&outputs, Some(self.work))
    }
}

/// Makes or reads the runs of an experiment, and returns its scenarios that were run now; `None` if it has no runs in the
/// folder that they are read from.
fn made(
    experiment: &Experiment,
    arguments: &Arguments,
    runs: &mut Runs,
    watcher: &Watcher<'_>,
) -> Result<Option<Vec<String>>, ReproductionError> {
    let (shipped, of_readings) = (experiment.shipped(), experiment.of_readings());
    if let Some(from) = &arguments.from {
        let has_all = runs.read(&shipped, from)?;
        runs.read(&of_readings, from)?;
        if !has_all {
            let from = from.display();
            arguments.work.note(&format!("{}: left out, because `{from}` has not all of its runs", experiment.id));
        }
        return Ok(has_all.then(Vec::new));
    }
    let wanted = if arguments.readings { [shipped, of_readings].concat() } else { shipped };
    let tell = |size: &str| arguments.work.note(&format!("{}: {size}", experiment.id));
    let new = runs.make(&wanted, tell, watcher);
    watcher.clear();
    runs.write_tables(&wanted, &arguments.out)?;
    let shipped = |new: Vec<Variant>| new.into_iter().filter(Variant::is_shipped).map(|variant| variant.scenario);
    new.map(|new| Some(shipped(new).collect()))
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
    let costs = Costs::measured();
    let header = ["id", "what", "runs", "CPU a run", "CPU in all", "scenarios"];
    let mut rows = vec![header.map(str::to_owned).to_vec()];
    let (mut all_s, mut unmeasured, mut counted_in) = (0.0, 0, BTreeSet::new());
    let all = experiments();
    for experiment in &all {
        let scenarios = experiment.scenarios();
        let run_s = costs.of_runs_s(scenarios.iter().copied());
        let runs = f64::from(experiment.runs.get());
        // Experiments share scenarios, and a scenario is run once.
        for scenario in scenarios.iter().copied().filter(|scenario| counted_in.insert(scenario.to_string())) {
            match costs.of_run_s(scenario) {
                Some(run_s) => all_s += runs * run_s,
                None => unmeasured += 1,
            }
        }
        let time = |runs: f64| run_s.map_or_else(|| "not measured".to_owned(), |run_s| duration(runs * run_s));
        let named = if scenarios.is_empty() { "none".to_owned() } else { scenarios.join(", ") };
        let (title, count) = (experiment.title.clone(), experiment.runs.to_string());
        rows.push(vec![experiment.id.clone(), title, count, time(1.0), time(runs), named]);
    }
    columns(&rows, &[Align::Left, Align::Left, Align::Right, Align::Right, Align::Right, Align::Left], stdout)?;
    let without = match unmeasured {
        0 => String::new(),
        count => format!(
            ", without {} that {} not measured",
            counted(count, "scenario"),
            if count == 1 { "was" } else { "were" }
        ),
    };
    writeln!(stdout, "\nall: {} of CPU time; a scenario of several tables counts once{without}", duration(all_s))?;
    writeln!(stdout, "times: {}; {}", costs.machine, costs.method)
}

/// A time in a unit in which it is not large.
fn duration(time_s: f64) -> String {
    match time_s {
        ..10.0 => format!("{time_s:.1} s"),
        ..120.0 => format!("{time_s:.0} s"),
        ..7200.0 => format!("{:.0} min", time_s / 60.0),
        _ => format!("{:.1} h", time_s / 3600.0),
    }
}

fn print(results: &Results, stdout: &mut impl Write) -> io::Result<()> {
    writeln!(stdout, "{} {}\n", results.id, results.title)?;
    let align = [Align::Left, Align::Right, Align::Left, Align::Right, Align::Left];
    let mut table = |header: [&str; 5], lines: &[Line]| {
        let mut rows = vec![header.map(str::to_owned).to_vec()];
        rows.extend(lines.iter().map(|line| line.cells().to_vec()));
        columns(&rows, &align, stdout)?;
        writeln!(stdout)
    };
    let ours = format!("ours (mean, 95 % interval, {})", results.runs());
    table(["", "published", "in", &ours, "verdict"], &results.lines)?;
    if !results.conclusions.is_empty() {
        table(["conclusion", "published", "in", "ours", "verdict"], &results.conclusions)?;
        writeln!(stdout, "  {MARGIN}")?;
    }
    for note in &results.notes {
        writeln!(stdout, "  {note}")?;
    }
    writeln!(stdout)
}

/// How many conclusions and numbers of each chapter have each verdict.
fn print_verdicts(finished: &[Results], stdout: &mut impl Write) -> io::Result<()> {
    let mut rows = vec![std::iter::once("verdicts").chain(Tally::header()).map(str::to_owned).collect::<Vec<_>>()];
    rows.extend(by_chapter(finished).into_iter().map(|(name, tally)| [vec![name], tally.cells()].concat()));
    let mut align = vec![Align::Right; rows[0].len()];
    align[0] = Align::Left;
    columns(&rows, &align, stdout)?;
    writeln!(stdout)
}

const MARGIN: &str = "A margin is the mean difference between runs of the same seed, in the comparison that decides the \
                      result, with its 95 % confidence interval. A margin above 0 supports the conclusion; if the \
                      interval contains 0, it cannot be told whether the conclusion holds.";
