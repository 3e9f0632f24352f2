//! Joint maps of several networks of the same nodes: one likelihood from all their logs.

use std::borrow::Cow;
use std::collections::BTreeMap;

use rayon::prelude::*;
#[cfg(feature = "config")]
use serde::{Deserialize, Serialize};
use sextant_channel::{ReceptionLog, Stop};
use sextant_kernel::{NodeId, SettingError, Watch, Work};

use super::ml_tm::uses_under;
use crate::count_rule::CountRule;
use crate::error::MapError;
use crate::estimator::{Estimator, EstimatorSettings, Mapper, ProfileSetting};
use crate::grid_ml::findings::Findings;
use crate::grid_ml::fitted::{Fit, NetworkFits};
use crate::grid_ml::fitted_ml_tm::FittedMlTm;
use crate::grid_ml::ml_tm::{DEFAULT_MEMORY_MB, MlTm, MlTmConfig};
use crate::grid_ml::solver::{Contenders, GridSearch, Moments, Peak, Solver, SolverScratch};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::lattice::Lattice;
use crate::learned::EstimatorFindings;
use crate::log_facts::{SectorsConfig, SoughtHeights};
use crate::posterior::{Estimate, EstimateKind, TieRule};
use crate::profile::{ProfileConfig, ReceptionProfile};
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// A joint map as written in a scenario.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "config", serde(deny_unknown_fields))]
pub struct JointConfig {
    /// The networks whose logs are evidence, at least two.
    pub networks: Vec<JointNetworkConfig>,
    /// Distance of neighbouring grid vertices (m).
    pub grid_step_m: f64,
    /// How the place is estimated from the likelihood.
    #[cfg_attr(feature = "config", serde(default))]
    pub estimate: EstimateKind,
    /// Which place `argmax` takes if several vertices have the highest likelihood.
    #[cfg_attr(feature = "config", serde(default))]
    pub ties: TieRule,
    /// Lowest and highest height of a node (m). If absent, as for `ml_tm`, from the stops of all networks and the longest
    /// range.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub z_range_m: Option<[f64; 2]>,
    /// Maximum memory for the grid window of one node (MB); 512 if absent.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub max_memory_mb: Option<u32>,
}

/// One network of a joint map as written in a scenario.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "config", serde(deny_unknown_fields))]
pub struct JointNetworkConfig {
    /// Name of the network.
    pub network: String,
    /// How likely a packet is received over a distance; fitted to the log of the network if absent.
    #[cfg_attr(feature = "config", serde(default = "fitted"))]
    pub profile: ProfileConfig,
    /// How a reception of several packets counts, as for `ml_tm`.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub counts: Option<CountRule>,
    /// How the antenna sectors of the network are used. If absent, the sectors of its log are evidence.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub sectors: Option<SectorsConfig>,
}

#[cfg(feature = "config")]
fn fitted() -> ProfileConfig {
    ProfileConfig::Fitted(crate::profile::FittedConfig::default())
}

/// A map from the logs of several networks of the same nodes, each with its own stops, profile and sectors.
///
/// The likelihood of a node is the product of its likelihoods in each network where it was heard. The search set holds
/// the vertices that are in that of [`MlTm`] in each of these networks. If there are none, the node is infeasible, and
/// the search sets are those of infeasible nodes in each network; if these have no vertex in common either, the
/// network that received the most packets places the node alone.
#[derive(Clone, Debug, PartialEq)]
pub struct JointMlTm {
    members: Vec<Member>,
    grid_step_m: f64,
    estimate: EstimateKind,
    ties: TieRule,
    z_range_m: Option<[f64; 2]>,
    allowed_bytes: u64,
}

#[derive(Clone, Debug, PartialEq)]
struct Member {
    network: String,
    likelihood: JointLikelihood,
}

#[derive(Clone, Debug, PartialEq)]
enum JointLikelihood {
    Given(MlTm),
    Fitted(FittedMlTm),
}

/// A log with the likelihood for it.
struct Prepared<'a> {
    ml_tm: MlTm,
    log: Cow<'a, ReceptionLog>,
    /// The number of each node of the map in the log, if it is there.
    nodes: Vec<Option<NodeId>>,
}

/// First margin below the highest likelihood of each network within which vertices are collected, in addition to what
/// the estimate needs.
const MARGIN: f64 = 20.0;

impl JointMlTm {
    /// The algorithm's name in tables and topics.
    pub const NAME: &'static str = "joint-ml-tm";

