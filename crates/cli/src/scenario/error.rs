//! What is wrong with a scenario, and where.

use std::fmt;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use miette::{Diagnostic, LabeledSpan, NamedSource, Report, SourceCode};
use sextant_kernel::SettingError;

use super::document::{Document, Entry, Origin, Source, Value};
use super::key_path::{KeyPath, Step};
use crate::diagnostic::Failure;

/// One thing that is wrong with a scenario: a message, the place in the text, and what to do.
#[derive(Clone, Debug)]
pub struct ScenarioError {
    message: String,
    place: Option<Box<Place>>,
    help: Option<String>,
}

/// A piece of a source, and what is said of it.
#[derive(Clone, Debug)]
struct Place {
    source: NamedSource<Arc<str>>,
    span: Range<usize>,
    label: String,
}

/// Everything found wrong with one scenario; never empty.
#[derive(Clone, Debug)]
pub struct ScenarioErrors(Vec<ScenarioError>);

impl ScenarioErrors {
    /// The errors, if there are any.
    pub(crate) fn check(errors: Vec<ScenarioError>) -> Result<(), Self> {
        if errors.is_empty() { Ok(()) } else { Err(Self(errors)) }
    }

    /// The errors, in the order of the scenario's parts.
    #[must_use]
    pub fn errors(&self) -> &[ScenarioError] {
        &self.0
    }
}

impl From<ScenarioError> for ScenarioErrors {
    fn from(error: ScenarioError) -> Self {
        Self(vec![error])
    }
}

impl fmt::Display for ScenarioErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, error) in self.0.iter().enumerate() {
            if i > 0 {
                f.write_str("; ")?;
            }
            write!(f, "{error}")?;
        }
        Ok(())
    }
}

impl std::error::Error for ScenarioErrors {}

impl From<ScenarioErrors> for Failure {
    fn from(errors: ScenarioErrors) -> Self {
        Self::BadInput(errors.0.into_iter().map(Report::new).collect())
    }
}

