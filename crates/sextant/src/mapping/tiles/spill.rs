//! The temporary file with the receptions of all tiles.

use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use sextant_channel::Reception;
use sextant_recording::disk::{self, DiskFile};
use sextant_recording::output::open_scratch;
use sha2::{Digest, Sha256};

use super::row;
use crate::mapping::TilesError;

/// Octets that are collected for a tile before they are written.
const BLOCK: usize = 1 << 16;

/// The receptions of all tiles, in blocks of one tile each. The file has no name while it is used, where the system allows
/// that: whatever ends the program, nothing of it remains.
#[derive(Debug)]
pub(super) struct Spill {
    path: PathBuf,
    file: DiskFile,
    /// Octets that the complete file needs, about.
    bytes: u64,
    end: u64,
    tiles: Vec<SpilledTile>,
    has_name: bool,
    /// Of all that was written, and of which tile it is.
    digest: Sha256,
}

#[derive(Clone, Debug, Default)]
struct SpilledTile {
    /// Where its blocks begin, and how long they are.
    blocks: Vec<(u64, usize)>,
    /// What is not written yet.
    waiting: Vec<u8>,
}

impl Spill {
    /// Creates the file at `path` for so many tiles. It will have about so many octets.
    pub(super) fn create(path: &Path, tiles: usize, bytes: u64) -> Result<Self, TilesError> {
        let file =
            open_scratch(path).map_err(|error| TilesError::Write { path: path.to_owned(), bytes, why: error.why })?;
        // An open file may lose its name on some systems only; there it goes when it is dropped.
        let has_name = cfg!(not(unix)) || disk::remove_file(path).is_err();
        Ok(Self {
            path: path.to_owned(),
            file,
            bytes,
            end: 0,
            tiles: vec![SpilledTile::default(); tiles],
            has_name,
            digest: Sha256::new(),
        })
    }

    /// Adds a reception to a tile.
    pub(super) fn push(&mut self, tile: usize, reception: &Reception) -> Result<(), TilesError> {
        let waiting = &mut self.tiles[tile].waiting;
        row::write(reception, waiting);
        if waiting.len() < BLOCK { Ok(()) } else { self.write(tile) }
    }

    /// Writes what is left.
    pub(super) fn finish(&mut self) -> Result<(), TilesError> {
        for tile in 0..self.tiles.len() {
            self.write(tile)?;
            self.tiles[tile].waiting = Vec::new();
        }
        Ok(())
    }

    /// Hash of all receptions, and of the tiles that they are in.
    pub(super) fn sha256(&self) -> [u8; 32] {
        self.digest.clone().finalize().into()
    }

    fn write(&mut self, tile: usize) -> Result<(), TilesError> {
        let SpilledTile { blocks, waiting } = &mut self.tiles[tile];
        if waiting.is_empty() {
            return Ok(());
        }
        self.file.write_all(waiting).map_err(|why| unwritten(&self.path, self.bytes, &why))?;
        self.digest.update(tile.to_le_bytes());
        self.digest.update(&*waiting);
        blocks.push((self.end, waiting.len()));
        self.end += waiting.len() as u64;
        waiting.clear();
        Ok(())
    }

    /// Calls `take` with each reception of a tile, in the order in which they came.
    pub(super) fn read(&self, tile: usize, mut take: impl FnMut(Reception)) -> Result<(), TilesError> {
        let unread = |why: io::Error| TilesError::Read { path: self.path.clone(), why: why.to_string() };
        let mut file = &self.file;
        let mut octets = Vec::with_capacity(BLOCK);
        for &(start, length) in &self.tiles[tile].blocks {
            octets.resize(length, 0);
            file.seek(SeekFrom::Start(start)).map_err(unread)?;
            file.read_exact(&mut octets).map_err(unread)?;
            let mut rest = octets.as_slice();
            while let Some(reception) = row::read(&mut rest) {
                take(reception);
            }
        }
        Ok(())
    }
}

fn unwritten(path: &Path, bytes: u64, why: &io::Error) -> TilesError {
    TilesError::Write { path: path.to_owned(), bytes, why: why.to_string() }
}

impl Drop for Spill {
    fn drop(&mut self) {
        if self.has_name {
            // Nobody can be told.
            let _ = disk::remove_file(&self.path);
        }
    }
}

#[cfg(test)]
mod tests {
    use sextant_kernel::NodeId;

    use super::*;

    fn heard(node: u32, stop: u32) -> Reception {
        Reception::heard(NodeId(node), stop, 1, 2)
    }

    #[test]
    fn each_tile_returns_its_receptions_in_order_and_no_file_remains() {
        let folder = tempfile::tempdir().expect("there is room");
        let mut spill = Spill::create(&folder.path().join("tiles.part"), 3, 0).expect("there is room");
        let all: Vec<Reception> = (0..30_000).map(|i| heard(i % 7, i)).collect();
        for reception in &all {
            spill.push(reception.node.index() % 2, reception).expect("there is room");
        }
        spill.finish().expect("there is room");
        assert_eq!(spill.end, 30_000 * 17);
        for tile in 0..3 {
            let mut found = Vec::new();
            spill.read(tile, |reception| found.push(reception)).expect("it was written");
            let expected: Vec<Reception> =
                all.iter().filter(|reception| tile < 2 && reception.node.index() % 2 == tile).copied().collect();
            assert_eq!(found, expected, "tile {tile}");
        }
        drop(spill);
        assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_an_error_that_says_how_much_is_needed() {
        let folder = tempfile::tempdir().expect("there is room");
        let path = folder.path().join("tiles.part");
        std::os::unix::fs::symlink("/dev/full", &path).expect("there is room");
        let mut spill = Spill::create(&path, 1, 5_000_000).expect("the link is open");
        let error =
            (0..).find_map(|stop| spill.push(0, &heard(0, stop)).err()).expect("the disk is full").to_string();
        assert!(error.contains("tiles.part`: No space left") && error.contains("they need 5 MB there"), "{error}");
    }
}
