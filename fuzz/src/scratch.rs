//! A folder for files that readers take by their paths. It is as fast as its disk: `fuzz/run.sh` puts it into memory.

use std::path::{Path, PathBuf};

use tempfile::TempDir;

thread_local! {
    /// One folder a thread, which is removed with it.
    static FOLDER: TempDir = tempfile::tempdir().expect("a folder for temporary files");
}

/// The folder of this thread.
fn folder() -> PathBuf {
    FOLDER.with(|folder| folder.path().to_owned())
}

/// The path of a file with this name, that may be there from an earlier input.
pub(crate) fn path(name: &str) -> PathBuf {
    folder().join(name)
}

/// Writes a file of this name. Its path stays the same from input to input, so that messages do.
pub(crate) fn file(name: &str, content: &[u8]) -> PathBuf {
    let path = path(name);
    std::fs::write(&path, content).expect("a temporary file can be written");
    path
}

/// The path of a file whose content is the same for all inputs.
pub(crate) fn constant(name: &str, content: &[u8]) -> PathBuf {
    let path = path(name);
    if !path.exists() { file(name, content) } else { path }
}

/// A folder of files that is removed when it is dropped.
pub(crate) struct Files(TempDir);

impl Files {
    /// A folder without files.
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir_in(folder()).expect("a temporary folder"))
    }

    /// Where it is.
    pub(crate) fn folder(&self) -> &Path {
        self.0.path()
    }

    /// Writes a file of this plain name.
    pub(crate) fn write(&self, name: &str, content: &[u8]) {
        std::fs::write(self.folder().join(name), content).expect("a temporary file can be written");
    }
}
