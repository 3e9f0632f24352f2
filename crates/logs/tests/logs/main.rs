//! Logs of robots as people have them.

#![allow(clippy::disallowed_methods, reason = "oracles may be those of the C library")]
#![expect(clippy::unwrap_used, reason = "a test fails at the first error")]

mod gatherer;
mod local_plane;
mod memory_tables;
mod packets;
mod receptions;

/// A folder with these files.
fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}
