//! Recordings in files.

use std::io::BufWriter;
use std::path::Path;

use super::super::error::RecordingError;
use super::Recorder;
use crate::container::sink::Sink;
use crate::disk::DiskFile;
use crate::output::{Draft, PART};

/// A recorder that writes to `PATH.part` and renames it to `PATH` at the end.
pub struct FileRecorder {
    recorder: Recorder<BufWriter<DiskFile>>,
    draft: Draft,
}

impl FileRecorder {
    /// A recorder for the file `path`. An existing file is replaced when the recording is finished.
    ///
    /// # Errors
    /// If the file `PATH.part` cannot be created, or `path` is a folder.
    pub fn create(path: &Path) -> Result<Self, RecordingError> {
        let draft = Draft::new(path, PART);
        let sink = Sink::create(&draft)?;
        Ok(Self { recorder: Recorder::from_sink(sink), draft })
    }

    /// Writes the summary section, syncs the file to the disk, renames `PATH.part` to `PATH` and syncs the folder.
    ///
    /// # Errors
    /// If any write failed, now or before. The file `PATH.part` is then kept.
    pub fn finish(self) -> Result<(), RecordingError> {
        self.recorder.sink.publish(&self.draft)
    }
}

impl std::ops::Deref for FileRecorder {
    type Target = Recorder<BufWriter<DiskFile>>;

    fn deref(&self) -> &Self::Target {
        &self.recorder
    }
}

impl std::ops::DerefMut for FileRecorder {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.recorder
    }
}
