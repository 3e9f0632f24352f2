//! Flags of the live view of a run.

use clap::Args;

use crate::live::{Speed, Viewer};

/// How a run is shown while it goes on.
#[derive(Clone, Debug, Args)]
pub(crate) struct LiveOptions {
    /// Show the run while it goes on, at the address that is printed. The recording is the same
    #[arg(long, value_name = "VIEWER", num_args = 0..=1, require_equals = true, default_missing_value = "browser")]
    pub(crate) live: Option<Viewer>,
    /// Simulated seconds in a second of the live view; `max` or 0 for as fast as possible
    #[arg(long, value_name = "N", requires = "live", default_value = "10", value_parser = Speed::read)]
    pub(crate) speed: Speed,
    /// The port of the live view; 0 for any that is free
    #[arg(long, value_name = "N", requires = "live", default_value_t = 8765)]
    pub(crate) port: u16,
    /// The address of the live view. Other machines can connect to it only if it is not 127.0.0.1
    #[arg(long, value_name = "HOST", requires = "live", default_value = "127.0.0.1")]
    pub(crate) host: String,
    /// Begin the live view paused: time passes when a viewer or a key resumes
    #[arg(long, requires = "live")]
    pub(crate) paused: bool,
}
