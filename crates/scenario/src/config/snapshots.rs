//! When and how finely fields are recorded.

use serde::{Deserialize, Serialize};
use sextant_channel::Bounds;
use sextant_kernel::SettingError;

/// Largest number of vertices of a snapshot.
const MOST_VERTICES: u64 = 4_000_000;
/// The latest snapshot (s).
const LATEST_S: f64 = 1e9;

/// Snapshots of all fields over the nodes, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SnapshotsConfig {
    /// When (s). Snapshots after the end of the simulation are left out.
    pub at_s: Vec<f64>,
    /// Distance between neighbouring vertices of the grid (m).
    #[serde(default = "default_step_m")]
    pub step_m: f64,
}

fn default_step_m() -> f64 {
    0.5
}

impl SnapshotsConfig {
    /// Rejects times before the start, and steps that give too many vertices over the `bounds` of the nodes.
    pub(crate) fn check(&self, bounds: Option<Bounds>) -> Result<(), SettingError> {
        for (i, &at_s) in self.at_s.iter().enumerate() {
            SettingError::in_range(&format!("at_s[{i}]"), at_s, 0.0, LATEST_S)?;
        }
        SettingError::positive("step_m", self.step_m)?;
        let [columns, rows] = bounds.map_or([1, 1], |bounds| self.counts(bounds)).map(u64::from);
        if columns * rows > MOST_VERTICES {
            let found = format!("{}, which gives {columns} by {rows} vertices", self.step_m);
            return Err(SettingError::new("step_m", found, format!("at most {MOST_VERTICES} vertices")));
        }
        Ok(())
    }

    /// Number of vertices along x and y: one before the `bounds`, as many as cover them, and one after.
    #[must_use]
    pub fn counts(&self, bounds: Bounds) -> [u32; 2] {
        let size = bounds.max - bounds.min;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the cast saturates")]
        let count = |length_m: f64| ((length_m / self.step_m).ceil() as u32).saturating_add(3);
        [count(size.x_m), count(size.y_m)]
    }
}
