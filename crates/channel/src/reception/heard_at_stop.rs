//! What a robot heard at one stop.

use super::{RangeSample, Reception, SectorReport};

/// What a robot heard at one stop, of all nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeardAtStop<'a> {
    /// The receptions, one per node.
    pub receptions: &'a [Reception],
    /// The signal-to-noise ratios of all sectors of these nodes, if they reported them.
    pub reports: &'a [SectorReport],
    /// The ranges that the robot measured meanwhile, in the order of time.
    pub ranges: &'a [RangeSample],
}

/// The same as a robot writes it into its log. The number of the stop is filled in by the log.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StopLog {
    /// The receptions, one per node.
    pub receptions: Vec<Reception>,
    /// The signal-to-noise ratios of all sectors of these nodes, if they reported them.
    pub reports: Vec<SectorReport>,
    /// The ranges that the robot measured meanwhile, in the order of time.
    pub ranges: Vec<RangeSample>,
}

impl StopLog {
    /// What was heard at the stop with this number.
    #[must_use]
    pub fn at(mut self, stop: u32) -> Self {
        self.receptions.iter_mut().for_each(|reception| reception.stop = stop);
        self.reports.iter_mut().for_each(|report| report.stop = stop);
        self
    }

    /// What was heard.
    #[must_use]
    pub fn heard(&self) -> HeardAtStop<'_> {
        HeardAtStop { receptions: &self.receptions, reports: &self.reports, ranges: &self.ranges }
    }
}

impl From<Vec<Reception>> for StopLog {
    /// Receptions of nodes that reported no more than their best sector.
    fn from(receptions: Vec<Reception>) -> Self {
        Self { receptions, ..Self::default() }
    }
}

impl From<HeardAtStop<'_>> for StopLog {
    fn from(HeardAtStop { receptions, reports, ranges }: HeardAtStop<'_>) -> Self {
        Self { receptions: receptions.to_vec(), reports: reports.to_vec(), ranges: ranges.to_vec() }
    }
}

impl<'a, T: AsRef<[Reception]> + ?Sized> From<&'a T> for HeardAtStop<'a> {
    /// Receptions of nodes that reported no more than their best sector.
    fn from(receptions: &'a T) -> Self {
        Self { receptions: receptions.as_ref(), ..Self::default() }
    }
}
