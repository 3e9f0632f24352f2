//! The files that settings name, and how much is read of a file.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::setting::{SettingError, SettingProblem};

/// The most that is read of a file as a whole (octets). A larger one is surely not what it should be: `/dev/zero` for example.
pub const LARGEST_FILE: u64 = 1 << 28;

/// The content of the file at `path`, if it is at most `most` octets long.
///
/// # Errors
/// If it cannot be read, or is longer.
pub fn read_at_most(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let mut content = Vec::new();
    File::open(path)?.take(most + 1).read_to_end(&mut content)?;
    if content.len() as u64 > most {
        let why = format!("it is larger than {} MB, the most that is read of such a file", most >> 20);
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, why));
    }
    Ok(content)
}

/// The same of a text in UTF-8.
///
/// # Errors
/// If it cannot be read, is longer, or is not UTF-8.
pub fn read_text_at_most(path: &Path, most: u64) -> io::Result<String> {
    text(read_at_most(path, most)?)
}

fn text(content: Vec<u8>) -> io::Result<String> {
    String::from_utf8(content).map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error.utf8_error()))
}

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
            Self::Folder(folder) => read_at_most(&folder.join(file), LARGEST_FILE),
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
        text(self.read(file)?)
    }

    /// Whether `file` is in the folder or in one below it. Who wrote the settings may not be who runs them: what is in other
    /// files is not shown.
    #[must_use]
    pub fn has_within(&self, file: &Path) -> bool {
        match self {
            // There is nothing to show of a file that is not there.
            Self::Folder(folder) => !folder.join(file).exists() || is_within(&folder.join(file), folder),
            Self::Attached(_) => true,
        }
    }

    /// An error in the content of `file`, as it may be shown: that of a file outside the folder names the line alone.
    #[must_use]
    pub fn discreet(&self, file: &Path, error: SettingError) -> SettingError {
        if self.has_within(file) {
            return error;
        }
        let SettingProblem::Invalid { found, allowed } = &error.problem else { return error };
        let line = found.split_once(", line ").map_or(String::new(), |(_, rest)| {
            let digits = rest.bytes().take_while(u8::is_ascii_digit).count();
            format!(", line {}", &rest[..digits])
        });
        let shown = format!("`{}`{line}; its content is not shown, because it is in another folder", file.display());
        SettingError::new(error.key, shown, allowed.clone())
    }
}

/// Whether the file at `path` is in `folder` or in one below it.
#[must_use]
pub fn is_within(path: &Path, folder: &Path) -> bool {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    match (path.canonicalize(), folder.canonicalize()) {
        (Ok(path), Ok(folder)) => path.starts_with(folder),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_may_be_as_long_as_the_limit_and_no_longer() {
        assert_eq!(LARGEST_FILE, 256 * 1024 * 1024);
        let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml");
        let octets = std::fs::read(&own).unwrap();
        let length = octets.len() as u64;
        assert_eq!(read_at_most(&own, length).unwrap(), octets);
        assert_eq!(read_text_at_most(&own, length).unwrap().into_bytes(), octets);
        assert_eq!(read_at_most(&own, length - 1).unwrap_err().kind(), io::ErrorKind::FileTooLarge);
        let error = text(vec![b'a', 0xFF]).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::InvalidData);
        let files = Files::of_folder(Path::new(env!("CARGO_MANIFEST_DIR")));
        assert_eq!(
            (files.path(Path::new("Cargo.toml")), files.read(Path::new("Cargo.toml")).unwrap()),
            (own, octets)
        );
        assert_eq!(Files::Attached(Arc::default()).path(Path::new("a/b.csv")), Path::new("a/b.csv"));
    }

    #[cfg(unix)]
    #[test]
    fn a_file_without_end_is_rejected() {
        let error = read_at_most(Path::new("/dev/zero"), 1 << 20).unwrap_err();
        assert!(error.to_string().contains("larger than 1 MB"), "{error}");
        assert_eq!(read_at_most(Path::new("/dev/null"), 0).unwrap(), b"");
    }

    #[test]
    fn the_content_of_files_in_other_folders_is_not_shown() {
        let files = Files::of_folder(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/src")));
        let error = |file: &str| {
            let found = format!("`{file}`, line 12: column `secret`");
            files.discreet(Path::new(file), SettingError::new("file", found, "a name")).to_string()
        };
        assert!(error("lib.rs").contains("secret"));
        let outside = error("../Cargo.toml");
        assert!(
            !outside.contains("secret") && outside.contains("`../Cargo.toml`, line 12; its content"),
            "{outside}"
        );
    }

    #[test]
    fn attached_files_are_not_looked_for_on_the_disk() {
        let files = Files::Attached(Arc::new(BTreeMap::from([(PathBuf::from("a.csv"), b"x".to_vec())])));
        assert_eq!(files.read_text(Path::new("a.csv")).unwrap(), "x");
        let missing = files.read(Path::new(file!())).unwrap_err();
        assert!(missing.to_string().contains("not among the files"), "{missing}");
    }
}
