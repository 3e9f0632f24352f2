//! The estimators by name: a new one is a folder, and a line here.

use sextant_kernel::SettingError;

use crate::auto::AutoConfig;
use crate::comparators::{
    AngleOfArrivalConfig, ApitConfig, CentroidConfig, DrMdsConfig, DvHopConfig, GaussianProcessConfig,
    LogDistanceConfig, MdsMapConfig, NtldvHopConfig, PacketCentroidConfig, RssMlConfig, RssiCentroidConfig,
    SmacofConfig, StrongestStopConfig, TimeDifferenceConfig, TimeOfArrivalConfig, TpmConfig, TriangleCentroidConfig,
    WeightedCentroidConfig,
};
use crate::estimator::{AnyLog, EstimatorSettings, Mapper, ProfileSetting, ReceiverSetting};
use crate::grid_ml::{JointConfig, MlTmConfig, MmTm};
use crate::joint_path::{PathErrorConfig, PathUse};
use crate::link_model::LinkModelConfig;
use crate::log_facts::SectorsConfig;
use crate::range_ml::RangeMlConfig;
use crate::ranging::RangingConfig;
use crate::rss_grid::RssGridConfig;
use crate::self_calibrated::SelfCalibratedConfig;
use crate::stitch::StitchConfig;

/// One map to compute from the reception log, as written in a scenario.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MapConfig {
    /// Name of the map in tables and recordings; the algorithm's name if absent.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub name: Option<String>,
    /// Name of the network whose log is mapped; the first one that robots survey if absent. Joint maps name their networks
    /// themselves.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub network: Option<String>,
    /// Joins the logs of robots whose frames of coordinates differ: each is mapped in its own frame, the nodes that two of
    /// these maps have in common tell how their frames differ, and the map is made from all logs in one frame. Robots whose
    /// frames are known keep them. If absent, all robots are taken to have one frame.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub stitch: Option<StitchConfig>,
    /// On which path of the robots: as they believe it to be, or estimated with the places of nodes.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "is_believed"))]
    pub path: PathUse,
    /// How wrong the odometry of the robots may be, for an estimated path.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub path_error: Option<PathErrorConfig>,
    /// How the map is computed.
    pub algorithm: AlgorithmConfig,
}

#[cfg(feature = "config")]
fn is_believed(path: &PathUse) -> bool {
    *path == PathUse::Believed
}

/// Declares the settings of all estimators as one type, and finds for each what it can do.
macro_rules! estimators {
    (@mapper $settings:ident) => { $settings.mapper() };
    (@mapper $settings:ident $mapper:path) => { $mapper($settings) };
    ($($(#[doc = $doc:literal])* $variant:ident($settings:ty) as $key:literal $(by $mapper:path)?,)*) => {
        /// A mapping algorithm as written in a scenario.
        #[derive(Clone, Debug, PartialEq)]
        #[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
        #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
        pub enum AlgorithmConfig {
            $(
                $(#[doc = $doc])*
                #[cfg_attr(feature = "config", serde(rename = $key))]
                $variant($settings),
            )*
        }

        impl AlgorithmConfig {
            /// The estimators that can be named without settings, in the order of their ranks.
            #[must_use]
            pub fn of_any_log() -> Vec<AnyLog> {
                let all = [$(($key, <$settings as EstimatorSettings>::ANY_LOG)),*];
                // Settings may be those of two estimators, of which one suits any log.
                let own = |(key, any_log): (&str, Option<AnyLog>)| any_log.filter(|any_log| any_log.key() == key);
                let mut found: Vec<AnyLog> = all.into_iter().filter_map(own).collect();
                found.sort_by_key(|any_log| any_log.rank);
                found
            }

            /// The names of the estimators that use what is known of the places of nodes.
            pub(crate) fn names_with_prior() -> Vec<String> {
                Self::names_where(&[$(($key, <$settings as EstimatorSettings>::USES_PRIOR)),*])
            }

            /// The names of the estimators that map a log part by part.
            pub(crate) fn names_by_parts() -> Vec<String> {
                Self::names_where(&[$(($key, <$settings as EstimatorSettings>::BY_PARTS)),*])
            }

            /// Its key in a scenario: `ml_tm`.
            #[must_use]
            pub fn key(&self) -> &'static str {
                match self {
                    $(Self::$variant(_) => $key,)*
                }
            }

            /// The reception profiles in the settings, with their keys within `algorithm`: none for algorithms without one,
            /// several for a joint map.
            pub fn profiles_mut(&mut self) -> Vec<ProfileSetting<'_>> {
                let key = self.key();
                let mut profiles = match self {
                    $(Self::$variant(settings) => settings.profiles_mut(),)*
                };
                profiles.iter_mut().for_each(|profile| profile.key = format!("{key}.{}", profile.key));
                profiles
            }

            /// The law that turns signal strengths into distances, if the algorithm uses one.
            pub fn ranging_mut(&mut self) -> Option<&mut RangingConfig> {
                match self {
                    $(Self::$variant(settings) => settings.ranging_mut(),)*
                }
            }

            /// How sectors are used, if the settings say so.
            pub fn sectors_mut(&mut self) -> Option<&mut SectorsConfig> {
                match self {
                    $(Self::$variant(settings) => settings.sectors_mut(),)*
                }
            }

            /// The receiver of signal strengths, if the algorithm uses one.
            pub fn receiver_mut(&mut self) -> Option<ReceiverSetting<'_>> {
                match self {
                    $(Self::$variant(settings) => settings.receiver_mut(),)*
                }
            }

            /// The networks whose logs are mapped together, by name; `None` if the log of one network is mapped.
            #[must_use]
            pub fn networks(&self) -> Option<Vec<&str>> {
                match self {
                    $(Self::$variant(settings) => settings.networks(),)*
                }
            }
        }

        impl TryFrom<AlgorithmConfig> for Mapper {
            type Error = SettingError;

            fn try_from(config: AlgorithmConfig) -> Result<Self, SettingError> {
                match config {
                    $(AlgorithmConfig::$variant(settings) => estimators!(@mapper settings $($mapper)?).map_err(|error| error.within($key)),)*
                }
            }
        }
    };
}

