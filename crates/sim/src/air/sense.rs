//! A look at the channel.

use sextant_channel::{Milliwatts, Position};
use sextant_kernel::SimTime;

use super::interface::Interface;

/// A look at the channel: carrier sense of a radio at a place, during `[from, to)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sense {
    pub(crate) radio: Interface,
    pub(crate) place: Position,
    pub(crate) from: SimTime,
    pub(crate) to: SimTime,
    /// Mean power at or above which the channel is busy.
    pub(crate) threshold: Milliwatts,
}
