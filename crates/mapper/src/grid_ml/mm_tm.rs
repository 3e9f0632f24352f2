//! MmTM: topology maps from an antenna array that knows the sector of each reception (Gunathillake 2018, chapter 4).

use sextant_channel::{ReceptionLog, SectorGains, SectorTable, Stop};
use sextant_kernel::{SettingError, Watch};

use super::ml_tm::uses_under;
use super::ml_tm_parts::fixed;
use crate::each_node::EachNode;
use crate::error::MapError;
use crate::estimator::{Estimator, Mapper, NodeOfLog};
use crate::grid_ml::fitted::Fit;
use crate::grid_ml::fitted_ml_tm::FittedMlTm;
use crate::grid_ml::ml_tm::{MlTm, MlTmConfig};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::learned::EstimatorFindings;
use crate::log_facts::SectorTolerance;
use crate::log_facts::sectors::GainUse;
use crate::parts::{FixedLaw, LogParts, PartEstimator, PartsError, each_part};
use crate::pattern::{KnownObstacles, PatternMap};
use crate::profile::{ProfileConfig, ReceptionProfile};
use crate::surface::Surface;
use crate::topology_map::TopologyMap;

/// MmTM: [`MlTm`] on a log whose receptions have sectors. Its likelihood of node i at vertex g is the product over all
/// stops of Z₁ (received or missed over the distance) and Z₂ (the direction from the robot to the vertex is in the sector
/// of the reception; 1 for a missed packet).
///
/// Where the log knows the gains of the antenna and the profile is fitted, these replace the wedges: see
/// [`PatternLaw`](crate::PatternLaw).
///
/// A log without sectors, or without their directions, is an error; [`MlTm`] maps it without them.
#[derive(Clone, Debug, PartialEq)]
pub struct MmTm(SectorLikelihood);

#[derive(Clone, Debug, PartialEq)]
enum SectorLikelihood {
    Given(Box<MlTm>),
    Fitted(Box<FittedMlTm>),
}

impl MmTm {
    /// The algorithm's name in tables and topics.
    pub const NAME: &'static str = "mmtm";

    /// The profile of the settings; `None` if it is fitted to the log.
    #[must_use]
    pub fn profile(&self) -> Option<&ReceptionProfile> {
        match &self.0 {
            SectorLikelihood::Given(ml_tm) => Some(ml_tm.profile()),
            SectorLikelihood::Fitted(_) => None,
        }
    }

    /// ML-TM with the same likelihood, for the surface of a node: under the profile of the settings, or under a fitted one,
    /// to which the part of the log that is [evidence](Fit::evidence) belongs.
    #[must_use]
    pub fn ml_tm(&self, fit: Option<&Fit>) -> Option<MlTm> {
        match (&self.0, fit) {
            (SectorLikelihood::Given(ml_tm), _) => Some(MlTm::clone(ml_tm)),
            (SectorLikelihood::Fitted(fitted), Some(fit)) => Some(fitted.with_fit(fit)),
            (SectorLikelihood::Fitted(_), None) => None,
        }
    }

    /// The map of the nodes in `log`, and the profile that it was made with if it was fitted.
    ///
    /// # Errors
    /// [`MapError::Missing`] if the log lacks sectors or their directions; and those of
    /// [`MlTm::map`].
    pub fn map(
        &self,
        log: &ReceptionLog,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<EstimatorFindings>), MapError> {
        self.map_known(&Knowledge::from(log), watch)
    }

    /// The same with all that is known.
    fn map_known(
        &self,
        knowledge: &Knowledge<'_>,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<EstimatorFindings>), MapError> {
        let log = knowledge.log;
        let (map, learned) = match &self.0 {
            SectorLikelihood::Given(ml_tm) => {
                ml_tm.demand_sectors(log, Self::NAME)?;
                (ml_tm.map(log, watch)?, None)
            }
            SectorLikelihood::Fitted(fitted) => match gains_of(fitted, log, log.receptions().sectors().is_some())? {
                Some(gains) => {
                    let (map, fit) =
                        pattern(fitted).map(log, gains, known_obstacles(fitted, knowledge)?, Self::NAME, watch)?;
                    (map, fit.map(EstimatorFindings::new))
                }
                None => {
                    let (map, fit) = fitted.map_sectors(log, Self::NAME, watch)?;
                    (map, fit.map(EstimatorFindings::new))
                }
            },
        };
        Ok((TopologyMap { algorithm: Self::NAME, ..map }, learned))
    }
}

/// The gains by which a log is mapped; `None` if sectors are wedges. `has_sectors` says that receptions have sectors.
fn gains_of<'a>(
    fitted: &FittedMlTm,
    log: &'a ReceptionLog,
    has_sectors: bool,
) -> Result<Option<&'a SectorGains>, MapError> {
    let use_of_gains = fitted.sectors().gains;
    if use_of_gains == GainUse::Never || !has_sectors {
        return Ok(None);
    }
    match log.sectors().and_then(SectorTable::gains) {
        None if use_of_gains == GainUse::Needed => Err(MapError::Missing {
            algorithm: MmTm::NAME,
            what: "the gains of the sectors",
            remedy: "a log has them in `antenna.toml`; `model = \"wedge\"` does without them",
        }),
        // Of an ideal pattern the edges of sectors tell as much, if they keep their directions.
        gains => Ok(gains
            .filter(|gains| use_of_gains == GainUse::Needed || gains.antenna().is_measured() || log.has_headings())),
    }
}

