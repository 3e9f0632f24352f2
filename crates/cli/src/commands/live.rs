//! Flags of the live view of a run.

use clap::Args;

/// How a run is shown while it goes on.
#[derive(Clone, Debug, Args)]
pub(crate) struct LiveOptions {
    /// Show the run while it goes on: Foxglove connects to ws://HOST:PORT. The recording is the same
    #[arg(long)]
    pub(crate) live: bool,
    /// Simulated seconds in a second of the live view; `max` or 0 for as fast as possible
    #[arg(long, value_name = "N", requires = "live", default_value = "10", value_parser = speed)]
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

/// Simulated seconds in a second; `None` for as fast as possible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Speed(
    #[cfg_attr(not(feature = "live"), expect(dead_code, reason = "there is no live view"))] pub(crate) Option<f64>,
);

fn speed(text: &str) -> Result<Speed, &'static str> {
    if text == "max" {
        return Ok(Speed(None));
    }
    match text.parse::<f64>() {
        Ok(0.0) => Ok(Speed(None)),
        Ok(speed) if (1e-6..=1e9).contains(&speed) => Ok(Speed(Some(speed))),
        _ => Err("allowed: 0.000001 to 1000000000; 0 or max for as fast as possible"),
    }
}
