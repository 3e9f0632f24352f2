//! The files that settings name.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Where the files are that settings name: nodes, meshes, antenna patterns, traces of traffic, maps.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Files {
    /// In a folder of the disk.
    Folder(PathBuf),
    /// In memory, by the path that the settings name. The disk is never looked at.
    Attached(Arc<BTreeMap<PathBuf, Vec<u8>>>),
}

/// The files of the working folder.
impl Default for Files {
    fn default() -> Self {
        Self::Folder(PathBuf::new())
    }
}

impl Files {
    /// The files of a folder.
    #[must_use]
    pub fn of_folder(folder: &Path) -> Self {
        Self::Folder(folder.to_owned())
    }

    /// The path of `file` for messages.
    #[must_use]
    pub fn path(&self, file: &Path) -> PathBuf {
        match self {
            Self::Folder(folder) => folder.join(file),
            Self::Attached(_) => file.to_owned(),
        }
    }

    /// The content of `file`.
    ///
    /// # Errors
    /// If it cannot be read, or is not attached.
    pub fn read(&self, file: &Path) -> io::Result<Vec<u8>> {
        match self {
            Self::Folder(folder) => std::fs::read(folder.join(file)),
            Self::Attached(files) => files.get(file).cloned().ok_or_else(|| {
                io::Error::new(
                    io::ErrorKind::NotFound,
                    "it is not among the files that are attached to the recording",
                )
            }),
        }
    }

    /// The text in `file`.
    ///
    /// # Errors
    /// If it cannot be read, is not attached, or is not UTF-8.
    pub fn read_text(&self, file: &Path) -> io::Result<String> {
        match self {
            Self::Folder(folder) => std::fs::read_to_string(folder.join(file)),
            Self::Attached(_) => String::from_utf8(self.read(file)?)
                .map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error.utf8_error())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attached_files_are_not_looked_for_on_the_disk() {
        let files = Files::Attached(Arc::new(BTreeMap::from([(PathBuf::from("a.csv"), b"x".to_vec())])));
        assert_eq!(files.read_text(Path::new("a.csv")).unwrap(), "x");
        let missing = files.read(Path::new(file!())).unwrap_err();
        assert!(missing.to_string().contains("not among the files"), "{missing}");
    }
}
