//! The source texts of settings, and places in them.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

/// Name of the sources that override a scenario by one setting.
pub(crate) const SETTING: &str = "setting";

/// A source of settings: a file, or one line.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    /// Its name in messages: the path as given, or what the line is.
    pub(crate) name: String,
    /// The whole text.
    pub(crate) text: Arc<str>,
    /// Paths in it are relative to this folder.
    pub(crate) folder: PathBuf,
}

/// The place of a setting in its source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Origin {
    /// Index of the source.
    pub(crate) source: usize,
    /// The bytes of its key; `None` for an entry of an array.
    pub(crate) key: Option<Range<usize>>,
    /// The bytes of its value; for a table, of its header.
    pub(crate) value: Range<usize>,
}

impl Origin {
    /// The bytes of its key, or of its value if it has no key.
    pub(crate) fn head(&self) -> Range<usize> {
        self.key.clone().unwrap_or_else(|| self.value.clone())
    }
}
