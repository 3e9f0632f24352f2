//! What every estimator has in common: what it is called, what it needs to know, how it maps, and what can be said of it.

use std::any::Any;
use std::fmt;
use std::sync::Arc;

use sextant_channel::{ReceptionLog, Stop};
use sextant_kernel::{NodeId, SettingError, Unwatched, Watch};

use crate::comparable::Comparable;
use crate::error::MapError;
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::learned::EstimatorFindings;
use crate::log_facts::SectorsConfig;
use crate::parts::{LogParts, PartEstimator, PartsError, map_parts};
use crate::posterior::Concern;
use crate::profile::{ProfileConfig, ReceptionProfile};
use crate::ranging::RangingConfig;
use crate::surface::Surface;
use crate::survey_frame::{Axes, Survey, in_survey};
use crate::topology_map::TopologyMap;

/// An algorithm that maps the nodes of a log, with its settings.
pub trait Estimator: Any + Comparable + fmt::Debug + Send + Sync {
    /// Its name in tables and topics: `ml-tm`.
    fn name(&self) -> &'static str;

    /// The kinds of knowledge that it uses.
    fn uses(&self) -> &'static [KnowledgeKind];

    /// The map, and what else was learned from the log, if anything. `watch` receives the progress, and may end the work.
    ///
    /// # Errors
    /// If the map would need more memory than allowed, the algorithm lacks knowledge that it needs, or `watch` ends the
    /// work.
    fn estimate(
        &self,
        knowledge: &Knowledge<'_>,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<EstimatorFindings>), MapError>;

    /// The axes in which it works.
    fn axes(&self) -> Axes {
        Axes::Log
    }

    /// How it maps a log part by part; `None` if it needs all of the log at once.
    fn by_parts(&self) -> Option<&dyn PartEstimator> {
        None
    }

    /// Whether it uses how many packets of a node were received at a stop, and not only whether one was.
    fn counts_packets(&self) -> bool {
        true
    }

    /// Whether it uses what is known of the places of nodes.
    fn uses_prior(&self) -> bool {
        false
    }

    /// Least number of anchors for a map in two or three `dimensions`.
    fn least_anchors(&self, dimensions: usize) -> usize {
        let _ = dimensions;
        0
    }

    /// Whether the grid of a log with at least these stops fits the memory that is allowed.
    ///
    /// # Errors
    /// [`MapError::GridTooLarge`].
    fn check_grid(&self, stops: &[Stop]) -> Result<(), MapError> {
        let _ = stops;
        Ok(())
    }

    /// The networks whose logs it maps together, by name; none if it maps the log of one network.
    fn networks(&self) -> Vec<&str> {
        Vec::new()
    }

    /// The reception profile of its settings, if they give one.
    fn profile(&self) -> Option<&ReceptionProfile> {
        None
    }

    /// The likelihood of a node over a grid, where the estimator learned this from the log; `None` if it has no grid that can
    /// be shown.
    ///
    /// # Errors
    /// [`MapError::NotHeard`]; if `watch` ends the work.
    fn surface(
        &self,
        learned: Option<&EstimatorFindings>,
        of: NodeOfLog<'_>,
        watch: &dyn Watch,
    ) -> Option<Result<Surface, MapError>> {
        let _ = (learned, of, watch);
        None
    }

    /// How it places nodes whose distances were measured, if by other evidence than its own.
    fn by_ranges(&self) -> Option<&Mapper> {
        None
    }

    /// The same estimator, quicker, for a log that has grown since this one `learned` from it: it begins with what is known. Its map
    /// differs from one that is made from the start by what the search leaves open. `None` if it always begins from the start.
    fn after(&self, learned: &EstimatorFindings) -> Option<Mapper> {
        let _ = learned;
        None
    }

    /// The packets that nodes send for its map.
    fn messages(&self) -> Messages {
        if self.uses().contains(&KnowledgeKind::RobotReceptions) { Messages::Survey } else { Messages::Unknown }
    }
}

/// A node of a log.
#[derive(Clone, Copy, Debug)]
pub struct NodeOfLog<'a> {
    /// The log.
    pub log: &'a ReceptionLog,
    /// The node.
    pub node: NodeId,
}

/// The packets that nodes send for a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Messages {
    /// Those that a robot hears at its stops.
    Survey,
    /// Hop counts that are flooded from landmarks. Holds their number, if the settings give it.
    Floods(Landmarks),
    /// Those that anchors send to the nodes around them.
    Beacons,
    /// It is not known which.
    Unknown,
}

/// The nodes from which hops are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Landmarks {
    /// So many nodes.
    Count(usize),
    /// The anchors.
    Anchors,
    /// They are sought in the network.
    Sought,
}

/// An estimator, ready to map any log. It maps in the axes that suit the estimator ([`Axes`]): the map does not depend on where
/// the origin lies, where x points and in which order rows come, as far as the grid follows from the log.
#[derive(Clone, Debug)]
pub struct Mapper(Arc<dyn Estimator>);

impl Mapper {
    /// The mapper that is `estimator`.
    #[must_use]
    pub fn new(estimator: impl Estimator + 'static) -> Self {
        Self(Arc::new(estimator))
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
    ) -> Result<(TopologyMap, Option<EstimatorFindings>), MapError> {
        let knowledge = knowledge.into();
        self.check_prior(knowledge.prior)?;
        let (mut map, learned) = match self.axes() {
            Axes::Log => self.0.estimate(&knowledge, watch),
            Axes::Survey => estimate_in_survey(&*self.0, &knowledge, watch),
        }?;
        let Some(by_ranges) = self.0.by_ranges().filter(|_| !knowledge.log.ranges().is_empty()) else {
            return Ok((map, learned));
        };
        let (of_ranges, ranges) = by_ranges.map_and_learn(knowledge, watch)?;
        take_places(&mut map, of_ranges);
        let learned = match (learned, ranges) {
            (Some(learned), Some(ranges)) => Some(learned.and(ranges)),
            (learned, ranges) => learned.or(ranges),
        };
        Ok((map, learned))
    }
}

