//! Well-known algorithms for comparison. Each uses only the knowledge that it states.

mod apit;
mod centroid;
mod dr_mds;
mod dv_hop;
mod eigenpairs;
mod frame;
mod graph;
mod heard_anchors;
mod hop_distance;
mod landmarks;
pub mod lateration;
mod mds;
mod mds_map;
mod ntldv_hop;
mod packet_centroid;
mod rss_ml;
mod smacof;
mod strengths;
mod tpm;
mod triangle_centroid;

use sextant_channel::Position;
use sextant_kernel::{Interrupted, SettingError, Watch, Work};

use crate::{Knowledge, KnowledgeKind, MapError, RssGrid, TopologyMap};

pub use apit::{Apit, ApitConfig};
pub use centroid::{Centroid, CentroidConfig, WeightedCentroid, WeightedCentroidConfig};
pub use dr_mds::{DrMds, DrMdsConfig};
pub use dv_hop::{DvHop, DvHopConfig, HopLength};
pub use frame::FrameConfig;
pub use landmarks::{CountConfig, ExtremeConfig, LandmarksConfig};
pub use mds_map::{MdsMap, MdsMapConfig};
pub use ntldv_hop::{NtldvHop, NtldvHopConfig};
pub use packet_centroid::{PacketCentroid, PacketCentroidConfig};
pub use rss_ml::{RssMl, RssMlConfig};
pub use smacof::{Smacof, SmacofConfig};
pub use strengths::{
    GaussianProcess, GaussianProcessConfig, LogDistance, LogDistanceConfig, RssiCentroid, RssiCentroidConfig,
    StrongestStop, StrongestStopConfig,
};
pub use tpm::{AxesConfig, Tpm, TpmConfig};
pub use triangle_centroid::{TriangleCentroid, TriangleCentroidConfig, TriangleWeights};

