//! The estimator that suits a log, chosen by the log.

mod again;
mod agreement;
mod fall_of_strength;
mod folds;
mod opinions;
mod predict;
mod report;
mod rules;
mod score;
mod widths;

use std::sync::Arc;

#[cfg(feature = "config")]
use serde::{Deserialize, Serialize};
use sextant_channel::{ReceptionLog, SectorGains, SectorTable};
use sextant_kernel::{NodeId, SettingError, Watch};

use self::folds::{Fold, Folds};
use self::opinions::GainOfLaw;
pub use self::opinions::{Opinion, OpinionConstants, OpinionSource, Opinions, OtherOpinions};
use self::rules::ChoiceFacts;
pub use self::rules::ChoiceReason;
use self::score::Predicted;
pub use self::score::Score;
use self::widths::{enlarge, slow_fall};
use crate::count_rule::CountRule;
use crate::error::MapError;
use crate::estimator::{AnyLog, Estimator, EstimatorSettings, Mapper};
use crate::grid_ml::{Fit, FittedMlTm, MlTmConfig};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::learned::EstimatorFindings;
use crate::link_model::{Law, LinkFit, LinkModel, LinkModelConfig, unsure_of_law};
use crate::log_facts::SoughtHeights;
use crate::log_facts::reach::{heard_nodes, reach_m};
use crate::pattern::{PatternFit, PatternMap};
use crate::posterior::{EstimateKind, PlacePrior};
use crate::profile::{FittedConfig, ProfileConfig};
use crate::range_ml::RangeMlConfig;
use crate::self_calibrated::{Calibration, SelfCalibrated, SelfCalibratedConfig};
use crate::survey_frame::Axes;
use crate::topology_map::TopologyMap;

/// The choice of an estimator as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "config", serde(deny_unknown_fields, default))]
pub struct AutoConfig {
    /// Whether signal strengths are used where the log has them.
    pub rssi: bool,
    /// Lowest and highest height of a node (m). If absent, nodes are at the height of the stops if these are nearly level.
    #[cfg_attr(feature = "config", serde(skip_serializing_if = "Option::is_none"))]
    pub z_range_m: Option<[f64; 2]>,
}

impl Default for AutoConfig {
    fn default() -> Self {
        Self { rssi: true, z_range_m: None }
    }
}

/// Several estimators, of which the log chooses one.
///
/// The stops are cut into a few folds of neighbours. Each estimator maps some of the nodes without the stops of one fold,
/// then without those of the next. Its score is how probable it finds what was heard at the stops that were left out: packets,
/// and their strengths where the log has them. The self-calibrated map and the fitted grid take packets as independent: one of
/// them maps the log if it predicts as well as the link model does, the first of them unless the second is better by two standard
/// errors. Where the log has strengths, it must predict these better from its places, and most links must have several packets. One that is far behind after a fold is not
/// tried on the next. Their regions are enlarged until they explain how far their maps from parts of the stops differ. The places
/// of the link model are joined with other [`Opinions`], which know no law of radio. A log with too few stops or nodes for folds
/// is mapped by the link model. Where the log knows the measured gains of the sectors in which nodes were heard, a map by these
/// is another estimator of independent packets, and the first one. Nodes whose distances were measured are placed by these
/// ([`RangeMl`](crate::RangeMl)).
#[derive(Clone, Debug, PartialEq)]
pub struct Auto {
    rssi: bool,
    z_range_m: Option<[f64; 2]>,
    link_model: LinkModel,
    /// Its grid suits no log yet.
    fitted: FittedMlTm,
    self_calibrated: SelfCalibrated,
    by_ranges: Mapper,
    /// What it chose for the log when that was shorter: no other estimator is tried.
    before: Option<Arc<Choice>>,
}

