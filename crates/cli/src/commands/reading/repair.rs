//! Flags: what the user says is wrong in a log.

use clap::Args;
use sextant_logs::{PacketDelay, RepairOptions};

/// What is wrong in a log, and corrected while it is read; the default is nothing.
#[derive(Clone, Debug, Default, PartialEq, Args)]
#[command(next_help_heading = "Corrections of logs of robots")]
pub(crate) struct RepairFlags {
    /// The times of the packets and ranges are late by so many seconds by the clock of the path (early if negative): that is taken off.
    /// `auto` takes off what the packets tell, if they tell it clearly
    #[arg(long, value_name = "S|auto", default_value = "0", hide_default_value = true, allow_hyphen_values = true)]
    pub(crate) packet_delay: PacketDelay,
    /// Leave out rows (of a bag: messages) of a satellite receiver without a fix: places that are empty, NaN or 0, 0. In
    /// metres 0, 0 has no fix if all other places are far away
    #[arg(long)]
    pub(crate) skip_no_fix: bool,
    /// A signal strength of this value was not measured, 127 for example: the packet counts without a strength. May be a list
    #[arg(long, value_name = "DBM", value_delimiter = ',', allow_hyphen_values = true)]
    pub(crate) rssi_missing: Vec<f64>,
}

impl From<RepairFlags> for RepairOptions {
    fn from(flags: RepairFlags) -> Self {
        let RepairFlags { packet_delay, skip_no_fix, rssi_missing } = flags;
        Self { packet_delay, skip_no_fix, rssi_missing }
    }
}
