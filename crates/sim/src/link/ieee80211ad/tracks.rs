//! The tracks of what a station has under way, if packets are traced.

use sextant_kernel::{SimTime, StationId};

use crate::link::track::PacketTrack;

/// The tracks of what a station has under way.
#[derive(Debug, Default)]
pub(super) struct Tracks {
    /// That of the sweep or the broadcast.
    pub(super) task: PacketTrack,
    /// That of the answer.
    pub(super) answer: PacketTrack,
    /// When the last sweep was offered.
    pub(super) sweep_offered: SimTime,
    /// Number of sweeps that have ended.
    pub(super) sweeps: u32,
    /// When the answer under way was offered, and to which station, if there is one.
    pub(super) answer_offered: Option<(SimTime, Option<StationId>)>,
    /// Number of answers that have ended.
    pub(super) answers: u32,
}
