//! Which file a path stands for, whatever it is called.

use std::fs::{File, TryLockError};
use std::io;
use std::path::{Component, Path, PathBuf};

/// Which file a path stands for: the same for all names of one file (links, hard links, `..`), also of one that does not
/// exist yet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FileIdentity {
    /// A file or folder that exists.
    Existing(SystemNumber),
    /// One that does not: the nearest folder above it that exists, and the way from there in small letters, because some
    /// file systems do not distinguish them from capital ones.
    Missing(Option<SystemNumber>, String),
}

/// What the system calls a file: its file system, and its number there.
#[cfg(unix)]
type SystemNumber = (u64, u64);

/// Without such numbers: the only path without links.
#[cfg(not(unix))]
type SystemNumber = PathBuf;

#[cfg(unix)]
fn number(path: &Path) -> io::Result<SystemNumber> {
    Ok(number_of(&std::fs::metadata(path)?))
}

#[cfg(unix)]
fn number_of(metadata: &std::fs::Metadata) -> SystemNumber {
    use std::os::unix::fs::MetadataExt;
    (metadata.dev(), metadata.ino())
}

#[cfg(not(unix))]
fn number(path: &Path) -> io::Result<SystemNumber> {
    path.canonicalize()
}

impl FileIdentity {
    /// The identity of the file at `path`.
    #[must_use]
    pub fn of(path: &Path) -> Self {
        if let Ok(number) = number(path) {
            return Self::Existing(number);
        }
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let above = path.ancestors().skip(1).find_map(|above| Some((above, number(above).ok()?)));
        match above {
            Some((above, number)) => {
                let rest = path.strip_prefix(above).unwrap_or(&path);
                Self::Missing(Some(number), plain(rest).to_string_lossy().to_lowercase())
            }
            None => Self::Missing(None, plain(&path).to_string_lossy().to_lowercase()),
        }
    }

    /// Whether the open `file` is still the one at `path`, and not one that was renamed or removed.
    ///
    /// # Errors
    /// If one of them cannot be looked at.
    #[cfg(unix)]
    pub(crate) fn is_at(file: &File, path: &Path) -> io::Result<bool> {
        Ok(number_of(&file.metadata()?) == number(path)?)
    }

    /// An open file cannot be renamed or removed by others.
    ///
    /// # Errors
    /// Never.
    #[cfg(not(unix))]
    pub(crate) fn is_at(_file: &File, path: &Path) -> io::Result<bool> {
        Ok(path.exists())
    }
}

/// Locks the open `file`; whether no other process has it, and it is still the one at `path`.
#[must_use]
pub fn is_claimed(file: &File, path: &Path) -> bool {
    // Some file systems have no locks.
    let is_taken = matches!(file.try_lock(), Err(TryLockError::WouldBlock));
    !is_taken && FileIdentity::is_at(file, path).unwrap_or(false)
}

/// The path without `.` and `..`. Links are kept.
#[must_use]
pub fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir => {
                plain.pop();
            }
            other => plain.push(other),
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_names_of_a_file_are_one_file() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("a.csv"), "a").unwrap();
        std::fs::write(at("b.csv"), "a").unwrap();
        std::fs::create_dir(at("below")).unwrap();
        std::fs::hard_link(at("a.csv"), at("hard.csv")).unwrap();
        let mut names = vec![at("below/../a.csv"), at("./a.csv"), at("hard.csv")];
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(at("a.csv"), at("soft.csv")).unwrap();
            std::os::unix::fs::symlink(folder.path(), at("below/loop")).unwrap();
            names.extend([at("soft.csv"), at("below/loop/a.csv")]);
        }
        for name in names {
            assert_eq!(FileIdentity::of(&name), FileIdentity::of(&at("a.csv")), "{}", name.display());
        }
        assert_ne!(FileIdentity::of(&at("a.csv")), FileIdentity::of(&at("b.csv")));
    }

    #[test]
    fn a_file_that_does_not_exist_yet_is_known_by_its_folder() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| FileIdentity::of(&folder.path().join(name));
        std::fs::create_dir(folder.path().join("below")).unwrap();
        assert_eq!(at("new.csv"), at("below/../new.csv"));
        assert_eq!(at("new.csv"), at("NEW.csv"), "one file on some file systems");
        assert_eq!(at("no/where/new.csv"), at("no/other/../where/new.csv"));
        assert_ne!(at("new.csv"), at("below/new.csv"));
        assert_ne!(at("new.csv"), at("newer.csv"));
        let here = std::env::current_dir().unwrap();
        assert_eq!(FileIdentity::of(Path::new("not-there.csv")), FileIdentity::of(&here.join("not-there.csv")));
    }
}
