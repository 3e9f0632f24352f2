//! A long file, written bit by bit.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::draft::{Draft, DraftError, PART};
use super::error::OutputError;
use crate::disk::{self, DiskFile};

/// Why a file cannot be written that another process writes.
const BUSY: &str = "it is being written by another process";

/// A file that is called `PATH.part` until [`PartFile::finish`]. Without that it is removed when it is dropped.
#[derive(Debug)]
pub struct PartFile {
    draft: Draft,
    /// `None` once it is finished.
    output: Option<BufWriter<DiskFile>>,
}

impl PartFile {
    /// Creates the empty file `PATH.part`.
    ///
    /// # Errors
    /// If it cannot be created, or `path` is a folder or a device.
    pub fn create(path: &Path) -> Result<Self, OutputError> {
        let draft = Draft::new(path, PART);
        let output = draft.open().map_err(error)?;
        Ok(Self { draft, output: Some(output) })
    }

    /// The final name of the file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.draft.path
    }

    /// Syncs the file and gives it its final name. If that fails, it is removed.
    ///
    /// # Errors
    /// If it cannot be written or renamed.
    pub fn finish(mut self) -> Result<(), OutputError> {
        match self.output.take() {
            Some(output) => self.draft.name(output).map_err(|why| {
                // Only the first error is reported.
                let _ = disk::remove_file(&self.draft.part);
                error(why)
            }),
            None => Ok(()),
        }
    }
}

impl Write for PartFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.output.as_mut().map_or(Ok(bytes.len()), |output| output.write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.output.as_mut().map_or(Ok(()), Write::flush)
    }
}

impl Drop for PartFile {
    fn drop(&mut self) {
        if self.output.take().is_some() {
            // Nobody can be told.
            let _ = disk::remove_file(&self.draft.part);
        }
    }
}

pub(super) fn error(error: DraftError) -> OutputError {
    let (path, why): (PathBuf, String) = match error {
        DraftError::Create { path, why } => (path, why),
        DraftError::Busy { path } => (path, BUSY.to_owned()),
        DraftError::Write { path, why } => (path, why.to_string()),
        DraftError::Rename { path, why, .. } => (path, why.to_string()),
    };
    OutputError { path, why }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_not_finished_is_removed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        PartFile::create(&path).unwrap().write_all(b"a").unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        let mut file = PartFile::create(&path).unwrap();
        file.write_all(b"a,b\n").unwrap();
        file.finish().unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"a,b\n");
    }
}
