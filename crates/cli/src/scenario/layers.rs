//! A scenario in layers: the file that it extends, the file itself, the flags of the command line.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::document::{self, Document, Entry, Table, Value};
use super::effective;
use super::error::ScenarioError;
use super::key_path::{KeyPath, Step};
use super::source::{Origin, Source};

/// Reads `path`, all that it extends, and lays `overrides` (each `path.to.key=value`) on top.
///
/// Tables are merged key by key; anything else, arrays included, is replaced by the later layer.
pub(crate) fn read(path: &Path, overrides: &[String], seed: Option<u64>) -> Result<Document, ScenarioError> {
    let mut sources = Vec::new();
    let mut root = read_file(path, &mut sources, &mut Vec::new(), None)?;
    let folder = folder_of(path);
    for flag in overrides {
        let text: Arc<str> = Arc::from(flag.as_str());
        sources.push(Source { name: "--set".to_owned(), text, folder: folder.clone() });
        lay_flag(&mut root, &sources)?;
    }
    let text = match sources.as_slice() {
        [only] => only.text.to_string(),
        layers => effective::text(&root, layers),
    };
    if let Some(seed) = seed {
        sources.push(Source { name: "--seed".to_owned(), text: Arc::from(format!("seed={seed}")), folder });
        lay_flag(&mut root, &sources)?;
    }
    Ok(Document { root, sources, text })
}

fn folder_of(path: &Path) -> PathBuf {
    path.parent().map(Path::to_path_buf).unwrap_or_default()
}

/// The file that names another one, and where.
type Mention<'a> = (&'a Source, std::ops::Range<usize>);

fn read_file(
    path: &Path,
    sources: &mut Vec<Source>,
    chain: &mut Vec<(PathBuf, String)>,
    mention: Option<Mention<'_>>,
) -> Result<Entry, ScenarioError> {
    let placed = |error: ScenarioError| match &mention {
        Some((source, span)) => error.at(source, span.clone(), "extended here"),
        None => error,
    };
    let unreadable = |error: &std::io::Error| placed(ScenarioError::unreadable(path, error));
    let identity = path.canonicalize().map_err(|error| unreadable(&error))?;
    let name = path.display().to_string();
    if let Some(first) = chain.iter().position(|(seen, _)| *seen == identity) {
        let mut ring: Vec<_> = chain[first..].iter().map(|(_, name)| name.as_str()).collect();
        ring.push(&name);
        return Err(placed(ScenarioError::new(format!("`extends` runs in a circle: {}", ring.join(" -> ")))));
    }
    let bytes = std::fs::read(path).map_err(|error| unreadable(&error))?;
    let text = String::from_utf8(bytes)
        .map_err(|error| unreadable(&std::io::Error::new(std::io::ErrorKind::InvalidData, error.utf8_error())))?;
    chain.push((identity, name.clone()));
    let source = Source { name, text: Arc::from(text), folder: folder_of(path) };
    let index = sources.len();
    sources.push(source.clone());
    let mut own = document::parse(sources, index)?;
    let base = match &mut own.value {
        Value::Table(table) => table.remove("extends"),
        _ => None,
    };
    let Some(base) = base else { return Ok(own) };
    let Value::String(file) = &base.value else {
        return Err(ScenarioError::new("`extends` is not a text; allowed: the path of one scenario file").at(
            &source,
            base.origin.value,
            "here",
        ));
    };
    // The base comes first in the order of sources, because later ones override.
    sources.truncate(index);
    let mention = Some((&source, base.origin.value.clone()));
    let mut root = read_file(&source.folder.join(file), sources, chain, mention)?;
    own.renumber(sources.len());
    sources.push(source);
    root.overlay(own);
    Ok(root)
}

impl Entry {
    fn renumber(&mut self, source: usize) {
        self.origin.source = source;
        self.layer = source;
        match &mut self.value {
            Value::Array(items) => items.iter_mut().for_each(|item| item.renumber(source)),
            Value::Table(table) => table.values_mut().for_each(|entry| entry.renumber(source)),
            _ => {}
        }
    }
}

/// Lays the last source, a flag `path.to.key=value`, on `root`.
pub(crate) fn lay_flag(root: &mut Entry, sources: &[Source]) -> Result<(), ScenarioError> {
    let index = sources.len() - 1;
    let flag = &sources[index];
    let whole = 0..flag.text.len();
    let Some(equals) = flag.text.find('=') else {
        return Err(ScenarioError::new(format!("{} {} has no `=`", flag.name, flag.text))
            .at(flag, whole, "expected path.to.key=value")
            .help("for example: --set robots.0.speed_m_per_s=2"));
    };
    let steps = KeyPath::parse_spanned(flag.text[..equals].trim_end()).map_err(|error| {
        ScenarioError::new(format!("{}: {}", flag.name, error.message)).at(flag, error.span, "here")
    })?;
    let written = &flag.text[equals + 1..];
    let start = equals + 1 + (written.len() - written.trim_start().len());
    let written = written.trim();
    let value = match document::parse_value(sources, index, start, written)? {
        Some(value) => value,
        None if written.starts_with(['"', '\'', '[', '{']) || written.is_empty() => {
            return Err(ScenarioError::new(format!("{}: `{written}` is no TOML value", flag.name))
                .at(flag, start..start + written.len(), "here")
                .help("allowed: a number, true or false, a text, an array [..] or a table {..}"));
        }
        None => Value::String(written.to_owned()),
    };
    let value_span = start..start + written.len();
    let mut entry = root;
    let mut path = KeyPath::default();
    let mut last = 0..0;
    for (step, span) in steps {
        let origin = Origin { source: index, key: Some(span.clone()), value: value_span.clone() };
        if !matches!(entry.value, Value::Table(_) | Value::Array(_)) {
            // A choice written as a text makes place for one written as a table.
            entry.value = Value::Table(Table::new());
            entry.origin = Origin { source: index, key: Some(last.clone()), value: value_span.clone() };
        }
        entry.layer = index;
        entry = match (&mut entry.value, &step) {
            (Value::Table(table), Step::Key(key)) => {
                let fresh = || Entry { value: Value::Table(Table::new()), origin, layer: index };
                table.entry(key.clone()).or_insert_with(fresh)
            }
            (Value::Array(items), step) => {
                let count = items.len();
                let Some(item) = step.index().and_then(|i| items.get_mut(i)) else {
                    let allowed = match count {
                        0 => "it is empty".to_owned(),
                        1 => "allowed: 0".to_owned(),
                        count => format!("allowed: 0 to {}", count - 1),
                    };
                    let entries = if count == 1 { "entry" } else { "entries" };
                    return Err(ScenarioError::new(format!("{}: `{path}` has {count} {entries}", flag.name))
                        .at(flag, span, allowed));
                };
                item
            }
            _ => {
                return Err(ScenarioError::new(format!("{}: `{path}` is a table, not an array", flag.name)).at(
                    flag,
                    span,
                    "a key is wanted here",
                ));
            }
        };
        path = path.child(step);
        last = span;
    }
    *entry = Entry { value, origin: Origin { source: index, key: Some(last), value: value_span }, layer: index };
    Ok(())
}
