//! The path of a robot in a simulation, and how it is drawn while the recording plays.

use sextant_channel::Position;
use sextant_kernel::SimTime;
use sextant_recording::{FileRecorder, RecordingError};

/// The whole way is drawn again after this many places at least.
const LEAST_PLACES: usize = 8;
/// It is drawn again when this share of it is new, so that all its drawings together are a few times as long as the path.
const NEW_SHARE: usize = 8;

/// The path of a robot.
pub(super) struct CommandTrack {
    pub(super) name: String,
    pub(super) places: Vec<Position>,
    pub(super) heading_rad: f64,
    /// Number of places in the last drawing of the whole way.
    drawn: usize,
}

impl CommandTrack {
    /// That of a robot that was not seen yet.
    pub(super) fn new(name: &str) -> Self {
        Self { name: name.to_owned(), places: Vec::new(), heading_rad: 0.0, drawn: 0 }
    }

    /// Adds a place, if the robot was not there already. Returns whether it is new.
    pub(super) fn push(&mut self, place: Position) -> bool {
        let is_new = self.places.last() != Some(&place);
        if is_new {
            self.places.push(place);
        }
        is_new
    }

    /// Draws the leg to the last place, or the whole way where that is due.
    pub(super) fn draw_leg(
        &mut self,
        time: SimTime,
        application: Option<&str>,
        recorder: &mut FileRecorder,
    ) -> Result<(), RecordingError> {
        let &[.., from, to] = &self.places[..] else { return Ok(()) };
        let count = self.places.len();
        if count - self.drawn >= LEAST_PLACES.max(count / NEW_SHARE) {
            return self.draw_way(time, application, recorder);
        }
        recorder.leg(time, application, &self.name, count - 1, [from, to])
    }

    /// Draws the whole way.
    pub(super) fn draw_way(
        &mut self,
        time: SimTime,
        application: Option<&str>,
        recorder: &mut FileRecorder,
    ) -> Result<(), RecordingError> {
        self.drawn = self.places.len();
        recorder.way(time, application, &self.name, &self.places)
    }

    /// Records that the robot is still where it is, so that a viewer does not move it to where the next simulation begins.
    pub(super) fn stay(&self, time: SimTime, recorder: &mut FileRecorder) -> Result<(), RecordingError> {
        let place = self.places.last();
        place.map_or(Ok(()), |&place| recorder.robot(time, &self.name, place, self.heading_rad))
    }

    /// Draws the whole way at the end of the simulation, if the robot has moved.
    pub(super) fn close(
        &mut self,
        time: SimTime,
        application: Option<&str>,
        recorder: &mut FileRecorder,
    ) -> Result<(), RecordingError> {
        if self.places.len() > 1 { self.draw_way(time, application, recorder) } else { Ok(()) }
    }
}
