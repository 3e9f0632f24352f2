//! Whether the files of a log have changed.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant, SystemTime};

use sextant_kernel::{Watch, Work};

use super::Arguments;
use crate::terminal::Watcher;

/// Folders in a log are looked into so far.
const DEPTH: usize = 3;
/// Files are looked at again after this time while a map is made.
const LOOK: Duration = Duration::from_millis(200);

/// Sizes of files and when they were changed.
pub(super) type Sizes = BTreeMap<PathBuf, (u64, Option<SystemTime>)>;

/// The files of the log that `arguments` name.
pub(super) fn sizes(arguments: &Arguments) -> Sizes {
    let mut sizes = Sizes::new();
    let files = [Some(arguments.log.as_path())].into_iter().chain(arguments.reading.files());
    for file in files.flatten() {
        // A file that cannot be looked at is told of when it is read.
        let _ = look(file, DEPTH, &mut sizes);
    }
    sizes
}

/// Notes the files at `path` and in folders below it.
fn look(path: &Path, depth: usize, sizes: &mut Sizes) -> io::Result<()> {
    let about = fs::metadata(path)?;
    if !about.is_dir() {
        sizes.insert(path.to_owned(), (about.len(), about.modified().ok()));
    } else if depth > 0 {
        for entry in fs::read_dir(path)? {
            look(&entry?.path(), depth - 1, sizes)?;
        }
    }
    Ok(())
}

/// Stops a map when the user interrupts, or when the files of its log are no longer as they were `seen`.
#[derive(Debug)]
pub(super) struct UntilGrown<'a> {
    watcher: Watcher<'a>,
    arguments: &'a Arguments,
    seen: &'a Sizes,
    looked: Mutex<Instant>,
    has_grown: AtomicBool,
}

impl<'a> UntilGrown<'a> {
    pub(super) fn new(watcher: Watcher<'a>, arguments: &'a Arguments, seen: &'a Sizes) -> Self {
        Self { watcher, arguments, seen, looked: Mutex::new(now()), has_grown: AtomicBool::new(false) }
    }

    /// Whether they have changed, as far as was looked. One thread looks, and the others go on.
    fn has_grown(&self) -> bool {
        if let Ok(mut looked) = self.looked.try_lock()
            && looked.elapsed() >= LOOK
        {
            if sizes(self.arguments) != *self.seen {
                self.has_grown.store(true, Ordering::Relaxed);
            }
            *looked = now();
        }
        self.has_grown.load(Ordering::Relaxed)
    }
}

impl Watch for UntilGrown<'_> {
    fn begin(&self, work: Work) {
        self.watcher.begin(work);
    }

    fn advance(&self, steps: u64) {
        self.watcher.advance(steps);
    }

    fn is_stopped(&self) -> bool {
        self.watcher.is_stopped() || self.has_grown()
    }
}

fn now() -> Instant {
    #[expect(clippy::disallowed_methods, reason = "a log grows by the wall clock")]
    Instant::now()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_in_folders_are_looked_at_too() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("bag")).unwrap();
        fs::write(folder.path().join("bag/part.mcap"), "abc").unwrap();
        let mut sizes = Sizes::new();
        look(folder.path(), DEPTH, &mut sizes).unwrap();
        assert_eq!(sizes.values().map(|size| size.0).collect::<Vec<_>>(), [3]);
    }
}
