//! A scenario as a tree of settings with their places in the source texts.

pub(crate) mod effective;
pub(crate) mod key_path;
pub(crate) mod layers;
pub(crate) mod setting_line;

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use toml::de::{DeTable, DeValue};

use super::error::ScenarioError;
use super::source::{Origin, Source};
use key_path::{KeyPath, PathStep};

/// A setting and its place in the source texts.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    pub(crate) value: Value,
    pub(crate) origin: Origin,
    /// The last source that set this or anything in it.
    pub(crate) layer: usize,
}

/// A table of settings.
pub(crate) type Table = BTreeMap<String, Entry>;

/// The value of a setting.
#[derive(Clone, Debug)]
pub(crate) enum Value {
    Boolean(bool),
    /// Within i64 or u64.
    Integer(i128),
    Float(f64),
    String(String),
    Datetime(String),
    Array(Vec<Entry>),
    Table(Table),
    /// Stands for a value that was rejected or is missing, while the rest is checked.
    Placeholder(Placeholder),
}

/// What stands for a value that was rejected or is missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Placeholder {
    /// Nothing: an optional setting has its default.
    Absent,
    /// The number 1, the first choice, a short text, an empty array, a table without settings.
    One,
    /// The same with the number 100.
    Large,
}

/// The merged settings of a scenario, and their sources.
#[derive(Clone, Debug)]
pub(crate) struct Document {
    pub(crate) root: Entry,
    pub(crate) sources: Vec<Source>,
    /// The text of the file or, if there are several layers, of the merged settings; without `--seed`.
    pub(crate) text: String,
}

impl Default for Document {
    /// No settings.
    fn default() -> Self {
        let origin = Origin { source: 0, key: None, value: 0..0 };
        let root = Entry { value: Value::Table(Table::new()), origin, layer: 0 };
        Self { root, sources: Vec::new(), text: String::new() }
    }
}

impl Document {
    /// The entry at `path` and true, or the deepest existing entry above it and false.
    pub(crate) fn nearest(&self, path: &KeyPath) -> (&Entry, bool) {
        let mut entry = &self.root;
        for step in &path.0 {
            match entry.child(step) {
                Some(child) => entry = child,
                None => return (entry, false),
            }
        }
        (entry, true)
    }

    /// The entry at `path`, to change.
    pub(crate) fn entry_mut(&mut self, path: &KeyPath) -> Option<&mut Entry> {
        path.0.iter().try_fold(&mut self.root, |entry, step| entry.child_mut(step))
    }

    /// The entry at `path`, to change. Tables on the way to it are added.
    pub(crate) fn entry_or_insert(&mut self, path: &KeyPath) -> Option<&mut Entry> {
        path.0.iter().try_fold(&mut self.root, |entry, step| {
            let fresh = Entry { value: Value::Table(Table::new()), origin: entry.origin.clone(), layer: entry.layer };
            if !matches!(entry.value, Value::Table(_) | Value::Array(_)) {
                entry.value = Value::Table(Table::new());
            }
            match (&mut entry.value, step) {
                (Value::Table(table), PathStep::Key(key)) => Some(table.entry(key.clone()).or_insert(fresh)),
                (Value::Array(items), step) => items.get_mut(step.index()?),
                _ => None,
            }
        })
    }
}

impl Entry {
    /// The entry one step down.
    pub(crate) fn child(&self, step: &PathStep) -> Option<&Self> {
        match (&self.value, step) {
            (Value::Table(table), PathStep::Key(key)) => table.get(key),
            (Value::Array(items), step) => items.get(step.index()?),
            _ => None,
        }
    }

    /// The entry one step down, to change.
    pub(crate) fn child_mut(&mut self, step: &PathStep) -> Option<&mut Self> {
        match (&mut self.value, step) {
            (Value::Table(table), PathStep::Key(key)) => table.get_mut(key),
            (Value::Array(items), step) => items.get_mut(step.index()?),
            _ => None,
        }
    }

