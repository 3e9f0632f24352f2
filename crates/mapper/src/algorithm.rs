//! The mapping algorithms by name.

#[cfg(feature = "config")]
use schemars::JsonSchema;
#[cfg(feature = "config")]
use serde::{Deserialize, Serialize};
use sextant_kernel::{SettingError, Unwatched, Watch};

use crate::{
    ApitConfig, Auto, AutoConfig, Calibration, Centroid, CentroidConfig, Choice, Comparator, DrMdsConfig,
    DvHopConfig, Fit, FittedChannel, FittedMlTm, GaussianProcess, GaussianProcessConfig, JointConfig, JointMlTm,
    Knowledge, KnowledgeKind, LinkFit, LinkModel, LinkModelConfig, LogDistanceConfig, MapError, MdsMapConfig, MlTm,
    MlTmConfig, MmTm, NtldvHopConfig, PacketCentroid, PacketCentroidConfig, PlacePrior, ProfileConfig, RangingConfig,
    ReceptionProfile, RssGridConfig, RssMlConfig, RssiCentroidConfig, SelfCalibrated, SelfCalibratedConfig,
    SmacofConfig, StrongestStop, StrongestStopConfig, TopologyMap, TpmConfig, TriangleCentroidConfig,
    WeightedCentroidConfig,
};

#[cfg(feature = "obstacles")]
use crate::{ObstacleMlTm, ObstacleUse};

/// One map to compute from the reception log, as written in a scenario.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "config", serde(deny_unknown_fields))]
pub struct MapConfig {
    /// Name of the map in tables and recordings; the algorithm's name if absent.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub name: Option<String>,
    /// Name of the network whose log is mapped; the first one that robots survey if absent. Joint maps name their networks
    /// themselves.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub network: Option<String>,
    /// How the map is computed.
    pub algorithm: AlgorithmConfig,
}

/// A mapping algorithm as written in a scenario.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "config", serde(rename_all = "snake_case", deny_unknown_fields))]
pub enum AlgorithmConfig {
    /// Maximum likelihood on a grid.
    MlTm(MlTmConfig),
    /// Maximum likelihood on a grid from an antenna array: the log must have sectors and their directions.
    Mmtm(MlTmConfig),
    /// Maximum likelihood on a grid from the logs of several networks of the same nodes.
    Joint(JointConfig),
    /// Places, reception curve, efficiency of stops, and obstacles, estimated together from the log alone.
    SelfCalibrated(SelfCalibratedConfig),
    /// A model of real radio links, estimated from the log alone.
    LinkModel(LinkModelConfig),
    /// The mean of the stops that heard a node, weighted by a power of the share of packets that they received.
    PacketCentroid(PacketCentroidConfig),
    /// The estimator that the log chooses: link model, fitted grid, self-calibrated or packet centroid.
    Auto(AutoConfig),
    /// A topology-preserving map of hop counts.
    Tpm(TpmConfig),
    /// Intersections of circles round the strongest anchors, three at a time.
    RssiTriangleCentroid(TriangleCentroidConfig),
    /// The mean of the anchors heard.
    Centroid(CentroidConfig),
    /// The mean of the anchors heard, weighted by signal strength.
    WeightedCentroid(WeightedCentroidConfig),
    /// Hops to anchors times the length of a hop, then multilateration.
    DvHop(DvHopConfig),
    /// DV-Hop in space with its usual improvements.
    NtldvHop(NtldvHopConfig),
    /// Classical scaling of hops between all pairs of nodes.
    MdsMap(MdsMapConfig),
    /// Classical scaling of ranges that are straight over two hops.
    DrMds(DrMdsConfig),
    /// Stress majorisation of ranges between neighbours.
    Smacof(SmacofConfig),
    /// Triangles of anchors, judged by neighbours, in the plane.
    Apit(ApitConfig),
    /// Cooperative maximum likelihood on signal strengths between nodes.
    RssMl(RssMlConfig),
    /// A Bayesian grid on the signal strengths that the robot measured.
    RssGrid(RssGridConfig),
    /// The stop where the robot received a node with the greatest strength.
    StrongestStop(StrongestStopConfig),
    /// The mean of the stops where the robot received a node, weighted by signal strength.
    RssiCentroid(RssiCentroidConfig),
    /// Place, power and path-loss exponent of each node that fit its strengths best.
    LeastSquares(LogDistanceConfig),
    /// A Gaussian process over the strengths of each node: the node is where it is greatest.
    GaussianProcess(GaussianProcessConfig),
}

/// A reception profile in the settings of an algorithm.
#[derive(Debug, PartialEq)]
pub struct ProfileSetting<'a> {
    /// Its key within `algorithm`.
    pub key: String,
    /// Name of the network that it is for; `None` for that of the map.
    pub network: Option<String>,
    /// The profile.
    pub profile: &'a mut ProfileConfig,
}

