//! Progress messages on the terminal.

use std::io::{self, IsTerminal, Write};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use indicatif::{ProgressDrawTarget, ProgressStyle};
use sextant_kernel::text::{message, printable};
use sextant_kernel::{Watch, Work};

use crate::interrupt::Interrupt;

/// Prints a warning on standard error.
pub(crate) fn warn(warning: &str) {
    say(&format!("warning: {warning}"));
}

/// Prints a line on standard error.
pub(crate) fn say(line: &str) {
    // If standard error is closed, nobody can be told.
    let _ = writeln!(io::stderr(), "{}", message(line));
}

/// Standard output of results.
pub(crate) fn stdout() -> Stdout {
    Stdout(io::stdout().lock())
}

/// Standard output, on which control characters are written as `\\u{1b}`: results may hold names from files of others.
#[derive(Debug)]
pub(crate) struct Stdout(io::StdoutLock<'static>);

impl Write for Stdout {
    fn write(&mut self, octets: &[u8]) -> io::Result<usize> {
        // A character may be cut in two; its first part waits for the second one.
        let whole = match str::from_utf8(octets) {
            Ok(text) => text,
            Err(error) if error.error_len().is_none() && error.valid_up_to() > 0 => {
                str::from_utf8(&octets[..error.valid_up_to()]).unwrap_or_default()
            }
            Err(_) => return self.0.write(octets),
        };
        self.0.write_all(printable(whole).as_bytes())?;
        Ok(whole.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

/// A progress bar on standard error. Nothing is drawn if standard error is not a terminal, or with `--quiet`.
#[derive(Clone, Debug)]
pub(crate) struct ProgressBar(indicatif::ProgressBar);

impl ProgressBar {
    /// A bar for `total` steps of `what`.
    #[must_use]
    pub(crate) fn new(what: &'static str, total: u64, quiet: bool) -> Self {
        let bar = if quiet || !io::stderr().is_terminal() {
            indicatif::ProgressBar::hidden()
        } else {
            indicatif::ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr_with_hz(10))
        };
        let style = ProgressStyle::with_template("{prefix:>10} [{bar:30}] {pos}/{len} {msg}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> "));
        bar.set_prefix(what);
        bar.enable_steady_tick(Duration::from_millis(250));
        Self(bar)
    }

    /// Shows that `done` steps are done, and `note` beside the bar.
    pub(crate) fn set(&self, done: u64, note: String) {
        self.0.set_position(done);
        self.0.set_message(note);
    }

    /// Removes the bar.
    pub(crate) fn clear(&self) {
        self.0.finish_and_clear();
    }
}

/// Work of at least this many operations (about a minute) is announced by a line if no bar can be drawn.
const LARGE: f64 = 3e10;

/// Shows the progress of maps on standard error, and stops them when the user interrupts. Without a terminal it only
/// prints a line for large work; with `--quiet` it prints nothing.
#[derive(Debug)]
pub(crate) struct Watcher<'a> {
    interrupt: &'a Interrupt,
    is_quiet: bool,
    bar: Mutex<Option<indicatif::ProgressBar>>,
}

impl<'a> Watcher<'a> {
    /// A watcher of work that has not begun.
    #[must_use]
    pub(crate) fn new(interrupt: &'a Interrupt, is_quiet: bool) -> Self {
        Self { interrupt, is_quiet, bar: Mutex::default() }
    }

    /// Removes the bar.
    pub(crate) fn clear(&self) {
        if let Some(bar) = self.bar.lock().unwrap_or_else(PoisonError::into_inner).take() {
            bar.finish_and_clear();
        }
    }
}

impl Watch for Watcher<'_> {
    fn begin(&self, work: Work) {
        self.clear();
        if self.is_quiet {
            return;
        }
        if io::stderr().is_terminal() {
            let bar =
                indicatif::ProgressBar::with_draw_target(Some(work.steps), ProgressDrawTarget::stderr_with_hz(10));
            let style = ProgressStyle::with_template("{prefix:>10} [{bar:30}] {pos}/{len} {msg}, {eta} left");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> "));
            bar.set_prefix(work.name);
            bar.set_message(format!("{}s", work.unit));
            bar.enable_steady_tick(Duration::from_millis(250));
            *self.bar.lock().unwrap_or_else(PoisonError::into_inner) = Some(bar);
        } else if work.operations >= LARGE {
            // If standard error is closed, nobody can be told.
            let _ = writeln!(
                io::stderr(),
                "note: {}: {} {}s, at most {:.0e} operations",
                work.name,
                work.steps,
                work.unit,
                work.operations
            );
        }
    }

    fn advance(&self, steps: u64) {
        if self.is_quiet {
            return;
        }
        if let Some(bar) = &*self.bar.lock().unwrap_or_else(PoisonError::into_inner) {
            bar.inc(steps);
        }
    }

    fn is_stopped(&self) -> bool {
        self.interrupt.is_requested()
    }
}

impl Drop for Watcher<'_> {
    fn drop(&mut self) {
        self.clear();
    }
}
