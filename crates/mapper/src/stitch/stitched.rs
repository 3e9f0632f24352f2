//! An estimator whose log is that of robots with frames of their own.

use sextant_channel::{ReceptionLog, Stop};
use sextant_kernel::{RobotId, Seed, SettingError, Watch};

use super::frame_change::FrameChange;
use super::joint::{self, Agreement};
use super::logs;
use super::pair::{PairFit, PairState};
use super::report::{RobotFrame, RobotOutcome, Stitching};
use super::settings::{StitchConfig, StitchRules};
use super::shared::OwnMap;
use super::tree;
use crate::{
    Estimator, EstimatorFindings, Knowledge, KnowledgeKind, MapError, Mapper, Messages, ReceptionProfile, TopologyMap,
};

/// A robot is left out if fewer nodes agree with the maps of the others.
const LEAST_AGREEING: usize = 3;

/// An estimator that maps the log of each robot in its own frame first, and then the log of all in that of the first robot.
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

    /// The maps of each robot in its own frame; why there is none, in words.
    fn own_maps(
        &self,
        knowledge: &Knowledge<'_>,
        robots: &[RobotId],
        watch: &dyn Watch,
    ) -> Result<Vec<Result<OwnMap, String>>, MapError> {
        let map = |&robot: &RobotId| {
            let log = logs::moved(knowledge.log, |other| (other == robot).then_some(FrameChange::NONE));
            match self.inner.map_and_learn(Knowledge { log: &log, ..*knowledge }, watch) {
                Ok((map, _)) => Ok(Ok(OwnMap::of(&map, &log))),
                Err(MapError::Interrupted(interrupted)) => Err(MapError::Interrupted(interrupted)),
                Err(error) => Ok(Err(error.to_string())),
            }
        };
        robots.iter().map(map).collect()
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
        if log.sectors().is_some() {
            return Err(MapError::StitchedSectors);
        }
        if log.robot_count() < 2 {
            return Err(MapError::OneRobot { robot: log.robot_name(RobotId(0)).into_owned() });
        }
        let robots = logs::robots(log);
        let own = self.own_maps(knowledge, &robots, watch)?;
        let maps: Vec<OwnMap> = own.iter().map(|own| own.as_ref().cloned().unwrap_or_default()).collect();
        let (frames, agreements, pairs) = frames_of(&maps, self.rules, knowledge.seed);
        let frame_of = |robot: RobotId| -> Option<FrameChange> {
            let at = robots.iter().position(|&other| other == robot)?;
            frames.get(at).copied().unwrap_or(Some(FrameChange::NONE))
        };
        let joined = logs::moved(log, frame_of);
        let (map, learned) = self.inner.map_and_learn(Knowledge { log: &joined, ..*knowledge }, watch)?;
        let names = Names { log, robots: &robots };
        let robots = (0..robots.len()).map(|robot| RobotFrame {
            name: names.of(robot),
            placed: maps.get(robot).map_or(map.mapped(), |own| own.nodes.len()),
            outcome: match (own.get(robot), frames.get(robot)) {
                (None, _) | (_, None) => joined_as(FrameChange::NONE, Agreement::default()),
                (_, Some(Some(change))) => joined_as(*change, agreements[robot]),
                (Some(Err(why)), _) => RobotOutcome::LeftOut { why: why.clone() },
                (Some(Ok(_)), Some(None)) => RobotOutcome::LeftOut { why: names.why(robot, &frames, &pairs) },
            },
        });
        let robots = robots.collect();
        Ok((map, Some(EstimatorFindings::new(Stitching { robots, pairs, learned }))))
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

fn joined_as(change: FrameChange, agreement: Agreement) -> RobotOutcome {
    let Agreement { shared, agreeing, residual_m } = agreement;
    RobotOutcome::Joined { change, shared, agreeing, residual_m }
}

/// How the frame of each robot becomes that of the first one, from `maps` in these frames: `None` for a robot whose frame they
/// do not tell. `seed` is that of random pairs of nodes that are tried. Returns also what each pair of maps tells.
///
/// The same maps give the same frames.
#[must_use]
pub fn stitch(maps: &[OwnMap], rules: StitchRules, seed: Seed) -> (Vec<Option<FrameChange>>, Vec<PairFit>) {
    let (frames, _, pairs) = frames_of(maps, rules, seed);
    (frames, pairs)
}

fn frames_of(
    maps: &[OwnMap],
    rules: StitchRules,
    seed: Seed,
) -> (Vec<Option<FrameChange>>, Vec<Agreement>, Vec<PairFit>) {
    let pairs: Vec<PairFit> = (0..maps.len())
        .flat_map(|a| (a + 1..maps.len()).map(move |b| [a, b]))
        .map(|robots| PairFit::of(robots, robots.map(|robot| &maps[robot]), rules, seed))
        .collect();
    let mut known = pairs.clone();
    loop {
        let start = tree::frames(maps.len(), &known);
        let (frames, agreements) = joint::refine(maps, start, rules.lengths);
        let disagrees =
            |robot: &usize| *robot > 0 && frames[*robot].is_some() && agreements[*robot].agreeing < LEAST_AGREEING;
        let Some(robot) = (0..maps.len()).filter(disagrees).min_by_key(|&robot| agreements[robot].agreeing) else {
            return (frames, agreements, pairs);
        };
        known.retain(|pair| !pair.robots.contains(&robot));
    }
}

/// The names of robots, by number among those that listened.
struct Names<'a> {
    log: &'a ReceptionLog,
    robots: &'a [RobotId],
}

impl Names<'_> {
    fn of(&self, robot: usize) -> String {
        self.log.robot_name(self.robots[robot]).into_owned()
    }

    /// Why a robot is left out: what its map and that of a joined robot with which it shares most nodes tell.
    fn why(&self, robot: usize, frames: &[Option<FrameChange>], pairs: &[PairFit]) -> String {
        let other = |pair: &PairFit| pair.robots[usize::from(pair.robots[0] == robot)];
        let of_robot = pairs.iter().filter(|pair| pair.robots.contains(&robot) && frames[other(pair)].is_some());
        match of_robot.max_by_key(|pair| pair.shared) {
            Some(pair) => match &pair.state {
                PairState::Undecided(fault) => format!("with {}, {fault}", self.of(other(pair))),
                PairState::Fitted { .. } => "its map does not agree with those of the others".to_owned(),
            },
            None => "no robot with a known frame has a map".to_owned(),
        }
    }
}
