//! Algorithms that users know, to compare with: each on the knowledge that it says it uses.

mod centroid;
mod graph;
mod heard_anchors;
mod landmarks;
mod ranging;
mod tpm;
mod triangle_centroid;

use sextant_kernel::SettingError;

use crate::{Knowledge, KnowledgeKind, MapError, TopologyMap};

pub use centroid::{Centroid, CentroidConfig, WeightedCentroid, WeightedCentroidConfig};
pub use landmarks::{CountConfig, ExtremeConfig, LandmarksConfig};
pub use ranging::{Ranging, RangingConfig};
pub use tpm::{AxesConfig, Tpm, TpmConfig};
pub use triangle_centroid::{TriangleCentroid, TriangleCentroidConfig, TriangleWeights};

/// An algorithm to compare with.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Comparator {
    /// Singular vectors of hop counts.
    Tpm(Tpm),
    /// Circles round anchors, three by three.
    TriangleCentroid(TriangleCentroid),
    /// The mean of the anchors heard.
    Centroid(Centroid),
    /// Their mean weighted by signal strength.
    WeightedCentroid(WeightedCentroid),
}

impl Comparator {
    /// The algorithm's name in tables and topics.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Tpm(_) => Tpm::NAME,
            Self::TriangleCentroid(_) => TriangleCentroid::NAME,
            Self::Centroid(_) => Centroid::NAME,
            Self::WeightedCentroid(_) => WeightedCentroid::NAME,
        }
    }

    /// What it uses.
    #[must_use]
    pub fn uses(&self) -> &'static [KnowledgeKind] {
        match self {
            Self::Tpm(_) => Tpm::USES,
            Self::TriangleCentroid(_) => TriangleCentroid::USES,
            Self::Centroid(_) => Centroid::USES,
            Self::WeightedCentroid(_) => WeightedCentroid::USES,
        }
    }

    /// Anchors without which there is no map in two or three `dimensions`.
    #[must_use]
    pub fn least_anchors(&self, dimensions: usize) -> usize {
        match self {
            Self::Tpm(tpm) => tpm.least_anchors(dimensions),
            Self::TriangleCentroid(_) => dimensions + 1,
            Self::Centroid(_) | Self::WeightedCentroid(_) => 1,
        }
    }

    /// The map of what `knowledge` tells.
    ///
    /// # Errors
    /// If it lacks what the algorithm needs.
    pub fn map(&self, knowledge: &Knowledge<'_>) -> Result<TopologyMap, MapError> {
        match self {
            Self::Tpm(tpm) => tpm.map(knowledge),
            Self::TriangleCentroid(triangles) => triangles.map(knowledge),
            Self::Centroid(centroid) => centroid.map(knowledge),
            Self::WeightedCentroid(centroid) => centroid.map(knowledge),
        }
    }
}

/// Dimensions of a map: as written, or those of the anchors or stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Dimensions(Option<usize>);

impl TryFrom<Option<u8>> for Dimensions {
    type Error = SettingError;

    fn try_from(written: Option<u8>) -> Result<Self, SettingError> {
        match written {
            None => Ok(Self(None)),
            Some(dimensions @ (2 | 3)) => Ok(Self(Some(dimensions.into()))),
            Some(other) => Err(SettingError::new("dimensions", other, "2 or 3")),
        }
    }
}

impl Dimensions {
    fn of(self, knowledge: &Knowledge<'_>) -> usize {
        self.0.unwrap_or_else(|| knowledge.dimensions())
    }
}

fn default_link_share() -> f64 {
    0.5
}

/// Refuses shares of packets that make no link.
fn check_link_share(share: f64) -> Result<(), SettingError> {
    if share > 0.0 && share <= 1.0 {
        Ok(())
    } else {
        Err(SettingError::new("link_share", share, "above 0, at most 1"))
    }
}
