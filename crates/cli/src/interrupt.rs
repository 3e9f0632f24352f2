//! Ctrl-C and requests to terminate.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::diagnostic::Failure;

/// Knows whether the user wants the work to end. The first request lets the work finish its files; the
/// second one ends the process at once.
#[derive(Clone, Debug, Default)]
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Listens for SIGINT, SIGTERM and SIGHUP (Ctrl-C on Windows). At most once a process.
    ///
    /// # Errors
    /// If the system refuses the handler.
    pub fn install() -> Result<Self, Failure> {
        let interrupt = Self::default();
        let requested = Arc::clone(&interrupt.0);
        ctrlc::set_handler(move || {
            if requested.swap(true, Ordering::Relaxed) {
                std::process::exit(130);
            }
        })
        .map_err(|error| Failure::failed(format!("Ctrl-C cannot be handled: {error}")))?;
        Ok(interrupt)
    }

    /// Whether the work should end.
    #[must_use]
    pub fn is_requested(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
