//! Which packets were heard while the place of the robot is known.

use std::time::Duration;

use sextant_kernel::SimTime;

use crate::error::robot_log_error::RobotLogError;
use crate::path::robot_path::{Path, span_of};
use crate::time::instant;

/// What became of the packets.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cover {
    all: u64,
    pub(crate) before: u64,
    pub(crate) after: u64,
    pub(crate) in_gaps: u64,
    /// Earliest and latest time.
    span: Option<(SimTime, SimTime)>,
    /// Packets of a node that go back in time by more than a jitter, and the farthest.
    back: u64,
    farthest_back: Duration,
}

impl Cover {
    /// Notes a packet, which is earlier than the one of the same node before it by `back`.
    pub(crate) fn take(&mut self, time: SimTime, back: Duration) {
        self.all += 1;
        if back > Path::JITTER {
            self.back += 1;
            self.farthest_back = self.farthest_back.max(back);
        }
        let (first, last) = self.span.unwrap_or((time, time));
        self.span = Some((first.min(time), last.max(time)));
    }

    /// The earliest and the latest time of the packets, if all are from the time of the path.
    pub(crate) fn placed_span(&self) -> Option<(SimTime, SimTime)> {
        self.span.filter(|_| self.before + self.after == 0)
    }

    /// Whether there were no packets.
    pub(crate) fn is_empty(&self) -> bool {
        self.span.is_none()
    }

    /// Checks that there are packets on `paths`, and notes those that are not. `delay_s` was taken off their times (s).
    pub(crate) fn check<'a>(
        &self,
        paths: impl Iterator<Item = &'a Path> + Clone,
        delay_s: f64,
        notes: &mut Vec<String>,
    ) -> Result<(), RobotLogError> {
        let Some(packets) = self.span else {
            return Err(RobotLogError::NoPackets);
        };
        let Self { all, before, after, in_gaps, back, farthest_back, .. } = *self;
        let path = span_of(paths.clone());
        if before + after + in_gaps == all {
            return Err(RobotLogError::NotCovered { count: all, packets, path, delay_s });
        }
        if before + after > 0 {
            notes.push(format!(
                "{before} packets are from before the path begins and {after} from after it ends, of {all}: they are not used"
            ));
        }
        if in_gaps > 0 {
            let gaps = paths.flat_map(Path::gaps);
            let longest = gaps.max_by_key(|gap| (gap.to.saturating_since(gap.from), std::cmp::Reverse(gap.from)));
            let longest = longest.map_or_else(String::new, |gap| {
                format!("; the longest is from {} s to {} s", instant::format(gap.from), instant::format(gap.to))
            });
            notes.push(format!(
                "{in_gaps} of {all} packets are from gaps of the path, in which the place of the robot is unknown{longest}: \
                 they are not used"
            ));
        }
        if back > 0 {
            notes.push(format!(
                "{back} packets are earlier than the packet of the same node before them, by up to {} s: each was placed by \
                 its own time; correct the times if a clock was set during the survey",
                instant::format_span(farthest_back)
            ));
        }
        Ok(())
    }
}
