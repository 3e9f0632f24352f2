//! Applications and the phases of a run.

use std::io::Write;

use mcap::records::Metadata;
use sextant_channel::Position;
use sextant_kernel::SimTime;

use super::super::drawing;
use super::super::error::RecordingError;
use super::super::messages::applications::{ApplicationMessage, CaptureMessage, EstimateMessage};
use super::Recorder;
use crate::messages::names::{ApplicationTopics, PHASES_METADATA};
use crate::messages::phase::{self, Phase};

impl<W: Write> Recorder<W> {
    /// Writes the phases of the run, at its end.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn phases(&mut self, phases: &[Phase]) -> Result<(), RecordingError> {
        self.describe(&Metadata { name: PHASES_METADATA.to_owned(), metadata: phase::record(phases) })
    }

    /// Writes what an application is, where its phase begins.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn application(&mut self, time: SimTime, application: &ApplicationMessage) -> Result<(), RecordingError> {
        self.write(time, &ApplicationTopics::new(&application.name).description, application)
    }

    /// Writes what an application worked out about the world.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn estimate(&mut self, application: &str, estimate: &EstimateMessage) -> Result<(), RecordingError> {
        let topics = ApplicationTopics::new(application);
        self.write(SimTime::from_nanos(estimate.time_ns), &topics.estimates, estimate)
    }

    /// Writes that a robot of an application captured a target, and marks the place.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn capture(&mut self, application: &str, capture: &CaptureMessage) -> Result<(), RecordingError> {
        let topics = ApplicationTopics::new(application);
        self.write(SimTime::from_nanos(capture.time_ns), &topics.captures, capture)?;
        self.captured(application, capture)
    }

    /// Writes the path of `robot` in an application (m).
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn application_path(
        &mut self,
        time: SimTime,
        application: &str,
        robot: &str,
        places: &[Position],
    ) -> Result<(), RecordingError> {
        let topics = ApplicationTopics::new(application);
        self.write(time, &format!("{}{robot}", topics.paths), &drawing::path(time, places))
    }
}