estimators! {
    /// Maximum likelihood on a grid.
    MlTm(MlTmConfig) as "ml_tm",
    /// Maximum likelihood on a grid from an antenna array: the log must have sectors and their directions.
    Mmtm(MlTmConfig) as "mmtm" by MmTm::mapper,
    /// Maximum likelihood on a grid from the logs of several networks of the same nodes.
    Joint(JointConfig) as "joint",
    /// Places, reception curve, efficiency of stops, and obstacles, estimated together from the log alone.
    SelfCalibrated(SelfCalibratedConfig) as "self_calibrated",
    /// A model of real radio links, estimated from the log alone.
    LinkModel(LinkModelConfig) as "link_model",
    /// The mean of the stops that heard a node, weighted by a power of the share of packets that they received.
    PacketCentroid(PacketCentroidConfig) as "packet_centroid",
    /// The estimator that the log chooses: link model with other opinions, fitted grid or self-calibrated.
    Auto(AutoConfig) as "auto",
    /// A topology-preserving map of hop counts.
    Tpm(TpmConfig) as "tpm",
    /// Intersections of circles round the strongest anchors, three at a time.
    RssiTriangleCentroid(TriangleCentroidConfig) as "rssi_triangle_centroid",
    /// The mean of the anchors heard.
    Centroid(CentroidConfig) as "centroid",
    /// The mean of the anchors heard, weighted by signal strength.
    WeightedCentroid(WeightedCentroidConfig) as "weighted_centroid",
    /// Hops to anchors times the length of a hop, then multilateration.
    DvHop(DvHopConfig) as "dv_hop",
    /// DV-Hop in space with its usual improvements.
    NtldvHop(NtldvHopConfig) as "ntldv_hop",
    /// Classical scaling of hops between all pairs of nodes.
    MdsMap(MdsMapConfig) as "mds_map",
    /// Classical scaling of ranges that are straight over two hops.
    DrMds(DrMdsConfig) as "dr_mds",
    /// Stress majorisation of ranges between neighbours.
    Smacof(SmacofConfig) as "smacof",
    /// Triangles of anchors, judged by neighbours, in the plane.
    Apit(ApitConfig) as "apit",
    /// Cooperative maximum likelihood on signal strengths between nodes.
    RssMl(RssMlConfig) as "rss_ml",
    /// A Bayesian grid on the signal strengths that the robot measured.
    RssGrid(RssGridConfig) as "rss_grid",
    /// The stop where the robot received a node with the greatest strength.
    StrongestStop(StrongestStopConfig) as "strongest_stop",
    /// The mean of the stops where the robot received a node, weighted by signal strength.
    RssiCentroid(RssiCentroidConfig) as "rssi_centroid",
    /// Place, power and path-loss exponent of each node that fit its strengths best.
    LeastSquares(LogDistanceConfig) as "least_squares",
    /// A Gaussian process over the strengths of each node: the node is where it is greatest.
    GaussianProcess(GaussianProcessConfig) as "gaussian_process",
    /// Maximum likelihood on measured ranges, with their biases, scale and clock.
    RangeMl(RangeMlConfig) as "range_ml",
    /// Least squares on measured ranges.
    TimeOfArrival(TimeOfArrivalConfig) as "time_of_arrival",
    /// Least squares on the differences of measured ranges.
    TimeDifference(TimeDifferenceConfig) as "time_difference",
    /// Where the directions of sectors cross: the log must have sectors and their directions.
    AngleOfArrival(AngleOfArrivalConfig) as "angle_of_arrival",
}

impl AlgorithmConfig {
    /// The names, which are keys with hyphens, of the estimators to which something applies.
    fn names_where(keys: &[(&str, bool)]) -> Vec<String> {
        keys.iter().filter(|(_, applies)| *applies).map(|(key, _)| key.replace('_', "-")).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn estimators_of_any_log_have_ranks_of_their_own_and_make_a_mapper() {
        let found = AlgorithmConfig::of_any_log();
        for (rank, any_log) in found.iter().enumerate() {
            assert_eq!(usize::from(any_log.rank), rank, "{any_log:?}");
        }
        assert_eq!(found.first().map(|any_log| any_log.name), Some("auto"));
        assert!(found.iter().all(|any_log| any_log.name != "mmtm"), "a log need not have sectors");
    }
}
