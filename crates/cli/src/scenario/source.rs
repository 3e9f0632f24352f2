//! The texts that settings are read from, and places in them.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

/// A text that settings were read from: a file, or one flag of the command line.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    /// What messages call it: the path as given, or the flag.
    pub(crate) name: String,
    /// The whole text.
    pub(crate) text: Arc<str>,
    /// Relative paths in it are meant from here.
    pub(crate) folder: PathBuf,
}

/// Where a setting was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Origin {
    /// Index of the source.
    pub(crate) source: usize,
    /// The bytes of its key; none in an array.
    pub(crate) key: Option<Range<usize>>,
    /// The bytes of its value; of a table, its header.
    pub(crate) value: Range<usize>,
}

impl Origin {
    /// The bytes that stand for the setting as a whole: its key, or its value where it has none.
    pub(crate) fn head(&self) -> Range<usize> {
        self.key.clone().unwrap_or_else(|| self.value.clone())
    }
}