/// The obstacles, if the settings say that they are known.
#[cfg(feature = "obstacles")]
fn known_obstacles<'a>(
    fitted: &FittedMlTm,
    knowledge: &Knowledge<'a>,
) -> Result<Option<KnownObstacles<'a>>, MapError> {
    let of = |law| Ok(KnownObstacles { law, field: knowledge.obstacles(MmTm::NAME)? });
    fitted.sectors().ways.map(of).transpose()
}

/// No obstacles are known without the feature.
#[cfg(not(feature = "obstacles"))]
#[expect(clippy::unnecessary_wraps, reason = "the same as with the feature")]
fn known_obstacles<'a>(_: &FittedMlTm, _: &Knowledge<'a>) -> Result<Option<KnownObstacles<'a>>, MapError> {
    Ok(None)
}

/// The map by gains with the settings of a grid.
fn pattern(fitted: &FittedMlTm) -> PatternMap {
    let (_, ml_tm, z_range_m) = fitted.stages();
    PatternMap {
        grid_step_m: ml_tm.grid_step_m(),
        estimate: ml_tm.estimate_kind(),
        z_range_m,
        counts: ml_tm.count_rule(),
    }
}

impl TryFrom<MlTmConfig> for MmTm {
    type Error = SettingError;

    fn try_from(config: MlTmConfig) -> Result<Self, SettingError> {
        if config.sectors.as_ref().is_some_and(|sectors| sectors.tolerance == SectorTolerance::Unlimited) {
            let allowed = "positional, angular or angular_literal; ml_tm maps without sectors";
            return Err(SettingError::new("sectors.tolerance", "unlimited", allowed));
        }
        match config.profile.clone() {
            ProfileConfig::Fitted(fitted) => {
                FittedMlTm::new(config, fitted).map(|fitted| Self(SectorLikelihood::Fitted(Box::new(fitted))))
            }
            #[cfg(feature = "obstacles")]
            ProfileConfig::Channel(channel) if channel.obstacles == crate::profile::ObstacleUse::Known => {
                Err(SettingError::new("profile.channel.obstacles", "known", "unknown; only ml_tm counts obstacles"))
            }
            ProfileConfig::Trapezoid(_) | ProfileConfig::Channel(_) => {
                let ml_tm = MlTm::try_from(config)?;
                if ml_tm.sectors().gains == GainUse::Needed {
                    let remedy = "write `profile.fitted = {}`, or another model";
                    return Err(SettingError::conflict("sectors.model", "a profile that is given", remedy));
                }
                Ok(Self(SectorLikelihood::Given(Box::new(ml_tm))))
            }
        }
    }
}

impl Estimator for MmTm {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn uses(&self) -> &'static [KnowledgeKind] {
        match &self.0 {
            SectorLikelihood::Fitted(fitted) if fitted.sectors().ways.is_some() => {
                &[KnowledgeKind::RobotReceptions, KnowledgeKind::Obstacles]
            }
            SectorLikelihood::Given(_) | SectorLikelihood::Fitted(_) => uses_under(self.profile()),
        }
    }

    fn profile(&self) -> Option<&ReceptionProfile> {
        self.profile()
    }

    fn check_grid(&self, stops: &[Stop]) -> Result<(), MapError> {
        match &self.0 {
            SectorLikelihood::Given(ml_tm) => ml_tm.check_grid(stops),
            SectorLikelihood::Fitted(_) => Ok(()),
        }
    }

    fn surface(
        &self,
        learned: Option<&EstimatorFindings>,
        NodeOfLog { log, node }: NodeOfLog<'_>,
        watch: &dyn Watch,
    ) -> Option<Result<Surface, MapError>> {
        match (&self.0, learned.and_then(EstimatorFindings::get::<Fit>)) {
            (SectorLikelihood::Given(ml_tm), _) => Some(ml_tm.surface(log, node, watch)),
            (SectorLikelihood::Fitted(fitted), Some(fit)) => {
                Some(fitted.with_fit(fit).surface(&fit.evidence(log), node, watch))
            }
            (SectorLikelihood::Fitted(_), None) => None,
        }
    }

    fn by_parts(&self) -> Option<&dyn PartEstimator> {
        Some(self)
    }

    fn estimate(
        &self,
        knowledge: &Knowledge<'_>,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<EstimatorFindings>), MapError> {
        self.map_known(knowledge, watch)
    }
}

impl MmTm {
    /// The estimator with the settings of a grid.
    ///
    /// # Errors
    /// If a value is invalid.
    pub fn mapper(config: MlTmConfig) -> Result<Mapper, SettingError> {
        Self::try_from(config).map(Mapper::new)
    }
}

impl PartEstimator for MmTm {
    fn fix<'a>(
        &'a self,
        parts: &dyn LogParts,
        knowledge: &'a Knowledge<'a>,
        watch: &dyn Watch,
    ) -> Result<Box<dyn FixedLaw + 'a>, PartsError> {
        match &self.0 {
            SectorLikelihood::Given(ml_tm) => {
                let estimator = Self(SectorLikelihood::Given(Box::new(fixed(ml_tm, parts, watch)?)));
                Ok(Box::new(EachNode { estimator, knowledge }))
            }
            SectorLikelihood::Fitted(fitted) => {
                let mut has_sectors = false;
                each_part(parts, watch, &mut |_, log| {
                    has_sectors |= log.receptions().sectors().is_some();
                    Ok(())
                })?;
                match gains_of(fitted, parts.whole(), has_sectors)? {
                    Some(gains) => {
                        let known = known_obstacles(fitted, knowledge)?;
                        pattern(fitted).fix(parts, gains, known, Self::NAME, watch)
                    }
                    None => fitted.fix_for(parts, knowledge, Some(Self::NAME), watch),
                }
            }
        }
    }
}
