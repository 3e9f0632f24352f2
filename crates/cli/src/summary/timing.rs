//! What the work cost on this machine.

use std::time::Instant;

use serde::Serialize;

/// What it cost on this machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Timing {
    /// From start to end (s).
    pub wall_s: f64,
    /// Simulating and recording (s).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gather_s: Option<f64>,
    /// Mapping and measuring (s).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub map_s: Option<f64>,
    /// Simulated events a second of `gather_s` (1/s).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub events_per_s: Option<f64>,
    /// Most memory in use at any time, where the system tells (B).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peak_rss_bytes: Option<u64>,
}

/// Measures how long a stage of the work takes.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch(Instant);

impl Stopwatch {
    /// Starts now.
    #[must_use]
    #[expect(clippy::disallowed_methods, reason = "the cli times whole stages")]
    pub fn start() -> Self {
        Self(Instant::now())
    }

    /// Time since the start (s).
    #[must_use]
    pub fn elapsed_s(self) -> f64 {
        self.0.elapsed().as_secs_f64()
    }
}

/// Most memory that this process has used so far (B); `None` where the system does not tell.
#[must_use]
pub fn peak_rss_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}
