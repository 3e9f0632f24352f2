//! What tests of this crate share.

use tempfile::TempDir;

/// A folder with these files: names and texts.
pub(crate) fn folder_of<'a>(files: impl IntoIterator<Item = (&'a str, &'a str)>) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).expect("a file");
    }
    folder
}
