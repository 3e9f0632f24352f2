//! Well-known algorithms for comparison. Each uses only the knowledge that it states.

mod anchor_hops;
mod apit;
mod arrival;
mod centroid;
mod comparator;
mod dr_mds;
mod dv_hop;
mod eigenpairs;
mod frame;
mod graph;
mod heard_anchors;
mod hop_distance;
mod landmarks;
pub mod lateration;
pub mod localise;
mod mds;
mod mds_map;
mod ntldv_hop;
mod packet_centroid;
mod rss_ml;
mod smacof;
pub(crate) mod strengths;
mod tpm;
mod triangle_centroid;
mod upright_anchors;

use sextant_channel::Position;
use sextant_kernel::{Interrupted, SettingError, Watch, Work};

use crate::knowledge::Knowledge;

pub use anchor_hops::HopLength;
pub use apit::{Apit, ApitConfig};
pub use arrival::{
    AngleOfArrival, AngleOfArrivalConfig, TimeDifference, TimeDifferenceConfig, TimeOfArrival, TimeOfArrivalConfig,
};
pub use centroid::{Centroid, CentroidConfig, WeightedCentroid, WeightedCentroidConfig};
pub use comparator::Comparator;
pub use dr_mds::{DrMds, DrMdsConfig};
pub use dv_hop::{DvHop, DvHopConfig};
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