    /// The names of the networks, in the order in which their logs are given to [`map`](Self::map).
    pub fn networks(&self) -> impl ExactSizeIterator<Item = &str> {
        self.members.iter().map(|member| member.network.as_str())
    }

    /// The profiles that are given, not fitted.
    pub(crate) fn profiles(&self) -> impl Iterator<Item = &ReceptionProfile> {
        self.members.iter().filter_map(|member| match &member.likelihood {
            JointLikelihood::Given(ml_tm) => Some(ml_tm.profile()),
            JointLikelihood::Fitted(_) => None,
        })
    }

    /// The map of the nodes in the first of `logs`, one log for each network, and the profiles that were fitted. Nodes have
    /// the same names in all logs; a node that a log does not name was not heard there. Computed on the current rayon pool;
    /// the result is bit-identical for any number of threads.
    ///
    /// # Errors
    /// [`MapError::Networks`] if there is not one log for each network; [`MapError::OtherNodes`] if a log names a node that the
    /// first one does not; and those of [`MlTm::map`].
    pub fn map(
        &self,
        logs: &[&ReceptionLog],
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Vec<Option<Fit>>), MapError> {
        let Some(first) = logs.first().filter(|_| logs.len() == self.members.len()) else {
            return Err(MapError::Networks { networks: self.members.len(), logs: logs.len() });
        };
        let mut fits = Vec::new();
        let mut prepared = Vec::new();
        for (member, log) in self.members.iter().zip(logs) {
            let nodes = numbers(first, log, &member.network)?;
            let (ml_tm, log, fit) = member.likelihood.prepared(log, watch)?;
            prepared.push(Prepared { ml_tm, log, nodes });
            fits.push(fit);
        }
        let range_m = prepared.iter().map(|member| member.ml_tm.profile().range_m()).fold(0.0, f64::max);
        let step_m = prepared.iter().map(|member| member.ml_tm.grid_step_m()).fold(self.grid_step_m, f64::min);
        let stops: Vec<Stop> = prepared.iter().flat_map(|member| member.log.stops()).copied().collect();
        let mut map = TopologyMap {
            algorithm: Self::NAME,
            estimates: vec![None; first.node_count()],
            grid_step_m: Some(step_m),
            vertices_evaluated: 0,
            heights: SoughtHeights::of(&stops, self.z_range_m, range_m),
            frame: CoordinateFrame::World,
        };
        if logs.iter().all(|log| log.receptions().is_empty()) {
            return Ok((map, fits));
        }
        let lattice = Lattice::covering(&stops, range_m, step_m, self.z_range_m, self.allowed_bytes)?;
        let solvers: Result<Vec<Solver<'_>>, MapError> =
            prepared.iter().map(|member| member.ml_tm.solver(&lattice, &member.log, watch)).collect();
        let solvers = solvers?;
        let operations = |(member, solver): (&Prepared<'_>, &Solver<'_>)| -> f64 { solver.operations(&member.log) };
        watch.begin(Work {
            name: Self::NAME,
            unit: "node",
            steps: first.node_count() as u64,
            operations: prepared.iter().zip(&solvers).map(operations).sum(),
        });
        let solved: Result<Vec<(Option<Estimate>, u64)>, MapError> = (0..first.node_count())
            .into_par_iter()
            .with_min_len(8)
            .map_init(
                || solvers.iter().map(Solver::scratch).collect::<Vec<SolverScratch>>(),
                |scratch, node| {
                    let solved = self.estimate(&lattice, &prepared, &solvers, scratch, node);
                    watch.check()?;
                    watch.advance(1);
                    Ok(solved)
                },
            )
            .collect();
        map.take_in(solved?);
        Ok((map, fits))
    }

