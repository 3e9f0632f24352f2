//! A file that has a temporary name until it is complete.

use std::fs::{OpenOptions, TryLockError};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use super::identity::FileIdentity;
use crate::disk::{self, DiskFile};

/// A file that has a temporary name until it is complete. While it is written it is locked: another process that wants to
/// write it gets an error. What a process that was killed left under the temporary name gets another name, and stays.
#[derive(Debug)]
pub(crate) struct Draft {
    /// The temporary name.
    pub(crate) part: PathBuf,
    /// The final name.
    pub(crate) path: PathBuf,
}

/// Why a draft did not become a file.
#[derive(Debug)]
pub(crate) enum DraftError {
    /// It cannot be created.
    Create {
        /// The file.
        path: PathBuf,
        /// The reason.
        why: String,
    },
    /// Another process writes it.
    Busy {
        /// The file.
        path: PathBuf,
    },
    /// The data cannot be written to the disk.
    Write {
        /// The file that was being written.
        path: PathBuf,
        /// The system's answer.
        why: io::Error,
    },
    /// It cannot be renamed.
    Rename {
        /// The finished file.
        part: PathBuf,
        /// Its final name.
        path: PathBuf,
        /// The system's answer.
        why: io::Error,
    },
}

/// What is added to the name of a file until it is complete.
pub(crate) const PART: &str = ".part";

/// What is added to the name of a recovered copy until it is complete.
pub(crate) const RECOVERING: &str = ".recovering";

/// So often the temporary file is opened anew if other processes finish theirs at the same moment.
const ATTEMPTS: u32 = 100;

/// The temporary name of the file `path`.
pub(crate) fn part_of(path: &Path, suffix: &str) -> PathBuf {
    let mut part = path.as_os_str().to_owned();
    part.push(suffix);
    part.into()
}

/// What stands under the temporary name of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Leftover {
    /// Nothing, or an empty file.
    Nothing,
    /// What a process that ended early has written.
    Kept,
    /// The file of a process that writes it now.
    Busy,
}

impl Leftover {
    /// What stands at the temporary name `part`.
    pub(crate) fn at(part: &Path) -> Self {
        let Ok(metadata) = std::fs::symlink_metadata(part) else { return Self::Nothing };
        if !metadata.is_file() {
            return Self::Nothing;
        }
        match OpenOptions::new().write(true).open(part).map(|file| file.try_lock()) {
            Ok(Err(TryLockError::WouldBlock)) => Self::Busy,
            _ if metadata.len() > 0 => Self::Kept,
            _ => Self::Nothing,
        }
    }
}

/// The name that a left-over at `part` gets: the first of `part.1`, `part.2`, .. that is free.
pub(crate) fn kept_name(part: &Path) -> PathBuf {
    let names = (1_u64..).map(|number| part_of(part, &format!(".{number}")));
    names.into_iter().find(|name| name.symlink_metadata().is_err()).unwrap_or_else(|| part.to_owned())
}

impl Draft {
    /// The file `path`, which is called `path` + `suffix` until it is complete.
    pub(crate) fn new(path: &Path, suffix: &str) -> Self {
        Self { part: part_of(path, suffix), path: path.to_owned() }
    }

    /// Creates the empty file. Folders, devices and pipes are rejected, because a file cannot replace them.
    pub(crate) fn open(&self) -> Result<BufWriter<DiskFile>, DraftError> {
        let refused = |path: &Path, why: String| DraftError::Create { path: path.to_owned(), why };
        if self.path.is_dir() {
            return Err(refused(&self.path, "it is a folder".to_owned()));
        }
        if self.path.exists() && !self.path.is_file() {
            return Err(refused(&self.path, "it is a device or a pipe, not a file".to_owned()));
        }
        self.open_part()
    }

    /// Creates the empty file, whatever stands under the final name.
    pub(super) fn open_part(&self) -> Result<BufWriter<DiskFile>, DraftError> {
        let refused = |path: &Path, why: String| DraftError::Create { path: path.to_owned(), why };
        for _ in 0..ATTEMPTS {
            let file = self.claim().map_err(|why| match why.kind() {
                io::ErrorKind::WouldBlock => DraftError::Busy { path: self.path.clone() },
                _ => refused(&self.part, why.to_string()),
            })?;
            if let Some(file) = file {
                return Ok(BufWriter::new(file));
            }
        }
        Err(DraftError::Busy { path: self.path.clone() })
    }

    /// The temporary file, empty and locked; `None` if it changed meanwhile.
    fn claim(&self) -> io::Result<Option<DiskFile>> {
        let created = DiskFile::create_new(&self.part);
        let file = match created {
            Err(why) if why.kind() == io::ErrorKind::AlreadyExists => match self.part.symlink_metadata() {
                // A file that a link names belongs to somebody else.
                Ok(found) if found.is_symlink() && !self.is_device() => {
                    return disk::rename(&self.part, &kept_name(&self.part)).map(|()| None);
                }
                Ok(_) => match DiskFile::open(&self.part) {
                    Err(why) if why.kind() == io::ErrorKind::NotFound => return Ok(None),
                    opened => opened?,
                },
                Err(_) => return Ok(None),
            },
            created => created?,
        };
        match file.system().try_lock() {
            Err(TryLockError::WouldBlock) => return Err(io::ErrorKind::WouldBlock.into()),
            // Some file systems have no locks.
            Err(TryLockError::Error(_)) | Ok(()) => {}
        }
        if !FileIdentity::is_at(file.system(), &self.part).unwrap_or(false) {
            return Ok(None);
        }
        if file.system().metadata()?.len() > 0 {
            return disk::rename(&self.part, &kept_name(&self.part)).map(|()| None);
        }
        Ok(Some(file))
    }

