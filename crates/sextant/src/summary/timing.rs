//! Time and memory on this machine.

use std::time::Instant;

use serde::Serialize;

/// Time and memory on this machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Timing {
    /// Total time (s).
    pub wall_s: f64,
    /// Time of simulation and recording (s).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gather_s: Option<f64>,
    /// Time of mapping and measuring (s).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub map_s: Option<f64>,
    /// Simulated events per second of `gather_s` (1/s).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub events_per_s: Option<f64>,
    /// Peak memory (B), if the system reports it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peak_rss_bytes: Option<u64>,
}

/// Measures how long a stage of the work takes.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch(Instant);

impl Stopwatch {
    /// Starts now.
    #[must_use]
    #[expect(clippy::disallowed_methods, reason = "only the command line measures time")]
    pub fn start() -> Self {
        Self(Instant::now())
    }

    /// Time since the start (s).
    #[must_use]
    pub fn elapsed_s(self) -> f64 {
        self.0.elapsed().as_secs_f64()
    }
}

/// Peak memory of this process so far (B); `None` if the system does not report it.
#[must_use]
pub fn peak_rss_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}