impl ScenarioError {
    pub(crate) fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), place: None, help: None }
    }

    /// Points at `span` of `source`.
    pub(crate) fn at(mut self, source: &Source, span: Range<usize>, label: impl Into<String>) -> Self {
        self.place = Some(Box::new(Place {
            source: NamedSource::new(&source.name, Arc::clone(&source.text)),
            span,
            label: label.into(),
        }));
        self
    }

    /// Where it points, as `file:line:column`, if anywhere; lines and columns count from 1.
    #[must_use]
    pub fn place(&self) -> Option<String> {
        let Place { source, span, .. } = self.place.as_deref()?;
        let before = &source.inner()[..span.start];
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
        Some(format!("{}:{line}:{column}", source.name()))
    }

    pub(crate) fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// `path` cannot be read.
    pub(crate) fn unreadable(path: &Path, error: &std::io::Error) -> Self {
        let name = path.display();
        if path.is_dir() {
            return Self::new(format!("`{name}` is a folder, not a scenario"))
                .help("name the scenario file in it, FOLDER/NAME.toml");
        }
        match error.kind() {
            std::io::ErrorKind::NotFound => Self::new(format!("there is no file `{name}`")),
            std::io::ErrorKind::InvalidData => {
                Self::new(format!("`{name}` is not UTF-8 text")).help("a scenario is a text file in the TOML format")
            }
            _ => Self::new(format!("`{name}` cannot be read: {error}")),
        }
    }

    /// The text of `source` is not TOML.
    pub(crate) fn syntax(source: &Source, error: &toml::de::Error) -> Self {
        let end = source.text.len();
        let span = error.span().unwrap_or(end..end);
        let message = error.message().trim().replace('\n', ", ");
        let message = message.trim_end_matches(", expected nothing");
        Self::new(format!("{} is not valid TOML: {message}", source.name)).at(source, span, "here")
    }

    /// A value outside its domain, found at `error.key` from the top of the document.
    pub(crate) fn setting(document: &Document, error: &SettingError) -> Self {
        let this = Self::new(error.to_string());
        match KeyPath::parse(&error.key) {
            Ok(path) => {
                let (entry, exact) = document.nearest(&path);
                let label = if exact { value_label(&error.allowed) } else { "in this table".to_owned() };
                this.pointing(document, entry, exact, label)
            }
            Err(_) => this,
        }
    }

    /// A refusal by serde, found at `path`.
    pub(crate) fn refusal(document: &Document, path: &KeyPath, refusal: &super::Refusal) -> Self {
        use super::Refusal;
        let (entry, exact) = document.nearest(path);
        // The path to an unknown key may end at the key or at its table.
        let step = Step::Key(refusal.name().to_owned());
        let (table, entry_of) = match (path.0.split_last(), entry.child(&step)) {
            (_, Some(child)) => (path.clone(), child),
            (Some((last, above)), None) if *last == step => (KeyPath(above.to_vec()), entry),
            _ => (path.clone(), entry),
        };
        let place = if table.0.is_empty() { "the scenario".to_owned() } else { format!("`{table}`") };
        match refusal {
            Refusal::UnknownField { field, expected } => Self::new(format!("unknown key `{field}` in {place}"))
                .pointing_at_key(document, &entry_of.origin, suggestion(field, expected, "no such key"))
                .help(allowed("keys allowed here", expected)),
            Refusal::UnknownVariant { variant, expected } => {
                let is_key = matches!(entry.value, Value::Table(_)) || !exact;
                let label = suggestion(variant, expected, "no such choice");
                let this = Self::new(format!("unknown choice `{variant}` for {place}"));
                let this = if is_key {
                    this.pointing_at_key(document, &entry_of.origin, label)
                } else {
                    this.pointing(document, entry, true, label)
                };
                this.help(allowed("choices", expected))
            }
            Refusal::MissingField(field) => Self::new(format!("`{field}` is missing in {place}"))
                .pointing_at_key(document, &entry.origin, "this table needs it")
                .help(format!("write `{} = ..`", path.child(Step::Key((*field).to_owned())))),
            Refusal::Unfit { found, expected } => Self::new(format!("`{path}` is {found}; allowed: {expected}"))
                .pointing(document, entry, exact, value_label(expected)),
            Refusal::Other(message) => {
                let message = if path.0.is_empty() { message.clone() } else { format!("`{path}`: {message}") };
                Self::new(message).pointing(document, entry, exact, "here")
            }
        }
    }

    /// Points at the value of `entry`, or at its key where the value is a table or not the very one meant.
    fn pointing(self, document: &Document, entry: &Entry, exact: bool, label: impl Into<String>) -> Self {
        let origin = &entry.origin;
        let whole = matches!(entry.value, Value::Table(_)) || !exact;
        let span = if whole { origin.head() } else { origin.value.clone() };
        self.at(&document.sources[origin.source], span, label)
    }

    fn pointing_at_key(self, document: &Document, origin: &Origin, label: impl Into<String>) -> Self {
        self.at(&document.sources[origin.source], origin.head(), label)
    }
}

impl fmt::Display for ScenarioError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for ScenarioError {}

impl Diagnostic for ScenarioError {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help.as_ref().map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.place.as_deref().map(|place| &place.source as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let Place { span, label, .. } = self.place.as_deref()?;
        let label = LabeledSpan::new_primary_with_span(Some(label.clone()), span.clone());
        Some(Box::new(std::iter::once(label)))
    }
}

/// What stands below a value outside its domain; what is allowed again only if it is short.
fn value_label(allowed: &str) -> String {
    if allowed.chars().count() <= 50 { format!("allowed: {allowed}") } else { "this value".to_owned() }
}

/// "did you mean ..?" if one of `expected` is close to `found`, else `otherwise`.
fn suggestion(found: &str, expected: &[&str], otherwise: &str) -> String {
    let closest = expected
        .iter()
        .map(|name| (strsim::jaro_winkler(found, name), name))
        .max_by(|(a, _), (b, _)| a.total_cmp(b))
        .filter(|(likeness, _)| *likeness > 0.8);
    match closest {
        Some((_, name)) => format!("did you mean `{name}`?"),
        None => otherwise.to_owned(),
    }
}

fn allowed(what: &str, expected: &[&str]) -> String {
    if expected.is_empty() {
        return format!("{what}: none");
    }
    let names: Vec<_> = expected.iter().map(|name| format!("`{name}`")).collect();
    format!("{what}: {}", names.join(", "))
}
