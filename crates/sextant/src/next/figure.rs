//! The figure of where to listen next.

use sextant_channel::Position;
use sextant_figure::{Figure, PlannedStop, Source, of_next_stops};
use sextant_recording::RecordingError;

use super::{NextStops, last_stop};
use crate::mapping::{self, ComputedMap, Input};

/// The figure of `next` over the map that tells it. `title` names the log.
///
/// # Errors
/// If the log is that of a recording, and this cannot be read.
pub fn figure(
    title: &str,
    input: &Input,
    computed: &ComputedMap<'_>,
    next: &NextStops,
) -> Result<Figure, RecordingError> {
    let drawn = mapping::drawn(input)?;
    let log = input.log();
    let source = Source { title, log, drawn: &drawn, sector_displacements: &[], claimed_obstacles: &[] };
    let stops: Vec<PlannedStop> = next
        .stops
        .iter()
        .map(|stop| PlannedStop {
            name: stop.stop.clone(),
            place: Position::new(stop.x_m, stop.y_m, stop.z_m),
            way: stop.way.iter().map(|&[x_m, y_m]| Position::new(x_m, y_m, stop.z_m)).collect(),
            error_fall_m: stop.error_fall_m,
        })
        .collect();
    let robots = (0..log.robot_count()).map(sextant_kernel::RobotId::from_index);
    let driver = robots.into_iter().find(|&robot| log.robot_name(robot) == next.robot.as_str());
    let start = driver.and_then(|robot| last_stop(log.stops(), robot)).map_or(Position::ORIGIN, |stop| stop.position);
    Ok(of_next_stops(&source, &computed.map, start, &stops, next.total()))
}
