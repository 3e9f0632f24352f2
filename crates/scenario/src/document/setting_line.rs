//! A setting in one line: `path.to.key=value`.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::key_path::{KeyPath, PathStep};
use super::{Document, Entry, Table, Value, parse_value};
use crate::error::ScenarioError;
use crate::source::{Origin, SETTING, Source};

impl Document {
    /// Overrides a setting by the text `path.to.key=value`; `name` is its name in messages. Paths of files in it are relative to
    /// `folder`.
    ///
    /// # Errors
    /// If the text has another form, or names an entry that an array does not have.
    pub(crate) fn lay_setting(&mut self, name: &str, text: &str, folder: &Path) -> Result<(), ScenarioError> {
        let source = Source { name: name.to_owned(), text: Arc::from(text), folder: folder.to_owned() };
        self.sources.push(source);
        Line::read(&self.sources, self.sources.len() - 1)?.lay(&mut self.root)
    }
}

/// A setting in one line, read.
pub(crate) struct ReadSetting {
    pub(crate) path: KeyPath,
    pub(crate) value: Entry,
}

impl ReadSetting {
    /// Reads `path.to.key=value`.
    ///
    /// # Errors
    /// If the text has another form.
    pub(crate) fn of(text: &str) -> Result<Self, ScenarioError> {
        let source = Source { name: SETTING.to_owned(), text: Arc::from(text), folder: PathBuf::new() };
        let sources = [source];
        let mut line = Line::read(&sources, 0)?;
        let value = std::mem::replace(&mut line.value, Value::Boolean(false));
        let value = line.entry(value, 0..0);
        Ok(Self { path: KeyPath(line.steps.into_iter().map(|(step, _)| step).collect()), value })
    }
}

/// A parsed line.
struct Line<'a> {
    source: &'a Source,
    index: usize,
    /// The steps of the key, and the bytes of each.
    steps: Vec<(PathStep, Range<usize>)>,
    value: Value,
    value_span: Range<usize>,
}

impl<'a> Line<'a> {
    /// Parses the text of `sources[index]`. A value that is not TOML is a text without quotes, unless it begins like a
    /// quoted text, an array or a table.
    fn read(sources: &'a [Source], index: usize) -> Result<Self, ScenarioError> {
        let source = &sources[index];
        let Some((key, written)) = source.text.split_once('=') else {
            return Err(ScenarioError::new(format!("{} {} has no `=`", source.name, source.text))
                .at(source, 0..source.text.len(), "expected path.to.key=value")
                .help("for example: robots.0.speed_m_per_s=2"));
        };
        let steps = KeyPath::parse_spanned(key.trim_end()).map_err(|error| {
            ScenarioError::new(format!("{}: {}", source.name, error.message)).at(source, error.span, "here")
        })?;
        let start = source.text.len() - written.trim_start().len();
        let written = written.trim();
        let value_span = start..start + written.len();
        let value = match parse_value(sources, index, start, written)? {
            Some(value) => value,
            None if written.starts_with(['"', '\'', '[', '{']) || written.is_empty() => {
                return Err(ScenarioError::new(format!("{}: `{written}` is not a TOML value", source.name))
                    .at(source, value_span, "here")
                    .help("allowed: a number, true or false, a text, an array [..] or a table {..}"));
            }
            None => Value::String(written.to_owned()),
        };
        Ok(Self { source, index, steps, value, value_span })
    }

    /// Sets the value at its path in `root`.
    fn lay(mut self, root: &mut Entry) -> Result<(), ScenarioError> {
        let mut entry = root;
        let mut path = KeyPath::default();
        let mut last = 0..0;
        for (step, span) in std::mem::take(&mut self.steps) {
            if !matches!(entry.value, Value::Table(_) | Value::Array(_)) {
                // A choice written as a text is replaced by one written as a table.
                *entry = self.entry(Value::Table(Table::new()), last);
            }
            entry.layer = self.index;
            entry = self.child(entry, &path, &step, &span)?;
            path = path.child(step);
            last = span;
        }
        let value = std::mem::replace(&mut self.value, Value::Boolean(false));
        *entry = self.entry(value, last);
        Ok(())
    }

    /// A setting of this line, whose key is at the bytes `key`.
    fn entry(&self, value: Value, key: Range<usize>) -> Entry {
        let origin = Origin { source: self.index, key: Some(key), value: self.value_span.clone() };
        Entry { value, origin, layer: self.index }
    }

    /// The entry one `step` (at the bytes `span`) below `entry`, which is at `path`. It is added if a table lacks it.
    fn child<'e>(
        &self,
        entry: &'e mut Entry,
        path: &KeyPath,
        step: &PathStep,
        span: &Range<usize>,
    ) -> Result<&'e mut Entry, ScenarioError> {
        let refuse = |problem: String, label: String| {
            Err(ScenarioError::new(format!("{}: {problem}", self.source.name)).at(self.source, span.clone(), label))
        };
        match (&mut entry.value, step) {
            (Value::Table(table), PathStep::Key(key)) => {
                let fresh = || self.entry(Value::Table(Table::new()), span.clone());
                Ok(table.entry(key.clone()).or_insert_with(fresh))
            }
            (Value::Array(items), step) => match (step.index(), items.len()) {
                (Some(at), count) if at < count => Ok(&mut items[at]),
                (_, 0) => refuse(format!("`{path}` has 0 entries"), "it is empty".to_owned()),
                (_, 1) => refuse(format!("`{path}` has 1 entry"), "allowed: 0".to_owned()),
                (_, count) => refuse(format!("`{path}` has {count} entries"), format!("allowed: 0 to {}", count - 1)),
            },
            _ => refuse(format!("`{path}` is a table, not an array"), "a key is expected here".to_owned()),
        }
    }
}
