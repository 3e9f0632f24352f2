//! Ctrl-C and requests to terminate.

use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

use sextant_kernel::{Watch, Work};

use crate::diagnostic::Failure;

/// What work gets to end by itself if there is nothing to keep.
const GRACE: Duration = Duration::from_millis(500);
/// How often it is looked whether what is to be kept is whole.
const LOOK: Duration = Duration::from_millis(20);

/// Knows whether the user wants the work to end. After the first request the process ends within a second, or as soon as
/// what is to be [kept](Self::keep) is whole; the second one ends it at once.
#[derive(Clone, Debug, Default)]
pub struct Interrupt {
    is_requested: Arc<AtomicBool>,
    keepers: Arc<AtomicUsize>,
}

/// While it lives, the process is not ended but ends by itself.
#[derive(Debug)]
#[must_use]
pub struct Keeper(Arc<AtomicUsize>);

impl Interrupt {
    /// Listens for SIGINT, SIGTERM and SIGHUP (Ctrl-C on Windows). At most once a process.
    ///
    /// # Errors
    /// If the system refuses the handler.
    pub fn install() -> Result<Self, Failure> {
        let interrupt = Self::default();
        let Self { is_requested, keepers } = interrupt.clone();
        ctrlc::set_handler(move || {
            if is_requested.swap(true, Ordering::SeqCst) {
                std::process::exit(130);
            }
            let keepers = Arc::clone(&keepers);
            thread::spawn(move || {
                thread::sleep(GRACE);
                while keepers.load(Ordering::SeqCst) > 0 {
                    thread::sleep(LOOK);
                }
                // Nobody is left to be told if standard error is gone.
                let _ = writeln!(io::stderr(), "interrupted");
                std::process::exit(130);
            });
        })
        .map_err(|error| Failure::failed(format!("Ctrl-C cannot be handled: {error}")))?;
        Ok(interrupt)
    }

    /// Whether the work should end.
    #[must_use]
    pub fn is_requested(&self) -> bool {
        self.is_requested.load(Ordering::Relaxed)
    }

    /// From now on there is something to be kept: files that are whole only when they are finished, or results that are yet
    /// to be written. The work then has to look often whether it should end.
    pub fn keep(&self) -> Keeper {
        self.keepers.fetch_add(1, Ordering::SeqCst);
        Keeper(Arc::clone(&self.keepers))
    }
}

impl Drop for Keeper {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::SeqCst);
    }
}

/// Ends work without showing how far it is.
impl Watch for Interrupt {
    fn begin(&self, _: Work) {}

    fn advance(&self, _: u64) {}

    fn is_stopped(&self) -> bool {
        self.is_requested()
    }
}
