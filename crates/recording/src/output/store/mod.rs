//! Finished parts of long work, from which it goes on when it was cut off. The work is a list of runs, numbered from 0, and the
//! results of a run are rows of text.
//!
//! | file | what |
//! | --- | --- |
//! | `A-B.csv` | a part: the rows of the runs A to B - 1 |
//! | `A-B.unfinished-N.csv` | the rows of the part that are finished, as they came; N is another one for each process that does it |
//! | `fingerprint` | what the work is, where one process does it alone |
//!
//! The first line of a part says what work it is of. The rows follow in blocks, each with a checksum: one that was cut off or
//! changed is not read, nor is what follows it. No file has two writers, so none needs a lock; a process that does the
//! work alone locks `fingerprint`. What is appended is there when the process is killed.

mod blocks;
mod error;
mod name;
mod range;
mod row_files;

pub use blocks::RowBlock;
pub use error::StoreError;
pub use name::PartName;
pub use range::NumberRange;
pub use row_files::RowPlace;

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, Write};
use std::path::{Path, PathBuf};

use super::identity::is_claimed;
use super::{OutputError, WholeFile, write_file};
use crate::disk::{self, DiskFile};
use crate::output::foreign_folder::ForeignFolder;
use blocks::{Blocks, block};
use row_files::RowFiles;

/// Begins the first line of a part.
const MARK: &str = "sextant-part-2";

/// The file that says what the work is.
const FINGERPRINT: &str = "fingerprint";

/// The most that is read of it and of the first line of a part (octets).
const LARGEST_MARK: u64 = 1 << 20;
const LONGEST_HEAD: u64 = 1 << 10;

/// A folder of finished parts.
#[derive(Debug)]
pub struct Store {
    /// The folder or one above it, whose files somebody else may have written.
    foreign: ForeignFolder,
    folder: PathBuf,
    /// What the work is: a word.
    identity: String,
    /// Locked as long as this process does the work alone.
    lock: Option<File>,
    files: RowFiles,
}

/// Whether work was begun before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Begun {
    /// Now.
    Now,
    /// It was, and cut off.
    Before,
}

impl Store {
    /// The store in `folder`, which is in the `foreign` one, of a work that many processes do.
    #[must_use]
    pub fn shared(foreign: ForeignFolder, folder: PathBuf, identity: &str) -> Self {
        Self { foreign, folder, identity: identity.to_owned(), lock: None, files: RowFiles::default() }
    }

