//! Frames on air in a recording, as viewers draw them.

use std::collections::BTreeMap;
use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::SimTime;
use sextant_recording::{FileRecorder, RecordingError};
use sextant_sim::{FrameOnAir, FrameOutcome};

use super::RecordedSimulation;

/// Frames of this span are drawn together, and for as long: airtimes are too short to be seen.
const SPAN: Duration = Duration::from_millis(100);

/// Frames that are drawn together.
#[derive(Default)]
pub(super) struct Air {
    /// Start of the first one.
    since: SimTime,
    /// Lines from senders to receivers, by outcome.
    lines: BTreeMap<&'static str, Vec<[Position; 2]>>,
}

impl Air {
    /// Draws the frames so far.
    pub(super) fn draw(&mut self, offset: Duration, recorder: &mut FileRecorder) -> Result<(), RecordingError> {
        if self.lines.is_empty() {
            return Ok(());
        }
        let lines: Vec<_> = std::mem::take(&mut self.lines).into_iter().collect();
        recorder.on_air(self.since + offset, &lines, SPAN)
    }
}

impl RecordedSimulation {
    /// Adds a frame that a robot or sink received, or lost although it listened; those before it are drawn when their span is
    /// over. A lost frame is drawn to the nearest robot or sink. Frames of robots and sinks are not drawn.
    pub(super) fn draw_frame(
        &mut self,
        frame: &FrameOnAir<'_>,
        recorder: &mut FileRecorder,
    ) -> Result<(), RecordingError> {
        if matches!(frame.outcome, FrameOutcome::OutOfRange | FrameOutcome::NotListened(_)) {
            return Ok(());
        }
        let Some(&from) = self.nodes.get(frame.source.index()) else { return Ok(()) };
        if frame.start >= self.air.since + SPAN {
            let offset = self.offset;
            self.air.draw(offset, recorder)?;
        }
        let mut ends: Vec<Position> =
            frame.heard.iter().filter_map(|heard| self.collector(heard.collector)).collect();
        if ends.is_empty() {
            let collectors = (0..self.robots.len() + self.sinks.len()).filter_map(|index| self.collector(index));
            ends.extend(collectors.min_by(|a, b| a.distance_m(from).total_cmp(&b.distance_m(from))));
        }
        if ends.is_empty() {
            return Ok(());
        }
        if self.air.lines.is_empty() {
            self.air.since = frame.start;
        }
        let lines = self.air.lines.entry(frame.outcome.name()).or_default();
        lines.extend(ends.into_iter().map(|to| [from, to]));
        Ok(())
    }

    /// The place of a robot or sink: robots come first.
    fn collector(&self, index: usize) -> Option<Position> {
        match index.checked_sub(self.robots.len()) {
            None => self.robots[index].places.last().copied(),
            Some(sink) => self.sinks.get(sink).copied(),
        }
    }
}
