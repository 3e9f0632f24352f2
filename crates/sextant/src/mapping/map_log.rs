//! One map of a log, in one call.

use sextant_channel::ReceptionLog;
use sextant_kernel::Watch;
use sextant_mapper::{EstimatorFindings, TopologyMap};
use sextant_scenario::{AlgorithmName, MapSettings};

use super::error::MapLogError;
use super::logs::MapLogs;
use crate::measure::{Subject, in_world, measure};
use crate::summary::MapSummary;

/// A map of a log, with what was estimated with it.
#[derive(Clone, Debug)]
pub struct LogMap {
    /// The map. Its places are in the frame of the stops, or in one of their own if the algorithm uses no stops.
    pub map: TopologyMap,
    /// What else was estimated from the log.
    pub learned: Option<EstimatorFindings>,
    /// Its properties as `sextant map` prints them, without errors: no truth is known.
    pub summary: MapSummary,
}

/// Maps the nodes of `log` by `algorithm` with its default settings. The same log gives the same map as `sextant map`.
///
/// ```
/// use sextant_channel::{Position, Reception, ReceptionLog, Stop};
/// use sextant_kernel::{NodeId, RobotId, SimTime, Unwatched};
///
/// let stop = |x_m: f64, y_m: f64| Stop { robot: RobotId(0), time: SimTime::ZERO, position: Position::new(x_m, y_m, 0.0), heading_rad: None };
/// let stops: Vec<Stop> = (0..16).map(|i| stop(f64::from(i % 4), f64::from(i / 4))).collect();
/// // The lamp stands at the stop number 5, and the packets that get through fall with the distance from it.
/// let heard = |i: usize| {
///     let received = 10 - (3.0 * stops[i].position.distance_m(stops[5].position)).min(10.0) as u32;
///     Reception { node: NodeId(0), stop: i as u32, received, sent: 10, sector: None, rssi_dbm: None, snr_db: None }
/// };
/// let log = ReceptionLog::new(vec!["lamp".to_owned()], stops.clone(), (0..16).map(heard).collect(), Vec::new())?;
/// let map = sextant::map_log(&log, "packet-centroid".parse()?, &Unwatched)?.map;
/// let place = map.positions()[0].expect("the lamp was heard");
/// assert!(place.distance_m(Position::new(1.0, 1.0, 0.0)) < 0.5, "{place:?}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// If the log lacks what the algorithm needs, or `watch` stops the work.
pub fn map_log(log: &ReceptionLog, algorithm: AlgorithmName, watch: &dyn Watch) -> Result<LogMap, MapLogError> {
    let settings = MapSettings::new(None, Some(algorithm), None, None, &[])?;
    let job = &settings.maps[0];
    let logs = MapLogs::alone(log);
    let (map, learned) = job.mapper.map_and_learn(logs.knowledge(job), watch)?;
    let (map, alignment) = in_world(map, None);
    let summary =
        measure(&Subject::new(job, log), &map, learned.as_ref(), log.names(), None, &settings.metrics, watch)?;
    Ok(LogMap { map, learned, summary: MapSummary { alignment: Some(alignment), ..summary }.judged() })
}
