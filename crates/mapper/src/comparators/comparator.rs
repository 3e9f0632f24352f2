//! What every comparator has in common.

use std::any::Any;
use std::fmt;

use sextant_kernel::Watch;

use crate::comparable::Comparable;
use crate::error::MapError;
use crate::estimator::{Estimator, Messages};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::learned::EstimatorFindings;
use crate::survey_frame::Axes;
use crate::topology_map::TopologyMap;

/// A well-known algorithm that maps all nodes of a log at once, and learns nothing else from it. Each is an [`Estimator`].
pub trait Comparator: Any + Comparable + fmt::Debug + Send + Sync {
    /// The algorithm's name in tables and topics.
    const NAME: &'static str;

    /// The kinds of knowledge that it uses.
    fn uses(&self) -> &'static [KnowledgeKind];

    /// Least number of anchors for a map in two or three `dimensions`.
    fn least_anchors(&self, _dimensions: usize) -> usize {
        0
    }

    /// The packets that nodes send for its map.
    fn messages(&self) -> Messages {
        Messages::Unknown
    }

    /// The axes in which it works.
    fn axes(&self) -> Axes {
        Axes::Log
    }

    /// The map.
    ///
    /// # Errors
    /// [`MapError::Missing`] and [`MapError::TooFewAnchors`] without what it uses; [`MapError::TooMuchMemory`];
    /// [`MapError::Interrupted`] if `watch` ends the work.
    fn map(&self, knowledge: &Knowledge<'_>, watch: &dyn Watch) -> Result<TopologyMap, MapError>;
}

impl<C: Comparator> Estimator for C {
    fn name(&self) -> &'static str {
        C::NAME
    }

    fn uses(&self) -> &'static [KnowledgeKind] {
        Comparator::uses(self)
    }

    fn estimate(
        &self,
        knowledge: &Knowledge<'_>,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<EstimatorFindings>), MapError> {
        self.map(knowledge, watch).map(|map| (map, None))
    }

    fn axes(&self) -> Axes {
        Comparator::axes(self)
    }

    fn least_anchors(&self, dimensions: usize) -> usize {
        Comparator::least_anchors(self, dimensions)
    }

    fn messages(&self) -> Messages {
        Comparator::messages(self)
    }
}