/// What was learned about a log and its estimators.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The score of each estimator.
    pub scores: Vec<Score>,
    /// Name of the estimator that was chosen.
    pub chosen: &'static str,
    /// Why it was chosen.
    pub reason: ChoiceReason,
    /// What it estimated with the map.
    pub fit: Option<EstimatorFit>,
    /// Factor by which the variances of the map were enlarged, at least 1: its maps from parts of the stops differ by more than
    /// its own regions tell, the log cannot tell it from the link model, whose regions are wider, or strengths fall more slowly than
    /// in real surroundings.
    pub enlargement: f64,
    /// The other opinions on each place, if they are in the map.
    pub opinions: Option<Opinions>,
}

/// What an estimator estimated with its map.
#[derive(Clone, Debug, PartialEq)]
pub enum EstimatorFit {
    /// A law of links.
    Links(LinkFit),
    /// A reception profile.
    Profile(Fit),
    /// A reception curve, the efficiency of each stop, and the obstacles.
    Calibration(Calibration),
    /// The law of an antenna.
    Pattern(PatternFit),
}

/// Steps of the grid of the fitted map over the reach.
const STEPS_PER_REACH: f64 = 40.0;

/// What is wrong with a law counts in variances so many times the squared distance between maps by different laws: both err, and
/// in part alike.
const BETWEEN_LAWS: f64 = 2.0;

/// The name of the map by gains among the candidates.
const PATTERN: &str = "antenna-pattern";

/// The number of the link model among the candidates.
const LINKS: usize = 0;

