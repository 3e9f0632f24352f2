//! Snapshots of fields in a recording.

use std::time::Duration;

use sextant_channel::{Bounds, Position};
use sextant_kernel::SimTime;
use sextant_recording::{FileRecorder, GridPlane, RecordingError};
use sextant_sim::Field;

use sextant_scenario::{Scenario, SnapshotsConfig};

/// Records `fields` at the instants that the scenario names, as far as they are not after `end`.
pub(super) fn record(
    scenario: &Scenario,
    fields: &[Field],
    end: SimTime,
    recorder: &mut FileRecorder,
) -> Result<(), RecordingError> {
    let Some(snapshots) = &scenario.recording().fields else { return Ok(()) };
    let places = scenario.world().nodes.iter().map(|node| node.position);
    let bounds = Bounds::of(places).expect("a world has nodes");
    for &at_s in &snapshots.at_s {
        let time = SimTime::ZERO + Duration::from_secs_f64(at_s);
        if time > end {
            continue;
        }
        for field in fields {
            recorder.field(time, field.name(), &plane(field, time, bounds, snapshots))?;
        }
    }
    Ok(())
}

/// Records `fields` in the phase of a mission, which lasts `end` and begins after `offset` in the recording: at the
/// instants that the scenario names and, if the mission `seeks` a source, also at the beginning.
pub(super) fn record_phase(
    scenario: &Scenario,
    fields: &[Field],
    end: SimTime,
    offset: Duration,
    seeks: bool,
    recorder: &mut FileRecorder,
) -> Result<(), RecordingError> {
    let bounds = Bounds::of(scenario.world().nodes.iter().map(|node| node.position)).expect("a world has nodes");
    let named = scenario.recording().fields.clone();
    let size = bounds.max - bounds.min;
    let own = SnapshotsConfig { at_s: Vec::new(), step_m: (size.x_m.max(size.y_m) / VERTICES).max(LEAST_STEP_M) };
    let mut snapshots = named.unwrap_or(own);
    if seeks {
        snapshots.at_s.push(0.0);
    }
    snapshots.at_s.sort_by(f64::total_cmp);
    snapshots.at_s.dedup();
    for &at_s in &snapshots.at_s {
        let time = SimTime::ZERO + Duration::from_secs_f64(at_s);
        if time > end {
            continue;
        }
        for field in fields {
            recorder.field(time + offset, field.name(), &plane(field, time, bounds, &snapshots))?;
        }
    }
    Ok(())
}

/// Vertices of a snapshot along the longer side of the world, if the scenario does not say how fine it is.
const VERTICES: f64 = 120.0;
/// Least distance of its vertices (m).
const LEAST_STEP_M: f64 = 1e-3;

/// The values of a field around `bounds`, on the level through their middle.
fn plane(field: &Field, time: SimTime, bounds: Bounds, snapshots: &SnapshotsConfig) -> GridPlane {
    let step_m = snapshots.step_m;
    let first = Position { z_m: bounds.center().z_m, ..bounds.min - Position::new(step_m, step_m, 0.0) };
    let [columns, rows] = snapshots.counts(bounds);
    let vertex = |column: u32, row: u32| first + Position::new(f64::from(column), f64::from(row), 0.0) * step_m;
    let values = (0..rows).flat_map(|row| (0..columns).map(move |column| vertex(column, row)));
    GridPlane { first, step_m, columns, values: values.map(|place| field.value(place, time)).collect() }
}
