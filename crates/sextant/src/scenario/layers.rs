//! The layers of a scenario: the file that it extends, the file itself, and the flags of the command line.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::document::{self, Document, Entry, Value};
use super::effective;
use super::error::ScenarioError;
use super::source::Source;

/// Reads `path` and the files that it extends, and overrides their settings by `overrides` (each `path.to.key=value`).
///
/// Tables are merged key by key. A later layer replaces all other values, also arrays.
pub(crate) fn read(path: &Path, overrides: &[String], seed: Option<u64>) -> Result<Document, ScenarioError> {
    let mut sources = Vec::new();
    let root = read_file(path, &mut sources, &mut Vec::new(), None)?;
    let mut document = Document { root, sources, text: String::new() };
    let folder = folder_of(path);
    for flag in overrides {
        document.lay_flag("--set", flag, &folder)?;
    }
    document.text = match document.sources.as_slice() {
        [only] => only.text.to_string(),
        layers => effective::text(&document.root, layers),
    };
    if let Some(seed) = seed {
        document.lay_flag("--seed", &format!("seed={seed}"), &folder)?;
    }
    Ok(document)
}

impl Document {
    /// Overrides settings by those of a text; `name` is its name in messages.
    pub(super) fn lay_text(&mut self, name: &str, text: &str) -> Result<(), ScenarioError> {
        let source = Source { name: name.to_owned(), text: Arc::from(text), folder: PathBuf::new() };
        self.sources.push(source);
        self.root.overlay(document::parse(&self.sources, self.sources.len() - 1)?);
        Ok(())
    }
}

fn folder_of(path: &Path) -> PathBuf {
    path.parent().map(Path::to_path_buf).unwrap_or_default()
}

/// The place where a file names another file.
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
        return Err(placed(ScenarioError::new(format!("`extends` forms a circle: {}", ring.join(" -> ")))));
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
    // The base comes first in the list of sources, because later sources override earlier ones.
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
