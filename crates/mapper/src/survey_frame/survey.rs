//! A log in the frame of its survey.

use sextant_channel::{Contact, Reception, ReceptionLog, ReceptionLogBuilder, SectorReport, Stop};
use sextant_kernel::{NodeId, RobotId, SimTime};

use super::draft::HeardStops;
use super::frame::SurveyFrame;
use crate::posterior::{Area, PlacePrior};

/// A survey: its frame, and its stops in this frame.
#[derive(Debug)]
pub(crate) struct Survey {
    pub(crate) frame: SurveyFrame,
    /// Nodes, stops and contacts, without receptions.
    pub(crate) whole: ReceptionLog,
    /// The number in the survey of each stop and node of the log, if it has one.
    stops: Vec<Option<u32>>,
    nodes: Vec<Option<NodeId>>,
}

impl Survey {
    /// The survey of `log`; `None` if nothing was heard.
    pub(crate) fn of_log(log: &ReceptionLog) -> Option<Self> {
        let mut heard = HeardStops::none(log.stops().len());
        heard.take(log);
        let mut draft = heard.draft(log)?;
        draft.take((0..log.node_count()).map(NodeId::from_index), log);
        Some(Self::new(draft.frame(log.stops().len()), log))
    }

    /// The survey with a frame, at the stops of `log`.
    pub(crate) fn new(frame: SurveyFrame, log: &ReceptionLog) -> Self {
        let mut stops = vec![None; log.stops().len()];
        for (number, &stop) in (0..).zip(&frame.stops) {
            stops[stop as usize] = Some(number);
        }
        let mut nodes = vec![None; log.node_count()];
        for (number, node) in frame.nodes.iter().enumerate() {
            nodes[node.index()] = Some(NodeId::from_index(number));
        }
        let names = frame.nodes.iter().map(|node| log.names()[node.index()].clone()).collect();
        let contact = |contact: &Contact| Contact { position: frame.axes.place(contact.position), ..*contact };
        let contacts = log.contacts().iter().map(contact).collect();
        let whole = ReceptionLogBuilder::default().build(names, laid(&frame, &stops, log), contacts);
        let whole = whole.and_then(|whole| match log.sectors() {
            Some(sectors) => whole.with_sectors(sectors.clone()),
            None => Ok(whole),
        });
        let whole = whole.unwrap_or_else(|error| unreachable!("a log that is turned is a log: {error}"));
        Self { frame, whole, stops, nodes }
    }

    /// All of `log` in this frame, and the number of each of its nodes in `log`.
    pub(crate) fn log(&self, log: &ReceptionLog) -> (Vec<usize>, ReceptionLog) {
        let (numbers, _, turned) = self.part((0..log.node_count()).map(NodeId::from_index), log);
        (numbers, turned)
    }

    /// The nodes of a part of the log in the order of the survey: their numbers in the part `log` and in the survey, and the
    /// part in this frame. They are `nodes` in the whole log. Nodes that were not heard are not there.
    pub(crate) fn part(
        &self,
        nodes: impl Iterator<Item = NodeId>,
        log: &ReceptionLog,
    ) -> (Vec<usize>, Vec<NodeId>, ReceptionLog) {
        let order = self.order(nodes);
        let mut receptions = ReceptionLogBuilder::default();
        let mut of_node: Vec<Reception> = Vec::new();
        for (number, &(_, in_part)) in order.iter().enumerate() {
            let node = NodeId::from_index(number);
            let in_survey = |reception: Reception| {
                Some(Reception { node, stop: self.stops[reception.stop as usize]?, ..reception })
            };
            of_node.clear();
            of_node.extend(log.of(NodeId::from_index(in_part)).iter().filter_map(in_survey));
            of_node.sort_unstable_by_key(|reception| reception.stop);
            receptions.extend(of_node.iter().copied());
        }
        if log.receptions().sectors().is_some() {
            receptions.keep_sectors();
        }
        let mut number_of = vec![None; log.node_count()];
        for (number, &(_, in_part)) in order.iter().enumerate() {
            number_of[in_part] = Some(NodeId::from_index(number));
        }
        for report in log.sector_reports() {
            if let (Some(node), Some(stop)) = (number_of[report.node.index()], self.stops[report.stop as usize]) {
                receptions.report(SectorReport { node, stop, ..report });
            }
        }
        let (survey, in_part): (Vec<NodeId>, Vec<usize>) = order.into_iter().unzip();
        let names = survey.iter().map(|node| self.whole.names()[node.index()].clone()).collect();
        let turned = self.whole.part(names, receptions);
        let turned = turned.unwrap_or_else(|error| unreachable!("a log that is turned is a log: {error}"));
        (in_part, survey, turned)
    }

    /// The numbers in the survey of those of the `nodes` of a part that were heard, with their numbers in the part.
    pub(crate) fn order(&self, nodes: impl Iterator<Item = NodeId>) -> Vec<(NodeId, usize)> {
        let numbered = nodes.enumerate();
        let mut order: Vec<(NodeId, usize)> =
            numbered.filter_map(|(in_part, node)| Some((self.nodes[node.index()]?, in_part))).collect();
        order.sort_unstable();
        order
    }

    /// What is known of the places of nodes, in this frame.
    pub(crate) fn prior(&self, prior: &PlacePrior) -> PlacePrior {
        let turned = |area: &Area| area.moved(|point| self.frame.axes.point(point));
        PlacePrior { area: prior.area.as_ref().map(turned), ..prior.clone() }
    }
}

/// The stops of a survey in their order. The path is kept: the time of a stop is its place on the path, and where a stop is left
/// out, another robot goes on, so that no drive leads past it.
fn laid(frame: &SurveyFrame, number_of: &[Option<u32>], log: &ReceptionLog) -> Vec<Stop> {
    let mut path: Vec<usize> = (0..log.stops().len()).collect();
    path.sort_by_key(|&stop| log.stops()[stop].time);
    let mut robots: Vec<RobotId> = (0..log.robot_count()).map(RobotId::from_index).collect();
    let mut next = robots.len();
    let mut found: Vec<Option<Stop>> = vec![None; frame.stops.len()];
    for (rank, &at) in (0..).zip(&path) {
        let stop = log.stops()[at];
        match number_of[at] {
            Some(number) => {
                let (robot, time) = (robots[stop.robot.index()], SimTime::from_nanos(rank));
                let position = frame.axes.place(stop.position);
                found[number as usize] = Some(Stop { robot, time, position, ..stop });
            }
            None => {
                robots[stop.robot.index()] = RobotId::from_index(next);
                next += 1;
            }
        }
    }
    found.into_iter().flatten().collect()
}
