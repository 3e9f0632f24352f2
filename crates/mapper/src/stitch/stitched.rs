//! An estimator whose log is that of robots with frames of their own.

use sextant_channel::{ReceptionLog, Stop};
use sextant_kernel::{NodeId, RobotId, SettingError, Watch};

use super::frame_change::FrameChange;
use super::frames::{Frames, as_shares, stitch};
use super::logs::moved_log;
use super::members::Members;
use super::pair::{PairFit, PairState};
use super::report::{JoinedFrame, RobotFrame, RobotOutcome, Stitching};
use super::settings::{StitchConfig, StitchRules};
use super::shared::OwnMap;
use crate::error::MapError;
use crate::estimator::{Estimator, Mapper, Messages};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::learned::EstimatorFindings;
use crate::posterior::Estimate;
use crate::profile::ReceptionProfile;
use crate::topology_map::TopologyMap;

/// An estimator that maps the log of each robot in its own frame first, and then the log of all in the frame of the map. Robots
/// that are known to have that frame are mapped together.
#[derive(Clone, Debug, PartialEq)]
pub struct Stitched {
    inner: Mapper,
    rules: StitchRules,
}

impl Stitched {
    /// The stitched version of `inner`.
    ///
    /// # Errors
    /// If `inner` maps several networks, or uses what is known in the frame of the world, such as anchors.
    pub fn mapper(inner: Mapper, config: StitchConfig) -> Result<Mapper, SettingError> {
        let remedy = "remove one of them; stitching works with maps of what robots hear, in one network";
        let is_of_robots = |kind: &KnowledgeKind| {
            matches!(
                kind,
                KnowledgeKind::RobotReceptions
                    | KnowledgeKind::RobotRssi
                    | KnowledgeKind::RobotPath
                    | KnowledgeKind::PathLoss
            )
        };
        if let Some(kind) = inner.uses().iter().find(|kind| !is_of_robots(kind)) {
            let with = format!("`{}`, which uses {}", inner.name(), kind.name());
            return Err(SettingError::conflict("stitch", with, remedy));
        }
        if !inner.networks().is_empty() {
            let with = format!("`{}`, a map of several networks", inner.name());
            return Err(SettingError::conflict("stitch", with, remedy));
        }
        Ok(Mapper::new(Self { inner, rules: config.into() }))
    }

    /// The maps of each member in its own frame; why there is none, in words.
    fn own_maps(
        &self,
        knowledge: &Knowledge<'_>,
        members: &Members<'_>,
        watch: &dyn Watch,
    ) -> Result<Vec<Result<OwnMap, String>>, MapError> {
        let map = |member: usize| {
            let log = moved_log(knowledge.log, |robot| members.has(member, robot).then_some(FrameChange::NONE));
            match self.inner.map_and_learn(Knowledge { log: &log, ..*knowledge }, watch) {
                Ok((map, _)) => Ok(Ok(OwnMap::of(&map, &log))),
                Err(MapError::Interrupted(interrupted)) => Err(MapError::Interrupted(interrupted)),
                Err(error) => Ok(Err(error.to_string())),
            }
        };
        (0..members.count()).map(map).collect()
    }
}