    fn is_device(&self) -> bool {
        std::fs::metadata(&self.part).is_ok_and(|found| !found.is_file() && !found.is_dir())
    }

    /// Syncs the file, renames it, and syncs the folder, in this order. So a file with the final name is complete, even
    /// after a power failure.
    pub(crate) fn name(&self, output: BufWriter<DiskFile>) -> Result<(), DraftError> {
        let unwritten = |path: &Path, why: io::Error| DraftError::Write { path: path.to_owned(), why };
        let file = output.into_inner().map_err(|why| unwritten(&self.part, why.into_error()))?;
        file.sync().map_err(|why| unwritten(&self.part, why))?;
        disk::rename(&self.part, &self.path).map_err(|why| DraftError::Rename {
            part: self.part.clone(),
            path: self.path.clone(),
            why,
        })?;
        // Closed, and so unlocked, only when it has its final name: nobody takes it for a left-over.
        drop(file);
        disk::sync_folder_of(&self.path).map_err(|why| unwritten(&self.path, why))
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    fn written(draft: &Draft, text: &[u8]) {
        let mut output = draft.open().unwrap();
        output.write_all(text).unwrap();
        draft.name(output).unwrap();
    }

    #[test]
    fn a_file_that_is_written_now_is_not_written_twice() {
        let folder = tempfile::tempdir().unwrap();
        let draft = Draft::new(&folder.path().join("a.mcap"), PART);
        let mut output = draft.open().unwrap();
        output.write_all(b"first").unwrap();
        output.flush().unwrap();
        assert!(matches!(draft.open(), Err(DraftError::Busy { .. })));
        assert_eq!(Leftover::at(&draft.part), Leftover::Busy);
        draft.name(output).unwrap();
        assert_eq!(Leftover::at(&draft.part), Leftover::Nothing);
        written(&draft, b"second");
        assert_eq!(std::fs::read(&draft.path).unwrap(), b"second");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn what_a_killed_process_left_stays_under_another_name() {
        let folder = tempfile::tempdir().unwrap();
        let draft = Draft::new(&folder.path().join("a.mcap"), PART);
        for (left, name) in [("one", "a.mcap.part.1"), ("two", "a.mcap.part.2")] {
            std::fs::write(&draft.part, left).unwrap();
            assert_eq!(Leftover::at(&draft.part), Leftover::Kept);
            assert_eq!(kept_name(&draft.part), folder.path().join(name));
            written(&draft, b"new");
            assert_eq!(std::fs::read_to_string(folder.path().join(name)).unwrap(), left);
        }
        assert_eq!(std::fs::read(&draft.path).unwrap(), b"new");
    }

    #[cfg(unix)]
    #[test]
    fn a_link_under_the_temporary_name_is_not_followed() {
        let folder = tempfile::tempdir().unwrap();
        let draft = Draft::new(&folder.path().join("a.mcap"), PART);
        let precious = folder.path().join("precious.csv");
        std::fs::write(&precious, "years of work").unwrap();
        for target in [&precious, &folder.path().join("nowhere")] {
            std::os::unix::fs::symlink(target, &draft.part).unwrap();
            written(&draft, b"new");
        }
        assert_eq!(std::fs::read_to_string(&precious).unwrap(), "years of work");
        assert_eq!(std::fs::read(&draft.path).unwrap(), b"new");
    }

    #[test]
    fn of_many_threads_at_once_each_writes_a_whole_file_or_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mcap");
        let texts: Vec<Vec<u8>> = (b'a'..=b'h').map(|letter| vec![letter; 100_000]).collect();
        for _ in 0..20 {
            let outcomes: Vec<_> = std::thread::scope(|scope| {
                let writers = texts.iter().map(|text| {
                    let draft = Draft::new(&path, PART);
                    scope.spawn(move || {
                        let mut output = draft.open()?;
                        output.write_all(text).map_err(|why| DraftError::Write { path: draft.part.clone(), why })?;
                        draft.name(output)
                    })
                });
                let writers: Vec<_> = writers.collect();
                writers.into_iter().map(|writer| writer.join().unwrap()).collect()
            });
            assert!(outcomes.iter().any(Result::is_ok));
            assert!(
                outcomes.iter().all(|outcome| matches!(outcome, Ok(()) | Err(DraftError::Busy { .. }))),
                "{outcomes:?}"
            );
            assert!(texts.contains(&std::fs::read(&path).unwrap()));
            assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        }
    }
}