/// An estimator that may be chosen.
#[derive(Clone, Copy)]
enum Candidate<'a> {
    LinkModel(&'a LinkModel),
    Fitted(&'a FittedMlTm),
    SelfCalibrated(&'a SelfCalibrated),
    Pattern(PatternMap, &'a SectorGains),
}

/// What the candidates made of the stops that were left out.
#[derive(Default)]
struct Trials {
    /// What each candidate predicted of them; empty if none were left out.
    predicted: Vec<Predicted>,
    /// The maps without them of each candidate.
    parts: Vec<Vec<TopologyMap>>,
    /// Whether the log has strengths.
    has_strengths: bool,
    gain: GainOfLaw,
}

impl Auto {
    /// The algorithm's name in tables and topics.
    pub const NAME: &'static str = "auto";

    /// The kinds of knowledge that it uses.
    #[must_use]
    pub fn uses(&self) -> &'static [KnowledgeKind] {
        if self.rssi {
            &[KnowledgeKind::RobotReceptions, KnowledgeKind::RobotRssi, KnowledgeKind::RobotPath]
        } else {
            &[KnowledgeKind::RobotReceptions, KnowledgeKind::RobotPath]
        }
    }

    /// The map of the nodes in `log`, and how it was chosen (`None` if nothing was heard). With a `prior`, only the link model
    /// can use what is known. The result is bit-identical for any number of threads.
    ///
    /// # Errors
    /// Those of the estimators; [`MapError::Interrupted`] if `watch` ends the work.
    pub fn map(
        &self,
        log: &ReceptionLog,
        prior: Option<&PlacePrior>,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<Choice>), MapError> {
        if let Some(again) = self.map_again(log, prior, watch)? {
            return Ok(again);
        }
        let heard = heard_nodes(log);
        let reach_m = reach_m(log, &heard);
        let fitted = self.fitted.with_grid_step_m(reach_m / STEPS_PER_REACH);
        let mut link_model = self.link_model.with_hearing_of(log);
        let mut candidates = vec![Candidate::LinkModel(&self.link_model)];
        if prior.is_none() {
            candidates.extend(self.pattern(log, reach_m));
            candidates.extend([Candidate::SelfCalibrated(&self.self_calibrated), Candidate::Fitted(&fitted)]);
        }
        let mut trials = Trials { parts: vec![Vec::new(); candidates.len()], ..Trials::default() };
        if candidates.len() > 1
            && let Some(folds) = Folds::of(log, self.is_spatial(log, reach_m))
        {
            trials.predicted = vec![Predicted::new(folds.nodes()); candidates.len()];
            for fold in folds.iter() {
                if let Some(law) = predict(&link_model, &fold, &candidates, &mut trials, watch)? {
                    link_model = link_model.with_first_law(law);
                }
            }
        }
        let as_good = as_good(&candidates, &trials.predicted);
        let strengths_agree = as_good.is_none_or(|number| trials.strengths_agree(number));
        let Trials { predicted, parts, gain, has_strengths } = trials;
        let scores = score::scores(candidates.iter().map(|candidate| candidate.name()), &predicted);
        let mut facts = ChoiceFacts {
            knows_places: prior.is_some(),
            compared: !predicted.is_empty(),
            as_good,
            strengths_agree,
            single_packets: has_strengths && has_single_packets(log),
            settles: true,
        };
        // Usual links tell nothing of links that seem independent.
        let is_own_law = prior.is_some() || as_good.is_some();
        let own_share = if is_own_law { 1.0 } else { OpinionConstants::LEARNT.own_share_at(gain.mean()) };
        let link_model = link_model.with_own_share(own_share);
        candidates[LINKS] = Candidate::LinkModel(&link_model);
        let (mut number, mut reason) = rules::choose(&facts, LINKS);
        let (mut map, mut fit) = candidates[number].map(log, prior, watch)?;
        if number != LINKS && !settles(&map, fit.as_ref()) {
            facts.settles = false;
            (number, reason) = rules::choose(&facts, LINKS);
            (map, fit) = candidates[number].map(log, prior, watch)?;
        }
        let candidate = candidates[number];
        let enlargement = match candidate {
            // Its regions know that its law is estimated, but not that real strengths fall faster.
            Candidate::LinkModel(_) => slow_fall(fit.as_ref()).powi(2),
            _ => {
                let others = (0..parts.len()).filter(|&other| other != number);
                let nearest_law = others.filter_map(|other| agreement::between_laws(&parts[number], &parts[other]));
                let law_error = BETWEEN_LAWS * nearest_law.reduce(f64::min).unwrap_or(0.0);
                let enlarged = agreement::enlargement(&parts[number]) + law_error;
                let enlarged = enlarged.max(unsure_of_law(heard.len()));
                if score::is_surely_better(&predicted[number], &predicted[LINKS]) {
                    enlarged
                } else {
                    // For all that the log tells, packets of a link may share what they lose.
                    enlarged.max(agreement::variances_over(&parts[number], &parts[LINKS]))
                }
            }
        };
        enlarge(&mut map, enlargement);
        let opinions = match (candidate, &fit) {
            (Candidate::LinkModel(_), Some(EstimatorFit::Links(fit))) if prior.is_none() => {
                let joined = join_opinions(&mut map, log, fit, (gain.mean(), enlargement), watch)?;
                joined.map(|joined| if is_own_law { Opinions { own_share: 1.0, ..joined } } else { joined })
            }
            _ => None,
        };
        map.algorithm = Self::NAME;
        let choice = Choice { scores, chosen: candidate.name(), reason, fit, enlargement, opinions };
        Ok(if map.mapped() == 0 { (map, None) } else { (map, Some(choice)) })
    }

    /// The map by the gains of sectors, where `log` knows them.
    fn pattern<'a>(&self, log: &'a ReceptionLog, reach_m: f64) -> Option<Candidate<'a>> {
        let pattern = PatternMap {
            grid_step_m: reach_m / STEPS_PER_REACH,
            estimate: EstimateKind::PosteriorMean,
            z_range_m: self.z_range_m,
            counts: CountRule::Packets,
        };
        gains_of(log).map(|gains| Candidate::Pattern(pattern, gains))
    }

    /// Whether nodes are searched for in space.
    fn is_spatial(&self, log: &ReceptionLog, reach_m: f64) -> bool {
        let heights = SoughtHeights::of_log(log.stops(), self.z_range_m, reach_m, reach_m / STEPS_PER_REACH);
        heights.is_some_and(|heights| heights.high_m > heights.low_m)
    }
}