impl AlgorithmConfig {
    /// The reception profiles in the settings: none for algorithms without one, several for a joint map.
    pub fn profiles_mut(&mut self) -> Vec<ProfileSetting<'_>> {
        let one =
            |key: &str, config| ProfileSetting { key: format!("{key}.profile"), network: None, profile: config };
        match self {
            Self::MlTm(config) => vec![one("ml_tm", &mut config.profile)],
            Self::Mmtm(config) => vec![one("mmtm", &mut config.profile)],
            Self::Joint(config) => (config.networks.iter_mut().enumerate())
                .map(|(i, member)| ProfileSetting {
                    key: format!("joint.networks[{i}].profile"),
                    network: Some(member.network.clone()),
                    profile: &mut member.profile,
                })
                .collect(),
            _ => Vec::new(),
        }
    }

    /// The law that turns signal strengths into distances, if the algorithm uses one.
    pub fn ranging_mut(&mut self) -> Option<&mut RangingConfig> {
        match self {
            Self::RssiTriangleCentroid(config) => Some(&mut config.ranging),
            Self::WeightedCentroid(config) => Some(&mut config.ranging),
            Self::DrMds(config) => Some(&mut config.ranging),
            Self::Smacof(config) => Some(&mut config.ranging),
            Self::RssMl(config) => Some(&mut config.ranging),
            Self::RssGrid(config) => Some(&mut config.ranging),
            _ => None,
        }
    }
}

/// A mapping algorithm, ready to map any log.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Mapper {
    /// Maximum likelihood on a grid.
    MlTm(MlTm),
    /// Maximum likelihood on a grid from an antenna array.
    MmTm(MmTm),
    /// Maximum likelihood on a grid from the logs of several networks.
    Joint(JointMlTm),
    /// Maximum likelihood on a grid under a profile estimated from the log.
    FittedMlTm(FittedMlTm),
    /// Maximum likelihood under a known channel among known obstacles.
    #[cfg(feature = "obstacles")]
    ObstacleMlTm(Box<ObstacleMlTm>),
    /// Places, reception curve, efficiency of stops, and obstacles, estimated together from the log alone.
    SelfCalibrated(SelfCalibrated),
    /// A model of real radio links, estimated from the log alone.
    LinkModel(LinkModel),
    /// The mean of the stops that heard a node, weighted by packets.
    PacketCentroid(PacketCentroid),
    /// The estimator that the log chooses.
    Auto(Auto),
    /// An algorithm for comparison.
    Comparator(Comparator),
}

/// What an algorithm learned from a log in addition to the map.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Learned {
    /// A reception profile.
    Profile(Fit),
    /// The reception profile of each network for which it was not given, by name.
    Profiles(Vec<(String, Fit)>),
    /// A reception curve, the efficiency of each stop, and the obstacles.
    Calibration(Calibration),
    /// How power falls with distance, and the sensitivity.
    Channel(FittedChannel),
    /// A law of links.
    Links(LinkFit),
    /// Which estimator suits the log.
    Choice(Choice),
}

/// Names of the algorithms that use a [`PlacePrior`].
const USE_PRIOR: &[&str] = &[Auto::NAME, LinkModel::NAME];

