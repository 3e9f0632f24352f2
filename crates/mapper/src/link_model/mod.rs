//! Maps by a model of real radio links.

mod cavity;
mod fit;
mod geometry;
mod hearing;
mod law;
mod likelihood;
mod links;
mod locate;
mod losses;
mod outages;
mod parts;
mod posterior;
mod predict;
mod prediction;
mod receiver;
mod receiver_trial;
mod report;
mod site;
mod tables;
mod unknown;
mod window;
mod with_law;

use rayon::prelude::*;
#[cfg(feature = "config")]
use serde::{Deserialize, Serialize};
use sextant_channel::{ReceptionLog, Stop};
use sextant_kernel::{Interrupted, SettingError, Watch, Work};

use crate::error::MapError;
use crate::estimator::{AnyLog, Estimator, EstimatorSettings, Mapper};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::learned::EstimatorFindings;
use crate::log_facts::SoughtHeights;
use crate::log_facts::heights::check_z_range;
use crate::numerics::normal::below;
use crate::parts::PartEstimator;
use crate::posterior::{Estimate, FitState, PlacePrior};
use crate::survey_frame::Axes;
use crate::topology_map::{CoordinateFrame, TopologyMap};
use fit::FoundLaw;
use hearing::Hearing;
pub use law::Law;
use links::PlaceLinks;
pub use losses::Losses;
use outages::Outages;
pub(crate) use predict::{Placed, Predictor};
pub use receiver::Receiver;
use window::LinkWindow;
use with_law::{ModelWithLaw, VERTICES};

/// The link model as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "config", serde(deny_unknown_fields, default))]
pub struct LinkModelConfig {
    /// Whether signal strengths are used where the log has them.
    pub rssi: bool,
    /// Lowest and highest height of a node (m). If absent, nodes are at the height of the stops if these are nearly level.
    #[cfg_attr(feature = "config", serde(skip_serializing_if = "Option::is_none"))]
    pub z_range_m: Option<[f64; 2]>,
}

impl Default for LinkModelConfig {
    fn default() -> Self {
        Self { rssi: true, z_range_m: None }
    }
}

/// Maps by a model of real radio links: packets of a link share their shadowing, and neighbouring places share part of it.
///
/// Each link has a margin: what its signal has above the need of the receiver, in standard deviations of the fading. The
/// packets that were received and their mean strength tell the margin; a [`Law`] tells how it depends on the place of the
/// node. The law comes from the log itself (empirical Bayes). Its shadowing is a Gaussian process over the places of
/// listening: what many places say that lie close together counts about once. A place is the mean of its posterior.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkModel {
    config: LinkModelConfig,
    /// How much of the law by which nodes are placed is that of the log, 0 to 1; the rest is that of usual links.
    own_share: f64,
    /// How margins become packets and strengths, if it is known.
    hearing: Option<KnownHearing>,
    /// The law at which the search for one begins, if it is known.
    first_law: Option<Law>,
}

/// How margins become packets and strengths, as a log told.
#[derive(Clone, Copy, Debug, PartialEq)]
struct KnownHearing {
    receiver: Option<Receiver>,
    losses: Losses,
}

/// Which measurements a map used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(Serialize))]
#[cfg_attr(feature = "config", serde(rename_all = "kebab-case"))]
pub enum LinkEvidence {
    /// How many packets were received.
    Packets,
    /// With which strength; every packet that is known to be sent was received.
    Rssi,
    /// Both.
    PacketsAndRssi,
}

/// What was estimated with a map by the link model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkFit {
    /// The law of links.
    pub law: Law,
    /// How the receivers turn margins into strengths, if the log has usable strengths.
    pub receiver: Option<Receiver>,
    /// Losses that power does not cause.
    pub losses: Losses,
    /// Probability that a link is dead whatever its power: nothing is heard, and that says nothing of the place.
    pub outage: f64,
    /// Which measurements were used.
    pub evidence: LinkEvidence,
    /// Whether nodes were looked for far beyond all stops: the log is much more probable then.
    pub has_far_nodes: bool,
    /// Number of rounds of the search for the law.
    pub rounds: u32,
    /// Whether the search ended by itself, within the bounds of the law.
    pub settled: bool,
}

impl LinkFit {
    /// Share of the packets that arrive over a distance (m), over all nodes, directions and shadowing.
    #[must_use]
    pub fn probability(&self, distance_m: f64) -> f64 {
        let spread = self.law.spread();
        let margin = self.law.at_one_metre() - self.law.slope * libm::log(distance_m.max(1e-9));
        let slopes = self.law.slope_deviation() * libm::log(distance_m.max(1e-9) / self.law.distance_m);
        let reached = below(margin / (1.0 + spread * spread + slopes * slopes).sqrt());
        (1.0 - self.outage) * self.losses.kept() * reached
    }

    /// The path-loss exponent, if the log has strengths.
    #[must_use]
    pub fn path_loss_exponent(&self) -> Option<f64> {
        self.receiver.map(|receiver| law::exponent(self.law.slope, receiver.fading_db))
    }
}

