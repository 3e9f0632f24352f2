//! Failures of commands: messages and exit codes.

use std::fmt;
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::process::ExitCode;

use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme, LabeledSpan, NamedSource, Report, SourceCode};
use sextant::LinkError;
use sextant::antenna::{BookError, ConvertError};
use sextant::export::ExportError;
use sextant::floorplan::{self, FloorPlanError};
use sextant::mapping::MapLogError;
use sextant::next::NextError;
use sextant::run::RunError;
use sextant::scenario::{ScenarioError, ScenarioErrors};
use sextant_kernel::Interrupted;
use sextant_kernel::text::{is_harmful, message, printable};
use sextant_logs::RobotLogError;
use sextant_recording::RecordingError;
use sextant_recording::admission::OutputRefusal;
use sextant_recording::output::OutputError;
use sextant_report::ReportError;
use sextant_study::campaign::CampaignError;
use sextant_study::sweep::{SweepError, TableError};
use sextant_thesis::ReproductionError;

/// Why a command failed.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Wrong usage or bad input, with all errors found. Exit code 2.
    BadInput(Vec<Report>),
    /// The input is good, but the work failed. Exit code 1.
    Failed(Report),
    /// Stopped by Ctrl-C or another signal. Exit code 130.
    Interrupted,
    /// Stopped by a scheduler; it may go on later. Exit code 75 (`EX_TEMPFAIL` of BSD).
    Terminated,
    /// The reader of standard output closed it, as `head` does. Exit code 0.
    Unread,
}

impl Failure {
    /// What went wrong, without how to fix it.
    pub(crate) fn text(&self) -> String {
        match self {
            Self::BadInput(reports) => reports.iter().map(Report::to_string).collect::<Vec<_>>().join("; "),
            Self::Failed(report) => report.to_string(),
            Self::Interrupted | Self::Terminated => "it was stopped".to_owned(),
            Self::Unread => "nobody reads it".to_owned(),
        }
    }

    /// Bad input, in one sentence.
    pub(crate) fn bad_input(message: impl Into<String>) -> Self {
        Self::BadInput(vec![Report::new(Message { text: message.into(), help: None, excerpt: None })])
    }

    /// Bad input, in one sentence, and how to fix it.
    pub(crate) fn bad_input_with_help(message: impl Into<String>, help: impl Into<String>) -> Self {
        Self::BadInput(vec![Report::new(Message { text: message.into(), help: Some(help.into()), excerpt: None })])
    }

    /// An error of the library; `is_system_error` if the disk or the system caused it, not the input.
    fn of(error: &dyn std::error::Error, help: Option<&str>, is_system_error: bool) -> Self {
        let message = Message { text: error.to_string(), help: help.map(str::to_owned), excerpt: None };
        let report = Report::new(message);
        if is_system_error { Self::Failed(report) } else { Self::BadInput(vec![report]) }
    }

    /// The work failed, in one sentence.
    pub(crate) fn failed(message: impl Into<String>) -> Self {
        Self::Failed(Report::new(Message { text: message.into(), help: None, excerpt: None }))
    }

    /// The file at `path` could not be written.
    #[must_use]
    pub(crate) fn unwritable(path: &Path, error: &io::Error) -> Self {
        Self::failed(format!("`{}` cannot be written: {error}", path.display()))
    }

    /// The exit code of the process.
    #[must_use]
    pub(crate) fn exit_code(&self) -> ExitCode {
        match self {
            Self::BadInput(_) => ExitCode::from(2),
            Self::Failed(_) => ExitCode::from(1),
            Self::Interrupted => ExitCode::from(130),
            Self::Terminated => ExitCode::from(75),
            Self::Unread => ExitCode::SUCCESS,
        }
    }

