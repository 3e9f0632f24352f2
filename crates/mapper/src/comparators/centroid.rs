//! Centroids of the anchors that a node heard (Bulusu, Heidemann and Estrin 2000), plain and weighted.

use sextant_channel::Position;
use sextant_kernel::{SettingError, Watch};

use super::heard_anchors::HeardAnchors;
use super::node_by_node;
use crate::comparators::Comparator;
use crate::error::MapError;
use crate::estimator::{EstimatorSettings, Mapper, Messages};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::ranging::{Ranging, RangingConfig};
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// The centroid as written in a scenario: it has no settings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CentroidConfig {}

/// The centroid of all anchors that a node heard. A node that heard none is not placed. Anchors keep their known
/// places.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Centroid;

impl Comparator for Centroid {
    const NAME: &'static str = "centroid";

    fn uses(&self) -> &'static [KnowledgeKind] {
        &[KnowledgeKind::AnchorReceptions, KnowledgeKind::Anchors]
    }

    fn least_anchors(&self, _: usize) -> usize {
        1
    }

    fn messages(&self) -> Messages {
        Messages::Beacons
    }

    /// The map.
    ///
    /// # Errors
    /// [`MapError::Missing`] without what was heard of anchors; [`MapError::TooFewAnchors`] without any;
    /// [`MapError::Interrupted`].
    fn map(&self, knowledge: &Knowledge<'_>, watch: &dyn Watch) -> Result<TopologyMap, MapError> {
        map(knowledge, Self::NAME, watch, |_| 1.0)
    }
}

/// The weighted centroid as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WeightedCentroidConfig {
    /// How signal strengths become distances.
    pub ranging: RangingConfig,
    /// Each anchor weighs the inverse of its distance to this power: above 0, at most 10.
    pub degree: f64,
}

impl Default for WeightedCentroidConfig {
    fn default() -> Self {
        Self { ranging: RangingConfig::default(), degree: 1.0 }
    }
}

/// The centroid of all anchors that a node heard, each weighted by the inverse of its estimated distance to a power
/// (Blumenthal et al. 2007).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightedCentroid {
    ranging: Ranging,
    degree: f64,
}

impl TryFrom<WeightedCentroidConfig> for WeightedCentroid {
    type Error = SettingError;

    fn try_from(config: WeightedCentroidConfig) -> Result<Self, SettingError> {
        if !(config.degree > 0.0 && config.degree <= 10.0) {
            return Err(SettingError::new("degree", config.degree, "above 0, at most 10"));
        }
        let ranging = Ranging::try_from(config.ranging).map_err(|error| error.within("ranging"))?;
        Ok(Self { ranging, degree: config.degree })
    }
}

impl Comparator for WeightedCentroid {
    const NAME: &'static str = "weighted-centroid";

    fn uses(&self) -> &'static [KnowledgeKind] {
        &[KnowledgeKind::AnchorRssi, KnowledgeKind::Anchors, KnowledgeKind::PathLoss]
    }

    fn least_anchors(&self, _: usize) -> usize {
        1
    }

    fn messages(&self) -> Messages {
        Messages::Beacons
    }

    /// The map.
    ///
    /// # Errors
    /// [`MapError::Missing`] without what was heard of anchors; [`MapError::TooFewAnchors`] without any;
    /// [`MapError::Interrupted`].
    fn map(&self, knowledge: &Knowledge<'_>, watch: &dyn Watch) -> Result<TopologyMap, MapError> {
        map(knowledge, Self::NAME, watch, |rssi_dbm| libm::pow(self.ranging.distance_m(rssi_dbm), -self.degree))
    }
}

fn map(
    knowledge: &Knowledge<'_>,
    name: &'static str,
    watch: &dyn Watch,
    weight: impl Fn(f64) -> f64,
) -> Result<TopologyMap, MapError> {
    let anchors = HeardAnchors::new(knowledge, name, 1)?;
    let place = |node| {
        anchors.own_place(node).or_else(|| {
            let heard = anchors.of(node);
            weighted_mean(&heard.iter().map(|anchor| (anchor.position, weight(anchor.rssi_dbm))).collect::<Vec<_>>())
        })
    };
    let places = node_by_node(name, anchors.node_count(), anchors.mean_heard(), watch, place)?;
    Ok(TopologyMap::of_places(name, places, CoordinateFrame::World))
}

/// The weighted mean of places; `None` if there are no places.
pub(super) fn weighted_mean(places: &[(Position, f64)]) -> Option<Position> {
    let total: f64 = places.iter().map(|(_, weight)| weight).sum();
    (total > 0.0)
        .then(|| places.iter().fold(Position::ORIGIN, |sum, &(place, weight)| sum + place * (weight / total)))
}

impl EstimatorSettings for CentroidConfig {
    fn mapper(self) -> Result<Mapper, SettingError> {
        Ok(Mapper::new(Centroid))
    }
}

impl EstimatorSettings for WeightedCentroidConfig {
    fn mapper(self) -> Result<Mapper, SettingError> {
        WeightedCentroid::try_from(self).map(Mapper::new)
    }

    fn ranging_mut(&mut self) -> Option<&mut RangingConfig> {
        Some(&mut self.ranging)
    }
}