/// Heights of stops that differ by less than this share of the reach are level, as far as a step of a grid goes.
const LEVEL: f64 = 0.025;
/// Nodes are looked for far beyond all stops if the logarithm of the evidence grows by this (nats): strong evidence (Kass and
/// Raftery 1995).
const FAR_NODES: f64 = 3.0;

impl LinkModel {
    /// The algorithm's name in tables and topics.
    pub const NAME: &'static str = "link-model";

    /// The same model, which places nodes by a law in which the log has a share, 0 to 1, and usual links the rest. Without
    /// strengths, whose law is in decibels, it is that of the log. What it tells of its law is always that of the log.
    #[must_use]
    pub fn with_own_share(self, own_share: f64) -> Self {
        Self { own_share, ..self }
    }

    /// The same model, with receivers and losses as `log` tells them, for maps of its parts: nothing in these depends on a place.
    pub(crate) fn with_hearing_of(self, log: &ReceptionLog) -> Self {
        let hearing = PlaceLinks::of(log, self.config.rssi).map(|links| {
            let hearing = Hearing::of(&links, self.config.rssi);
            KnownHearing { receiver: hearing.receiver, losses: hearing.counts.losses() }
        });
        Self { hearing, ..self }
    }

    /// The same model, whose search for a law begins at that of another part of the log.
    pub(crate) fn with_first_law(self, law: Law) -> Self {
        Self { first_law: law.has_all_parts().then_some(law), ..self }
    }

    /// The kinds of knowledge that it uses.
    #[must_use]
    pub fn uses(&self) -> &'static [KnowledgeKind] {
        if self.config.rssi {
            &[KnowledgeKind::RobotReceptions, KnowledgeKind::RobotRssi]
        } else {
            &[KnowledgeKind::RobotReceptions]
        }
    }

    /// The map of the nodes in `log`, with a covariance for each node, and the law that was estimated (`None` if nothing was
    /// heard). The result is bit-identical for any number of threads. Nodes that were never heard are not placed.
    ///
    /// # Errors
    /// [`MapError::Interrupted`] if `watch` ends the work.
    pub fn map(
        &self,
        log: &ReceptionLog,
        prior: Option<&PlacePrior>,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<LinkFit>), MapError> {
        let mut map = Self::unmapped(log);
        let Some(links) = PlaceLinks::of(log, self.config.rssi) else { return Ok((map, None)) };
        let Some(learned) = self.learn(&links, log.stops(), (links.nodes.len(), prior), watch)? else {
            return Ok((map, None));
        };
        learned.locate(&links, &mut map, watch)?;
        Ok((map, Some(learned.fit)))
    }

    /// The map of no node of `log`.
    fn unmapped(log: &ReceptionLog) -> TopologyMap {
        let nowhere = vec![None; log.node_count()];
        TopologyMap::of_places(Self::NAME, nowhere, CoordinateFrame::World)
    }

    /// What `links` tell, of a log with these stops in which so many nodes were heard; `None` without stops.
    fn learn<'a>(
        &self,
        links: &PlaceLinks,
        stops: &[Stop],
        (heard, prior): (usize, Option<&'a PlacePrior>),
        watch: &dyn Watch,
    ) -> Result<Option<Learned<'a>>, Interrupted> {
        let z_range_m = self.config.z_range_m;
        let heights = SoughtHeights::of_log(stops, z_range_m, links.reach_m, LEVEL * links.reach_m);
        let Some(heights) = heights else { return Ok(None) };
        let is_spatial = heights.high_m > heights.low_m;
        let usual = LinkWindow::new(links, heights, z_range_m.is_some(), prior);
        watch.begin(Self::work(links, is_spatial));
        let hearing = match self.hearing {
            Some(KnownHearing { receiver, losses }) => Hearing::new(links, receiver, losses),
            None => Hearing::of(links, self.config.rssi),
        };
        let search = (self.first_law, self.own_share);
        let find = |window: &LinkWindow<'_>| fit::find(links, window, is_spatial, &hearing, search, watch);
        let far = match usual.of_far(&links.nodes) {
            Some(far) => {
                let log_evidence = |window: &LinkWindow<'_>| {
                    fit::log_evidence_in(links, window, is_spatial, &hearing, self.first_law, watch)
                };
                let is_likely = log_evidence(&far)? > log_evidence(&usual)? + FAR_NODES;
                let found = if is_likely { Some(find(&far)?) } else { None };
                found.filter(|found| far.holds_most_outside(&found.places)).map(|found| (far, found))
            }
            None => None,
        };
        let has_far_nodes = far.is_some();
        let (window, found) = match far {
            Some(far) => far,
            None => {
                let found = find(&usual)?;
                (usual, found)
            }
        };
        let FoundLaw { law, placing, outages, rounds, settled, .. } = found;
        let settled = settled && !law.is_at_bound();
        let evidence = evidence(links, hearing.receiver.is_some());
        let (receiver, losses, outage) = (hearing.receiver, hearing.counts.losses(), outages.of_log);
        let fit = LinkFit { law, receiver, losses, outage, evidence, has_far_nodes, rounds, settled };
        let inflation = unsure_of_law(heard) * if placing.has_alike_nodes() { OF_SIMPLE_LAW } else { 1.0 };
        Ok(Some(Learned { fit, placing, hearing, outages, window, heights, is_spatial, inflation }))
    }

    fn work(links: &PlaceLinks, is_spatial: bool) -> Work {
        let pairs: usize = links.nodes.iter().map(|node| node.links.len()).sum();
        Work {
            name: Self::NAME,
            // Those of the fit and one for each node.
            unit: "step",
            steps: links.nodes.len() as u64 + fit::WORK,
            operations: pairs as f64 * VERTICES[usize::from(is_spatial)].iter().sum::<f64>() * 200.0,
        }
    }
}

