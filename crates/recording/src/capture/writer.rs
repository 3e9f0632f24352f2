//! Captures of frames for protocol analysers, with timestamps in nanoseconds: IEEE 802.15.4 with TAP headers, IEEE
//! 802.11ad with radiotap headers.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use sextant_kernel::SimTime;

use super::frame::{CapturedDmgFrame, CapturedFrame};
use super::technologies::{LinkType, Technologies};
use super::{radiotap, tap};
use crate::disk::DiskFile;
use crate::error::RecordingError;
use crate::output::{Draft, DraftError, PART};

/// Writes a capture. The timestamp of a frame is its end, when a receiver has all of it; its start is in its header. After
/// the first failure, every call returns the same failure.
pub struct Capture<W: Write> {
    output: W,
    path: PathBuf,
    technologies: Technologies,
    /// Header and frame.
    record: Vec<u8>,
    /// What is written to the file.
    octets: Vec<u8>,
    failure: Option<RecordingError>,
}

impl<W: Write> Capture<W> {
    /// A capture of frames of these technologies that is written to `output`; `path` is its name in errors.
    ///
    /// # Errors
    /// If the header cannot be written.
    pub fn new(output: W, path: &Path, technologies: Technologies) -> Result<Self, RecordingError> {
        let (record, octets) = (Vec::with_capacity(256), Vec::with_capacity(256));
        let mut capture = Self { output, path: path.to_owned(), technologies, record, octets, failure: None };
        technologies.header(&mut capture.octets);
        capture.write_octets()?;
        Ok(capture)
    }

    /// Writes a frame of IEEE 802.15.4.
    ///
    /// # Errors
    /// If a write failed, now or before.
    ///
    /// # Panics
    /// If the capture is not for this technology.
    pub fn frame(&mut self, frame: &CapturedFrame<'_>) -> Result<(), RecordingError> {
        self.record.clear();
        tap::write(frame, &mut self.record);
        self.write_record(LinkType::Tap, frame.start + frame.airtime)
    }

    /// Writes a frame of IEEE 802.11ad.
    ///
    /// # Errors
    /// If a write failed, now or before.
    ///
    /// # Panics
    /// If the capture is not for this technology.
    pub fn dmg_frame(&mut self, frame: &CapturedDmgFrame<'_>) -> Result<(), RecordingError> {
        self.record.clear();
        radiotap::write(frame, &mut self.record);
        self.write_record(LinkType::Radiotap, frame.start + frame.airtime)
    }

    fn write_record(&mut self, link: LinkType, stamp: SimTime) -> Result<(), RecordingError> {
        if let Some(failure) = &self.failure {
            return Err(failure.clone());
        }
        self.octets.clear();
        self.technologies.record(link, stamp, &self.record, &mut self.octets);
        self.write_octets()
    }

    fn write_octets(&mut self) -> Result<(), RecordingError> {
        self.output.write_all(&self.octets).map_err(|why| {
            let failure = unwritten(&self.path, why);
            self.failure = Some(failure.clone());
            failure
        })
    }

    /// Flushes and returns the output.
    ///
    /// # Errors
    /// If a write failed, now or before.
    pub fn into_output(mut self) -> Result<W, RecordingError> {
        match self.failure {
            Some(failure) => Err(failure),
            None => self.output.flush().map(|()| self.output).map_err(|why| unwritten(&self.path, why)),
        }
    }
}

fn unwritten(path: &Path, why: io::Error) -> RecordingError {
    RecordingError::WriteCapture { path: path.to_owned(), why: why.to_string() }
}

/// A capture in the file `PATH.part`, which is renamed when it is complete.
pub struct FileCapture {
    capture: Capture<BufWriter<DiskFile>>,
    draft: Draft,
}

impl FileCapture {
    /// A capture of frames of these technologies for the file `path`. An existing file is replaced when the capture is
    /// finished.
    ///
    /// # Errors
    /// If the file `PATH.part` cannot be created, or `path` is a folder.
    pub fn create(path: &Path, technologies: Technologies) -> Result<Self, RecordingError> {
        let draft = Draft::new(path, PART);
        let capture = Capture::new(draft.open()?, &draft.part, technologies)?;
        Ok(Self { capture, draft })
    }

    /// Writes a frame of IEEE 802.15.4.
    ///
    /// # Errors
    /// If a write failed, now or before.
    pub fn frame(&mut self, frame: &CapturedFrame<'_>) -> Result<(), RecordingError> {
        self.capture.frame(frame)
    }

    /// Writes a frame of IEEE 802.11ad.
    ///
    /// # Errors
    /// If a write failed, now or before.
    pub fn dmg_frame(&mut self, frame: &CapturedDmgFrame<'_>) -> Result<(), RecordingError> {
        self.capture.dmg_frame(frame)
    }

    /// Syncs the file to the disk, renames `PATH.part` to `PATH` and syncs the folder.
    ///
    /// # Errors
    /// If a write failed, now or before. The file `PATH.part` is then kept.
    pub fn finish(self) -> Result<(), RecordingError> {
        self.draft.name(self.capture.into_output()?).map_err(|error| match error {
            DraftError::Write { path, why } => unwritten(&path, why),
            other => other.into(),
        })
    }
}