    fn estimate(
        &self,
        lattice: &Lattice,
        prepared: &[Prepared<'_>],
        solvers: &[Solver<'_>],
        scratch: &mut [SolverScratch],
        node: usize,
    ) -> (Option<Estimate>, u64) {
        let mut evaluated = 0;
        // The networks in which the node was heard, with the packets received.
        let mut heard: Vec<(usize, u64)> = Vec::new();
        for (at, member) in prepared.iter().enumerate() {
            let received = member.nodes[node]
                .map_or(0, |node| member.log.of(node).iter().map(|reception| u64::from(reception.received)).sum());
            if received > 0 {
                heard.push((at, received));
            }
        }
        // Exactly what is within this margin below the highest joint likelihood is needed.
        let needed = match self.estimate {
            EstimateKind::Argmax => 2.0 * Peak::TOLERANCE,
            EstimateKind::PosteriorMean => Moments::NEGLIGIBLE,
        };
        let mut search = |at: usize, margin: f64, is_clamped: bool| -> (Contenders, GridSearch) {
            let mut found = Contenders::within(margin);
            let receptions = prepared[at].nodes[node].map(|node| prepared[at].log.of(node));
            let search = receptions.map_or(GridSearch::default(), |receptions| {
                if is_clamped {
                    solvers[at].search_outliers(&mut scratch[at], receptions, margin, &mut found)
                } else {
                    solvers[at].search(&mut scratch[at], receptions, margin, &mut found)
                }
            });
            evaluated += search.evaluated;
            (found, search)
        };
        let (mut is_clamped, mut is_contradicted) = (false, false);
        let mut margin = needed + MARGIN;
        loop {
            let mut joint: Option<Vec<(u64, f64)>> = None;
            let mut highest = 0.0;
            let mut infeasible = is_clamped || is_contradicted;
            for &(at, _) in &heard {
                let (found, search) = search(at, margin, is_clamped);
                infeasible |= search.infeasible;
                highest += found.highest();
                let found = found.into_vertices();
                joint = Some(match joint {
                    Some(joint) => common(&joint, &found),
                    None => found,
                });
            }
            let Some(joint) = joint else { return (None, evaluated) };
            let best = joint.iter().map(|&(_, value)| value).fold(f64::NEG_INFINITY, f64::max);
            if heard.len() > 1 {
                if infeasible && !is_clamped {
                    // One network is infeasible: all are searched under clamped profiles, which can be compared.
                    is_clamped = true;
                    continue;
                }
                if best > f64::NEG_INFINITY && best - needed < highest - margin {
                    // A vertex that was not collected may be needed.
                    margin = highest - best + needed + 1e-6;
                    continue;
                }
                if best <= f64::NEG_INFINITY {
                    if margin < f64::INFINITY {
                        margin = f64::INFINITY;
                    } else if !is_clamped {
                        (is_clamped, margin) = (true, needed + MARGIN);
                    } else {
                        // The networks have no place in common: the one that received the most decides.
                        let most = heard.iter().map(|&(_, received)| received).max();
                        heard.retain(|&(_, received)| Some(received) == most);
                        heard.truncate(1);
                        (is_clamped, is_contradicted, margin) = (false, true, needed + MARGIN);
                    }
                    continue;
                }
            }
            let mut findings = Findings::new(self.estimate, lattice);
            for (index, value) in joint {
                findings.take(index, lattice.position(lattice.vertex(index)), value);
            }
            return (findings.estimate(lattice, self.ties, infeasible), evaluated);
        }
    }
}

/// The vertices of both lists, in rising order, with the sums of their values.
fn common(a: &[(u64, f64)], b: &[(u64, f64)]) -> Vec<(u64, f64)> {
    let mut b = b.iter().peekable();
    let mut found = Vec::new();
    for &(index, value) in a {
        while b.next_if(|&&(other, _)| other < index).is_some() {}
        if let Some(&(_, other)) = b.next_if(|&&(other, _)| other == index) {
            found.push((index, value + other));
        }
    }
    found
}

/// The number in `log` of each node of `first`.
fn numbers(first: &ReceptionLog, log: &ReceptionLog, network: &str) -> Result<Vec<Option<NodeId>>, MapError> {
    let of_name: BTreeMap<&str, usize> = log.names().iter().enumerate().map(|(i, name)| (name.as_str(), i)).collect();
    let numbers: Vec<Option<NodeId>> =
        first.names().iter().map(|name| of_name.get(name.as_str()).copied().map(NodeId::from_index)).collect();
    let mut is_known = vec![false; log.node_count()];
    numbers.iter().flatten().for_each(|node| is_known[node.index()] = true);
    match is_known.iter().position(|known| !known) {
        Some(other) => Err(MapError::OtherNodes { network: network.into(), name: log.names()[other].clone() }),
        None => Ok(numbers),
    }
}

impl JointLikelihood {
    /// The likelihood for `log`, and the part of the log that is evidence.
    fn prepared<'a>(
        &self,
        log: &'a ReceptionLog,
        watch: &dyn Watch,
    ) -> Result<(MlTm, Cow<'a, ReceptionLog>, Option<Fit>), MapError> {
        let (ml_tm, log, fit) = match self {
            Self::Given(ml_tm) => (ml_tm.clone(), Cow::Borrowed(log), None),
            Self::Fitted(fitted) => match fitted.fit(log, watch)? {
                Some(fit) => (fitted.with_fit(&fit), Cow::Owned(fit.evidence(log)), Some(fit)),
                None => (fitted.unfitted().clone(), Cow::Borrowed(log), None),
            },
        };
        let log = match log {
            Cow::Borrowed(log) => ml_tm.counted(log),
            Cow::Owned(log) => Cow::Owned(ml_tm.counted(&log).into_owned()),
        };
        Ok((ml_tm, log, fit))
    }
}

impl TryFrom<JointConfig> for JointMlTm {
    type Error = SettingError;