fn evidence(links: &PlaceLinks, uses_rssi: bool) -> LinkEvidence {
    let mut heard = links.nodes.iter().flat_map(|node| &node.links).filter(|link| link.received > 0);
    match uses_rssi {
        false => LinkEvidence::Packets,
        true if heard.all(|link| link.received == link.sent && link.rssi_dbm.is_some()) => LinkEvidence::Rssi,
        true => LinkEvidence::PacketsAndRssi,
    }
}

/// The factor on variances of places whose law was estimated from `nodes` nodes. The form is that of the final prediction error
/// (Akaike 1969), which grows by the number of parameters for each observation. The constants are those with which regions hold
/// what they say on logs of one, a few and many nodes.
pub(crate) fn unsure_of_law(nodes: usize) -> f64 {
    1.0 + 10.0 / (nodes as f64 + 4.0)
}

/// The factor on variances of places by a law of fewer parameters, which takes more places for independent witnesses. With it
/// regions of 95 % hold 93 to 100 % in fields of textbook laws and of a disc, in which such a law is found.
const OF_SIMPLE_LAW: f64 = 1.4;

/// What a log told.
#[derive(Debug)]
struct Learned<'a> {
    fit: LinkFit,
    /// The law by which nodes are placed.
    placing: Law,
    hearing: Hearing,
    outages: Outages,
    window: LinkWindow<'a>,
    heights: SoughtHeights,
    is_spatial: bool,
    /// Factor on covariances.
    inflation: f64,
}

impl Learned<'_> {
    /// Adds the nodes of `links` to `map`.
    fn locate(&self, links: &PlaceLinks, map: &mut TopologyMap, watch: &dyn Watch) -> Result<(), Interrupted> {
        let Self { hearing, outages, window, is_spatial, inflation, .. } = self;
        let (law, is_spatial, inflation) = (self.placing, *is_spatial, *inflation);
        let model = ModelWithLaw { law, hearing, outages, links, window, is_spatial, inflation };
        let [low_m, high_m] = window.heights();
        let planes = links.nodes.iter().map(|node| window.of(node));
        let (low_m, high_m) = planes
            .fold((low_m, high_m), |(low_m, high_m), bounds| (low_m.min(bounds.low[2]), high_m.max(bounds.high[2])));
        map.heights = Some(SoughtHeights { low_m, high_m, ..self.heights });
        let located: Result<Vec<_>, Interrupted> = links
            .nodes
            .par_iter()
            .map(|node| {
                watch.check()?;
                let located = model.locate(node);
                watch.advance(1);
                Ok(located)
            })
            .collect();
        for (node, (estimate, vertices)) in links.nodes.iter().zip(located?) {
            // A law that is assumed where the log does not tell it has a reach.
            let state = FitState { is_reach_known: true, is_settled: self.fit.settled };
            let concern = state.concern(estimate.concern);
            map.estimates[node.node().index()] = Some(Estimate { concern, ..estimate });
            map.vertices_evaluated += vertices;
        }
        Ok(())
    }
}

impl TryFrom<LinkModelConfig> for LinkModel {
    type Error = SettingError;

    fn try_from(config: LinkModelConfig) -> Result<Self, SettingError> {
        check_z_range(config.z_range_m)?;
        Ok(Self { config, own_share: 1.0, hearing: None, first_law: None })
    }
}

impl Estimator for LinkModel {
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
        LinkModelConfig::USES_PRIOR
    }

    fn by_parts(&self) -> Option<&dyn PartEstimator> {
        Some(self)
    }

    fn estimate(
        &self,
        knowledge: &Knowledge<'_>,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<EstimatorFindings>), MapError> {
        let (map, fit) = self.map(knowledge.log, knowledge.prior, watch)?;
        Ok((map, fit.map(EstimatorFindings::new)))
    }
}

impl EstimatorSettings for LinkModelConfig {
    const ANY_LOG: Option<AnyLog> = Some(AnyLog {
        name: "link-model",
        rank: 1,
        description: "A model of real radio links, estimated from the log; uses signal strengths where the log has them",
        settings: "{}",
    });

    const USES_PRIOR: bool = true;

    const BY_PARTS: bool = true;

    fn mapper(self) -> Result<Mapper, SettingError> {
        LinkModel::try_from(self).map(Mapper::new)
    }
}
