//! Ctrl-C and other signals that end the program.

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use sextant_kernel::{Watch, Work};
use sextant_recording::disk;

use crate::diagnostic::Failure;

/// Time that the work has to end by itself when there is nothing to keep.
const GRACE: Duration = Duration::from_millis(500);
/// Time between two checks whether results still have to be kept.
const LOOK: Duration = Duration::from_millis(20);

/// Tells whether the user wants the work to end. After the first signal the process ends within a second, or as soon as
/// the results to [keep](Self::keep) are written. A second signal ends it at once. [Temporary](Self::temporary) files are
/// removed in both cases.
#[derive(Clone, Debug, Default)]
pub(crate) struct Interrupt {
    is_requested: Arc<AtomicBool>,
    /// Whether SIGTERM came: a scheduler or an administrator ends the process, not its user.
    is_terminated: Arc<AtomicBool>,
    keepers: Arc<AtomicUsize>,
    temporaries: Temporaries,
}

/// While it exists, the first signal does not end the process: the work ends by itself.
#[derive(Debug)]
#[must_use]
pub(crate) struct Keeper(Arc<AtomicUsize>);

/// A temporary file, which is removed when this value is dropped or a signal ends the process.
#[derive(Debug)]
#[must_use]
pub(crate) struct Temporary {
    path: PathBuf,
    temporaries: Temporaries,
}

/// The temporary files of the process.
#[derive(Clone, Debug, Default)]
struct Temporaries(Arc<Mutex<BTreeSet<PathBuf>>>);

impl Temporaries {
    fn change<T>(&self, change: impl FnOnce(&mut BTreeSet<PathBuf>) -> T) -> T {
        change(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Removes the files; the process ends next.
    fn remove(&self) {
        self.change(|paths| {
            for path in paths.iter() {
                // A file that has got its final name is no longer there.
                let _ = disk::remove_file(path);
            }
        });
    }
}

impl Interrupt {
    /// Installs the handler of SIGINT, SIGTERM and SIGHUP (Ctrl-C on Windows). Call it once per process.
    ///
    /// # Errors
    /// If the system rejects the handler.
    pub(crate) fn install() -> Result<Self, Failure> {
        let interrupt = Self::default();
        let Self { is_requested, is_terminated, keepers, temporaries } = interrupt.clone();
        ctrlc::set_handler(move || {
            if is_requested.swap(true, Ordering::SeqCst) {
                temporaries.remove();
                std::process::exit(130);
            }
            let (keepers, temporaries) = (Arc::clone(&keepers), temporaries.clone());
            thread::spawn(move || {
                thread::sleep(GRACE);
                while keepers.load(Ordering::SeqCst) > 0 {
                    thread::sleep(LOOK);
                }
                temporaries.remove();
                // If standard error is closed, nobody can be told.
                let _ = writeln!(io::stderr(), "interrupted");
                std::process::exit(130);
            });
        })
        .map_err(|error| Failure::failed(format!("Ctrl-C cannot be handled: {error}")))?;
        note_termination(is_terminated)?;
        Ok(interrupt)
    }

    /// Whether SIGTERM ended the work, as schedulers send it before they kill a process.
    #[must_use]
    pub(crate) fn is_terminated(&self) -> bool {
        self.is_terminated.load(Ordering::Relaxed)
    }

    /// Whether the work should end.
    #[must_use]
    pub(crate) fn is_requested(&self) -> bool {
        self.is_requested.load(Ordering::Relaxed)
    }

    /// Keeps the process alive after the first signal, so that open files can be finished and results written. The
    /// work must check often whether it should end.
    pub(crate) fn keep(&self) -> Keeper {
        self.keepers.fetch_add(1, Ordering::SeqCst);
        Keeper(Arc::clone(&self.keepers))
    }

    /// Marks the file at `path`, which may not exist yet, as temporary.
    pub(crate) fn temporary(&self, path: &Path) -> Temporary {
        self.temporaries.change(|paths| paths.insert(path.to_owned()));
        Temporary { path: path.to_owned(), temporaries: self.temporaries.clone() }
    }
}

/// Sets `flag` when SIGTERM comes, before the handler of all signals is called.
#[cfg(unix)]
fn note_termination(flag: Arc<AtomicBool>) -> Result<(), Failure> {
    signal_hook::flag::register(signal_hook::consts::SIGTERM, flag)
        .map(|_| ())
        .map_err(|error| Failure::failed(format!("SIGTERM cannot be handled: {error}")))
}

/// There is no such signal.
#[cfg(not(unix))]
fn note_termination(_: Arc<AtomicBool>) -> Result<(), Failure> {
    Ok(())
}

impl Drop for Keeper {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::SeqCst);
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        self.temporaries.change(|paths| {
            // A file that has got its final name is no longer there.
            let _ = disk::remove_file(&self.path);
            paths.remove(&self.path);
        });
    }
}

/// Stops work without showing its progress.
impl Watch for Interrupt {
    fn begin(&self, _: Work) {}

    fn advance(&self, _: u64) {}

    fn is_stopped(&self) -> bool {
        self.is_requested()
    }
}
