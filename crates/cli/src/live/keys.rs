//! Pause and step from the terminal.

use std::io::{self, IsTerminal};
use std::sync::Arc;
use std::thread;

use super::pace::Pace;

/// How it is done.
pub(super) const HELP: &str = "Enter pauses and resumes, `s` and Enter steps";

/// Whether somebody can press keys.
pub(super) fn has_keys() -> bool {
    io::stdin().is_terminal()
}

/// Reads lines until the end of standard input.
pub(super) fn listen(pace: &Arc<Pace>) {
    let pace = Arc::clone(pace);
    thread::spawn(move || {
        for line in io::stdin().lines().map_while(Result::ok) {
            match line.trim() {
                "" => pace.toggle(),
                "s" => pace.step(),
                _ => continue,
            };
        }
    });
}
