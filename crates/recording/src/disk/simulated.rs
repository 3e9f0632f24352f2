//! A disk that fails when a test says so, and what is left on it when the power goes.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::change::{Change, FileNumber};
use super::replaced::Disk;

/// What goes wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trouble {
    /// One change fails.
    Error,
    /// From one change on there is no room: nothing can be written or created until a file is removed.
    Full,
    /// Of one write the disk takes half of the octets, and the next change fails.
    Torn,
    /// A signal interrupts one write: it is to be tried again.
    Interrupted,
    /// From one change on all fail, and what did not reach the disk is lost.
    PowerLoss,
}

/// What of the changes that nobody asked to reach the disk has reached it all the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Luck {
    /// Nothing.
    None,
    /// The names, but not what is in the files.
    Names,
    /// The names, and of each file a part: blocks of it are missing.
    Torn,
    /// All.
    All,
}

/// A disk that makes all changes until one goes wrong, and remembers them.
#[derive(Debug)]
pub struct SimulatedDisk {
    folder: PathBuf,
    /// What was on it before: files with what they have, and folders.
    before: BTreeMap<PathBuf, Option<Vec<u8>>>,
    trouble: Option<(usize, Trouble)>,
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    /// The number of changes that were asked for.
    asked: usize,
    is_full: bool,
    is_torn: bool,
    made: Vec<Made>,
}

/// A change that was made.
#[derive(Debug)]
enum Made {
    Open(FileNumber, PathBuf),
    Write(FileNumber, Vec<u8>),
    Sync(FileNumber),
    Rename(PathBuf, PathBuf),
    Remove(PathBuf),
    CreateFolder(PathBuf),
    SyncFolder(PathBuf),
}

/// What has a name.
#[derive(Clone, Debug)]
enum Entry {
    Folder,
    /// A file from before.
    Old(Vec<u8>),
    File(FileNumber),
}

/// Octets of a block of a disk.
const BLOCK: usize = 512;

impl SimulatedDisk {
    /// The disk under `folder`, on which the change with the number `at`, from 0, goes wrong.
    ///
    /// # Errors
    /// If what is there cannot be read.
    pub fn new(folder: &Path, trouble: Option<(usize, Trouble)>) -> io::Result<Self> {
        let mut before = BTreeMap::new();
        let mut folders = vec![folder.to_owned()];
        while let Some(next) = folders.pop() {
            for entry in fs::read_dir(next)? {
                let path = entry?.path();
                let content = if path.is_dir() { None } else { Some(fs::read(&path)?) };
                if content.is_none() {
                    folders.push(path.clone());
                }
                before.insert(path, content);
            }
        }
        Ok(Self { folder: folder.to_owned(), before, trouble, state: Mutex::default() })
    }

    /// The number of changes that were asked for.
    #[must_use]
    pub fn changes(&self) -> usize {
        self.state().asked
    }

    /// Creates the folder `image` with what is on the disk after the power was lost and came back.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn after_power_loss(&self, luck: Luck, image: &Path) -> io::Result<()> {
        let state = self.state();
        fs::create_dir_all(image)?;
        for (path, entry) in state.names(&self.before, luck) {
            let Ok(name) = path.strip_prefix(&self.folder) else { continue };
            let path = image.join(name);
            if let Some(above) = path.parent() {
                fs::create_dir_all(above)?;
            }
            match entry {
                Entry::Folder => fs::create_dir_all(path)?,
                Entry::Old(content) => fs::write(path, content)?,
                Entry::File(file) => fs::write(path, state.content(file, luck))?,
            }
        }
        Ok(())
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Disk for SimulatedDisk {
    fn permit(&self, change: &Change<'_>) -> io::Result<usize> {
        let mut state = self.state();
        let now = state.asked;
        state.asked += 1;
        let room = match change {
            Change::Write { bytes, .. } => bytes.len(),
            _ => 0,
        };
        let taken = state.taken(change, now, self.trouble, room)?;
        state.remember(change, taken);
        Ok(taken)
    }
}

impl State {
    /// How many of `length` octets the disk takes.
    fn taken(
        &mut self,
        change: &Change<'_>,
        now: usize,
        trouble: Option<(usize, Trouble)>,
        length: usize,
    ) -> io::Result<usize> {
        let failed = |why: &str| Err(io::Error::other(why.to_owned()));
        if std::mem::take(&mut self.is_torn) {
            return failed("the disk failed");
        }
        let needs_room = matches!(change, Change::Write { .. } | Change::Open { .. } | Change::CreateFolder { .. });
        if matches!(change, Change::Remove { .. } | Change::RemoveFolder { .. }) {
            self.is_full = false;
        }
        match trouble {
            Some((at, Trouble::PowerLoss)) if now >= at => return failed("the power is off"),
            Some((at, trouble)) if now == at => match trouble {
                Trouble::Error => return failed("the disk failed"),
                Trouble::Full => self.is_full = true,
                Trouble::Torn if length > 1 => {
                    self.is_torn = true;
                    return Ok(length / 2);
                }
                Trouble::Torn => return failed("the disk failed"),
                Trouble::Interrupted if length > 0 => return Err(io::ErrorKind::Interrupted.into()),
                Trouble::Interrupted | Trouble::PowerLoss => {}
            },
            _ => {}
        }
        if self.is_full && needs_room {
            return Err(io::ErrorKind::StorageFull.into());
        }
        Ok(length)
    }

