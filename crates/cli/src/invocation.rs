//! How the program was called.

use std::env;
use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};

/// The program that was called, and its words.
#[derive(Clone, Debug)]
pub struct Invocation {
    program: Option<PathBuf>,
    words: Vec<OsString>,
}

impl Invocation {
    /// This process.
    #[must_use]
    pub fn of_process() -> Self {
        Self { program: None, words: env::args_os().skip(1).collect() }
    }

    /// The program at `program`, called with `words`: a script that calls [`main`](crate::main), for example.
    pub fn of_script(program: impl Into<PathBuf>, words: impl IntoIterator<Item = OsString>) -> Self {
        Self { program: Some(program.into()), words: words.into_iter().collect() }
    }

    /// The words after the name of the program.
    pub(crate) fn words(&self) -> &[OsString] {
        &self.words
    }

    /// Where the program is, so that a scheduler can call it.
    pub(crate) fn program(&self) -> io::Result<PathBuf> {
        self.program.as_deref().map_or_else(env::current_exe, Path::canonicalize)
    }
}
