//! Reads everything that figures need from a recording, in one pass.

use std::path::Path;

use super::activity::{self, RecordedActivity};
use super::packets::{self, RecordedPacket};
use super::run::{RecordedRun, RunReading, sound};
use super::world::{RecordedWorld, WorldReading};
use crate::error::RecordingError;

/// Everything in a recording that figures need.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// The reception log, with metadata and attachments.
    pub run: RecordedRun,
    /// Everything with a position.
    pub world: RecordedWorld,
    /// The packets in the order in which they ended; none if packets were not recorded.
    pub packets: Vec<RecordedPacket>,
    /// What radios did besides, if packets were recorded.
    pub activity: RecordedActivity,
}

/// Reads the recording `path` of a run: what [`read_run`](crate::read_run), [`read_world`](crate::read_world) and
/// [`read_packets`](crate::read_packets) read, in a third of the time.
///
/// # Errors
/// Those of these three.
pub fn read_recording(path: &Path) -> Result<Recording, RecordingError> {
    let (mut run, mut world) = (RunReading::default(), WorldReading::default());
    let (mut packets, mut activity) = (Vec::new(), RecordedActivity::default());
    sound(path, &mut |piece| {
        run.take(path, &piece)?;
        world.take(path, &piece)?;
        activity::take(&mut activity, path, &piece)?;
        packets::take(&mut packets, path, &piece)
    })?;
    Ok(Recording { run: run.finish(path)?, world: world.finish(), packets, activity })
}