impl Mapper {
    /// The algorithm's name in tables and topics: `ml-tm`.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::MlTm(_) | Self::FittedMlTm(_) => MlTm::NAME,
            #[cfg(feature = "obstacles")]
            Self::ObstacleMlTm(_) => MlTm::NAME,
            Self::MmTm(_) => MmTm::NAME,
            Self::Joint(_) => JointMlTm::NAME,
            Self::SelfCalibrated(_) => SelfCalibrated::NAME,
            Self::LinkModel(_) => LinkModel::NAME,
            Self::PacketCentroid(_) => PacketCentroid::NAME,
            Self::Auto(_) => Auto::NAME,
            Self::Comparator(comparator) => comparator.name(),
        }
    }

    /// The kinds of knowledge that the algorithm uses.
    #[must_use]
    pub fn uses(&self) -> &'static [KnowledgeKind] {
        match self {
            Self::MlTm(ml_tm) => used_with(Some(ml_tm.profile())),
            Self::MmTm(mm_tm) => used_with(mm_tm.profile()),
            Self::Joint(joint) => {
                used_with(joint.profiles().find(|profile| matches!(profile, ReceptionProfile::Table(_))))
            }
            Self::FittedMlTm(_) => used_with(None),
            #[cfg(feature = "obstacles")]
            Self::ObstacleMlTm(_) => {
                &[KnowledgeKind::RobotReceptions, KnowledgeKind::PathLoss, KnowledgeKind::Obstacles]
            }
            Self::SelfCalibrated(algorithm) => algorithm.uses(),
            Self::LinkModel(algorithm) => algorithm.uses(),
            Self::PacketCentroid(_) => PacketCentroid::USES,
            Self::Auto(algorithm) => algorithm.uses(),
            Self::Comparator(comparator) => comparator.uses(),
        }
    }

    /// Whether the algorithm uses what is known of the places of nodes.
    #[must_use]
    pub fn uses_prior(&self) -> bool {
        USE_PRIOR.contains(&self.name())
    }

    /// Checks that the algorithm uses `prior`, if there is one.
    ///
    /// # Errors
    /// [`MapError::UnusedPrior`] if it does not.
    pub fn check_prior(&self, prior: Option<&PlacePrior>) -> Result<(), MapError> {
        if prior.is_none() || self.uses_prior() {
            return Ok(());
        }
        let known: Vec<String> = USE_PRIOR.iter().map(|name| format!("`{name}`")).collect();
        Err(MapError::UnusedPrior { algorithm: self.name(), known: known.join(", ") })
    }

    /// Least number of anchors for a map in two or three `dimensions`.
    #[must_use]
    pub fn least_anchors(&self, dimensions: usize) -> usize {
        match self {
            Self::MlTm(_)
            | Self::MmTm(_)
            | Self::Joint(_)
            | Self::FittedMlTm(_)
            | Self::SelfCalibrated(_)
            | Self::LinkModel(_)
            | Self::PacketCentroid(_)
            | Self::Auto(_) => 0,
            #[cfg(feature = "obstacles")]
            Self::ObstacleMlTm(_) => 0,
            Self::Comparator(comparator) => comparator.least_anchors(dimensions),
        }
    }

    /// The map of the nodes in the log of `knowledge`, which may be a log alone.
    ///
    /// # Errors
    /// If the map would need more memory than allowed, or the algorithm lacks knowledge that it needs.
    pub fn map<'a>(&self, knowledge: impl Into<Knowledge<'a>>) -> Result<TopologyMap, MapError> {
        self.map_and_learn(knowledge, &Unwatched).map(|(map, _)| map)
    }

    /// The map of the nodes in the log, and what else the algorithm learned from the log, if anything. `watch`
    /// receives the progress, and may end the work within a fraction of a second.
    ///
    /// # Errors
    /// If the map would need more memory than allowed, the algorithm lacks knowledge that it needs or cannot use the
    /// prior, or `watch` ends the work.
    pub fn map_and_learn<'a>(
        &self,
        knowledge: impl Into<Knowledge<'a>>,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<Learned>), MapError> {
        let knowledge = knowledge.into();
        self.check_prior(knowledge.prior)?;
        match self {
            Self::MlTm(ml_tm) => ml_tm.map(knowledge.log, watch).map(|map| (map, None)),
            Self::MmTm(mm_tm) => mm_tm.map(knowledge.log, watch).map(|(map, fit)| (map, fit.map(Learned::Profile))),
            Self::Joint(joint) => {
                let logs: Result<Vec<_>, MapError> =
                    joint.networks().map(|network| knowledge.log_of(network)).collect();
                let (map, fits) = joint.map(&logs?, watch)?;
                let fitted = joint.networks().zip(fits).filter_map(|(name, fit)| Some((name.to_owned(), fit?)));
                let fitted: Vec<_> = fitted.collect();
                Ok((map, (!fitted.is_empty()).then_some(Learned::Profiles(fitted))))
            }
            Self::FittedMlTm(fitted) => {
                fitted.map(knowledge.log, watch).map(|(map, fit)| (map, fit.map(Learned::Profile)))
            }
            #[cfg(feature = "obstacles")]
            Self::ObstacleMlTm(ml_tm) => {
                ml_tm.map(knowledge.log, knowledge.obstacles(MlTm::NAME)?, watch).map(|map| (map, None))
            }
            Self::SelfCalibrated(algorithm) => {
                let (map, calibration) = algorithm.map(knowledge.log, watch)?;
                Ok((map, calibration.map(Learned::Calibration)))
            }
            Self::Comparator(Comparator::RssGrid(grid)) => {
                let (map, channel) = grid.map_and_learn(&knowledge, watch)?;
                Ok((map, channel.map(Learned::Channel)))
            }
            Self::LinkModel(algorithm) => {
                let (map, fit) = algorithm.map(knowledge.log, knowledge.prior, watch)?;
                Ok((map, fit.map(Learned::Links)))
            }
            Self::PacketCentroid(algorithm) => Ok((algorithm.map(knowledge.log), None)),
            Self::Auto(algorithm) => {
                let (map, choice) = algorithm.map(knowledge.log, knowledge.prior, watch)?;
                Ok((map, choice.map(Learned::Choice)))
            }
            Self::Comparator(comparator) => comparator.map(&knowledge, watch).map(|map| (map, None)),
        }
    }
}

