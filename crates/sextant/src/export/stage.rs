//! Where the files of an export stand until all of them are written.

use std::fs;
use std::path::{Path, PathBuf};

use sextant_recording::disk;
use sextant_recording::output::{OutputError, open_folder};

/// A folder within that of an export. It goes when it is dropped, with what was not published, and so does the folder of
/// the export if it is new and still empty.
pub(super) struct Stage {
    folder: PathBuf,
    stage: PathBuf,
    is_new: bool,
}

impl Stage {
    /// A stage in `folder`, which may be new.
    pub(super) fn open(folder: &Path) -> Result<Self, OutputError> {
        let is_new = !folder.exists();
        open_folder(folder)?;
        let stage = folder.join(format!(".sextant-export-{}.part", std::process::id()));
        let this = Self { folder: folder.to_owned(), stage, is_new };
        disk::create_folders(&this.stage).map_err(|error| OutputError::new(&this.stage, &error))?;
        Ok(this)
    }

    /// Where the file `path` of the folder stands until it is published.
    pub(super) fn place(&self, path: &Path) -> PathBuf {
        self.stage.join(path.strip_prefix(&self.folder).unwrap_or(path))
    }

    /// Gives a file its place in the folder.
    pub(super) fn publish(&self, path: &Path) -> Result<(), OutputError> {
        let parent = path.parent().unwrap_or(&self.folder);
        disk::create_folders(parent)
            .and_then(|()| disk::rename(&self.place(path), path))
            .and_then(|()| disk::sync_folder_of(path))
            .map_err(|error| OutputError::new(path, &error))
    }

    /// The files in the folder, in order, but those that are not published.
    pub(super) fn files(&self) -> Vec<PathBuf> {
        let mut files = Vec::new();
        let mut folders = vec![self.folder.clone()];
        while let Some(folder) = folders.pop() {
            let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
            for path in entries.filter(|path| *path != self.stage) {
                let is_folder = path.symlink_metadata().is_ok_and(|found| found.is_dir());
                if is_folder { folders.push(path) } else { files.push(path) }
            }
        }
        files.sort();
        files
    }
}

impl Drop for Stage {
    fn drop(&mut self) {
        // The error that ended the work is the one that is told.
        let _ = disk::remove_folder(&self.stage);
        let is_empty = || fs::read_dir(&self.folder).is_ok_and(|mut files| files.next().is_none());
        if self.is_new && is_empty() {
            let _ = disk::remove_folder(&self.folder);
        }
    }
}
