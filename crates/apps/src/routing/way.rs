//! How a station finds the next one.

use sextant_kernel::StationId;
use sextant_mac::routing::{Collection, Trickle};

use super::rpl::RplStation;

/// How a station finds the next one.
#[derive(Clone, Debug)]
pub(super) enum Way {
    /// It is the root of a tree that does not change.
    FixedRoot,
    /// It has this parent in a tree that does not change.
    Fixed(Option<StationId>),
    /// Beacons tell.
    Built { is_root: bool, tree: Box<Collection>, trickle: Trickle },
    /// RPL tells.
    Rpl(Box<RplStation>),
}

impl Way {
    /// That of the root of a tree that beacons build.
    pub(super) fn root(own: StationId, trickle: Trickle) -> Self {
        Self::Built { is_root: true, tree: Box::new(Collection::of_root(own)), trickle }
    }

    /// That of a node in a tree that beacons build.
    pub(super) fn node(own: StationId, trickle: Trickle, hysteresis_etx: f64) -> Self {
        Self::Built { is_root: false, tree: Box::new(Collection::of_node(own, hysteresis_etx)), trickle }
    }

    pub(super) fn is_root(&self) -> bool {
        match self {
            Self::FixedRoot => true,
            Self::Fixed(_) => false,
            Self::Built { is_root, .. } => *is_root,
            Self::Rpl(station) => station.dodag.is_root(),
        }
    }

    pub(super) fn parent(&self) -> Option<StationId> {
        match self {
            Self::FixedRoot => None,
            Self::Fixed(parent) => *parent,
            Self::Built { tree, .. } => tree.parent(),
            Self::Rpl(station) => station.dodag.parent(),
        }
    }

    /// Expected transmissions to the parent, if the station worked them out itself.
    pub(super) fn parent_etx(&self) -> Option<f64> {
        match self {
            Self::FixedRoot | Self::Fixed(_) => None,
            Self::Built { tree, .. } => tree.parent_etx(),
            Self::Rpl(station) => station.dodag.parent_etx(),
        }
    }

    pub(super) fn cost(&self) -> Option<f64> {
        match self {
            Self::FixedRoot | Self::Fixed(_) | Self::Rpl(_) => None,
            Self::Built { tree, .. } => tree.cost(),
        }
    }

    /// Whether a packet that goes up comes from a station that is not farther from the root.
    pub(super) fn is_uphill(&self, cost: Option<f64>) -> bool {
        matches!(self, Self::Built { tree, is_root: false, .. } if tree.is_uphill(cost))
    }
}
