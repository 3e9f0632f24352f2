//! Ranges that came one by one, on the paths of robots.

use sextant_channel::{Mounting, RangeSample};
use sextant_kernel::text::{are, counted, counts};
use sextant_kernel::{NodeId, RobotId, SimTime};

use crate::path::robot_path::Path;
use crate::ranges::units;

/// Ranges on the paths of robots.
#[derive(Clone, Debug, Default)]
pub(super) struct PathRanges {
    /// In the order of the log.
    samples: Vec<RangeSample>,
    /// Tries without a range.
    failed: usize,
    /// Those outside of the path, or in gaps of it.
    outside: usize,
}

impl PathRanges {
    /// Takes the range from `robot` on its `path` to `node`: exactly 0, or no number, is a failed try.
    pub(super) fn take(&mut self, path: &Path, robot: RobotId, node: NodeId, time: SimTime, range_m: f64) {
        if range_m.is_nan() || range_m.abs() <= 0.0 {
            self.failed += 1;
            return;
        }
        match path.at(time) {
            Some(position) => {
                let velocity = path.velocity_m_per_s(time);
                self.samples.push(RangeSample {
                    node,
                    robot,
                    time,
                    position,
                    mounting: Mounting::default(),
                    velocity,
                    range_m,
                });
            }
            None => self.outside += 1,
        }
    }

    /// A note on ranges that are in another unit, of those that were taken one by one.
    pub(super) fn unit_note(&self) -> Option<String> {
        units::note("the ranges", &self.samples)
    }

    /// Takes ranges that have their places.
    pub(super) fn extend(&mut self, samples: Vec<RangeSample>) {
        self.samples.extend(samples);
    }

    /// The ranges in the order of time, and notes on those that were taken one by one.
    pub(super) fn finish(mut self, notes: &mut Vec<String>) -> Vec<RangeSample> {
        if self.failed > 0 {
            notes.push(format!(
                "{} without a number, or of exactly 0, {} as failed tries",
                counted(self.failed, "range"),
                counts(self.failed)
            ));
        }
        if self.outside > 0 {
            let (ranges, are) = (counted(self.outside, "range"), are(self.outside));
            notes.push(format!(
                "{ranges} from before the path begins, after it ends or from gaps of it {are} not used"
            ));
        }
        self.samples.sort_by_key(|sample| sample.time);
        self.samples
    }

    pub(super) fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }

    /// Number of ranges with places.
    pub(super) fn len(&self) -> usize {
        self.samples.len()
    }
}
