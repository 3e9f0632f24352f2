//! Failures of commands: messages and exit codes.

use std::fmt;
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::process::ExitCode;

use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme, Report};
use sextant_kernel::Interrupted;
use sextant_mapper::MapError;

/// Why a command failed.
#[derive(Debug)]
pub enum Failure {
    /// Wrong usage or bad input, with all errors found. Exit code 2.
    BadInput(Vec<Report>),
    /// The input is good, but the work failed. Exit code 1.
    Failed(Report),
    /// Stopped by Ctrl-C or another signal. Exit code 130.
    Interrupted,
    /// The reader of standard output closed it, as `head` does. Exit code 0.
    Unread,
}

impl Failure {
    /// Bad input, in one sentence.
    pub fn bad_input(message: impl Into<String>) -> Self {
        Self::BadInput(vec![Report::new(Plain { message: message.into(), help: None })])
    }

    /// Bad input, in one sentence, and how to fix it.
    pub fn bad_input_with_help(message: impl Into<String>, help: impl Into<String>) -> Self {
        Self::BadInput(vec![Report::new(Plain { message: message.into(), help: Some(help.into()) })])
    }

    /// The work failed, in one sentence.
    pub fn failed(message: impl Into<String>) -> Self {
        Self::Failed(Report::new(Plain { message: message.into(), help: None }))
    }

    /// The file at `path` could not be written.
    #[must_use]
    pub fn unwritable(path: &Path, error: &io::Error) -> Self {
        Self::failed(format!("`{}` cannot be written: {error}", path.display()))
    }

    /// The exit code of the process.
    #[must_use]
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::BadInput(_) => ExitCode::from(2),
            Self::Failed(_) => ExitCode::from(1),
            Self::Interrupted => ExitCode::from(130),
            Self::Unread => ExitCode::SUCCESS,
        }
    }

    /// Prints the message on standard error.
    pub fn print(&self) {
        let text = match self {
            Self::BadInput(reports) => reports.iter().map(render).collect::<String>(),
            Self::Failed(report) => render(report),
            Self::Interrupted => "interrupted\n".to_owned(),
            Self::Unread => return,
        };
        // If standard error is closed, nobody can be told.
        let _ = io::stderr().write_all(text.as_bytes());
    }
}

/// The user stopped long work.
impl From<Interrupted> for Failure {
    fn from(_: Interrupted) -> Self {
        Self::Interrupted
    }
}

/// A map cannot be computed.
impl From<MapError> for Failure {
    fn from(error: MapError) -> Self {
        match error {
            MapError::Interrupted(_) => Self::Interrupted,
            error => Self::bad_input(error.to_string()),
        }
    }
}

/// Standard output could not be written.
impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        if error.kind() == io::ErrorKind::BrokenPipe {
            Self::Unread
        } else {
            Self::failed(format!("standard output cannot be written: {error}"))
        }
    }
}

/// Whether standard error may carry colours: it is a terminal, and `NO_COLOR` (no-color.org) is not set.
fn is_colourful() -> bool {
    io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

fn render(report: &Report) -> String {
    let theme = if is_colourful() { GraphicalTheme::unicode() } else { GraphicalTheme::unicode_nocolor() };
    let handler = GraphicalReportHandler::new_themed(theme).with_width(110).with_context_lines(1).with_links(false);
    let mut text = String::new();
    match handler.render_report(&mut text, report.as_ref()) {
        Ok(()) => text,
        Err(fmt::Error) => format!("{report}\n"),
    }
}

/// A message without a place in a file.
#[derive(Debug)]
struct Plain {
    message: String,
    help: Option<String>,
}

impl fmt::Display for Plain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Plain {}

impl Diagnostic for Plain {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help.as_ref().map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }
}