impl Estimator for Stitched {
    fn name(&self) -> &'static str {
        self.inner.name()
    }

    fn uses(&self) -> &'static [KnowledgeKind] {
        self.inner.uses()
    }

    fn check_grid(&self, stops: &[Stop]) -> Result<(), MapError> {
        // How the frames of the others fit to that of the first robot is known only with their logs.
        let first = stops.iter().map(|stop| stop.robot).min();
        let of_first: Vec<Stop> = stops.iter().filter(|stop| Some(stop.robot) == first).copied().collect();
        self.inner.check_grid(&of_first)
    }

    fn estimate(
        &self,
        knowledge: &Knowledge<'_>,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<EstimatorFindings>), MapError> {
        let log = knowledge.log;
        if log.robot_count() < 2 {
            return Err(MapError::OneRobot { robot: log.robot_name(RobotId(0)).into_owned() });
        }
        let members = Members::of(knowledge, &self.rules)?;
        if members.count() == 1 {
            let (map, learned) = self.inner.map_and_learn(*knowledge, watch)?;
            let stitching = Stitching::nothing(members.names(0), &map, learned);
            return Ok((map, Some(EstimatorFindings::new(stitching))));
        }
        if log.sectors().is_some() {
            return Err(MapError::StitchedSectors);
        }
        let own = self.own_maps(knowledge, &members, watch)?;
        let maps: Vec<OwnMap> = own.iter().map(|own| own.as_ref().cloned().unwrap_or_default()).collect();
        let frames = stitch(&maps, &self.rules, knowledge.seed);
        let of_robots = members.of_robots();
        let joined = moved_log(log, |robot| frames.changes[of_robots[robot.index()]?]);
        let (mut map, learned) = self.inner.map_and_learn(Knowledge { log: &joined, ..*knowledge }, watch)?;
        let errors = FrameErrors { frames: &frames, maps: &maps, log, of_robots: &of_robots };
        for (node, estimate) in map.estimates.iter_mut().enumerate() {
            *estimate = estimate.take().map(|estimate| errors.added_to(NodeId::from_index(node), estimate));
        }
        let why = |member: usize| match &own[member] {
            Err(why) => why.clone(),
            Ok(_) => why_left_out(member, &members, &frames),
        };
        let robots = members.robots().into_iter().map(|(robot, member)| RobotFrame {
            name: log.robot_name(robot).into_owned(),
            placed: maps[member].nodes.len(),
            outcome: match frames.changes[member] {
                Some(_) if member == 0 => RobotOutcome::Known(frames.agreements[0]),
                Some(change) => RobotOutcome::Joined(JoinedFrame {
                    change,
                    agreement: frames.agreements[member],
                    deviation_m: frames.deviation_m(member, &maps[member]),
                }),
                None => RobotOutcome::LeftOut { why: why(member) },
            },
        });
        let stitching = Stitching {
            robots: robots.collect(),
            members: (0..members.count()).map(|member| members.names(member)).collect(),
            groups: frames.groups(),
            pairs: frames.pairs,
            learned,
        };
        Ok((map, Some(EstimatorFindings::new(stitching))))
    }

    fn counts_packets(&self) -> bool {
        self.inner.counts_packets()
    }

    fn profile(&self) -> Option<&ReceptionProfile> {
        self.inner.profile()
    }

    fn messages(&self) -> Messages {
        self.inner.messages()
    }
}

/// What the errors of frames do to the places on the map of all.
struct FrameErrors<'a> {
    frames: &'a Frames,
    maps: &'a [OwnMap],
    log: &'a ReceptionLog,
    /// The member of each robot.
    of_robots: &'a [Option<usize>],
}

impl FrameErrors<'_> {
    /// The estimate of `node` with the errors of the frames in its covariance; without one if the frames have none.
    fn added_to(&self, node: NodeId, estimate: Estimate) -> Estimate {
        let Some(mut covariance) = estimate.covariance else { return estimate };
        let Some(frames) = &self.frames.covariance else { return Estimate { covariance: None, ..estimate } };
        let mut shares = self.frames.shares(self.maps, node);
        if shares.is_empty() {
            shares = self.shares_heard(node);
        }
        let added = frames.of_place(estimate.position, &shares);
        // A map in the plane stays one.
        let axes = if covariance[2][2] > 0.0 { 3 } else { 2 };
        for row in 0..axes {
            for column in 0..axes {
                covariance[row][column] += added[row][column];
            }
        }
        Estimate { covariance: Some(covariance), ..estimate }
    }

    /// The share of the stops that heard `node` of each member with a frame: of nodes that are on no map of a member.
    fn shares_heard(&self, node: NodeId) -> Vec<(usize, f64)> {
        let mut heard = vec![0.0; self.maps.len()];
        for reception in self.log.of(node).iter().filter(|reception| reception.received > 0) {
            let robot = self.log.stops()[reception.stop as usize].robot;
            if let Some(member) = self.of_robots[robot.index()] {
                heard[member] += 1.0;
            }
        }
        let is_told = |&(member, heard): &(usize, f64)| heard > 0.0 && self.frames.changes[member].is_some();
        as_shares(heard.into_iter().enumerate().filter(is_told).collect())
    }
}

/// Why a member is left out: what its map and that of a joined one with which it shares most nodes tell.
fn why_left_out(member: usize, members: &Members<'_>, frames: &Frames) -> String {
    let other = |pair: &PairFit| pair.robots[usize::from(pair.robots[0] == member)];
    let is_joined = |pair: &&PairFit| pair.robots.contains(&member) && frames.changes[other(pair)].is_some();
    match frames.pairs.iter().filter(is_joined).max_by_key(|pair| pair.shared) {
        Some(pair) => match &pair.state {
            PairState::Undecided(fault) => format!("with {}, {fault}", members.name(other(pair))),
            PairState::Fitted { .. } => "its map does not agree with those of the others".to_owned(),
        },
        None => "no robot with a known frame has a map".to_owned(),
    }
}
