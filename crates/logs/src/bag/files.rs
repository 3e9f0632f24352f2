//! The files of a bag: one, or those of a folder that `ros2 bag record` wrote.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use sextant_kernel::{LARGEST_FILE, read_text_at_most};

use crate::error::bag_error::BagError;

/// The first octets of files.
const ROS1_MAGIC: &[u8] = b"#ROSBAG V";
const SQLITE_MAGIC: &[u8] = b"SQLite format 3\0";
const ZSTD_MAGIC: &[u8] = &[0x28, 0xB5, 0x2F, 0xFD];

const METADATA: &str = "metadata.yaml";

/// Whether the file or folder `path` is a bag, or was one before it was compressed, in a format that can be read or not.
/// Recordings and bags are both MCAP files, so this is for other files and for folders.
pub(super) fn is_foreign_bag(path: &Path) -> bool {
    if path.is_dir() {
        return path.join(METADATA).is_file() || ["mcap", "db3", "bag"].iter().any(|&kind| has_file(path, kind));
    }
    let head = head(path).unwrap_or_default();
    // What else is compressed may be anything.
    let is_packed_bag = || {
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
        head.starts_with(ZSTD_MAGIC) && [".mcap.zstd", ".db3.zstd"].iter().any(|end| name.ends_with(end))
    };
    [ROS1_MAGIC, SQLITE_MAGIC].iter().any(|magic| head.starts_with(magic)) || is_packed_bag()
}

/// The MCAP files in a folder; none if it cannot be read.
pub(super) fn mcap_files(folder: &Path) -> Vec<PathBuf> {
    let is_mcap = |name: &String| Path::new(name).extension().is_some_and(|extension| extension == "mcap");
    names(folder).unwrap_or_default().iter().filter(|name| is_mcap(name)).map(|name| folder.join(name)).collect()
}

/// Whether a folder holds a bag that is not in MCAP, or the metadata of a bag.
pub(super) fn holds_other_bag(folder: &Path) -> bool {
    folder.join(METADATA).is_file() || ["db3", "bag"].iter().any(|&kind| has_file(folder, kind))
}

/// Whether the file `path` is a database of SQLite.
#[cfg(feature = "sqlite-bags")]
pub(super) fn is_sqlite(path: &Path) -> bool {
    head(path).is_ok_and(|head| head.starts_with(SQLITE_MAGIC))
}

/// Whether bags in SQLite can be read.
const READS_SQLITE: bool = cfg!(feature = "sqlite-bags");

/// The files of the bag `path`, in the order of recording: all in MCAP, or all in SQLite.
pub(super) fn files(path: &Path) -> Result<Vec<PathBuf>, BagError> {
    let owned = || path.to_owned();
    if !path.is_dir() {
        let head = head(path).map_err(|why| BagError::read(path, &why))?;
        return match head.as_slice() {
            head if head.starts_with(ROS1_MAGIC) => Err(BagError::Ros1 { path: owned() }),
            head if head.starts_with(SQLITE_MAGIC) && !READS_SQLITE => Err(BagError::Sqlite { path: owned() }),
            head if head.starts_with(ZSTD_MAGIC) => Err(BagError::Compressed { path: owned(), what: "files" }),
            _ => Ok(vec![owned()]),
        };
    }
    let names = names(path)?;
    let of_kind = |kind: &str| -> Vec<&String> {
        names.iter().filter(|name| Path::new(name).extension().is_some_and(|extension| extension == kind)).collect()
    };
    let mut found: Vec<_> = of_kind("mcap").into_iter().cloned().collect();
    let databases = of_kind("db3");
    if let ([mcap, ..], [database, ..]) = (found.as_slice(), databases.as_slice()) {
        let problem =
            format!("the folder has bags in MCAP and in SQLite, `{mcap}` and `{database}`: give one of them");
        return Err(BagError::Content { path: owned(), problem });
    }
    if READS_SQLITE && found.is_empty() {
        found = databases.iter().map(|name| (*name).clone()).collect();
    }
    if found.is_empty() {
        return Err(if !databases.is_empty() {
            BagError::Sqlite { path: owned() }
        } else if !of_kind("zstd").is_empty() {
            BagError::Compressed { path: owned(), what: "files" }
        } else if let [bag, ..] = of_kind("bag").as_slice() {
            BagError::Ros1 { path: path.join(bag) }
        } else {
            BagError::Content { path: owned(), problem: "the folder has no .mcap files".to_owned() }
        });
    }
    found.sort_by_cached_key(|name| order(name));
    let metadata = path.join(METADATA);
    if metadata.is_file() {
        let text = read_text_at_most(&metadata, LARGEST_FILE).map_err(|why| BagError::read(&metadata, &why))?;
        check_metadata(path, &text, &found)?;
    }
    Ok(found.iter().map(|name| path.join(name)).collect())
}