    /// The store in `folder`, which may be new, of a work that this process does alone; and whether it was begun before.
    ///
    /// # Errors
    /// If the folder is the store of other work, another process has it, or it cannot be read or written.
    pub fn alone(folder: &Path, identity: &str) -> Result<(Self, Begun), StoreError> {
        let foreign = ForeignFolder::new(folder);
        let mark = folder.join(FINGERPRINT);
        let busy = || StoreError::Busy { folder: folder.to_owned() };
        let begun = match foreign.read_text(&mark, LARGEST_MARK) {
            Ok(found) if found != identity => return Err(StoreError::Other { path: mark }),
            Ok(_) => Begun::Before,
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                disk::create_folder(folder)
                    .or_else(|error| match error.kind() {
                        // A process that was killed just after it created the folder left no fingerprint.
                        io::ErrorKind::AlreadyExists => Ok(()),
                        _ => Err(error),
                    })
                    .map_err(|error| OutputError::new(folder, &error))?;
                match write_file(&mark, identity.as_bytes()) {
                    // Another process has just finished the work.
                    Err(_) if !folder.exists() => return Err(busy()),
                    written => written?,
                }
                Begun::Now
            }
            Err(why) => return Err(StoreError::Read { path: mark, why }),
        };
        let lock = match File::open(&mark) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Err(busy()),
            opened => opened.map_err(|why| StoreError::Read { path: mark.clone(), why })?,
        };
        if !is_claimed(&lock, &mark) {
            return Err(busy());
        }
        let (folder, identity) = (folder.to_owned(), identity.to_owned());
        Ok((Self { foreign, folder, identity, lock: Some(lock), files: RowFiles::default() }, begun))
    }

    /// The parts in the store.
    ///
    /// # Errors
    /// If the folder cannot be read, or has a file that is no part.
    pub fn parts(&self) -> Result<Vec<PartName>, StoreError> {
        let unreadable = |why| StoreError::Read { path: self.folder.clone(), why };
        let mut parts = Vec::new();
        for path in self.foreign.entries(&self.folder).map_err(unreadable)? {
            let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
            match PartName::parse(name) {
                Some(part) => parts.push(part),
                // A part that another process writes now.
                None if path.extension().is_some_and(|extension| extension == "part") => {}
                None if name == FINGERPRINT && self.lock.is_some() => {}
                None => return Err(StoreError::Invalid { path, why: "parts are called A-B.csv".to_owned() }),
            }
        }
        Ok(parts)
    }

    /// Its folder.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The file of a part.
    #[must_use]
    pub fn path(&self, part: PartName) -> PathBuf {
        self.folder.join(part.text())
    }

    /// The rows of a part; `None` if it was unfinished and its process has just finished it.
    ///
    /// # Errors
    /// If it cannot be read, is no part, or is of other work.
    pub fn read(&self, part: PartName) -> Result<Option<PartRows>, StoreError> {
        let path = self.path(part);
        let unreadable = |why| StoreError::Read { path: path.clone(), why };
        let mut file = match self.foreign.open(&path) {
            Err(why) if part.unfinished.is_some() && why.kind() == io::ErrorKind::NotFound => return Ok(None),
            opened => BufReader::new(opened.map_err(unreadable)?),
        };
        let blocks = match self.head(&path, &mut file) {
            Ok(length) => Some(Blocks::new(file, length)),
            // A power failure left the file without its first line, and so without a row.
            Err(StoreError::Invalid { .. })
                if part.unfinished.is_some() && self.is_cut_off(&path).map_err(unreadable)? =>
            {
                None
            }
            Err(error) => return Err(error),
        };
        Ok(Some(PartRows { part, blocks }))
    }

    /// Keeps the file of an unfinished part open whose rows were read: they can be read again, also if another process
    /// finishes and removes it meanwhile.
    ///
    /// # Errors
    /// If the file cannot be used any more.
    pub fn keep_open(&self, rows: PartRows) -> Result<(), StoreError> {
        if let Some(blocks) = rows.blocks.filter(|_| rows.part.unfinished.is_some()) {
            let mut file = blocks.from.into_inner();
            let at = file.stream_position();
            let at = at.map_err(|why| StoreError::Read { path: self.path(rows.part), why })?;
            self.files.keep(rows.part, file, at);
        }
        Ok(())
    }

    /// Adds the rows at `place` to `rows`.
    ///
    /// # Errors
    /// If they cannot be read.
    pub fn read_rows(&self, place: RowPlace, rows: &mut Vec<u8>) -> Result<(), StoreError> {
        let path = self.path(place.part);
        let read = self.files.read(place, || self.foreign.open(&path), rows);
        read.map_err(|why| StoreError::Read { path, why })
    }

    /// Reads the first line of a part, and returns its length (octets).
    fn head(&self, path: &Path, text: &mut impl BufRead) -> Result<u64, StoreError> {
        let mut line = Vec::new();
        let read = text.by_ref().take(LONGEST_HEAD).read_until(b'\n', &mut line);
        read.map_err(|why| StoreError::Read { path: path.to_owned(), why })?;
        let length = line.len() as u64;
        let line = String::from_utf8_lossy(&line);
        let Some((MARK, identity)) = line.strip_suffix('\n').and_then(|line| line.split_once(',')) else {
            let why = format!("its first line is not `{MARK}` and the plan");
            return Err(StoreError::Invalid { path: path.to_owned(), why });
        };
        if identity != self.identity {
            return Err(StoreError::Other { path: path.to_owned() });
        }
        Ok(length)
    }

    /// Whether the first line of an unfinished part has not all of its octets.
    fn is_cut_off(&self, path: &Path) -> io::Result<bool> {
        let whole = head(&self.identity);
        let mut found = Vec::new();
        self.foreign.open(path)?.take(whole.len() as u64).read_to_end(&mut found)?;
        Ok(found.contains(&0) || found.len() < whole.len() && whole.starts_with(&found))
    }

    /// Begins a part, in a file of this process.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn begin(&self, range: NumberRange) -> Result<UnfinishedPart, OutputError> {
        let mut number = 1;
        loop {
            let name = PartName { range, unfinished: Some(number) };
            let path = self.path(name);
            let unwritten = |error: io::Error| OutputError::new(&path, &error);
            match DiskFile::create_new(&path) {
                Ok(mut file) => {
                    let head = head(&self.identity);
                    let written = file.write_all(&head).and_then(|()| file.sync());
                    written.and_then(|()| disk::sync_folder_of(&path)).map_err(unwritten)?;
                    self.files.keep(name, File::open(&path).map_err(unwritten)?, 0);
                    return Ok(UnfinishedPart { name, path, file, length: head.len() as u64 });
                }
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => number += 1,
                Err(error) => return Err(unwritten(error)),
            }
        }
    }

    /// Writes a finished part with the rows in `pieces` of text, completely or not at all; the work on it took `wall_s`
    /// seconds. Of processes that do the same part at once, the last one is kept.
    ///
    /// # Errors
    /// If it cannot be written, or a piece is an error.
    pub fn finish(
        &self,
        range: NumberRange,
        pieces: impl IntoIterator<Item = Result<Vec<u8>, StoreError>>,
        wall_s: f64,
    ) -> Result<(), StoreError> {
        let path = self.path(PartName { range, unfinished: None });
        let unwritten = |error: io::Error| OutputError::new(&path, &error);
        let mut file = WholeFile::create(&path)?;
        file.write_all(&head(&self.identity)).map_err(unwritten)?;
        for piece in pieces {
            file.write_all(&block(&piece?, wall_s)).map_err(unwritten)?;
        }
        Ok(file.finish()?)
    }

    /// Removes a part whose rows are in another one.
    pub fn remove(&self, part: PartName) {
        // One that stays does no harm.
        let _ = disk::remove_file(&self.path(part));
    }
}

