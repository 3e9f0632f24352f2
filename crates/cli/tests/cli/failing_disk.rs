//! A disk that is full for a moment.

use std::io::{self, Write};

/// Takes `room` octets, refuses one write, and takes all later ones: like a disk on which somebody makes room.
pub(crate) struct FailingDisk {
    room: usize,
    failed: bool,
}

impl FailingDisk {
    /// A disk with `room` for this many octets.
    pub(crate) fn new(room: usize) -> Self {
        Self { room, failed: false }
    }
}

impl Write for FailingDisk {
    fn write(&mut self, octets: &[u8]) -> io::Result<usize> {
        if !self.failed && octets.len() > self.room {
            self.failed = true;
            return Err(io::Error::new(io::ErrorKind::StorageFull, "no room for it"));
        }
        self.room = self.room.saturating_sub(octets.len());
        Ok(octets.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