    /// Prints the message on standard error, in the words that `speak` makes of those of the library.
    pub(crate) fn print(&self, speak: impl Fn(&str) -> String) {
        let spoken = |report: &Report| match report.downcast_ref::<Message>() {
            Some(message) => {
                render(&Report::new(Message { text: speak(&message.text), ..message.clone() }.printable()))
            }
            None => render(report),
        };
        let text = match self {
            Self::BadInput(reports) => reports.iter().map(spoken).collect::<String>(),
            Self::Failed(report) => spoken(report),
            Self::Interrupted => "interrupted\n".to_owned(),
            Self::Terminated => "terminated; finished runs are kept\n".to_owned(),
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

/// A scenario is invalid: each error with its place in the file.
impl From<ScenarioErrors> for Failure {
    fn from(errors: ScenarioErrors) -> Self {
        Self::BadInput(errors.errors().iter().map(report).collect())
    }
}

/// An error of a scenario as it is printed.
pub(crate) fn report(error: &ScenarioError) -> Report {
    let excerpt = error.excerpt().map(|excerpt| {
        let label = LabeledSpan::new_primary_with_span(Some(excerpt.label.clone()), excerpt.span.clone());
        Excerpt { source: NamedSource::new(&excerpt.source, excerpt.text.to_string()), label }
    });
    Report::new(Message { text: error.to_string(), help: error.advice().map(str::to_owned), excerpt })
}

impl From<BookError> for Failure {
    fn from(error: BookError) -> Self {
        Self::of(&error, None, false)
    }
}

impl From<FloorPlanError> for Failure {
    fn from(error: FloorPlanError) -> Self {
        let help = match &error {
            FloorPlanError::NoScale { .. } => {
                Some("divide a known length by its pixels: --scale 0.02 is 2 cm a pixel")
            }
            FloorPlanError::NoUnit { .. } => {
                Some("measure a door: --unit mm if it is about 900 wide, --unit m if it is 0.9")
            }
            FloorPlanError::NotDegrees { .. } => {
                Some("--unit m if they are metres; otherwise keep the building alone")
            }
            FloorPlanError::NoWalls { path, .. } if floorplan::is_traced(path) => {
                Some("walls are dark; what is thicker than --thickest is no wall")
            }
            _ => None,
        };
        Self::of(&error, help, matches!(error, FloorPlanError::Read { .. }))
    }
}

impl From<ConvertError> for Failure {
    fn from(error: ConvertError) -> Self {
        let advice = match &error {
            ConvertError::Missing { .. } => "name it: --sector, --azimuth, --elevation or --gain NAME".to_owned(),
            ConvertError::Shape { .. } => {
                "the order of the axes in the file: --order sector,elevation,azimuth".to_owned()
            }
            ConvertError::UnknownUnit { .. } => "the unit: --unit linear, --unit db or --unit dbi".to_owned(),
            ConvertError::UnknownAngles { .. } => "angles in radians: --radians; in degrees: --degrees".to_owned(),
            ConvertError::AngleUnits { .. } => "leave out --radians or --degrees, or rename the column".to_owned(),
            ConvertError::UnknownOrigin { name, .. } => {
                format!("angles from the zenith: --zenith; from the horizontal plane: --elevation '{name}'")
            }
            ConvertError::UnknownTurning => "--azimuths clockwise, or --azimuths counterclockwise".to_owned(),
            ConvertError::SeveralGains { .. } => "the one to take: --gain NAME".to_owned(),
            ConvertError::Elevation { .. } => "angles from the zenith: --zenith".to_owned(),
            ConvertError::Identity { .. } => "a sector that is the listening pattern: --quasi-omni ID".to_owned(),
            ConvertError::Invalid { .. }
            | ConvertError::Unreadable { .. }
            | ConvertError::Foreign { .. }
            | ConvertError::Mat(_)
            | ConvertError::Option { .. } => {
                return Self::of(&error, None, false);
            }
        };
        Self::of(&error, Some(&advice), false)
    }
}

impl From<LinkError> for Failure {
    fn from(error: LinkError) -> Self {
        Self::of(&error, None, false)
    }
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        match &error {
            RunError::Interrupted(_) => Self::Interrupted,
            _ => Self::of(&error, error.advice(), error.is_system_error()),
        }
    }
}

impl From<MapLogError> for Failure {
    fn from(error: MapLogError) -> Self {
        match error {
            MapLogError::Interrupted(_) => Self::Interrupted,
            MapLogError::Settings(errors) => errors.into(),
            MapLogError::Recording(error) => error.into(),
            error => Self::of(&error, None, error.is_system_error()),
        }
    }
}

impl From<NextError> for Failure {
    fn from(error: NextError) -> Self {
        match error {
            NextError::Interrupted(_) => Self::Interrupted,
            NextError::Map(error) => error.into(),
            error => Self::of(&error, error.advice(), error.is_system_error()),
        }
    }
}

impl From<SweepError> for Failure {
    fn from(error: SweepError) -> Self {
        match error {
            SweepError::Interrupted(_) => Self::Interrupted,
            SweepError::Scenario(errors) => errors.into(),
            SweepError::Unfinished { .. } => {
                Self::of(&error, Some("continue it with --resume, or remove the folder to start again"), false)
            }
            SweepError::OtherParts { .. } => {
                Self::of(&error, Some("remove the folder to start again, or choose another --out"), false)
            }
            error => Self::of(&error, error.advice(), error.is_system_error()),
        }
    }
}

impl From<CampaignError> for Failure {
    fn from(error: CampaignError) -> Self {
        match error {
            CampaignError::Interrupted(_) => Self::Interrupted,
            CampaignError::Scenario(errors) => errors.into(),
            CampaignError::Table(error) => error.into(),
            error => Self::of(&error, error.advice(), error.is_system_error()),
        }
    }
}

impl From<ReportError> for Failure {
    fn from(error: ReportError) -> Self {
        match error {
            ReportError::Recording(error) => error.into(),
            ReportError::Table(error) => error.into(),
            error => Self::of(&error, None, false),
        }
    }
}

impl From<ExportError> for Failure {
    fn from(error: ExportError) -> Self {
        match error {
            ExportError::Interrupted(_) => Self::Interrupted,
            error => Self::of(&error, error.advice(), error.is_system_error()),
        }
    }
}

impl From<TableError> for Failure {
    fn from(error: TableError) -> Self {
        Self::of(&error, error.advice().as_deref(), error.is_system_error())
    }
}

impl From<ReproductionError> for Failure {
    fn from(error: ReproductionError) -> Self {
        match error {
            ReproductionError::Interrupted(_) => Self::Interrupted,
            ReproductionError::Scenario(errors) => errors.into(),
            ReproductionError::Sweep(error) => error.into(),
            ReproductionError::Run(error) => error.into(),
            error => Self::of(&error, None, error.is_system_error()),
        }
    }
}

impl From<RecordingError> for Failure {
    fn from(error: RecordingError) -> Self {
        match error {
            RecordingError::Interrupted(_) => Self::Interrupted,
            error => Self::of(&error, None, error.is_system_error()),
        }
    }
}

impl From<RobotLogError> for Failure {
    fn from(error: RobotLogError) -> Self {
        Self::of(&error, None, error.is_system_error())
    }
}

impl From<OutputRefusal> for Failure {
    fn from(refusal: OutputRefusal) -> Self {
        let advice = match &refusal {
            OutputRefusal::Foreign { .. } | OutputRefusal::Exists { .. } => {
                Some("choose another name, or replace it with --force")
            }
            OutputRefusal::Folder { .. } => Some("choose another folder, or write into this one with --force"),
            other => other.advice(),
        };
        Self::of(&refusal, advice, false)
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        Self::of(&error, None, true)
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

/// A message, with its place in a file if it has one.
#[derive(Clone, Debug)]
struct Message {
    text: String,
    help: Option<String>,
    excerpt: Option<Excerpt>,
}

impl Message {
    /// The same without control characters of files of others, and without lines that fill a screen.
    fn printable(self) -> Self {
        let excerpt = self.excerpt.and_then(Excerpt::printable);
        Self { text: message(&self.text), help: self.help.map(|help| message(&help)), excerpt }
    }
}

/// The longest line of a file that is shown (octets).
const LONGEST_LINE: usize = 1000;

impl Excerpt {
    /// The same with each harmful character replaced by as many question marks as it has octets, so that places stay.
    /// Nothing if the line is too long to be shown.
    fn printable(self) -> Option<Self> {
        let Self { source, label } = self;
        let (name, text) = (source.name(), source.inner());
        let (start, end) = (label.offset().min(text.len()), (label.offset() + label.len()).min(text.len()));
        let from = text[..start].rfind('\n').map_or(0, |at| at + 1);
        let to = text[end..].find('\n').map_or(text.len(), |at| end + at);
        if text[from..to].lines().any(|line| line.len() > LONGEST_LINE) {
            return None;
        }
        let is_hidden = |c: char| is_harmful(c) && c != '\r';
        let plain = |c: char| if is_hidden(c) { "?".repeat(c.len_utf8()) } else { c.to_string() };
        let text: String = if text.contains(is_hidden) { text.chars().map(plain).collect() } else { text.clone() };
        Some(Self { source: NamedSource::new(printable(name), text), label })
    }
}

/// The part of a file that a message is about.
#[derive(Clone, Debug)]
struct Excerpt {
    source: NamedSource<String>,
    label: LabeledSpan,
}

impl fmt::Display for Message {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl std::error::Error for Message {}

impl Diagnostic for Message {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help.as_ref().map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.excerpt.as_ref().map(|excerpt| &excerpt.source as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let excerpt = self.excerpt.as_ref()?;
        Some(Box::new(std::iter::once(excerpt.label.clone())))
    }
}
