//! A packet that a robot heard.

use sextant_kernel::{RobotId, SimTime};

/// A packet that a robot heard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Packet<'a> {
    /// When it was heard.
    pub time: SimTime,
    /// The robot that heard it.
    pub robot: RobotId,
    /// Name of the node that sent it.
    pub node: &'a str,
    /// Received signal strength (dBm), if it was measured.
    pub rssi_dbm: Option<f64>,
    /// Signal-to-noise ratio (dB), if it was measured.
    pub snr_db: Option<f64>,
    /// The antenna sector in which it was heard, if the robot has sectors.
    pub sector: Option<u8>,
    /// The distance to the node that was measured with it (m), if it was.
    pub range_m: Option<f64>,
}

impl<'a> Packet<'a> {
    /// A packet that the first robot heard, of which nothing else is known.
    #[must_use]
    pub fn new(time: SimTime, node: &'a str) -> Self {
        Self { time, robot: RobotId(0), node, rssi_dbm: None, snr_db: None, sector: None, range_m: None }
    }
}
