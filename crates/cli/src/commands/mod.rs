//! The command line: commands, flags and help texts, and the calls into the library.

mod antenna;
mod campaign;
mod check;
mod completions;
mod explain;
mod explain_link;
mod export;
mod figure;
mod floorplan;
mod init;
mod inspect;
mod live;
mod man;
mod map;
mod next;
mod options;
mod outputs;
mod path_flags;
mod plan_flags;
mod reading;
mod recover;
mod report;
mod reproduce;
mod run;
mod schema;
mod slurm_flags;
mod spoken;
mod sweep;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

pub(crate) use spoken::with_flags;

use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::invocation::Invocation;

/// Simulates wireless sensor networks and robots that listen to them, and computes maps of the nodes from the receptions.
#[derive(Debug, Parser)]
#[command(name = "sextant", version, max_term_width = 110)]
#[command(
    after_help = "Exit codes: 0 done, 1 failed, 2 usage or bad input, 130 interrupted, 75 terminated by a scheduler (parts of a plan)."
)]
pub(crate) struct Cli {
    /// The command.
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// A command.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Write a scenario to begin with, or the log of a robot, explained by its comments
    Init(init::Arguments),
    /// Simulate a scenario, record it, and map the nodes
    Run(run::Arguments),
    /// Map the nodes from a recording of `run` or from the log of a real robot
    Map(Box<map::Arguments>),
    /// Say where a robot should listen next, so that the map of its log becomes better
    Next(Box<next::Arguments>),
    /// Run a scenario with many settings and seeds, and write one table
    Sweep(Box<sweep::Arguments>),
    /// Reproduce the tables and figures of the thesis, beside the published values
    Reproduce(reproduce::Arguments),
    /// Check scenario files without running them
    Check(check::Arguments),
    /// Explain a key of a scenario: what it means, its unit, its default, its choices
    Explain(explain::Arguments),
    /// Explain a link: the power between two stations, item by item
    ExplainLink(explain_link::Arguments),
    /// Show what the sectors of an antenna cover, or make a code book of a measurement
    Antenna(Box<antenna::Arguments>),
    /// Make walls for a scenario from a floor plan
    Floorplan(floorplan::Arguments),
    /// Draw figures of the network, the maps and their errors
    Figure(figure::Arguments),
    /// Write a run, a log, a sweep or a reproduction as one HTML file for a browser
    Report(Box<report::Arguments>),
    /// Write every table of a recording as CSV or Parquet
    Export(export::Arguments),
    /// Print the contents of a recording, or of the log of a robot and what is odd in it
    Inspect(Box<inspect::Arguments>),
    /// Copy the readable part of a broken recording
    Recover(recover::Arguments),
    /// Print the JSON schema of scenario files
    Schema,
    /// Print a completion script for a shell
    Completions(completions::Arguments),
    /// Print the manual page (view it with `sextant man | man -l -`)
    Man(man::Arguments),
}

/// Runs the command line, prints what it prints, and returns its exit code. It takes over SIGINT, SIGTERM and SIGHUP, and the
/// global pool of threads; so call it once per process.
#[must_use]
pub fn main(invocation: &Invocation) -> ExitCode {
    let words = [OsString::from("sextant")].into_iter().chain(invocation.words().iter().cloned());
    let cli = match Cli::try_parse_from(words) {
        Ok(cli) => cli,
        Err(error) => {
            // Help and version come here too. If the terminal is closed, nobody can be told.
            let _ = error.print();
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    match execute(&cli.command, invocation) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.print(with_flags);
            failure.exit_code()
        }
    }
}

fn execute(command: &Command, invocation: &Invocation) -> Result<(), Failure> {
    let interrupt = Interrupt::install()?;
    match command {
        Command::Init(arguments) => init::execute(arguments),
        Command::Run(arguments) => run::execute(arguments, &interrupt),
        Command::Map(arguments) => map::execute(arguments, invocation, &interrupt),
        Command::Next(arguments) => next::execute(arguments, &interrupt),
        Command::Sweep(arguments) if campaign::is_asked_for(arguments) => {
            campaign::execute(arguments, invocation, &interrupt)
        }
        Command::Sweep(arguments) => sweep::execute(arguments, &interrupt),
        Command::Reproduce(arguments) => reproduce::execute(arguments, &interrupt),
        Command::Check(arguments) => check::execute(arguments),
        Command::Explain(arguments) => explain::execute(arguments),
        Command::ExplainLink(arguments) => explain_link::execute(arguments),
        Command::Antenna(arguments) => antenna::execute(arguments, &interrupt),
        Command::Floorplan(arguments) => floorplan::execute(arguments),
        Command::Figure(arguments) => figure::execute(arguments, &interrupt),
        Command::Report(arguments) => report::execute(arguments, &interrupt),
        Command::Export(arguments) => export::execute(arguments, &interrupt),
        Command::Inspect(arguments) => inspect::execute(arguments),
        Command::Recover(arguments) => recover::execute(arguments, &interrupt),
        Command::Schema => schema::execute(),
        Command::Completions(arguments) => completions::execute(arguments, Cli::command()),
        Command::Man(arguments) => man::execute(arguments, Cli::command()),
    }
}
