//! The model with a law that is known.

use super::hearing::Hearing;
use super::law::Law;
use super::links::PlaceLinks;
use super::outages::Outages;
use super::window::LinkWindow;

/// Vertices of the coarse and the fine grid of a node, in the plane and in space.
pub(super) const VERTICES: [[f64; 2]; 2] = [[180.0, 350.0], [500.0, 900.0]];

/// The model with its law.
pub(super) struct ModelWithLaw<'a> {
    pub(super) law: Law,
    pub(super) hearing: &'a Hearing,
    pub(super) outages: &'a Outages,
    pub(super) links: &'a PlaceLinks,
    pub(super) window: &'a LinkWindow<'a>,
    pub(super) is_spatial: bool,
    /// Factor on covariances.
    pub(super) inflation: f64,
}