/// Puts the places of nodes that have ranges into a map of the same log by other evidence. A node whose ranges leave two places or
/// none stays where the map has it, if it has it.
fn take_places(map: &mut TopologyMap, of_ranges: TopologyMap) {
    for (place, of_ranges) in map.estimates.iter_mut().zip(of_ranges.estimates) {
        let is_told = of_ranges.as_ref().is_some_and(|estimate| {
            !matches!(estimate.concern, Some(Concern::NoEvidence | Concern::TwoPlaces | Concern::TooFew))
        });
        if is_told || place.is_none() {
            *place = of_ranges.or(place.take());
        }
    }
}

/// What `estimator` finds in the frame of the survey of `knowledge`, told in the frame of its log.
fn estimate_in_survey(
    estimator: &dyn Estimator,
    knowledge: &Knowledge<'_>,
    watch: &dyn Watch,
) -> Result<(TopologyMap, Option<EstimatorFindings>), MapError> {
    let Some(survey) = Survey::of_log(knowledge.log) else { return estimator.estimate(knowledge, watch) };
    watch.check()?;
    let (nodes, log) = survey.log(knowledge.log);
    let prior = knowledge.prior.map(|prior| survey.prior(prior));
    let (map, learned) = estimator.estimate(&in_survey(knowledge, &log, prior.as_ref()), watch)?;
    let learned = learned.map(|learned| learned.in_log(&survey.frame).unwrap_or(learned));
    Ok((survey.frame.map_in_log(map, &nodes, knowledge.log.node_count()), learned))
}

impl Mapper {
    /// The same as [`map_and_learn`](Self::map_and_learn), with a log that is read part by part. The log of `knowledge` is not
    /// used.
    ///
    /// # Errors
    /// If a part cannot be read, the estimator needs all of the log at once, and for the reasons of
    /// [`map_and_learn`](Self::map_and_learn).
    pub fn map_parts(
        &self,
        parts: &dyn LogParts,
        knowledge: Knowledge<'_>,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<EstimatorFindings>), PartsError> {
        self.check_prior(knowledge.prior)?;
        let estimator = self.parts_estimator()?;
        let knowledge = Knowledge { log: parts.whole(), ..knowledge };
        map_parts(estimator, self.name(), self.axes(), parts, &knowledge, watch)
    }
}

impl PartialEq for Mapper {
    fn eq(&self, other: &Self) -> bool {
        (*self.0).is_same(&*other.0)
    }
}

impl std::ops::Deref for Mapper {
    type Target = dyn Estimator;

    fn deref(&self) -> &Self::Target {
        &*self.0
    }
}

/// The settings of an estimator as written in a scenario.
pub trait EstimatorSettings {
    /// What suits any log, for an estimator that can be named without settings.
    const ANY_LOG: Option<AnyLog> = None;

    /// Whether the estimator uses what is known of the places of nodes ([`Estimator::uses_prior`]).
    const USES_PRIOR: bool = false;

    /// Whether the estimator maps a log part by part ([`Estimator::by_parts`]).
    const BY_PARTS: bool = false;

    /// The estimator with these settings.
    ///
    /// # Errors
    /// If a value is invalid.
    fn mapper(self) -> Result<Mapper, SettingError>;

    /// The reception profiles in the settings.
    fn profiles_mut(&mut self) -> Vec<ProfileSetting<'_>> {
        Vec::new()
    }

    /// The law that turns signal strengths into distances.
    fn ranging_mut(&mut self) -> Option<&mut RangingConfig> {
        None
    }

    /// How sectors are used, by an estimator that uses them.
    fn sectors_mut(&mut self) -> Option<&mut SectorsConfig> {
        None
    }

    /// The receiver of the signal strengths.
    fn receiver_mut(&mut self) -> Option<ReceiverSetting<'_>> {
        None
    }

    /// The networks whose logs are mapped together, by name; `None` if the log of one network is mapped.
    fn networks(&self) -> Option<Vec<&str>> {
        None
    }
}

/// How an estimator can be named without settings, because its defaults suit any log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AnyLog {
    /// Its name, which is its key in a scenario with hyphens: `ml-tm`.
    pub name: &'static str,
    /// Where it stands in lists, from 0: those that are tried first come first.
    pub rank: u8,
    /// What it computes, in a sentence without a full stop.
    pub description: &'static str,
    /// Its settings, as a table in a scenario.
    pub settings: &'static str,
}

impl AnyLog {
    /// Its key in a scenario: `ml_tm`.
    #[must_use]
    pub fn key(&self) -> String {
        self.name.replace('-', "_")
    }
}

/// A reception profile in the settings of an algorithm.
#[derive(Debug, PartialEq)]
pub struct ProfileSetting<'a> {
    /// Its key within the settings.
    pub key: String,
    /// Name of the network that it is for; `None` for that of the map.
    pub network: Option<String>,
    /// The profile.
    pub profile: &'a mut ProfileConfig,
}

/// A receiver of signal strengths in the settings of an algorithm.
#[derive(Debug, PartialEq)]
pub struct ReceiverSetting<'a> {
    /// Least strength at which packets are received (dBm).
    pub sensitivity_dbm: &'a mut Option<f64>,
    /// Hard communication radius (m).
    pub max_range_m: &'a mut Option<f64>,
}
