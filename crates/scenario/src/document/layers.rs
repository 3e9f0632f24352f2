//! The layers of a scenario: the file that it extends, the file itself, and the settings that override it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use sextant_kernel::{is_within, read_at_most};
use sextant_recording::ForeignFolder;

use super::effective;
use crate::document::{self, Document, Entry, Value};
use crate::error::ScenarioError;
use crate::source::{SETTING, Source};

/// The most that is read of a scenario (octets).
const LARGEST_SCENARIO: u64 = 1 << 26;

/// Reads `path` and the files that it extends. Tables are merged key by key. A later layer replaces all other values, also
/// arrays.
pub(crate) fn read(path: &Path) -> Result<Document, ScenarioError> {
    read_from(path, Chain::default())
}

/// The same of files that are all in a folder which somebody else may have made.
pub(crate) fn read_foreign(root: &ForeignFolder, path: &Path) -> Result<Document, ScenarioError> {
    read_from(path, Chain { root: Some(root), ..Chain::default() })
}

fn read_from(path: &Path, mut chain: Chain<'_>) -> Result<Document, ScenarioError> {
    let mut sources = Vec::new();
    let root = read_file(path, &mut sources, &mut chain, None)?;
    Ok(Document { root, sources, text: String::new() })
}

/// Reads a scenario from its text. Files that it names are relative to `folder`.
pub(crate) fn parse(text: &str, folder: &Path) -> Result<Document, ScenarioError> {
    let source = Source { name: "scenario".to_owned(), text: Arc::from(text), folder: folder.to_owned() };
    let mut sources = vec![source];
    let mut own = document::parse(&sources, 0)?;
    let base = match &mut own.value {
        Value::Table(table) => table.remove("extends"),
        _ => None,
    };
    let Some(base) = base else { return Ok(Document { root: own, sources, text: String::new() }) };
    let source = sources.remove(0);
    let root = read_base(&source, base, own, &mut sources, &mut Chain::default())?;
    Ok(Document { root, sources, text: String::new() })
}

impl Document {
    /// Overrides settings by `overrides` (each `path.to.key=value`) and by `seed`, which is not part of the text. Files that
    /// they name are relative to `folder`.
    pub(crate) fn override_by(
        &mut self,
        overrides: &[String],
        seed: Option<u64>,
        folder: &Path,
    ) -> Result<(), ScenarioError> {
        for setting in overrides {
            self.lay_setting(SETTING, setting, folder)?;
        }
        self.text = match self.sources.as_slice() {
            [only] => only.text.to_string(),
            layers => effective::text(&self.root, layers),
        };
        seed.map_or(Ok(()), |seed| self.lay_setting("seed", &format!("seed={seed}"), folder))
    }
}

impl Document {
    /// Overrides settings by those of a text; `name` is its name in messages.
    pub(crate) fn lay_text(&mut self, name: &str, text: &str) -> Result<(), ScenarioError> {
        let source = Source { name: name.to_owned(), text: Arc::from(text), folder: PathBuf::new() };
        self.sources.push(source);
        self.root.overlay(document::parse(&self.sources, self.sources.len() - 1)?);
        Ok(())
    }
}

pub(crate) fn folder_of(path: &Path) -> PathBuf {
    path.parent().map(Path::to_path_buf).unwrap_or_default()
}

/// The place where a file names another file.
type Mention<'a> = (&'a Source, std::ops::Range<usize>);

/// The files that extend each other.
#[derive(Debug, Default)]
struct Chain<'a> {
    /// No file outside of this folder is read, if there is one.
    root: Option<&'a ForeignFolder>,
    /// Those that were read, by the only path of each and by its name.
    files: Vec<(PathBuf, String)>,
}

impl Chain<'_> {
    fn read(&self, path: &Path) -> std::io::Result<Vec<u8>> {
        match self.root {
            Some(root) => root.read(path, LARGEST_SCENARIO),
            None => read_at_most(path, LARGEST_SCENARIO),
        }
    }
}

fn read_file(
    path: &Path,
    sources: &mut Vec<Source>,
    chain: &mut Chain<'_>,
    mention: Option<Mention<'_>>,
) -> Result<Entry, ScenarioError> {
    let placed = |error: ScenarioError| match &mention {
        Some((source, span)) => error.at(source, span.clone(), "extended here"),
        None => error,
    };
    let unreadable = |error: &std::io::Error| placed(ScenarioError::unreadable(path, error));
    let identity = path.canonicalize().map_err(|error| unreadable(&error))?;
    let name = path.display().to_string();
    if let Some(first) = chain.files.iter().position(|(seen, _)| *seen == identity) {
        let mut ring: Vec<_> = chain.files[first..].iter().map(|(_, name)| name.as_str()).collect();
        ring.push(&name);
        return Err(placed(ScenarioError::new(format!("`extends` forms a circle: {}", ring.join(" -> ")))));
    }
    let bytes = chain.read(path).map_err(|error| unreadable(&error))?;
    let text = String::from_utf8(bytes)
        .map_err(|error| unreadable(&std::io::Error::new(std::io::ErrorKind::InvalidData, error.utf8_error())))?;
    chain.files.push((identity, name.clone()));
    let source = Source { name, text: Arc::from(text), folder: folder_of(path) };
    let index = sources.len();
    sources.push(source.clone());
    // What is in a file that is no scenario is not shown, if a scenario of another folder names it.
    let is_foreign = mention.is_some() && !is_within(path, &folder_of(&chain.files[0].0));
    let mut own =
        document::parse(sources, index).map_err(|error| if is_foreign { error.discreet() } else { error })?;
    let base = match &mut own.value {
        Value::Table(table) => table.remove("extends"),
        _ => None,
    };
    let Some(base) = base else { return Ok(own) };
    // The base comes first in the list of sources, because later sources override earlier ones.
    sources.truncate(index);
    read_base(&source, base, own, sources, chain)
}

/// Reads the file that `source` extends, named by `base`, and lays `own`, the settings of `source`, over it.
fn read_base(
    source: &Source,
    base: Entry,
    mut own: Entry,
    sources: &mut Vec<Source>,
    chain: &mut Chain<'_>,
) -> Result<Entry, ScenarioError> {
    let Value::String(file) = &base.value else {
        return Err(ScenarioError::new("`extends` is not a text; allowed: the path of one scenario file").at(
            source,
            base.origin.value,
            "here",
        ));
    };
    let mention = Some((source, base.origin.value.clone()));
    let mut root = read_file(&source.folder.join(file), sources, chain, mention)?;
    own.renumber(sources.len());
    sources.push(source.clone());
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
