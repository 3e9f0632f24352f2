//! Ranges and strengths in the log of robots: by reciprocity, a robot among nodes at known places is a tag among receivers.

use std::collections::BTreeMap;
use std::path::Path as FilePath;

use sextant_channel::{Position, RangeSample, ReceptionLog};
use sextant_kernel::text::{are, counted, listed};
use sextant_mapper::TagReading;

use super::readings::TagReadings;
use crate::error::robot_log_error::RobotLogError;

impl TagReadings {
    /// The ranges and strengths of the robots of a log to its nodes, of which those at `known` places, by name, are receivers: each
    /// robot is a tag. Where it was is not looked at. A strength is the mean over a stop.
    ///
    /// # Errors
    /// If the stops have no times, or nothing is of a known receiver.
    pub fn of_log(
        path: &FilePath,
        log: &ReceptionLog,
        known: &BTreeMap<String, Position>,
    ) -> Result<Self, RobotLogError> {
        let numbers: BTreeMap<&str, usize> =
            known.keys().enumerate().map(|(number, name)| (name.as_str(), number)).collect();
        let refused = |problem: String| RobotLogError::NoRanges { name: path.display().to_string(), problem };
        let mut samples: Vec<&RangeSample> = log.ranges().iter().collect();
        samples.sort_by_key(|sample| sample.time);
        let mut found = Self::default();
        let mut strangers = [0_usize; 2];
        let of_node = |node: sextant_kernel::NodeId| numbers.get(log.names()[node.index()].as_str()).copied();
        for &&RangeSample { node, robot, time, range_m, .. } in &samples {
            match of_node(node) {
                Some(receiver) => {
                    let tag = log.robot_name(robot).into_owned();
                    found.tags.entry(tag).or_default().push(TagReading::range(receiver, time, range_m));
                }
                None => strangers[0] += 1,
            }
        }
        let stops = log.stops();
        let has_times = stops.iter().any(|stop| stop.time != stops[0].time);
        let strengths = log.receptions().iter().filter_map(|reception| Some((reception, reception.rssi_dbm?)));
        for (reception, rssi_dbm) in strengths.filter(|_| has_times) {
            match of_node(reception.node) {
                Some(receiver) => {
                    let stop = stops[reception.stop as usize];
                    let tag = log.robot_name(stop.robot).into_owned();
                    let reading = TagReading::strength(receiver, stop.time, rssi_dbm);
                    found.tags.entry(tag).or_default().push(reading);
                }
                None => strangers[1] += 1,
            }
        }
        for (count, noun) in strangers.into_iter().zip(["range", "strength"]) {
            if count > 0 {
                found.notes.push(format!(
                    "{} to nodes without a known place {} not used",
                    counted(count, noun),
                    are(count)
                ));
            }
        }
        if found.tags.is_empty() {
            let has_strengths = log.receptions().iter().any(|reception| reception.rssi_dbm.is_some());
            return Err(refused(if has_strengths && !has_times {
                "its stops have no times (t_s), and a track needs them".to_owned()
            } else if samples.is_empty() && !has_strengths {
                "it has neither ranges nor strengths: a scenario with a table `[ranging]` makes ranges".to_owned()
            } else {
                let names = listed(&known.keys().collect::<Vec<_>>());
                format!("it has no range and no strength to a node with a known place; those are {names}")
            }));
        }
        Ok(found.ready())
    }
}
