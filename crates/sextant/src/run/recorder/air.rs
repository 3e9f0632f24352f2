//! Frames on air in a recording, as viewers draw them.

use std::time::Duration;

use sextant_channel::Position;
use sextant_recording::DrawnFrame;
use sextant_sim::FrameOnAir;

use super::RecordedSimulation;

/// A frame is drawn for this long after its end: airtimes are too short to be seen.
const SHOWN: Duration = Duration::from_millis(100);

impl RecordedSimulation {
    /// A frame as lines from its sender to the robots and sinks that received it; if none did, to the nearest one. `None` if
    /// a robot or sink sent it, or there are none.
    pub(super) fn drawn<'a>(&self, frame: &FrameOnAir<'a>, ends: &'a mut Vec<Position>) -> Option<DrawnFrame<'a>> {
        let from = *self.nodes.get(frame.source.index())?;
        ends.clear();
        ends.extend(frame.heard.iter().filter_map(|heard| self.collector(heard.collector)));
        if ends.is_empty() {
            let collectors = (0..self.robots.len() + self.sinks.len()).filter_map(|index| self.collector(index));
            ends.extend(collectors.min_by(|a, b| a.distance_m(from).total_cmp(&b.distance_m(from))));
        }
        let is_drawn = !ends.is_empty();
        is_drawn.then(|| DrawnFrame {
            source: frame.source,
            from,
            to: ends,
            outcome: frame.outcome.name(),
            span: frame.airtime + SHOWN,
        })
    }

    /// The place of a robot or sink: robots come first.
    fn collector(&self, index: usize) -> Option<Position> {
        match index.checked_sub(self.robots.len()) {
            None => self.robots[index].places.last().copied(),
            Some(sink) => self.sinks.get(sink).copied(),
        }
    }
}
