//! The robots of a log, grouped by what is known of their frames.

use sextant_channel::ReceptionLog;
use sextant_kernel::RobotId;
use sextant_kernel::text::{choices, listed};

use super::logs;
use super::settings::StitchRules;
use crate::error::MapError;
use crate::knowledge::{FrameKnowledge, Knowledge};

/// The robots that listened: those in the frame of the map, which are one member, and each of the others.
#[derive(Clone, Debug)]
pub(super) struct Members<'a> {
    log: &'a ReceptionLog,
    robots: Vec<Vec<RobotId>>,
}

impl<'a> Members<'a> {
    /// The members of the log of `knowledge`.
    pub(super) fn of(knowledge: &Knowledge<'a>, rules: &StitchRules) -> Result<Self, MapError> {
        let log = knowledge.log;
        let known = known(log, rules, knowledge.frames)?;
        let listened = logs::robots(log);
        let mut in_frame: Vec<RobotId> = listened.iter().filter(|robot| known[robot.index()]).copied().collect();
        if in_frame.is_empty() {
            in_frame.extend(listened.first());
        }
        let others = listened.iter().filter(|robot| !in_frame.contains(robot)).map(|&robot| vec![robot]);
        let robots = std::iter::once(in_frame.clone()).chain(others).collect();
        Ok(Self { log, robots })
    }

    /// How many there are, at least one.
    pub(super) fn count(&self) -> usize {
        self.robots.len()
    }

    /// Whether `robot` is of this member.
    pub(super) fn has(&self, member: usize, robot: RobotId) -> bool {
        self.robots[member].contains(&robot)
    }

    /// The robots and their members, in the order of the log.
    pub(super) fn robots(&self) -> Vec<(RobotId, usize)> {
        let of = |(member, robots): (usize, &Vec<RobotId>)| -> Vec<(RobotId, usize)> {
            robots.iter().map(|&robot| (robot, member)).collect()
        };
        let mut robots: Vec<(RobotId, usize)> = self.robots.iter().enumerate().flat_map(of).collect();
        robots.sort_unstable_by_key(|&(robot, _)| robot.index());
        robots
    }

    /// The member of each robot of the log; `None` for a robot that never listened.
    pub(super) fn of_robots(&self) -> Vec<Option<usize>> {
        let mut members = vec![None; self.log.robot_count()];
        self.robots().into_iter().for_each(|(robot, member)| members[robot.index()] = Some(member));
        members
    }

    /// The names of the robots of a member.
    pub(super) fn names(&self, member: usize) -> Vec<String> {
        self.robots[member].iter().map(|&robot| self.log.robot_name(robot).into_owned()).collect()
    }

    /// What a member is called.
    pub(super) fn name(&self, member: usize) -> String {
        listed(&self.names(member))
    }
}

/// Which robots of `log` are known to have the frame of the map: those that the settings name, otherwise what else is known.
fn known(log: &ReceptionLog, rules: &StitchRules, frames: FrameKnowledge<'_>) -> Result<Vec<bool>, MapError> {
    let names: Vec<String> =
        (0..log.robot_count()).map(|robot| log.robot_name(RobotId::from_index(robot)).into_owned()).collect();
    let are_among = |known: &[String]| names.iter().map(|name| known.contains(name)).collect();
    match (&rules.known, frames) {
        (Some(set), _) => match set.iter().find(|name| !names.contains(name)) {
            Some(name) => Err(MapError::NoRobot { name: name.clone(), known: choices(&names) }),
            None => Ok(are_among(set)),
        },
        (None, FrameKnowledge::Shared(known)) => Ok(are_among(known)),
        (None, FrameKnowledge::SharedByAll) => Ok(vec![true; names.len()]),
    }
}
