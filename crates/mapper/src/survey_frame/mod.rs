//! The frame of a survey: axes and an order of stops and nodes that follow from what was heard, and not from how a log was
//! written.
//!
//! A map must not depend on where the origin of the coordinates lies, where x points, or in which order rows come. The
//! likelihoods of the estimators do not, but their grids, boxes, cells, samples and sums do. So an estimator that lays its grid
//! by the log ([`Axes::Survey`]) is given the log in a frame of its own: the origin is the middle of the least rectangle round
//! the stops that heard something, x is along its longer side, and each axis points to the half where more was heard. Stops and
//! nodes are numbered by their places in it. Nodes that were never heard, and silent stops that are far from all that was heard,
//! are left out. What the estimator finds is then told in the frame of the log.

mod axes;
mod draft;
mod frame;
mod rectangle;
mod survey;

pub(crate) use draft::HeardStops;
pub use frame::SurveyFrame;
pub(crate) use survey::Survey;

use crate::knowledge::Knowledge;
use crate::posterior::PlacePrior;

/// The axes in which an estimator works.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Axes {
    /// Those of the log: a grid that the settings lay, anchors and obstacles are in these, and what needs no axes is anyway.
    #[default]
    Log,
    /// Those of the survey, because its grid follows from the log. It is given the log, what is known of the places, and the
    /// seed, in the frame of the survey. Where sectors of an antenna have directions, the axes are those of the log all the same.
    Survey,
}

/// `knowledge` of the survey `log`.
pub(crate) fn in_survey<'a>(
    knowledge: &Knowledge<'a>,
    log: &'a sextant_channel::ReceptionLog,
    prior: Option<&'a PlacePrior>,
) -> Knowledge<'a> {
    Knowledge { prior, seed: knowledge.seed, ..Knowledge::from(log) }
}