/// Reads the two lines of the metadata that matter: a bag with missing files, or with compressed messages, would otherwise
/// give a wrong map or a confusing error.
fn check_metadata(path: &Path, metadata: &str, found: &[String]) -> Result<(), BagError> {
    let mut lines = metadata.lines();
    let mode = metadata.lines().find_map(|line| line.trim().strip_prefix("compression_mode:"));
    if mode.is_some_and(|mode| plain(mode).eq_ignore_ascii_case("message")) {
        return Err(BagError::Compressed { path: path.to_owned(), what: "messages" });
    }
    lines.find(|line| line.trim() == "relative_file_paths:");
    for listed in lines.map_while(|line| line.trim().strip_prefix("- ")).map(plain) {
        if !found.iter().any(|name| name == listed) {
            let problem = format!("`{METADATA}` names the file `{listed}`, which is missing");
            return Err(BagError::Content { path: path.to_owned(), problem });
        }
    }
    Ok(())
}

/// A scalar of YAML without its quotes.
fn plain(scalar: &str) -> &str {
    scalar.trim().trim_matches(['"', '\''])
}

fn names(folder: &Path) -> Result<Vec<String>, BagError> {
    let entries = std::fs::read_dir(folder).map_err(|why| BagError::read(folder, &why))?;
    let name = |entry: std::io::Result<std::fs::DirEntry>| {
        entry.map(|entry| entry.file_name().to_string_lossy().into_owned())
    };
    entries.map(name).collect::<Result<_, _>>().map_err(|why| BagError::read(folder, &why))
}

fn has_file(folder: &Path, kind: &str) -> bool {
    let is_kind = |name: &String| Path::new(name).extension().is_some_and(|extension| extension == kind);
    names(folder).is_ok_and(|names| names.iter().any(is_kind))
}

fn head(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut head = Vec::new();
    File::open(path)?.take(16).read_to_end(&mut head)?;
    Ok(head)
}

/// Sorts `bag_10.mcap` after `bag_9.mcap`.
fn order(name: &str) -> Vec<(String, u64)> {
    let mut parts = Vec::new();
    let mut rest = name;
    while !rest.is_empty() {
        let text = rest.find(|c: char| c.is_ascii_digit()).unwrap_or(rest.len());
        let digits = rest[text..].find(|c: char| !c.is_ascii_digit()).map_or(rest.len(), |end| text + end);
        parts.push((rest[..text].to_owned(), rest[text..digits].parse().unwrap_or(0)));
        rest = &rest[digits..];
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::folder_of;

    #[test]
    fn the_files_of_a_folder_are_in_the_order_of_their_numbers() {
        let folder = folder_of(["walk_10.mcap", "walk_9.mcap", "walk_0.mcap", "notes.txt"].map(|name| (name, "")));
        let files = files(folder.path()).unwrap();
        let names: Vec<_> = files.iter().map(|file| file.file_name().unwrap().to_str().unwrap()).collect();
        assert_eq!(names, ["walk_0.mcap", "walk_9.mcap", "walk_10.mcap"]);
    }

    #[test]
    fn a_bag_that_cannot_be_read_names_the_command_that_converts_it() {
        let folder = tempfile::tempdir().unwrap();
        for (name, content, expected) in [
            ("a.bag", b"#ROSBAG V2.0\n".as_slice(), "rosbags-convert --src"),
            ("a.mcap.zstd", &[0x28, 0xB5, 0x2F, 0xFD, 0], "compressed files"),
        ] {
            let path = folder.path().join(name);
            std::fs::write(&path, content).unwrap();
            assert!(is_foreign_bag(&path), "{name}");
            let problem = files(&path).unwrap_err().to_string();
            assert!(problem.contains(expected), "{problem}");
        }
    }

    #[test]
    fn a_bag_in_sqlite_is_read_or_names_the_feature() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.db3");
        std::fs::write(&path, b"SQLite format 3\0 etc").unwrap();
        for at in [&path, folder.path()] {
            assert!(is_foreign_bag(at));
            match files(at) {
                Ok(files) => assert!(READS_SQLITE && files == [path.clone()], "{files:?}"),
                Err(error) => {
                    let problem = error.to_string();
                    assert!(!READS_SQLITE && problem.contains("--features sqlite-bags"), "{problem}");
                }
            }
        }
        std::fs::write(folder.path().join("b.mcap"), "").unwrap();
        let problem = files(folder.path()).unwrap_err().to_string();
        assert!(problem.contains("`b.mcap` and `a.db3`: give one of them"), "{problem}");
    }

    #[test]
    fn a_missing_split_and_compressed_messages_are_errors() {
        let folder = folder_of([("walk_0.mcap", "")]);
        let metadata = "rosbag2_bagfile_information:\n  version: 9\n  storage_identifier: mcap\n  \
            relative_file_paths:\n    - walk_0.mcap\n    - \"walk_1.mcap\"\n  duration:\n    nanoseconds: 1\n";
        for (metadata, expected) in [
            (metadata.to_owned(), "`metadata.yaml` names the file `walk_1.mcap`, which is missing"),
            ("  compression_mode: MESSAGE\n".to_owned(), "compressed messages"),
        ] {
            std::fs::write(folder.path().join(METADATA), metadata).unwrap();
            let problem = files(folder.path()).unwrap_err().to_string();
            assert!(problem.contains(expected), "{problem}");
        }
    }
}
