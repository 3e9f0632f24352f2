//! Flags that say how the log of a robot is read.

mod bag;
mod form;
mod repair;
mod sniffer;

use std::path::Path;

use clap::Args;

use sextant_logs::{ReadOptions, RobotFrames, StopRule};

use bag::BagFlags;
use form::FormFlags;
use repair::RepairFlags;
use sniffer::SnifferFlags;

/// How the log of a robot is read.
#[derive(Clone, Debug, Args)]
pub(crate) struct Reading {
    /// Cut the path of a robot into stops by distance (1m) or by time (2s), if the log has packets and a path. The default
    /// is a distance that gives at most 400 stops
    #[arg(long, value_name = "1m|2s", default_value = "auto", hide_default_value = true)]
    pub(crate) stop_every: StopRule,
    /// Seconds between two packets of a node, if the log has packets and a path. The default is estimated from the packets
    #[arg(long, value_name = "S", value_parser = interval)]
    pub(crate) packet_interval: Option<f64>,
    /// Where the parts of the log are, and how they are written. This and what follows have headings of their own.
    #[command(flatten)]
    pub(crate) form: FormFlags,
    /// What is wrong in the log, and corrected.
    #[command(flatten)]
    pub(crate) repair: RepairFlags,
    /// What is read from a ROS bag.
    #[command(flatten)]
    pub(crate) bag: BagFlags,
    /// What belongs to the capture of a sniffer.
    #[command(flatten)]
    pub(crate) sniffer: SnifferFlags,
}

impl Reading {
    /// The files that these flags name, where they are given.
    pub(super) fn files(&self) -> [Option<&Path>; 2] {
        [self.form.path.as_deref(), self.form.packets.as_deref()]
    }

    /// The options of these flags.
    #[must_use]
    pub(crate) fn options(&self) -> ReadOptions {
        let Self { stop_every, packet_interval, form, repair, bag, sniffer } = self.clone();
        ReadOptions {
            stop_every,
            packet_interval_s: packet_interval,
            form: form.into(),
            repair: repair.into(),
            bag: bag.into(),
            sniffer: sniffer.into(),
            frames: RobotFrames::Shared,
        }
    }
}

/// Reads the value of `--packet-interval`.
fn interval(text: &str) -> Result<f64, &'static str> {
    let allowed = |interval_s: &f64| (1e-6..=1e6).contains(interval_s);
    text.parse().ok().filter(allowed).ok_or("expected seconds from 1e-6 to 1e6")
}
