//! What the sensors of the nodes came to.

use serde::Serialize;

/// What the sensors of the nodes said.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SensingSummary {
    /// Targets in the world.
    pub targets: usize,
    /// Fields in the world.
    pub fields: usize,
    /// Times that a target entered the radius of detection of a node, or was there at the start.
    pub detections: u64,
    /// Samples of fields by nodes.
    pub samples: u64,
    /// The errors of the sensors of targets. Absent if they make none.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub errors: Option<SensorErrorCounts>,
}

/// The errors of the sensors of targets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SensorErrorCounts {
    /// Passages of targets through the radius of a node, in its sight, that its sensor missed.
    pub missed_detections: u64,
    /// Of the detections, those of a target that was not there.
    pub false_detections: u64,
}
