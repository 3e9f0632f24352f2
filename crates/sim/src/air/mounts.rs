//! The antennas of the radios, as they are mounted.

use std::sync::Arc;

use sextant_channel::{Antenna, Db, Orientation, Position};

use super::receiver_id::ReceiverId;
use super::signal::Aim;

/// The antenna of one radio.
#[derive(Clone, Debug)]
pub(crate) struct Mount {
    pub(crate) antenna: Arc<Antenna>,
    pub(crate) orientation: Orientation,
    /// By how much the gain of each sector differs from the pattern; empty if it does not.
    pub(crate) ripple: Vec<Db>,
}

/// The antennas of all radios of an air, by receiver. Radios without one have the same gain in all directions, which
/// their power includes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Mounts(Vec<Option<Mount>>);

impl Mounts {
    /// Whether no radio has an antenna.
    #[inline]
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Mounts an antenna at a radio.
    pub(crate) fn add(&mut self, receiver: ReceiverId, mount: Mount) {
        let index = receiver.index();
        if self.0.len() <= index {
            self.0.resize(index + 1, None);
        }
        self.0[index] = Some(mount);
    }

    fn of(&self, receiver: ReceiverId) -> Option<&Mount> {
        self.0.get(receiver.index())?.as_ref()
    }

    /// Gain of a transmitter in `direction`, a unit vector of the world.
    pub(crate) fn transmit_gain(&self, sender: ReceiverId, aim: Aim, direction: Position) -> Db {
        match (aim, self.of(sender)) {
            (Aim::Omnidirectional, _) | (_, None) => Db(0.0),
            (Aim::Sector(sector), Some(mount)) => {
                let gain = mount.antenna.gain(sector, mount.orientation.to_antenna_frame(direction));
                mount.ripple.get(usize::from(sector)).map_or(gain, |&ripple| gain + ripple)
            }
        }
    }

    /// Whether a receiver listens in all directions alike.
    pub(crate) fn listens_alike(&self, receiver: ReceiverId) -> bool {
        !self.of(receiver).is_some_and(|mount| mount.antenna.has_measured_quasi_omni())
    }

    /// Gain of a receiver in `direction`, a unit vector of the world from the receiver to where the signal comes from. It
    /// listens in all directions alike, unless its quasi-omnidirectional pattern was measured.
    pub(crate) fn receive_gain(&self, receiver: ReceiverId, direction: Position) -> Db {
        let Some(mount) = self.of(receiver) else { return Db(0.0) };
        let measured = || mount.antenna.measured_quasi_omni(mount.orientation.to_antenna_frame(direction));
        let has_direction = direction.length_m() > 0.0;
        has_direction.then(measured).flatten().unwrap_or_else(|| mount.antenna.quasi_omni())
    }
}
