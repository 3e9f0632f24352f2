//! What the user says is wrong in a log.

use super::packet_delay::PacketDelay;

/// What is wrong in a log, and corrected while it is read; the default is nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RepairOptions {
    /// The times of the packets and ranges are late by so many seconds by the clock of the path (early if negative): that is taken off.
    /// `auto` takes off what the packets tell, if they tell it clearly
    pub packet_delay: PacketDelay,
    /// Leave out rows (of a bag: messages) of a satellite receiver without a fix: places that are empty, NaN or 0, 0. In
    /// metres 0, 0 has no fix if all other places are far away
    pub skip_no_fix: bool,
    /// A signal strength of this value was not measured, 127 for example: the packet counts without a strength. May be a list
    pub rssi_missing: Vec<f64>,
}
