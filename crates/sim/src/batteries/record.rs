//! What a simulation leaves of the battery of a node.

use std::time::Duration;

use sextant_kernel::SimTime;

/// What a simulation leaves of the battery of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BatteryRecord {
    /// Capacity (J).
    pub capacity_j: f64,
    /// What is left (J). What the kinetic model has bound counts.
    pub left_j: f64,
    /// Energy that radios and load took since the start, or the end of the warm-up if the node lived then (J).
    pub used_j: f64,
    /// In this time: until the node died, or the end.
    pub used_for: Duration,
    /// When it was empty; `None` if it never was.
    pub depleted: Option<SimTime>,
    /// How long it lasts from full with the mean power since the warm-up (s), or how long it lasted; infinite without a load.
    pub lifetime_s: f64,
}

impl BatteryRecord {
    /// Mean power of radios and load in that time (W).
    #[must_use]
    pub fn mean_power_w(&self) -> f64 {
        let span_s = self.used_for.as_secs_f64();
        if span_s > 0.0 { self.used_j / span_s } else { 0.0 }
    }
}