    fn remember(&mut self, change: &Change<'_>, taken: usize) {
        let own = Path::to_owned;
        self.made.push(match *change {
            Change::Open { file, path } => Made::Open(file, own(path)),
            Change::Write { file, bytes } => Made::Write(file, bytes[..taken].to_vec()),
            Change::Sync { file } => Made::Sync(file),
            Change::Rename { from, to } => Made::Rename(own(from), own(to)),
            Change::Remove { path } | Change::RemoveFolder { path } => Made::Remove(own(path)),
            Change::CreateFolder { path } => Made::CreateFolder(own(path)),
            Change::SyncFolder { path } => Made::SyncFolder(own(path)),
        });
    }

    /// The names after the power loss. A disk makes changes of names in their order; a folder that was synced has all until then.
    fn names(&self, before: &BTreeMap<PathBuf, Option<Vec<u8>>>, luck: Luck) -> BTreeMap<PathBuf, Entry> {
        let old = |content: &Option<Vec<u8>>| content.clone().map_or(Entry::Folder, Entry::Old);
        let mut names: BTreeMap<PathBuf, Entry> =
            before.iter().map(|(path, content)| (path.clone(), old(content))).collect();
        let sure = if luck == Luck::None { self.sure_names() } else { self.made.len() };
        for made in &self.made[..sure] {
            match made {
                Made::Open(file, path) => {
                    names.insert(path.clone(), Entry::File(*file));
                }
                Made::CreateFolder(path) => {
                    names.insert(path.clone(), Entry::Folder);
                }
                Made::Rename(from, to) => {
                    let moved: Vec<PathBuf> = names.keys().filter(|name| name.starts_with(from)).cloned().collect();
                    for name in moved {
                        let below = name.strip_prefix(from).unwrap_or(Path::new(""));
                        let new = if below.as_os_str().is_empty() { to.clone() } else { to.join(below) };
                        if let Some(entry) = names.remove(&name) {
                            names.insert(new, entry);
                        }
                    }
                }
                Made::Remove(path) => names.retain(|name, _| !name.starts_with(path)),
                Made::Write(..) | Made::Sync(_) | Made::SyncFolder(_) => {}
            }
        }
        names
    }

    /// How many of the changes are on the disk with all their names: those before the last one in a folder that was synced
    /// after it.
    fn sure_names(&self) -> usize {
        let is_synced = |at: usize, path: &Path| {
            let later = self.made[at..].iter();
            let folder = path.parent();
            later.into_iter().any(|made| matches!(made, Made::SyncFolder(synced) if Some(synced.as_path()) == folder))
        };
        let sure = self.made.iter().enumerate().rposition(|(at, made)| match made {
            Made::Open(_, path) | Made::Rename(_, path) | Made::Remove(path) | Made::CreateFolder(path) => {
                is_synced(at, path)
            }
            Made::Write(..) | Made::Sync(_) | Made::SyncFolder(_) => false,
        });
        sure.map_or(0, |at| at + 1)
    }

    /// What a file has after the power loss.
    fn content(&self, file: FileNumber, luck: Luck) -> Vec<u8> {
        let mut content = Vec::new();
        let mut sure = 0;
        for made in &self.made {
            match made {
                Made::Write(number, bytes) if *number == file => content.extend_from_slice(bytes),
                Made::Sync(number) if *number == file => sure = content.len(),
                _ => {}
            }
        }
        match luck {
            Luck::None | Luck::Names => content.truncate(sure),
            Luck::All => {}
            Luck::Torn => {
                content.truncate(sure.max(content.len() - content.len() % BLOCK));
                for (at, octet) in content.iter_mut().enumerate().skip(sure) {
                    if (at / BLOCK).is_multiple_of(2) {
                        *octet = 0;
                    }
                }
            }
        }
        content
    }
}