impl Trials {
    /// Whether strengths, if there are any, speak for the places of an estimator of independent packets, which does not use them.
    fn strengths_agree(&self, number: usize) -> bool {
        !self.has_strengths
            || score::strengths_confirm(&self.predicted[number], &self.predicted[LINKS], self.gain.mean())
    }
}

/// Joins other opinions with the places of `map` by the link model, whose law has this gain and whose variances were enlarged.
fn join_opinions(
    map: &mut TopologyMap,
    log: &ReceptionLog,
    fit: &LinkFit,
    (gain, enlargement): (Option<f64>, f64),
    watch: &dyn Watch,
) -> Result<Option<Opinions>, MapError> {
    let source = if fit.receiver.is_some() { OpinionSource::Strengths } else { OpinionSource::Packets };
    let others = OtherOpinions::of(log, source, watch)?;
    let others = if fit.has_far_nodes { others.amid_stops(log, map) } else { others };
    Ok(others.join(map, gain, &OpinionConstants::LEARNT.wider_by(enlargement.sqrt())))
}

/// Takes what each candidate makes of `fold`; the law of its links.
fn predict(
    link_model: &LinkModel,
    fold: &Fold<'_>,
    candidates: &[Candidate<'_>],
    trials: &mut Trials,
    watch: &dyn Watch,
) -> Result<Option<Law>, MapError> {
    let (of_links, law) = link_model.map(&fold.rest, None, watch)?;
    let Trials { predicted, parts, has_strengths, gain } = trials;
    *has_strengths |= law.is_some_and(|law| law.receiver.is_some());
    for (number, candidate) in candidates.iter().enumerate() {
        match candidate {
            Candidate::LinkModel(_) => {
                predicted[number].begin_fold();
                predict::by_links(fold, &fold.rest, law.as_ref(), &of_links, &mut predicted[number], gain);
                parts[number].push(of_links.clone());
            }
            Candidate::Fitted(_) | Candidate::SelfCalibrated(_) | Candidate::Pattern(..) => {
                if score::is_hopeless(&predicted[number], &predicted[LINKS]) {
                    continue;
                }
                let (map, fit) = candidate.map(&fold.rest, None, watch)?;
                predicted[number].begin_fold();
                predict::independent(fold, &map, fit.as_ref(), &mut predicted[number]);
                parts[number].push(map);
            }
        }
    }
    Ok(law.map(|law| law.law))
}

/// The gains of the sectors in which nodes of a log were heard, if it knows both: those that were measured, or of an antenna
/// that turns, for which there are no wedges.
fn gains_of(log: &ReceptionLog) -> Option<&SectorGains> {
    let gains = log.sectors().and_then(SectorTable::gains)?;
    let is_used = gains.antenna().is_measured() || log.has_headings();
    (is_used && log.receptions().sectors().is_some()).then_some(gains)
}

/// Whether most links of a log have no more than one packet.
fn has_single_packets(log: &ReceptionLog) -> bool {
    let links = || (0..log.node_count()).flat_map(|node| log.of(NodeId::from_index(node)));
    2 * links().filter(|link| link.sent <= 1).count() > links().count()
}

/// Whether an estimator settles on a log: its profile does, and most places have no concern.
fn settles(map: &TopologyMap, fit: Option<&EstimatorFit>) -> bool {
    let has_curve = !matches!(fit, Some(EstimatorFit::Profile(fit)) if !fit.converged);
    has_curve && 2 * map.concerns().count() <= map.mapped()
}

/// The number of the most trusted candidate of independent packets, if it predicts as well as the link model does.
fn as_good(candidates: &[Candidate<'_>], predicted: &[Predicted]) -> Option<usize> {
    if predicted.is_empty() {
        return None;
    }
    let is_independent = |number: &usize| !matches!(candidates[*number], Candidate::LinkModel(_));
    let independent: Vec<usize> = (0..candidates.len()).filter(is_independent).collect();
    score::as_good(predicted, LINKS, &independent)
}

impl Candidate<'_> {
    fn name(self) -> &'static str {
        match self {
            Self::LinkModel(_) => LinkModel::NAME,
            Self::Fitted(_) => "fitted",
            Self::SelfCalibrated(_) => SelfCalibrated::NAME,
            Self::Pattern(..) => PATTERN,
        }
    }

    fn map(
        self,
        log: &ReceptionLog,
        prior: Option<&PlacePrior>,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<EstimatorFit>), MapError> {
        Ok(match self {
            Self::LinkModel(model) => {
                let (map, fit) = model.map(log, prior, watch)?;
                (map, fit.map(EstimatorFit::Links))
            }
            Self::Fitted(fitted) => {
                let (map, fit) = fitted.map(log, watch)?;
                (map, fit.map(EstimatorFit::Profile))
            }
            Self::SelfCalibrated(calibrated) => {
                let (map, calibration) = calibrated.map(log, watch)?;
                (map, calibration.map(EstimatorFit::Calibration))
            }
            Self::Pattern(pattern, gains) => {
                let (map, fit) = pattern.map(log, gains, None, PATTERN, watch)?;
                (map, fit.map(EstimatorFit::Pattern))
            }
        })
    }
}

