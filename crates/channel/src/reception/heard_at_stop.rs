//! What a robot heard at one stop.

use super::{Reception, SectorReport};

/// What a robot heard at one stop, of all nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeardAtStop<'a> {
    /// The receptions, one per node.
    pub receptions: &'a [Reception],
    /// The signal-to-noise ratios of all sectors of these nodes, if they reported them.
    pub reports: &'a [SectorReport],
}

impl<'a, T: AsRef<[Reception]> + ?Sized> From<&'a T> for HeardAtStop<'a> {
    /// Receptions of nodes that reported no more than their best sector.
    fn from(receptions: &'a T) -> Self {
        Self { receptions: receptions.as_ref(), reports: &[] }
    }
}
