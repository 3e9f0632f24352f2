//! Folders that somebody else may have made.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};

/// A folder that somebody else may have made. Only regular files in it are read: `..`, absolute paths and links lead
/// nowhere, and devices and pipes, which may have no end, are not opened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ForeignFolder(PathBuf);

impl ForeignFolder {
    /// The folder at `root`. The user named it, so it may be a link itself.
    #[must_use]
    pub fn new(root: &Path) -> Self {
        Self(root.to_owned())
    }

    /// Where it is.
    #[must_use]
    pub fn root(&self) -> &Path {
        &self.0
    }

    /// The content of the file at `path`, which begins with that of the folder, if it is at most `most` octets long.
    ///
    /// # Errors
    /// If it is not a regular file in the folder ([`InvalidInput`](io::ErrorKind::InvalidInput)), is longer
    /// ([`FileTooLarge`](io::ErrorKind::FileTooLarge)), or cannot be read.
    pub fn read(&self, path: &Path, most: u64) -> io::Result<Vec<u8>> {
        let mut content = Vec::new();
        self.open(path)?.take(most.saturating_add(1)).read_to_end(&mut content)?;
        if content.len() as u64 > most { Err(too_large(most)) } else { Ok(content) }
    }

    /// The file at `path`, which begins with that of the folder.
    ///
    /// # Errors
    /// If it is not a regular file in the folder, or cannot be read.
    pub fn open(&self, path: &Path) -> io::Result<File> {
        let path = self.way(path)?;
        if !path.symlink_metadata()?.is_file() {
            return Err(refused(&path, "is not a file"));
        }
        File::open(path)
    }

    /// The same of a text in UTF-8.
    ///
    /// # Errors
    /// As [`read`](Self::read), and if it is not UTF-8.
    pub fn read_text(&self, path: &Path, most: u64) -> io::Result<String> {
        String::from_utf8(self.read(path, most)?)
            .map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error.utf8_error()))
    }

    /// Rejects a path that is not one of a regular file in the folder, of at most `most` octets.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn check(&self, path: &Path, most: u64) -> io::Result<()> {
        let length = self.open(path)?.metadata()?.len();
        if length > most { Err(too_large(most)) } else { Ok(()) }
    }

    /// What is in the folder at `path`, which begins with that of this one or is it, by name.
    ///
    /// # Errors
    /// If it is no folder in this one, or cannot be read.
    pub fn entries(&self, path: &Path) -> io::Result<Vec<PathBuf>> {
        let path = self.way(path)?;
        let mut entries = fs::read_dir(path)?.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>()?;
        entries.sort();
        Ok(entries)
    }

    /// The path without `.` and `..`, if each step of it is in the folder and none is a link.
    fn way(&self, path: &Path) -> io::Result<PathBuf> {
        let outside = || refused(path, "is not in the folder of these files");
        let mut steps = Vec::new();
        for component in path.strip_prefix(&self.0).map_err(|_| outside())?.components() {
            match component {
                Component::Normal(name) => steps.push(name),
                Component::CurDir => {}
                Component::ParentDir => {
                    steps.pop().ok_or_else(outside)?;
                }
                Component::Prefix(_) | Component::RootDir => return Err(outside()),
            }
        }
        let mut way = self.0.clone();
        for step in steps {
            way.push(step);
            if way.symlink_metadata()?.is_symlink() {
                return Err(refused(&way, "is a link"));
            }
        }
        Ok(way)
    }
}

fn too_large(most: u64) -> io::Error {
    let why = format!("it is larger than {} MB, the most that is read of such a file", most >> 20);
    io::Error::new(io::ErrorKind::FileTooLarge, why)
}

/// The error that a path is not what it should be.
fn refused(path: &Path, what: &str) -> io::Error {
    let why = format!("`{}` {what}; allowed: regular files in the folder", path.display());
    io::Error::new(io::ErrorKind::InvalidInput, why)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder `own` with a file, beside a file that is not in it.
    fn made() -> (tempfile::TempDir, ForeignFolder) {
        let folder = tempfile::tempdir().unwrap();
        let own = folder.path().join("own");
        fs::create_dir_all(own.join("below")).unwrap();
        fs::write(own.join("below/a.csv"), "a").unwrap();
        fs::write(folder.path().join("secret"), "secret").unwrap();
        (folder, ForeignFolder::new(&own))
    }

    #[test]
    fn only_files_in_the_folder_are_read() {
        let (outer, folder) = made();
        let at = |name: &str| folder.root().join(name);
        for name in ["below/a.csv", "./below/../below/a.csv"] {
            assert_eq!(folder.read_text(&at(name), 1).unwrap(), "a");
        }
        assert_eq!(folder.entries(folder.root()).unwrap(), [at("below")]);
        assert_eq!(folder.read(&at("below/b.csv"), 9).unwrap_err().kind(), io::ErrorKind::NotFound);
        assert_eq!(folder.read(&at("below/a.csv"), 0).unwrap_err().kind(), io::ErrorKind::FileTooLarge);
        let secret = outer.path().join("secret");
        for path in [at("../secret"), at("below/../../secret"), at("below"), folder.root().to_owned(), secret] {
            let error = folder.read(&path, 9).unwrap_err();
            assert_eq!(error.kind(), io::ErrorKind::InvalidInput, "{path:?}: {error}");
            assert!(error.to_string().contains("allowed: regular files in the folder"), "{error}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_devices_and_pipes_are_not_followed() {
        use std::os::unix::fs::symlink;

        let (outer, folder) = made();
        let at = |name: &str| folder.root().join(name);
        symlink("../secret", at("link")).unwrap();
        symlink("/dev/zero", at("zero")).unwrap();
        symlink("below", at("inner")).unwrap();
        symlink(outer.path(), at("outer")).unwrap();
        assert!(std::process::Command::new("mkfifo").arg(at("pipe")).status().unwrap().success());
        for name in ["link", "zero", "inner/a.csv", "outer/secret", "pipe"] {
            let error = folder.read(&at(name), 9).unwrap_err();
            assert_eq!(error.kind(), io::ErrorKind::InvalidInput, "{name}: {error}");
        }
        assert!(folder.entries(&at("outer")).is_err());
        // The user named the folder itself.
        symlink(folder.root(), outer.path().join("named")).unwrap();
        let named = ForeignFolder::new(&outer.path().join("named"));
        assert_eq!(named.read_text(&named.root().join("below/a.csv"), 9).unwrap(), "a");
    }
}
