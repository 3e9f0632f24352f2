//! A scenario file that is read once, for many scenarios.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use sextant_kernel::LARGEST_FILE;
use sextant_recording::ForeignFolder;

use super::document::{self, Document, Value, layers};
use super::error::{ScenarioError, ScenarioErrors};
use super::sweep::SweepAxes;

/// A scenario file with those that it extends, read but not checked: the settings that override it may make it valid.
#[derive(Clone, Debug)]
pub struct ScenarioFile {
    document: Arc<Document>,
    /// Empty for a text that is from no file.
    path: PathBuf,
    /// Paths in it are relative to this folder.
    folder: PathBuf,
    /// Of other files, none outside of this folder is read, if there is one.
    root: Option<ForeignFolder>,
}

impl ScenarioFile {
    /// Reads the file at `path` and those that it extends.
    ///
    /// # Errors
    /// If one cannot be read or is not TOML.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ScenarioErrors> {
        let path = path.as_ref();
        let document = Arc::new(layers::read(path)?);
        Ok(Self { document, path: path.to_owned(), folder: layers::folder_of(path), root: None })
    }

    /// The same of a file in a folder that somebody else may have made: all files that it extends or names are in the folder
    /// too.
    ///
    /// # Errors
    /// If one cannot be read, is not TOML, or is not a file in the folder.
    pub fn read_foreign(root: ForeignFolder, path: &Path) -> Result<Self, ScenarioErrors> {
        let document = Arc::new(layers::read_foreign(&root, path)?);
        Ok(Self { document, path: path.to_owned(), folder: layers::folder_of(path), root: Some(root) })
    }

    /// A text that is from no file. Files that it names are relative to the working folder.
    pub(super) fn of_text(text: &str) -> Result<Self, ScenarioErrors> {
        let document = Arc::new(layers::parse(text, Path::new(""))?);
        Ok(Self { document, path: PathBuf::new(), folder: PathBuf::new(), root: None })
    }

    /// Where the file is.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Paths in it are relative to this folder.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Rejects the path of a file that its settings name, if all of them are to be in a folder, and this one is not.
    pub(super) fn check_named(&self, path: &Path) -> Result<(), ScenarioError> {
        let Some(root) = &self.root else { return Ok(()) };
        root.check(path, LARGEST_FILE).map_err(|error| ScenarioError::unreadable(path, &error))
    }

    /// Where the files are that it was read from: those that it extends, then itself.
    pub fn layers(&self) -> impl Iterator<Item = &Path> {
        self.document.sources.iter().map(|source| Path::new(&source.name))
    }

    /// The files that it and those below it extend, as they are written there.
    pub fn bases(&self) -> impl Iterator<Item = PathBuf> {
        let sources = &self.document.sources;
        (0..sources.len()).filter_map(|i| match document::parse(sources, i).ok()?.value {
            Value::Table(mut table) => match table.remove("extends")?.value {
                Value::String(file) => Some(PathBuf::from(file)),
                _ => None,
            },
            _ => None,
        })
    }

    /// What its `[sweep]` varies, with the settings `set`. The keys of `product` keep the order of the file, and the last
    /// key varies fastest.
    ///
    /// # Errors
    /// If `[sweep]` does not have the form of [`SweepConfig`](super::SweepConfig).
    pub fn axes(&self, set: &[String]) -> Result<SweepAxes, ScenarioErrors> {
        Ok(SweepAxes::of(&self.overridden(set, None)?)?)
    }

    /// What its `[sweep]` varies with the settings `set`, which the sweep must not replace in each cell.
    ///
    /// # Errors
    /// As for [`axes`](Self::axes), and if a setting would have no effect.
    pub fn axes_of_sweep(&self, set: &[String]) -> Result<SweepAxes, ScenarioErrors> {
        let axes = self.axes(set)?;
        axes.check_settings(set)?;
        Ok(axes)
    }

    /// Its settings.
    pub(super) fn document(&self) -> &Document {
        &self.document
    }

    /// Its settings, overridden by `set` and `seed`.
    pub(super) fn overridden(&self, set: &[String], seed: Option<u64>) -> Result<Document, ScenarioErrors> {
        let mut document = self.document().clone();
        document.override_by(set, seed, &self.folder)?;
        Ok(document)
    }
}
