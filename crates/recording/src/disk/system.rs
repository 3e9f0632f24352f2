//! The disk of the system, which needs no question before a change.

use std::io;
use std::path::Path;

use super::change::Change;

/// Nothing is asked about a change.
pub(super) const fn permit(_path: &Path, _change: &Change<'_>) -> io::Result<()> {
    Ok(())
}

/// The disk under an open file: that of the system.
#[derive(Debug)]
pub(super) struct FileDisk;

impl FileDisk {
    pub(super) const fn under(_path: &Path) -> Self {
        Self
    }

    pub(super) const fn permit_opening(&self, _path: &Path) -> io::Result<()> {
        Ok(())
    }

    pub(super) const fn permit_sync(&self) -> io::Result<()> {
        Ok(())
    }

    /// The system decides how many octets are taken.
    pub(super) const fn taken(&self, _bytes: &[u8]) -> io::Result<Option<usize>> {
        Ok(None)
    }
}