/// Removes the store in `folder`. What another process begins there at the same moment stays.
///
/// # Errors
/// If it cannot be removed.
pub fn remove(folder: &Path) -> Result<(), OutputError> {
    match disk::remove_folder(folder) {
        Err(error) if error.kind() == io::ErrorKind::DirectoryNotEmpty => Ok(()),
        removed => removed.map_err(|error| OutputError::new(folder, &error)),
    }
}

/// The first line of a part.
fn head(identity: &str) -> Vec<u8> {
    format!("{MARK},{identity}\n").into_bytes()
}

/// How long something took (s), as a text.
fn seconds(text: &str) -> Option<f64> {
    text.parse().ok().filter(|wall_s: &f64| wall_s.is_finite() && *wall_s >= 0.0)
}

/// A part that this process does.
#[derive(Debug)]
pub struct UnfinishedPart {
    name: PartName,
    path: PathBuf,
    file: DiskFile,
    /// Its length (octets).
    length: u64,
}

impl UnfinishedPart {
    /// Its name.
    #[must_use]
    pub fn name(&self) -> PartName {
        self.name
    }

    /// Adds finished `rows`; the work had taken `wall_s` seconds until then. They are there also if the process is killed, but the
    /// disk is not waited for. Returns where they begin in the file (octets).
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn append(&mut self, rows: &[u8], wall_s: f64) -> Result<u64, OutputError> {
        let block = block(rows, wall_s);
        self.file.write_all(&block).map_err(|error| OutputError::new(&self.path, &error))?;
        self.length += block.len() as u64;
        Ok(self.length - rows.len() as u64)
    }

    /// Makes what was added reach the disk: it is there also if the power fails.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn sync(&self) -> Result<(), OutputError> {
        self.file.sync().map_err(|error| OutputError::new(&self.path, &error))
    }
}

/// The rows of a part, as text. Those that were cut off are left out.
#[derive(Debug)]
pub struct PartRows {
    part: PartName,
    /// Nothing if it has not even a first line.
    blocks: Option<Blocks<BufReader<File>>>,
}

impl PartRows {
    /// How long the work on the rows took that were read (s).
    #[must_use]
    pub fn wall_s(&self) -> f64 {
        self.blocks.as_ref().map_or(0.0, |blocks| blocks.wall_s)
    }

    /// The next rows; `None` at their end.
    ///
    /// # Errors
    /// If they cannot be read.
    pub fn next_block(&mut self) -> io::Result<Option<RowBlock<'_>>> {
        self.blocks.as_mut().map_or(Ok(None), Blocks::advance)
    }
}

#[cfg(test)]
mod tests;
