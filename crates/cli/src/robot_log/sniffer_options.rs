//! What the user says of a capture.

use std::path::PathBuf;

use clap::Args;

/// What belongs to the capture of a sniffer.
#[derive(Clone, Debug, Default, PartialEq, Args)]
#[command(next_help_heading = "Options for captures of sniffers")]
pub struct SnifferOptions {
    /// The path of the robot that carried the sniffer: a CSV file with columns t_s,x_m,y_m (and z_m) or t_s,lat,lon, with
    /// times of the clock of the capture (seconds since 1970, as a rule)
    #[arg(long, value_name = "path.csv")]
    pub path: Option<PathBuf>,
    /// Use only frames of this IEEE 802.15.4 PAN, 0xabcd for example. The default is all; nodes with a short address are then
    /// named with their PAN if the capture has several
    #[arg(long, value_name = "PAN", value_parser = pan)]
    pub pan: Option<u16>,
}

impl SnifferOptions {
    /// The flags that are given.
    #[must_use]
    pub fn given(&self) -> Vec<&'static str> {
        let Self { path, pan } = self;
        let flags = [("--path", path.is_some()), ("--pan", pan.is_some())];
        flags.into_iter().filter_map(|(flag, is_given)| is_given.then_some(flag)).collect()
    }
}

fn pan(text: &str) -> Result<u16, &'static str> {
    let hexadecimal = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X"));
    let parsed = hexadecimal.and_then(|digits| u16::from_str_radix(digits, 16).ok());
    parsed.ok_or("expected a PAN identifier from 0x0000 to 0xffff")
}
