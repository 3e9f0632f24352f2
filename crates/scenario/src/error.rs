//! Errors of scenarios, with their place in the text.

use std::fmt;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use super::source::Source;

/// An error in a scenario: a message, the place in the text, and a help text.
#[derive(Clone, Debug)]
pub struct ScenarioError {
    message: String,
    excerpt: Option<Box<Excerpt>>,
    help: Option<String>,
    setting: Option<Box<RefusedSetting>>,
}

/// The setting that an error is about, for programs that correct it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RefusedSetting {
    /// Its key, `robots[0].speed_m_per_s` for example.
    pub key: String,
    /// What was found: its value, or an unknown name; `None` if it is missing.
    pub found: Option<String>,
    /// What is allowed, in words; `None` if the message alone says it.
    pub allowed: Option<String>,
}

/// The part of a text that an error points at.
#[derive(Clone, Debug)]
pub struct Excerpt {
    /// Name of the text: that of its file, or of a setting.
    pub source: String,
    /// The whole text.
    pub text: Arc<str>,
    /// The octets of the text that the error is about.
    pub span: Range<usize>,
    /// What is wrong there.
    pub label: String,
}

/// All errors found in one scenario; at least one.
#[derive(Clone, Debug)]
pub struct ScenarioErrors(Vec<ScenarioError>);

impl ScenarioErrors {
    /// The errors, if there are any.
    pub(crate) fn check(errors: Vec<ScenarioError>) -> Result<(), Self> {
        if errors.is_empty() { Ok(()) } else { Err(Self(errors)) }
    }

    /// The errors without duplicates, in the order of `sources`; those without a place come last.
    pub(crate) fn in_order(mut errors: Vec<ScenarioError>, sources: &[Source]) -> Option<Self> {
        errors.sort_by_key(|error| {
            let place = error.excerpt().map(|excerpt| {
                let source = sources.iter().position(|source| Arc::ptr_eq(&source.text, &excerpt.text));
                (source.unwrap_or(usize::MAX), excerpt.span.start)
            });
            place.unwrap_or((usize::MAX, usize::MAX))
        });
        let mut distinct: Vec<ScenarioError> = Vec::new();
        for error in errors {
            if !distinct.iter().any(|other| other.message == error.message && other.place() == error.place()) {
                distinct.push(error);
            }
        }
        Self::check(distinct).err()
    }

    /// The errors, in the order of the file.
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

impl ScenarioError {
    /// An error without a place.
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), excerpt: None, help: None, setting: None }
    }

    /// Points at `span` of `source`.
    pub(crate) fn at(mut self, source: &Source, span: Range<usize>, label: impl Into<String>) -> Self {
        self.excerpt = Some(Box::new(Excerpt {
            source: source.name.clone(),
            text: Arc::clone(&source.text),
            span,
            label: label.into(),
        }));
        self
    }

    /// Says which setting it is about.
    pub(crate) fn about(
        mut self,
        key: impl fmt::Display,
        found: Option<&str>,
        allowed: Option<impl fmt::Display>,
    ) -> Self {
        let (found, allowed) = (found.map(str::to_owned), allowed.map(|allowed| allowed.to_string()));
        self.setting = Some(Box::new(RefusedSetting { key: key.to_string(), found, allowed }));
        self
    }

    /// The setting that it is about, if it is about one.
    #[must_use]
    pub fn setting(&self) -> Option<&RefusedSetting> {
        self.setting.as_deref()
    }

    /// Its place as `file:line:column`, if it has one; lines and columns are counted from 1.
    #[must_use]
    pub fn place(&self) -> Option<String> {
        let (line, column) = self.line_and_column()?;
        Some(format!("{}:{line}:{column}", self.excerpt()?.source))
    }

    /// Its line and column in the text of its [excerpt](Self::excerpt), both counted from 1.
    #[must_use]
    pub fn line_and_column(&self) -> Option<(usize, usize)> {
        let Excerpt { text, span, .. } = self.excerpt()?;
        let before = &text[..span.start];
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
        Some((line, column))
    }

    /// The part of the text that it points at, if there is one.
    #[must_use]
    pub fn excerpt(&self) -> Option<&Excerpt> {
        self.excerpt.as_deref()
    }

    /// How to correct it, if the message does not say so.
    #[must_use]
    pub fn advice(&self) -> Option<&str> {
        self.help.as_deref()
    }

    /// The same error with its place, but without any text of the file.
    pub(crate) fn discreet(self) -> Self {
        let place = self.place().unwrap_or_default();
        let advice = "its content is not shown, because it is in another folder; is it a scenario?";
        Self::new(format!("{place}: this is not valid TOML")).help(advice)
    }

    /// The same with what to do about it.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// The error that `path` cannot be read.
    #[must_use]
    pub fn unreadable(path: &Path, error: &std::io::Error) -> Self {
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
            std::io::ErrorKind::FileTooLarge => Self::new(format!("`{name}` is no scenario: {error}")),
            _ => Self::new(format!("`{name}` cannot be read: {error}")),
        }
    }

    /// The error that the text of `source` is not TOML.
    pub(crate) fn syntax(source: &Source, error: &toml::de::Error) -> Self {
        let end = source.text.len();
        let span = error.span().unwrap_or(end..end);
        let message = error.message().trim().replace('\n', ", ");
        let message = message.trim_end_matches(", expected nothing");
        Self::new(format!("{} is not valid TOML: {message}", source.name)).at(source, span, "here")
    }
}

impl fmt::Display for ScenarioError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for ScenarioError {}
