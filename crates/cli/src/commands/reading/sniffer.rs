//! Flags: what the user says of a capture.

use clap::Args;
use sextant_logs::{FcsField, SnifferOptions};

/// What belongs to the capture of a sniffer.
#[derive(Clone, Debug, Default, PartialEq, Args)]
#[command(next_help_heading = "Options for captures of sniffers")]
pub(crate) struct SnifferFlags {
    /// Use only frames of this IEEE 802.15.4 PAN, 0xabcd for example. The default is all; nodes with a short address are then
    /// named with their PAN if the capture has several
    #[arg(long, value_name = "PAN", value_parser = pan)]
    pub(crate) pan: Option<u16>,
    /// What stands at the end of frames of link type 195, in the place of their check sequence. `ti`: the RSSI of a chip of
    /// Texas Instruments (a CC2531; of others with what makes it dBm: ti:-45 for a CC2420, ti:-76 for a CC2520, ti:0). `none`:
    /// nothing that can be checked. The default is `checked`, the check sequence
    #[arg(long, value_name = "checked|none|ti[:DB]")]
    pub(crate) fcs: Option<FcsField>,
}

impl From<SnifferFlags> for SnifferOptions {
    fn from(flags: SnifferFlags) -> Self {
        let SnifferFlags { pan, fcs } = flags;
        Self { pan, fcs }
    }
}

fn pan(text: &str) -> Result<u16, &'static str> {
    let hexadecimal = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X"));
    let parsed = hexadecimal.and_then(|digits| u16::from_str_radix(digits, 16).ok());
    parsed.ok_or("expected a PAN identifier from 0x0000 to 0xffff")
}
