//! The antennas of the radios, as they are mounted.

use std::sync::Arc;

use sextant_channel::{Antenna, Db, Orientation, Position};

use super::receiver_id::ReceiverId;
use super::signal::Aim;

/// The antenna of one radio.
#[derive(Clone, Debug)]
pub(crate) struct Mount {
    pub(crate) antenna: Arc<Antenna>,
    /// How it is turned in the frame of its holder: the world or, if it turns with its station, the station.
    pub(crate) orientation: Orientation,
    pub(crate) holder: Holder,
    /// By how much the gain of each sector differs from the pattern; empty if it does not.
    pub(crate) ripple: Vec<Db>,
}

/// What an antenna keeps its direction in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Holder {
    /// The world: the station does not turn, or has a compass.
    World,
    /// The station: the antenna turns with it.
    Station,
}

/// A mount, and how the antenna is turned in the world now.
#[derive(Clone, Debug)]
struct Mounted {
    mount: Mount,
    /// That of a station that turns with its antenna (rad).
    heading_rad: f64,
    turned: Orientation,
}

/// The antennas of all radios of an air, by receiver. Radios without one have the same gain in all directions, which
/// their power includes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Mounts(Vec<Option<Mounted>>);

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
        self.0[index] = Some(Mounted { turned: mount.orientation, heading_rad: 0.0, mount });
    }

    fn of(&self, receiver: ReceiverId) -> Option<&Mounted> {
        self.0.get(receiver.index())?.as_ref()
    }

    /// The station of a radio has this heading now, counterclockwise from x (rad). An antenna that it holds turns with it.
    #[inline]
    pub(crate) fn turn(&mut self, receiver: ReceiverId, heading_rad: f64) {
        if let Some(Some(mounted)) = self.0.get_mut(receiver.index())
            && mounted.mount.holder == Holder::Station
            && mounted.heading_rad.to_bits() != heading_rad.to_bits()
        {
            let [yaw_rad, pitch_rad, roll_rad] = mounted.mount.orientation.angles_rad();
            mounted.turned = Orientation::new(heading_rad + yaw_rad, pitch_rad, roll_rad);
            mounted.heading_rad = heading_rad;
        }
    }

    /// The heading of the station that holds the antenna of a radio (rad); 0 if none does.
    pub(crate) fn heading_rad(&self, receiver: ReceiverId) -> f64 {
        self.of(receiver).map_or(0.0, |mounted| mounted.heading_rad)
    }

    /// Gain of a transmitter in `direction`, a unit vector of the world.
    pub(crate) fn transmit_gain(&self, sender: ReceiverId, aim: Aim, direction: Position) -> Db {
        match (aim, self.of(sender)) {
            (Aim::Omnidirectional, _) | (_, None) => Db(0.0),
            (Aim::Sector(sector), Some(Mounted { mount, turned, .. })) => {
                let gain = mount.antenna.gain(sector, turned.to_antenna_frame(direction));
                mount.ripple.get(usize::from(sector)).map_or(gain, |&ripple| gain + ripple)
            }
        }
    }

    /// Whether a receiver listens in all directions alike.
    pub(crate) fn listens_alike(&self, receiver: ReceiverId) -> bool {
        !self.of(receiver).is_some_and(|mounted| mounted.mount.antenna.has_measured_quasi_omni())
    }

    /// Gain of a receiver in `direction`, a unit vector of the world from the receiver to where the signal comes from. It
    /// listens in all directions alike, unless its quasi-omnidirectional pattern was measured.
    pub(crate) fn receive_gain(&self, receiver: ReceiverId, direction: Position) -> Db {
        let Some(Mounted { mount, turned, .. }) = self.of(receiver) else { return Db(0.0) };
        let measured = || mount.antenna.measured_quasi_omni(turned.to_antenna_frame(direction));
        let has_direction = direction.length_m() > 0.0;
        has_direction.then(measured).flatten().unwrap_or_else(|| mount.antenna.quasi_omni())
    }
}