/// An algorithm for comparison.
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
    /// Hops to anchors times the length of a hop.
    DvHop(DvHop),
    /// Hops to anchors times the length of a hop, with anchors that are not flat.
    NtldvHop(NtldvHop),
    /// Classical scaling of hops.
    MdsMap(MdsMap),
    /// Classical scaling of ranges that are straight over two hops.
    DrMds(DrMds),
    /// Stress majorisation of ranges.
    Smacof(Smacof),
    /// Triangles of anchors, judged by neighbours.
    Apit(Apit),
    /// Cooperative maximum likelihood on signal strengths.
    RssMl(RssMl),
    /// A Bayesian grid on the robot's signal strengths.
    RssGrid(RssGrid),
    /// The stop that received a node with the greatest strength.
    StrongestStop(StrongestStop),
    /// The mean of the stops that received a node, weighted by power.
    RssiCentroid(RssiCentroid),
    /// The log-distance law of each node that fits its strengths best.
    LogDistance(LogDistance),
    /// Where a smooth field through the strengths of a node is greatest.
    GaussianProcess(GaussianProcess),
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
            Self::DvHop(_) => DvHop::NAME,
            Self::NtldvHop(_) => NtldvHop::NAME,
            Self::MdsMap(_) => MdsMap::NAME,
            Self::DrMds(_) => DrMds::NAME,
            Self::Smacof(_) => Smacof::NAME,
            Self::Apit(_) => Apit::NAME,
            Self::RssMl(_) => RssMl::NAME,
            Self::RssGrid(_) => RssGrid::NAME,
            Self::StrongestStop(_) => StrongestStop::NAME,
            Self::RssiCentroid(_) => RssiCentroid::NAME,
            Self::LogDistance(_) => LogDistance::NAME,
            Self::GaussianProcess(_) => GaussianProcess::NAME,
        }
    }

    /// The kinds of knowledge that it uses.
    #[must_use]
    pub fn uses(&self) -> &'static [KnowledgeKind] {
        match self {
            Self::Tpm(_) => Tpm::USES,
            Self::TriangleCentroid(_) => TriangleCentroid::USES,
            Self::Centroid(_) => Centroid::USES,
            Self::WeightedCentroid(_) => WeightedCentroid::USES,
            Self::DvHop(_) => DvHop::USES,
            Self::NtldvHop(_) => NtldvHop::USES,
            Self::MdsMap(mds_map) => mds_map.uses(),
            Self::DrMds(dr_mds) => dr_mds.uses(),
            Self::Smacof(smacof) => smacof.uses(),
            Self::Apit(_) => Apit::USES,
            Self::RssMl(_) => RssMl::USES,
            Self::RssGrid(rss_grid) => rss_grid.uses(),
            Self::StrongestStop(_) => StrongestStop::USES,
            Self::RssiCentroid(_) => RssiCentroid::USES,
            Self::LogDistance(_) => LogDistance::USES,
            Self::GaussianProcess(_) => GaussianProcess::USES,
        }
    }

    /// Least number of anchors for a map in two or three `dimensions`.
    #[must_use]
    pub fn least_anchors(&self, dimensions: usize) -> usize {
        match self {
            Self::Tpm(tpm) => tpm.least_anchors(dimensions),
            Self::MdsMap(mds_map) => mds_map.least_anchors(dimensions),
            Self::DrMds(dr_mds) => dr_mds.least_anchors(dimensions),
            Self::Smacof(smacof) => smacof.least_anchors(dimensions),
            Self::TriangleCentroid(_) | Self::DvHop(_) | Self::NtldvHop(_) | Self::RssMl(_) => dimensions + 1,
            Self::Apit(_) => 3,
            Self::RssGrid(_)
            | Self::StrongestStop(_)
            | Self::RssiCentroid(_)
            | Self::LogDistance(_)
            | Self::GaussianProcess(_) => 0,
            Self::Centroid(_) | Self::WeightedCentroid(_) => 1,
        }
    }

    /// The map from `knowledge`.
    ///
    /// # Errors
    /// If `knowledge` lacks what the algorithm needs, the map would need more memory than allowed, or `watch` ends
    /// the work.
    pub fn map(&self, knowledge: &Knowledge<'_>, watch: &dyn Watch) -> Result<TopologyMap, MapError> {
        match self {
            Self::Tpm(tpm) => tpm.map(knowledge, watch),
            Self::TriangleCentroid(triangles) => triangles.map(knowledge, watch),
            Self::Centroid(centroid) => centroid.map(knowledge, watch),
            Self::WeightedCentroid(centroid) => centroid.map(knowledge, watch),
            Self::DvHop(dv_hop) => dv_hop.map(knowledge, watch),
            Self::NtldvHop(ntldv_hop) => ntldv_hop.map(knowledge, watch),
            Self::MdsMap(mds_map) => mds_map.map(knowledge, watch),
            Self::DrMds(dr_mds) => dr_mds.map(knowledge, watch),
            Self::Smacof(smacof) => smacof.map(knowledge, watch),
            Self::Apit(apit) => apit.map(knowledge, watch),
            Self::RssMl(rss_ml) => rss_ml.map(knowledge, watch),
            Self::RssGrid(rss_grid) => rss_grid.map(knowledge, watch),
            Self::StrongestStop(strongest) => strongest.map(knowledge, watch),
            Self::RssiCentroid(centroid) => centroid.map(knowledge, watch),
            Self::LogDistance(fit) => fit.map(knowledge, watch),
            Self::GaussianProcess(process) => process.map(knowledge, watch),
        }
    }
}

/// Dimensions of a map: from the settings, or from the heights of anchors or stops.
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

/// Checks the power of the weights of a centroid.
fn weight_power(key: &str, power: f64) -> Result<f64, SettingError> {
    if power > 0.0 && power <= 100.0 {
        Ok(power)
    } else {
        Err(SettingError::new(key, power, "a number above 0, at most 100"))
    }
}

/// The result of `place` for each node, one after the other. `operations` is the maximum number of operations for one
/// node.
fn node_by_node(
    name: &'static str,
    nodes: usize,
    operations: f64,
    watch: &dyn Watch,
    place: impl Fn(usize) -> Option<Position>,
) -> Result<Vec<Option<Position>>, Interrupted> {
    #[expect(clippy::cast_precision_loss, reason = "a number of nodes")]
    watch.begin(Work { name, unit: "node", steps: nodes as u64, operations: nodes as f64 * operations });
    (0..nodes)
        .map(|node| {
            let place = place(node);
            watch.check()?;
            watch.advance(1);
            Ok(place)
        })
        .collect()
}

fn default_link_share() -> f64 {
    0.5
}

/// Checks the setting `link_share`.
fn check_link_share(share: f64) -> Result<(), SettingError> {
    if share > 0.0 && share <= 1.0 {
        Ok(())
    } else {
        Err(SettingError::new("link_share", share, "above 0, at most 1"))
    }
}