    fn try_from(config: JointConfig) -> Result<Self, SettingError> {
        let JointConfig { networks, grid_step_m, estimate, ties, z_range_m, max_memory_mb } = config;
        if networks.len() < 2 {
            let found = format!("{} networks", networks.len());
            return Err(SettingError::new("networks", found, "2 or more; one alone is mapped by `ml_tm`"));
        }
        let mut members: Vec<Member> = Vec::new();
        for (i, JointNetworkConfig { network, profile, counts, sectors }) in networks.into_iter().enumerate() {
            let within = |error: SettingError| error.within(format!("networks[{i}]"));
            if members.iter().any(|member| member.network == network) {
                return Err(within(SettingError::new("network", &network, "a network that is not yet in the list")));
            }
            let config =
                MlTmConfig { grid_step_m, profile, counts, estimate, ties, z_range_m, sectors, max_memory_mb };
            let is_own = |error: &SettingError| ["profile", "sectors"].iter().any(|key| error.key.starts_with(key));
            let within_own = |error: SettingError| if is_own(&error) { within(error) } else { error };
            let likelihood = match config.profile.clone() {
                ProfileConfig::Fitted(fitted) => FittedMlTm::new(config, fitted).map(JointLikelihood::Fitted),
                ProfileConfig::Channel(_) | ProfileConfig::Trapezoid(_) => {
                    MlTm::try_from(config).map(JointLikelihood::Given)
                }
            };
            members.push(Member { network, likelihood: likelihood.map_err(within_own)? });
        }
        let allowed_bytes = u64::from(max_memory_mb.unwrap_or(DEFAULT_MEMORY_MB)) * 1_000_000;
        Ok(Self { members, grid_step_m, estimate, ties, z_range_m, allowed_bytes })
    }
}

impl Estimator for JointMlTm {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn uses(&self) -> &'static [KnowledgeKind] {
        uses_under(self.profiles().find(|profile| matches!(profile, ReceptionProfile::Table(_))))
    }

    fn networks(&self) -> Vec<&str> {
        self.networks().collect()
    }

    fn check_grid(&self, stops: &[Stop]) -> Result<(), MapError> {
        // The range of a profile that is fitted is known only with a log.
        if self.profiles().count() < self.members.len() {
            return Ok(());
        }
        let range_m = self.profiles().map(ReceptionProfile::range_m).fold(0.0, f64::max);
        Lattice::covering(stops, range_m, self.grid_step_m, self.z_range_m, self.allowed_bytes).map(drop)
    }

    fn estimate(
        &self,
        knowledge: &Knowledge<'_>,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<EstimatorFindings>), MapError> {
        let logs: Result<Vec<_>, MapError> = self.networks().map(|network| knowledge.log_of(network)).collect();
        let (map, fits) = self.map(&logs?, watch)?;
        let fitted = self.networks().zip(fits).filter_map(|(name, fit)| Some((name.to_owned(), fit?)));
        let fitted: Vec<_> = fitted.collect();
        Ok((map, (!fitted.is_empty()).then(|| EstimatorFindings::new(NetworkFits(fitted)))))
    }
}

impl EstimatorSettings for JointConfig {
    fn mapper(self) -> Result<Mapper, SettingError> {
        JointMlTm::try_from(self).map(Mapper::new)
    }

    fn profiles_mut(&mut self) -> Vec<ProfileSetting<'_>> {
        self.networks
            .iter_mut()
            .enumerate()
            .map(|(i, member)| ProfileSetting {
                key: format!("networks[{i}].profile"),
                network: Some(member.network.clone()),
                profile: &mut member.profile,
            })
            .collect()
    }

    fn networks(&self) -> Option<Vec<&str>> {
        Some(self.networks.iter().map(|member| member.network.as_str()).collect())
    }
}
