//! NTLDV-HOP (Chen et al. 2014), reconstructed: DV-Hop in space with the usual improvements.

use sextant_channel::Position;
use sextant_kernel::{SettingError, Watch};

use super::anchor_hops::{AnchorHops, HopLength};
use super::graph::UNREACHED;
use super::upright_anchors::{ReachedAnchor, sort_nearest_first, upright};
use super::{check_link_share, default_link_share};
use crate::comparators::Comparator;
use crate::comparators::lateration::{Range, multilaterate_linear, refine};
use crate::error::MapError;
use crate::estimator::{EstimatorSettings, Mapper};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::topology_map::TopologyMap;

/// NTLDV-HOP as written in a scenario. Without any of its improvements it is DV-Hop with linear least squares.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NtldvHopConfig {
    /// How an anchor computes the length of a hop.
    pub hop_length: HopLength,
    /// Whether a node takes the mean length of a hop over all anchors, weighted by one over its hops to them, instead of
    /// that of its nearest anchor.
    pub mean_hop_length: bool,
    /// Whether anchors are left out that only form nearly flat tetrahedra (triangles in the plane) with others.
    pub reject_flat_anchors: bool,
    /// Whether distances have the weight of one over their squared hops.
    pub weigh_by_hops: bool,
    /// Whether the linear solution is refined by Gauss-Newton steps.
    pub refine: bool,
    /// Whether places are moved into the box of the anchors, widened by one hop.
    pub clamp: bool,
    /// Least share of each other's packets that both nodes of a link must have received; above 0, at most 1.
    pub link_share: f64,
}

impl Default for NtldvHopConfig {
    fn default() -> Self {
        Self {
            hop_length: HopLength::LeastSquares,
            mean_hop_length: true,
            reject_flat_anchors: true,
            weigh_by_hops: true,
            refine: true,
            clamp: true,
            link_share: default_link_share(),
        }
    }
}

impl NtldvHopConfig {
    /// DV-Hop with linear least squares: none of the improvements.
    #[must_use]
    pub fn plain() -> Self {
        Self {
            hop_length: HopLength::Mean,
            mean_hop_length: false,
            reject_flat_anchors: false,
            weigh_by_hops: false,
            refine: false,
            clamp: false,
            link_share: default_link_share(),
        }
    }
}

/// NTLDV-HOP. A node is not placed if it reaches fewer anchors than the number of dimensions plus one, or if all that it
/// reaches are nearly in one plane (on one line) and such anchors are rejected. If flat anchors are rejected, a node uses
/// the twelve nearest; of equally near ones, those that are farthest from one another. If these are nearly in one plane, the
/// nearest anchors out of it are used with them. Anchors keep their known places. The paper was not available: this is a
/// reconstruction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NtldvHop {
    config: NtldvHopConfig,
}

impl TryFrom<NtldvHopConfig> for NtldvHop {
    type Error = SettingError;

    fn try_from(config: NtldvHopConfig) -> Result<Self, SettingError> {
        check_link_share(config.link_share)?;
        Ok(Self { config })
    }
}

impl Comparator for NtldvHop {
    const NAME: &'static str = "ntldv-hop";

    fn uses(&self) -> &'static [KnowledgeKind] {
        &[KnowledgeKind::Neighbours, KnowledgeKind::Anchors]
    }

    fn least_anchors(&self, dimensions: usize) -> usize {
        dimensions + 1
    }

    /// The map.
    ///
    /// # Errors
    /// [`MapError::Missing`] without a neighbour log; [`MapError::TooFewAnchors`] below three, in space four;
    /// [`MapError::TooMuchMemory`]; [`MapError::Interrupted`].
    fn map(&self, knowledge: &Knowledge<'_>, watch: &dyn Watch) -> Result<TopologyMap, MapError> {
        let field = AnchorHops::of(Self::NAME, knowledge, self.config.link_share, self.config.hop_length, watch)?;
        #[expect(clippy::cast_precision_loss, reason = "a number of anchors")]
        let operations = 100.0 * field.anchors.len() as f64 + 500.0;
        field.map(Self::NAME, knowledge, operations, watch, |node| self.place(&field, node))
    }
}

impl NtldvHop {
    fn place(&self, field: &AnchorHops<'_>, node: usize) -> Option<Position> {
        let reached = (0..field.anchors.len()).filter(|&anchor| field.hops[anchor][node] != UNREACHED);
        let reach = |anchor: usize| ReachedAnchor {
            anchor,
            place: field.anchors[anchor].position,
            hops: field.hops[anchor][node],
        };
        let mut reached: Vec<ReachedAnchor> = reached.map(reach).collect();
        sort_nearest_first(&mut reached);
        let length_m = self.hop_length_m(field, &reached)?;
        if self.config.reject_flat_anchors {
            reached = upright(&reached, field.dimensions);
        }
        let range = |of: &ReachedAnchor| {
            let hops = f64::from(of.hops);
            let weight = if self.config.weigh_by_hops { 1.0 / (hops * hops) } else { 1.0 };
            Range { weight, ..Range::new(of.place, length_m * hops) }
        };
        // The nearest anchor comes last: linear least squares subtracts its equation from the others.
        let ranges: Vec<Range> = reached.iter().rev().map(range).collect();
        let linear = multilaterate_linear(&ranges, field.dimensions).ok()?;
        let place = if self.config.refine { refine(linear, &ranges, field.dimensions) } else { linear };
        Some(if self.config.clamp { clamped(place, field, length_m) } else { place })
    }

    /// The length of a hop for a node that reaches these anchors, the nearest one first (m).
    fn hop_length_m(&self, field: &AnchorHops<'_>, reached: &[ReachedAnchor]) -> Option<f64> {
        let known = || reached.iter().filter_map(|of| Some((f64::from(of.hops), field.lengths_m[of.anchor]?)));
        if !self.config.mean_hop_length {
            return known().next().map(|(_, length_m)| length_m);
        }
        let (sum, weights) = known()
            .fold((0.0, 0.0), |(sum, weights), (hops, length_m)| (sum + length_m / hops, weights + 1.0 / hops));
        (weights > 0.0).then(|| sum / weights)
    }
}

/// The nearest place in the box of all anchors, widened by `margin_m`.
fn clamped(place: Position, field: &AnchorHops<'_>, margin_m: f64) -> Position {
    let place: [f64; 3] = place.into();
    let along = |axis: usize| field.anchors.iter().map(move |anchor| <[f64; 3]>::from(anchor.position)[axis]);
    [0, 1, 2]
        .map(|axis| {
            let low = along(axis).fold(f64::INFINITY, f64::min) - margin_m;
            place[axis].clamp(low, along(axis).fold(f64::NEG_INFINITY, f64::max) + margin_m)
        })
        .into()
}

impl EstimatorSettings for NtldvHopConfig {
    fn mapper(self) -> Result<Mapper, SettingError> {
        NtldvHop::try_from(self).map(Mapper::new)
    }
}
