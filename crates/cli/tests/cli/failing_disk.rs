//! A disk that is full for a short time.

use std::io::{self, Write};

/// Accepts `room` octets, fails one write, and accepts all later ones, as if space had been freed.
pub(crate) struct FailingDisk {
    room: usize,
    failed: bool,
}

impl FailingDisk {
    /// A disk with space for `room` octets.
    pub(crate) fn new(room: usize) -> Self {
        Self { room, failed: false }
    }
}

impl Write for FailingDisk {
    fn write(&mut self, octets: &[u8]) -> io::Result<usize> {
        if !self.failed && octets.len() > self.room {
            self.failed = true;
            return Err(io::Error::new(io::ErrorKind::StorageFull, "no space left"));
        }
        self.room = self.room.saturating_sub(octets.len());
        Ok(octets.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
