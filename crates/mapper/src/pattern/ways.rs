//! The ways of signals among known obstacles: straight through them, and reflected.

#[cfg(not(feature = "obstacles"))]
mod none;
#[cfg(feature = "obstacles")]
mod traced;

#[cfg(not(feature = "obstacles"))]
pub(super) use none::KnownWays;
#[cfg(feature = "obstacles")]
use sextant_channel::ObstacleField;
use sextant_channel::{ChannelLaw, Position};
#[cfg(feature = "obstacles")]
pub(super) use traced::KnownWays;

/// What a map by gains knows of obstacles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct KnownObstacles<'a> {
    /// How signals are reflected. Of the path loss, the carrier counts alone.
    pub(crate) law: ChannelLaw,
    #[cfg(feature = "obstacles")]
    pub(crate) field: &'a ObstacleField,
    /// Without the feature there are none.
    #[cfg(not(feature = "obstacles"))]
    pub(crate) none: std::marker::PhantomData<&'a ()>,
}

/// A way from a stop to a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    /// Unit vector from the stop along it.
    pub(super) direction: Position,
    pub(super) length_m: f64,
    /// What it loses beside the loss of its length (dB).
    pub(super) loss_db: f64,
}
