//! Captures of frames for protocol analysers, with timestamps in nanoseconds: IEEE 802.15.4 with TAP headers, IEEE
//! 802.11ad with radiotap headers.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use sextant_channel::Dbm;
use sextant_kernel::SimTime;

use super::error::RecordingError;
use crate::disk::DiskFile;
use crate::output::{Draft, DraftError, PART};

mod container;
mod radiotap;

use super::link_quality::link_quality;
use container::LinkType;
pub use container::Technologies;
pub(crate) use container::is_of_simulation;
pub use radiotap::CapturedDmgFrame;

/// Types of the fields of a TAP header (IEEE 802.15.4 TAP, section 4).
mod field {
    pub(super) const FCS_TYPE: u16 = 0;
    pub(super) const RSS: u16 = 1;
    pub(super) const CHANNEL_ASSIGNMENT: u16 = 3;
    pub(super) const START_OF_FRAME: u16 = 5;
    pub(super) const END_OF_FRAME: u16 = 6;
    pub(super) const LINK_QUALITY: u16 = 10;
}
/// FCS type of a 16-bit CRC.
const CRC_16: u8 = 1;

/// A frame of IEEE 802.15.4 in a capture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CapturedFrame<'a> {
    /// First symbol on air.
    pub start: SimTime,
    /// Time on air.
    pub airtime: Duration,
    /// The MAC frame (MPDU) with its check sequence.
    pub mpdu: &'a [u8],
    /// Number of the radio channel.
    pub channel: u8,
    /// Channel page: 0, or 1 for ASK and 2 for O-QPSK below 1 GHz.
    pub page: u8,
    /// How it was received, if the capture is by one receiver.
    pub signal: Option<Signal>,
}

/// How a frame was received.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Signal {
    /// Received signal strength (dBm).
    pub power: Dbm,
    /// The lowest power that this receiver can receive (dBm).
    pub sensitivity: Dbm,
}

impl Signal {
    /// Its link quality: see [`link_quality`].
    #[must_use]
    pub fn link_quality(&self) -> u8 {
        link_quality(self.power, self.sensitivity)
    }
}

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
        let end = frame.start + frame.airtime;
        self.record.clear();
        // Version, reserved octet, length of the TAP header.
        self.record.extend([0; 4]);
        self.field(field::FCS_TYPE, &[CRC_16]);
        if let Some(signal) = frame.signal {
            #[expect(clippy::cast_possible_truncation, reason = "the format has single precision")]
            let power_dbm = signal.power.0 as f32;
            self.field(field::RSS, &power_dbm.to_le_bytes());
        }
        self.field(field::CHANNEL_ASSIGNMENT, &[frame.channel, 0, frame.page]);
        self.field(field::START_OF_FRAME, &frame.start.as_nanos().to_le_bytes());
        self.field(field::END_OF_FRAME, &end.as_nanos().to_le_bytes());
        if let Some(signal) = frame.signal {
            self.field(field::LINK_QUALITY, &[signal.link_quality()]);
        }
        let header_octets = u16::try_from(self.record.len()).expect("six fields of at most 12 octets");
        self.record[2..4].copy_from_slice(&header_octets.to_le_bytes());
        self.record.extend(frame.mpdu);
        self.write_record(LinkType::Tap, end)
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

    /// A field of the TAP header: type, length, value, zeros up to a multiple of four octets.
    fn field(&mut self, kind: u16, value: &[u8]) {
        let octets = u16::try_from(value.len()).expect("at most eight octets");
        self.record.extend(kind.to_le_bytes());
        self.record.extend(octets.to_le_bytes());
        self.record.extend(value);
        self.record.extend(std::iter::repeat_n(0, value.len().next_multiple_of(4) - value.len()));
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
