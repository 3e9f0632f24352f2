//! What goes wrong: frames that are lost, nodes that die, anchors that lie.

use std::f64::consts::TAU;
use std::time::Duration;

use serde::{Deserialize, Serialize};
use sextant_channel::{Anchor, Position};
use sextant_kernel::{NodeId, Purpose, Seed, SettingError, SimTime};

use crate::purpose;
use crate::world::choice::{drawn, named, number_of};
use crate::world::layout::PlacedNode;

/// Latest instant of a death (s).
const LATEST_S: f64 = 1e7;

/// Farthest that an anchor lies (m).
const FARTHEST_M: f64 = 1e6;

/// What goes wrong, as written in a scenario.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct FaultsConfig {
    /// Share of the frames, received otherwise, that a receiver loses, each frame at each receiver by itself: 0 to 1. All
    /// frames of all networks are meant, those of neighbour discovery too. A frame lost so counts as lost to a weak
    /// signal.
    #[serde(skip_serializing_if = "is_zero")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = 0.0)))]
    pub message_loss: f64,
    /// The nodes that die during the simulation. Neighbour discovery is before it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub deaths: Option<DeathsConfig>,
    /// The anchors that believe to be at a wrong place, and say so.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lying_anchors: Option<LyingAnchorsConfig>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_zero(value: &f64) -> bool {
    value.to_bits() == 0
}

/// The nodes that die, each at a random instant, as written in a scenario. From then on the radio is off, sensors and
/// application say and do nothing; a frame on air ends first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct DeathsConfig {
    /// This share of the nodes dies, at random, rounded up: 0 to 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub share: Option<f64>,
    /// The nodes with these names die, instead of a share.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub names: Option<Vec<String>>,
    /// Start of the interval in which they die (s).
    pub from_s: f64,
    /// End of that interval (s).
    pub to_s: f64,
}

/// The anchors that lie, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct LyingAnchorsConfig {
    /// This share of the anchors lies, at random, rounded up: 0 to 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub share: Option<f64>,
    /// The anchors with these names lie, instead of a share.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub names: Option<Vec<String>>,
    /// Distance from the true place to the one that each believes in (m), in a random horizontal direction.
    pub distance_m: f64,
}

/// What goes wrong during a simulation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Faults {
    message_loss: f64,
    /// By node.
    deaths: Vec<Death>,
}

/// The death of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Death {
    /// The node.
    pub node: NodeId,
    /// When it dies.
    pub time: SimTime,
}

impl FaultsConfig {
    /// What goes wrong among `nodes`. Which of two nodes is drawn first to die, and when, does not depend on other nodes.
    ///
    /// # Errors
    /// If a share is outside 0 to 1, a name is unknown or given twice, both or neither of them are there, or the
    /// interval has no end after its start.
    pub fn build(&self, nodes: &[PlacedNode], seed: Seed) -> Result<Faults, SettingError> {
        let message_loss = SettingError::in_range("message_loss", self.message_loss, 0.0, 1.0)?;
        let deaths = self.deaths.as_ref().map(|deaths| deaths.draw(nodes, seed));
        let deaths = deaths.transpose().map_err(|error| error.within("deaths"))?.unwrap_or_default();
        Ok(Faults { message_loss, deaths })
    }

    /// The places that `anchors` believe in.
    ///
    /// # Errors
    /// If a share is outside 0 to 1, a name is not that of an anchor or given twice, both or neither of them are there,
    /// or the distance is not positive.
    pub fn believed(
        &self,
        anchors: &[Anchor],
        nodes: &[PlacedNode],
        seed: Seed,
    ) -> Result<Vec<Anchor>, SettingError> {
        let Some(lying) = &self.lying_anchors else { return Ok(anchors.to_vec()) };
        lying.believed(anchors, nodes, seed).map_err(|error| error.within("lying_anchors"))
    }
}

