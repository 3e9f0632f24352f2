//! The gains of a listener's sectors, where its antenna is known.

use std::sync::Arc;

use crate::{Antenna, Orientation, Position};

/// The gains of the sectors of a listener in all directions, in the frame of the stops: its antenna and how it is turned
/// there. What single antennas differ by from the pattern is not known to a mapper, so that it is not in here.
#[derive(Clone, Debug)]
pub struct SectorGains {
    antenna: Arc<Antenna>,
    orientation: Orientation,
    identities: Vec<u8>,
}

impl SectorGains {
    /// The gains of `antenna`, turned by `orientation`.
    #[must_use]
    pub fn new(antenna: Arc<Antenna>, orientation: Orientation) -> Self {
        let identities = antenna.sectors().iter().map(|sector| sector.sector).collect();
        Self { antenna, orientation, identities }
    }

    /// The identities of the sectors in the log, ascending.
    #[must_use]
    pub fn identities(&self) -> &[u8] {
        &self.identities
    }

    /// The antenna.
    #[must_use]
    pub fn antenna(&self) -> &Arc<Antenna> {
        &self.antenna
    }

    /// How the antenna is turned in the frame of the stops.
    #[must_use]
    pub fn orientation(&self) -> Orientation {
        self.orientation
    }

    /// The gains in a direction (dBi), in the order of [`identities`](Self::identities). `direction` is a unit vector in
    /// the frame of the stops, from the listener to the node.
    pub fn all_dbi(&self, direction: Position, gains: &mut Vec<f64>) {
        let direction = self.orientation.to_antenna_frame(direction);
        gains.clear();
        gains.extend((0..self.antenna.sector_count()).map(|sector| self.antenna.gain(sector, direction).0));
    }
}

impl PartialEq for SectorGains {
    /// Whether they are of the same antenna, turned alike. Two antennas that were read twice are not the same.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.antenna, &other.antenna) && self.orientation == other.orientation
    }
}