impl TryFrom<AutoConfig> for Auto {
    type Error = SettingError;

    fn try_from(AutoConfig { rssi, z_range_m }: AutoConfig) -> Result<Self, SettingError> {
        let fitted = MlTmConfig {
            estimate: EstimateKind::PosteriorMean,
            z_range_m,
            ..MlTmConfig::new(1.0, ProfileConfig::Fitted(FittedConfig::default()))
        };
        Ok(Self {
            rssi,
            z_range_m,
            link_model: LinkModel::try_from(LinkModelConfig { rssi, z_range_m })?,
            fitted: FittedMlTm::new(fitted, FittedConfig::default())?,
            self_calibrated: SelfCalibrated::try_from(SelfCalibratedConfig {
                z_range_m,
                ..SelfCalibratedConfig::default()
            })?,
            by_ranges: RangeMlConfig { z_range_m, ..RangeMlConfig::default() }.mapper()?,
            before: None,
        })
    }
}

impl Estimator for Auto {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn axes(&self) -> Axes {
        Axes::Survey
    }

    fn uses(&self) -> &'static [KnowledgeKind] {
        self.uses()
    }

    fn uses_prior(&self) -> bool {
        AutoConfig::USES_PRIOR
    }

    fn by_ranges(&self) -> Option<&Mapper> {
        Some(&self.by_ranges)
    }

    fn after(&self, learned: &EstimatorFindings) -> Option<Mapper> {
        let before = Some(Arc::new(learned.get::<Choice>()?.clone()));
        Some(Mapper::new(Self { before, ..self.clone() }))
    }

    fn estimate(
        &self,
        knowledge: &Knowledge<'_>,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<EstimatorFindings>), MapError> {
        let (map, choice) = self.map(knowledge.log, knowledge.prior, watch)?;
        Ok((map, choice.map(EstimatorFindings::new)))
    }
}

impl EstimatorSettings for AutoConfig {
    const ANY_LOG: Option<AnyLog> = Some(AnyLog {
        name: "auto",
        rank: 0,
        description: "The estimator that the log chooses: link model with other opinions, antenna pattern, fitted grid or self-calibrated",
        settings: "{}",
    });

    const USES_PRIOR: bool = true;

    fn mapper(self) -> Result<Mapper, SettingError> {
        Auto::try_from(self).map(Mapper::new)
    }
}