impl DeathsConfig {
    fn draw(&self, nodes: &[PlacedNode], seed: Seed) -> Result<Vec<Death>, SettingError> {
        let all: Vec<NodeId> = (0..nodes.len()).map(NodeId::from_index).collect();
        let allowed = "the name of a node";
        let affected = Affected { share: self.share, names: self.names.as_deref(), candidates: &all, allowed };
        let mut chosen = chosen(&affected, nodes, purpose::DEATHS, seed)?;
        chosen.sort_unstable();
        let from_s = SettingError::in_range("from_s", self.from_s, 0.0, LATEST_S)?;
        let to_s = SettingError::in_range("to_s", self.to_s, 0.0, LATEST_S)?;
        if from_s > to_s {
            return Err(SettingError::new("to_s", to_s, format!("at least `from_s`, {from_s}")));
        }
        let death = |node: NodeId| {
            let part = seed.uniform(purpose::DEATHS, [node.0.into(), 1, 0]);
            let time = SimTime::ZERO + Duration::from_secs_f64(from_s + part * (to_s - from_s));
            Death { node, time }
        };
        Ok(chosen.into_iter().map(death).collect())
    }
}

impl LyingAnchorsConfig {
    fn believed(&self, anchors: &[Anchor], nodes: &[PlacedNode], seed: Seed) -> Result<Vec<Anchor>, SettingError> {
        let all: Vec<NodeId> = anchors.iter().map(|anchor| anchor.node).collect();
        let allowed = "the name of an anchor";
        let affected = Affected { share: self.share, names: self.names.as_deref(), candidates: &all, allowed };
        let lying = chosen(&affected, nodes, purpose::LYING, seed)?;
        SettingError::positive("distance_m", self.distance_m)?;
        let distance_m = SettingError::in_range("distance_m", self.distance_m, 0.0, FARTHEST_M)?;
        let belief = |&anchor: &Anchor| {
            if !lying.contains(&anchor.node) {
                return anchor;
            }
            let angle_rad = TAU * seed.uniform(purpose::LYING, [anchor.node.0.into(), 1, 0]);
            let Position { x_m, y_m, z_m } = anchor.position;
            let (x_m, y_m) = (x_m + distance_m * libm::cos(angle_rad), y_m + distance_m * libm::sin(angle_rad));
            Anchor { position: Position::new(x_m, y_m, z_m), ..anchor }
        };
        Ok(anchors.iter().map(belief).collect())
    }
}

/// Which nodes a fault affects: a share of the candidates, or those with these names.
struct Affected<'a> {
    share: Option<f64>,
    names: Option<&'a [String]>,
    candidates: &'a [NodeId],
    /// What the names may be, for errors.
    allowed: &'a str,
}

/// The nodes that are affected.
fn chosen(
    affected: &Affected<'_>,
    nodes: &[PlacedNode],
    purpose: Purpose,
    seed: Seed,
) -> Result<Vec<NodeId>, SettingError> {
    let Affected { share, names, candidates, allowed } = *affected;
    match (share, names) {
        (Some(share), None) => {
            let count = number_of(share, candidates.len())?;
            Ok(drawn(candidates.iter().copied(), purpose, seed).take(count).collect())
        }
        (None, Some(names)) => named(names, nodes, allowed, |node| candidates.contains(&node)),
        (None, None) => Err(SettingError::missing("share", "`share` or `names`")),
        (Some(_), Some(_)) => Err(SettingError::conflict("share", "`names`", "set one of them")),
    }
}

impl Faults {
    /// Share of the frames, received otherwise, that a receiver loses.
    #[must_use]
    pub fn message_loss(&self) -> f64 {
        self.message_loss
    }

    /// The nodes that die, by node.
    #[must_use]
    pub fn deaths(&self) -> &[Death] {
        &self.deaths
    }

    /// The same without deaths.
    pub(crate) fn without_deaths(&self) -> Self {
        Self { deaths: Vec::new(), ..self.clone() }
    }
}
