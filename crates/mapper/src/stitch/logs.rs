//! The log of one robot, and that of several in one frame.

use sextant_channel::{Contact, Position, ReceptionLog, ReceptionLogBuilder, Stop};
use sextant_kernel::RobotId;

use super::frame_change::FrameChange;

/// The robots that listened somewhere, in their order.
pub(super) fn robots(log: &ReceptionLog) -> Vec<RobotId> {
    let mut has_stops = vec![false; log.robot_count()];
    log.stops().iter().for_each(|stop| has_stops[stop.robot.index()] = true);
    (0..has_stops.len()).filter(|&robot| has_stops[robot]).map(RobotId::from_index).collect()
}

/// The part of `log` of the robots that have a frame, with their stops and contacts moved by it. Without antenna sectors and
/// their signal-to-noise ratios: their directions are those of each robot's own frame.
#[must_use]
pub fn moved_log(log: &ReceptionLog, frame: impl Fn(RobotId) -> Option<FrameChange>) -> ReceptionLog {
    let frames: Vec<Option<FrameChange>> =
        (0..log.robot_count()).map(|robot| frame(RobotId::from_index(robot))).collect();
    let place = |robot: RobotId, place: Position| frames[robot.index()].map(|frame| frame.apply(place));
    let mut stops: Vec<Stop> = Vec::new();
    let mut number: Vec<Option<u32>> = Vec::with_capacity(log.stops().len());
    for stop in log.stops() {
        let moved = place(stop.robot, stop.position);
        number.push(moved.map(|_| u32::try_from(stops.len()).expect("fewer stops than in the whole log")));
        stops.extend(moved.map(|position| Stop { position, ..*stop }));
    }
    let contact = |contact: &Contact| Some(Contact { position: place(contact.robot, contact.position)?, ..*contact });
    let contacts = log.contacts().iter().filter_map(contact).collect();
    let mut receptions = ReceptionLogBuilder::default();
    for mut reception in log.receptions().iter() {
        if let Some(stop) = number[reception.stop as usize] {
            reception.stop = stop;
            receptions.push(reception);
        }
    }
    let moved = receptions.build(log.names().to_vec(), stops, contacts);
    let moved = moved.and_then(|moved| moved.with_robots(log.robots().to_vec()));
    moved.unwrap_or_else(|error| unreachable!("a part of a log is a log: {error}"))
}