impl TryFrom<AlgorithmConfig> for Mapper {
    type Error = SettingError;

    fn try_from(config: AlgorithmConfig) -> Result<Self, SettingError> {
        match config {
            AlgorithmConfig::MlTm(config) => match config.profile.clone() {
                ProfileConfig::Fitted(fitted) => FittedMlTm::new(config, fitted).map(Self::FittedMlTm),
                #[cfg(feature = "obstacles")]
                ProfileConfig::Channel(channel) if channel.obstacles == ObstacleUse::Known => {
                    ObstacleMlTm::new(config, &channel).map(Box::new).map(Self::ObstacleMlTm)
                }
                ProfileConfig::Trapezoid(_) | ProfileConfig::Channel(_) => MlTm::try_from(config).map(Self::MlTm),
            }
            .map_err(|error| error.within("ml_tm")),
            AlgorithmConfig::Mmtm(config) => {
                MmTm::try_from(config).map(Self::MmTm).map_err(|error| error.within("mmtm"))
            }
            AlgorithmConfig::Joint(config) => {
                JointMlTm::try_from(config).map(Self::Joint).map_err(|error| error.within("joint"))
            }
            AlgorithmConfig::SelfCalibrated(config) => SelfCalibrated::try_from(config)
                .map(Self::SelfCalibrated)
                .map_err(|error| error.within("self_calibrated")),
            AlgorithmConfig::LinkModel(config) => {
                LinkModel::try_from(config).map(Self::LinkModel).map_err(|error| error.within("link_model"))
            }
            AlgorithmConfig::PacketCentroid(config) => PacketCentroid::try_from(config)
                .map(Self::PacketCentroid)
                .map_err(|error| error.within("packet_centroid")),
            AlgorithmConfig::Auto(config) => {
                Auto::try_from(config).map(Self::Auto).map_err(|error| error.within("auto"))
            }
            AlgorithmConfig::Tpm(config) => compare("tpm", config, Comparator::Tpm),
            AlgorithmConfig::RssiTriangleCentroid(config) => {
                compare("rssi_triangle_centroid", config, Comparator::TriangleCentroid)
            }
            AlgorithmConfig::Centroid(CentroidConfig {}) => Ok(Self::Comparator(Comparator::Centroid(Centroid))),
            AlgorithmConfig::WeightedCentroid(config) => {
                compare("weighted_centroid", config, Comparator::WeightedCentroid)
            }
            AlgorithmConfig::DvHop(config) => compare("dv_hop", config, Comparator::DvHop),
            AlgorithmConfig::NtldvHop(config) => compare("ntldv_hop", config, Comparator::NtldvHop),
            AlgorithmConfig::MdsMap(config) => compare("mds_map", config, Comparator::MdsMap),
            AlgorithmConfig::DrMds(config) => compare("dr_mds", config, Comparator::DrMds),
            AlgorithmConfig::Smacof(config) => compare("smacof", config, Comparator::Smacof),
            AlgorithmConfig::Apit(config) => compare("apit", config, Comparator::Apit),
            AlgorithmConfig::RssMl(config) => compare("rss_ml", config, Comparator::RssMl),
            AlgorithmConfig::RssGrid(config) => compare("rss_grid", config, Comparator::RssGrid),
            AlgorithmConfig::StrongestStop(StrongestStopConfig {}) => {
                Ok(Self::Comparator(Comparator::StrongestStop(StrongestStop)))
            }
            AlgorithmConfig::RssiCentroid(config) => compare("rssi_centroid", config, Comparator::RssiCentroid),
            AlgorithmConfig::LeastSquares(config) => compare("least_squares", config, Comparator::LogDistance),
            AlgorithmConfig::GaussianProcess(GaussianProcessConfig {}) => {
                Ok(Self::Comparator(Comparator::GaussianProcess(GaussianProcess)))
            }
        }
    }
}

/// What a grid uses under a profile, which is fitted to the log if it is not given.
fn used_with(profile: Option<&ReceptionProfile>) -> &'static [KnowledgeKind] {
    match profile {
        Some(ReceptionProfile::Table(_)) => &[KnowledgeKind::RobotReceptions, KnowledgeKind::PathLoss],
        Some(ReceptionProfile::Trapezoid(_)) | None => &[KnowledgeKind::RobotReceptions],
    }
}

/// The algorithm whose settings are under `key`.
fn compare<C, A: TryFrom<C, Error = SettingError>>(
    key: &str,
    config: C,
    wrapped: fn(A) -> Comparator,
) -> Result<Mapper, SettingError> {
    A::try_from(config).map(|algorithm| Mapper::Comparator(wrapped(algorithm))).map_err(|error| error.within(key))
}
