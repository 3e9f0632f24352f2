//! A file for what does not fit into memory.

use std::path::Path;

use super::draft::Draft;
use super::error::OutputError;
use super::part_file::error;
use crate::disk::DiskFile;

/// Creates the empty file `path`, to write and to read. No other process gets it while it is open; what another one left
/// there gets another name.
///
/// # Errors
/// If it cannot be created, or another process has it.
pub fn open_scratch(path: &Path) -> Result<DiskFile, OutputError> {
    let output = Draft { part: path.to_owned(), path: path.to_owned() }.open_part().map_err(error)?;
    output.into_inner().map_err(|why| OutputError::new(path, why.error()))
}

#[cfg(test)]
mod tests {
    use std::io::{Read, Seek, Write};

    use super::*;

    #[test]
    fn two_processes_have_two_files() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.tiles.part");
        std::fs::write(&path, "left").unwrap();
        let mut file = open_scratch(&path).unwrap();
        assert!(open_scratch(&path).unwrap_err().to_string().contains("another process"));
        file.write_all(b"mine").unwrap();
        let mut reader = &file;
        reader.rewind().unwrap();
        let mut text = String::new();
        reader.read_to_string(&mut text).unwrap();
        assert_eq!(text, "mine");
        assert_eq!(std::fs::read(folder.path().join("a.tiles.part.1")).unwrap(), b"left");
    }
}
