//! Room for a plan in a folder, also where one was begun and not finished.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use sextant_recording::disk::{self, DiskFile};
use sextant_recording::output::{OutputError, is_claimed};

use super::plan_file::PlanFile;
use super::{Campaign, CampaignError, FILES, PARTS, Replace, slurm, work_file};

/// Stands in the folder until the plan is complete, so that a plan which was cut off is known as one.
const UNFINISHED: &str = "unfinished";

/// All that a plan has in its folder. The first one makes it a plan.
const CONTENTS: [&str; 6] = [PlanFile::NAME, FILES, work_file::LINES, work_file::TABLE, PARTS, slurm::FOLDER];

/// A folder in which a plan is being written, by this process alone.
#[derive(Debug)]
#[must_use]
pub(super) struct Room {
    mark: PathBuf,
    /// Locked as long as the plan is being written.
    _lock: DiskFile,
}

/// Fails if `folder` has something else than a plan that may be replaced, or the beginning of one.
pub(super) fn check(folder: &Path, replace: Replace) -> Result<(), CampaignError> {
    let is_plan = Campaign::is_in(folder);
    if is_plan && replace == Replace::Nothing {
        return Err(CampaignError::Exists { folder: folder.to_owned() });
    }
    let is_own = is_plan || folder.join(UNFINISHED).is_file();
    match names(folder)?.into_iter().find(|name| !(is_own && is_of_plan(name))) {
        None => Ok(()),
        Some(found) => Err(CampaignError::NotEmpty { folder: folder.to_owned(), found }),
    }
}

/// Makes `folder` an empty one but for its mark.
pub(super) fn make(folder: &Path, replace: Replace) -> Result<Room, CampaignError> {
    check(folder, replace)?;
    let unwritten = |path: &Path, error: &io::Error| CampaignError::from(OutputError::new(path, error));
    disk::create_folders(folder).map_err(|error| unwritten(folder, &error))?;
    let mark = folder.join(UNFINISHED);
    let lock = locked(&mark).map_err(|error| unwritten(folder, &error))?;
    // Another process may have written a plan since the first look.
    check(folder, replace).inspect_err(|_| {
        // Only the first error is reported.
        let _ = disk::remove_file(&mark);
    })?;
    let mut old = names(folder)?;
    // The file that makes it a plan goes first.
    old.sort_by_key(|name| CONTENTS.iter().position(|own| name == own));
    for name in old.iter().filter(|name| *name != UNFINISHED) {
        let path = folder.join(name);
        let removed = if path.is_dir() { disk::remove_folder(&path) } else { disk::remove_file(&path) };
        removed.map_err(|error| unwritten(&path, &error))?;
    }
    Ok(Room { mark, _lock: lock })
}

/// The mark, which no other process has.
///
/// # Errors
/// If another process writes a plan there, or the mark cannot be written.
fn locked(mark: &Path) -> io::Result<DiskFile> {
    let busy = || io::Error::new(io::ErrorKind::WouldBlock, "another process writes a plan there");
    let file = match DiskFile::create_new(mark) {
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => match DiskFile::open(mark) {
            // The other process has just finished.
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Err(busy()),
            opened => opened?,
        },
        created => created?,
    };
    if !is_claimed(file.system(), mark) {
        return Err(busy());
    }
    disk::sync_folder_of(mark)?;
    Ok(file)
}

impl Room {
    /// Says that the plan is complete.
    pub(super) fn complete(self) -> Result<(), CampaignError> {
        Ok(disk::remove_file(&self.mark).map_err(|error| OutputError::new(&self.mark, &error))?)
    }
}

/// Whether a plan has a file of this name, or had one for a moment.
fn is_of_plan(name: &str) -> bool {
    CONTENTS.contains(&name) || name == UNFINISHED || name.ends_with(".part")
}

/// What is in `folder`; nothing if it does not exist.
fn names(folder: &Path) -> Result<Vec<String>, CampaignError> {
    let found = match fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        other => other
            .and_then(|entries| entries.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned())).collect()),
    };
    Ok(found.map_err(|error| OutputError::new(folder, &error))?)
}
