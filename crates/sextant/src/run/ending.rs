//! Why the way of a robot ended.

use std::collections::BTreeSet;

use sextant_apps::ControllerConfig;
use sextant_kernel::NodeId;
use sextant_scenario::Scenario;
use sextant_sim::{Ending, RobotRecord, RoleConfig, StopsLeftOut, Survey};

use super::simulator::Simulated;
use crate::summary::{LeftOutSummary, RobotEnd, RobotSummary};

/// The robots of the survey: their paths, and why they ended.
pub(super) fn robots(scenario: &Scenario, simulated: &Simulated) -> Vec<RobotSummary> {
    let Simulated { survey, programmed, .. } = simulated;
    let robot = |(record, config): (&RobotRecord, &sextant_sim::RobotConfig<ControllerConfig>)| {
        let has_own = |robots: &BTreeSet<String>| robots.contains(&record.name);
        let is_driven_by_an_application = has_own(&programmed.applications);
        // The settings of a controller that was replaced say nothing.
        let is_replaced = has_own(&programmed.controllers) || is_driven_by_an_application;
        let controller = config.controller.as_ref().filter(|_| !is_replaced);
        let wanted = controller.map_or(1, ControllerConfig::packets_per_node);
        let surveys = config.role == RoleConfig::Survey;
        RobotSummary {
            name: record.name.clone(),
            stops: record.stops,
            path_length_m: record.path_length_m,
            ending: record.ending.map(|ending| match ending {
                Ending::Complete => "complete",
                Ending::StepsExhausted => "steps_exhausted",
                Ending::Stuck => "stuck",
            }),
            ended: (!is_driven_by_an_application).then(|| end(record, controller, wanted, survey.interrupted)),
            duration_s: record.end.map(sextant_kernel::SimTime::as_secs_f64),
            unreached: if surveys { unreached(survey, wanted) } else { Vec::new() },
            packets_wanted: (surveys && wanted > 1).then_some(wanted),
            left_out: left_out(record.left_out),
        }
    };
    survey.robots.iter().zip(scenario.robots_of_survey()).map(robot).collect()
}

fn end(record: &RobotRecord, controller: Option<&ControllerConfig>, wanted: u32, interrupted: bool) -> RobotEnd {
    let searches = matches!(controller, Some(ControllerConfig::AutomatedS(_) | ControllerConfig::RandomWalk(_)));
    match record.ending {
        None if interrupted => RobotEnd::Interrupted,
        None => RobotEnd::TimeLimit,
        Some(Ending::StepsExhausted) => RobotEnd::StepsExhausted,
        Some(Ending::Stuck) => RobotEnd::Stuck,
        Some(Ending::Complete) if !searches => RobotEnd::PathEnded,
        Some(Ending::Complete) if record.packets.iter().all(|&packets| packets >= wanted) => RobotEnd::AllHeard,
        Some(Ending::Complete) => RobotEnd::AreaSwept,
    }
}

fn left_out(StopsLeftOut { in_obstacles, unreachable }: StopsLeftOut) -> Option<LeftOutSummary> {
    (in_obstacles + unreachable > 0).then_some(LeftOutSummary { in_obstacles, unreachable })
}

/// Names of the nodes from which all robots together received fewer than `wanted` packets. Where one is enough, a range is too.
fn unreached(survey: &Survey, wanted: u32) -> Vec<String> {
    let heard = |node: usize| survey.robots.iter().fold(0, |sum: u32, robot| sum.saturating_add(robot.packets[node]));
    let has_ranges = |node| {
        let node = NodeId::from_index(node);
        wanted <= 1 && survey.logs.iter().any(|network| !network.log.ranges_to(node).is_empty())
    };
    let names = survey.log().names().iter().enumerate();
    names.filter(|&(node, _)| heard(node) < wanted && !has_ranges(node)).map(|(_, name)| name.clone()).collect()
}