    /// Overrides this entry by `over`: tables are merged key by key, all other values are replaced.
    pub(crate) fn overlay(&mut self, over: Self) {
        match (&mut self.value, over.value) {
            (Value::Table(under), Value::Table(table)) => {
                for (key, entry) in table {
                    match under.get_mut(&key) {
                        Some(existing) => existing.overlay(entry),
                        None => {
                            under.insert(key, entry);
                        }
                    }
                }
                self.origin = over.origin;
                self.layer = over.layer;
            }
            (_, value) => *self = Self { value, ..over },
        }
    }
}

impl Document {
    /// Changes the path `file`, the value at `key`, from relative to the layer that names it to relative to `folder`.
    pub(crate) fn rebase(&self, key: &str, file: &mut PathBuf, folder: &Path) {
        let Ok(path) = KeyPath::parse(key) else { return };
        let (entry, _) = self.nearest(&path);
        let from = &self.sources[entry.origin.source].folder;
        if from != folder
            && let Ok(path) = std::path::absolute(from.join(&*file))
        {
            *file = path;
        }
    }
}

/// Parses the text of `sources[index]`.
pub(crate) fn parse(sources: &[Source], index: usize) -> Result<Entry, ScenarioError> {
    let source = &sources[index];
    let root = DeTable::parse(&source.text).map_err(|error| ScenarioError::syntax(source, &error))?;
    let reader = Reader { sources, index, shift: 0 };
    let origin = Origin { source: index, key: None, value: 0..0 };
    Ok(Entry { value: reader.table(root.get_ref())?, origin, layer: index })
}

/// Parses one value at byte `shift` of `sources[index]`; `None` if it is not a TOML value.
pub(crate) fn parse_value(
    sources: &[Source],
    index: usize,
    shift: usize,
    text: &str,
) -> Result<Option<Value>, ScenarioError> {
    match DeValue::parse(text) {
        Ok(value) => {
            let span = value.span();
            Reader { sources, index, shift }.value(value.get_ref(), &span).map(Some)
        }
        Err(_) => Ok(None),
    }
}

/// Converts the parser's tree to ours.
struct Reader<'a> {
    sources: &'a [Source],
    index: usize,
    shift: usize,
}

impl Reader<'_> {
    fn moved(&self, span: &Range<usize>) -> Range<usize> {
        span.start + self.shift..span.end + self.shift
    }

    fn table(&self, table: &DeTable<'_>) -> Result<Value, ScenarioError> {
        let mut entries = Table::new();
        for (key, value) in table {
            let span = value.span();
            let origin = Origin { source: self.index, key: Some(self.moved(&key.span())), value: self.moved(&span) };
            let value = self.value(value.get_ref(), &span)?;
            entries.insert(key.get_ref().to_string(), Entry { value, origin, layer: self.index });
        }
        Ok(Value::Table(entries))
    }

    fn value(&self, value: &DeValue<'_>, span: &Range<usize>) -> Result<Value, ScenarioError> {
        Ok(match value {
            DeValue::String(text) => Value::String(text.to_string()),
            DeValue::Integer(integer) => {
                let number = i128::from_str_radix(integer.as_str(), integer.radix()).ok();
                let allowed = i128::from(i64::MIN)..=i128::from(u64::MAX);
                let Some(number) = number.filter(|number| allowed.contains(number)) else {
                    return Err(self.refuse(span, "this integer does not fit into 64 bits"));
                };
                Value::Integer(number)
            }
            DeValue::Float(float) => match float.as_str().parse() {
                Ok(number) => Value::Float(number),
                Err(_) => return Err(self.refuse(span, "this is not a number")),
            },
            DeValue::Boolean(boolean) => Value::Boolean(*boolean),
            DeValue::Datetime(datetime) => Value::Datetime(datetime.to_string()),
            DeValue::Array(items) => {
                let mut entries = Vec::with_capacity(items.len());
                for item in items {
                    let span = item.span();
                    let origin = Origin { source: self.index, key: None, value: self.moved(&span) };
                    entries.push(Entry { value: self.value(item.get_ref(), &span)?, origin, layer: self.index });
                }
                Value::Array(entries)
            }
            DeValue::Table(table) => self.table(table)?,
        })
    }

    fn refuse(&self, span: &Range<usize>, message: &str) -> ScenarioError {
        ScenarioError::new(message).at(&self.sources[self.index], self.moved(span), "here")
    }
}
