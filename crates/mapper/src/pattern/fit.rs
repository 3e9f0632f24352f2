//! The law of a log, with the places of its nodes integrated out.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use rayon::prelude::*;
use sextant_channel::ReceptionLog;
use sextant_kernel::{NodeId, Watch, Work};

use super::blur::Blur;
use super::evidence::{LawTables, Naming, PatternEvidence, PatternLikelihood, PatternTables, Prospect, SectorsHeard};
use super::gain_map::GainMap;
use super::hearing::{self, LevelTrial, PacketTrial, Trials};
use super::law::PatternLaw;
use super::naming::{self, Scenery, TURN_RAD, TurnOfRound};
use super::places::{self, CellPosterior, Look};
use super::report_law::ReportLaw;
use super::scene::AntennaScene;
use super::ways::KnownWays;
use crate::error::MapError;
use crate::log_facts::search_box::SearchBox;
use crate::numerics::golden_section::highest;

/// The distance over which cells are seen, as a share of the reach.
const SEEN_FROM: f64 = 0.33;
/// The law is estimated from at most so many nodes, and begun with so many.
const NODES: usize = 48;
const FIRST_NODES: usize = 12;
/// The turn of the antenna is improved in a round by so many.
const TURN_NODES: usize = 4;
/// Places that stand for the posterior of a node.
const SAMPLE: usize = 12;
/// Most rounds.
const ROUNDS: u32 = 15;
/// Rounds before known obstacles count: a rough law is found without them, at less cost.
const OPEN_ROUNDS: u32 = 3;
/// Steps of the search for the turn in a round.
const TURN_STEPS: u32 = 9;
/// The law has settled if nothing changes by more than this in a round (dB, degrees).
const SETTLED_DB: f64 = 0.2;
/// The same where nodes report all sectors, which tell far more.
const SETTLED_OF_REPORTS_DB: f64 = 0.05;
/// Margins that are tried at first, from the usual one (dB), and so many yaws.
const MARGINS_DB: [f64; 7] = [0.0, -4.0, 4.0, -8.0, 8.0, -12.0, 12.0];
const YAWS: u32 = 24;
/// Of these, so many are looked at closely.
const WHOLE_LOOKS: usize = 3;
/// Laws that are tried at first, at most: margins, yaws, and smaller turns.
const FIRST_LAWS: f64 = 40.0;
/// An antenna is turned from what the log says only if this makes the log likelier by so much (logarithm), where a node counts
/// for or against it by so much at most: three nodes at least must agree.
const TURNED: f64 = 10.0;
const OF_NODE: f64 = 4.0;
/// Steps of the grid over the reach, while the law is estimated.
const STEPS_PER_REACH: f64 = 25.0;

/// A log, its antenna, and where its nodes are searched for.
pub(super) struct SectorSurvey<'a> {
    pub(super) log: &'a ReceptionLog,
    pub(super) scene: &'a AntennaScene,
}

/// Some of the nodes, from which a law is estimated.
pub(super) fn thinned<T: Copy>(nodes: &[T]) -> Vec<T> {
    few(nodes, NODES)
}

/// At most so many of `nodes`, from all along the list.
fn few<T: Copy>(nodes: &[T], most: usize) -> Vec<T> {
    nodes.iter().copied().step_by(nodes.len().div_ceil(most).max(1)).collect()
}

/// The law that was found.
#[derive(Clone, Debug)]
pub(super) struct FoundPattern {
    pub(super) law: PatternLaw,
    pub(super) ripple_sigma_db: f64,
    pub(super) rounds: u32,
    pub(super) is_settled: bool,
    pub(super) nodes: usize,
    /// Receptions with sectors from which noise, ripple and yaw were estimated.
    pub(super) namings: usize,
}

/// A law that was tried at first, with the logarithm of the probability of what the log says: of all nodes, and of each.
#[derive(Clone)]
struct FirstLaw {
    law: PatternLaw,
    value: f64,
    of_nodes: Vec<f64>,
}

impl FirstLaw {
    /// The likelier of two laws; the first one if both are as likely.
    fn or_likelier(self, other: Self) -> Self {
        if other.value > self.value { other } else { self }
    }

    /// By how much the nodes agree that this law is likelier than another one.
    fn agreed_beyond(&self, other: &Self) -> f64 {
        self.of_nodes.iter().zip(&other.of_nodes).map(|(one, other)| (one - other).clamp(-OF_NODE, OF_NODE)).sum()
    }
}

/// A node with what the log says of it, and its box. It keeps what its reports say of directions from law to law.
struct NodeInBox {
    evidence: PatternEvidence,
    within: SearchBox,
}

/// The likelihoods of a law, from the roughest to the finest, which is not blurred.
pub(super) struct Likelihoods {
    law: PatternLaw,
    /// Shared by laws that differ in what names do not depend on.
    of_law: Arc<[LawTables; Blur::COUNT]>,
    tables: Arc<PatternTables>,
    reach_m: f64,
    ways: WaysOfLaw,
}

/// Which ways of signals a law counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum WaysOfLaw {
    /// The straight one in the open. Others are noise.
    Straight,
    /// All among known obstacles, if any are known.
    Known,
}

impl Likelihoods {
    pub(super) fn new(law: PatternLaw, map: &GainMap, ways: WaysOfLaw) -> Self {
        let ripple = law.ripple_db.iter().copied().fold(0.0, f64::max);
        let reach_m = law.reach_m(map.greatest_dbi() + ripple);
        Self { law, of_law: Arc::default(), tables: Arc::new(PatternTables::new()), reach_m, ways }
    }

    /// Those of a law with the same noise and ripple.
    fn of_other(&self, law: PatternLaw, map: &GainMap) -> Self {
        let reach_m = law.reach_m(map.greatest_dbi());
        Self { law, of_law: Arc::clone(&self.of_law), tables: Arc::clone(&self.tables), reach_m, ways: self.ways }
    }

    /// The likelihood with a blur.
    fn blurred<'a>(&'a self, scene: &'a AntennaScene, blur: Blur) -> PatternLikelihood<'a> {
        let likelihood =
            PatternLikelihood::new(&self.law, &scene.map, &self.of_law[blur.level()], blur, &self.tables);
        likelihood.among(self.known_ways(scene))
    }

    /// The ways among known obstacles, if they count.
    fn known_ways<'a>(&self, scene: &'a AntennaScene) -> Option<&'a KnownWays> {
        scene.ways.as_ref().filter(|_| self.ways == WaysOfLaw::Known)
    }

    /// The posterior of a node in a box, with its evidence.
    pub(super) fn places(
        &self,
        survey: &SectorSurvey<'_>,
        node: &(NodeId, SearchBox),
        step_m: f64,
    ) -> Option<(PatternEvidence, CellPosterior)> {
        let evidence = survey.evidence(node, self.reach_m);
        let found = self.posterior(survey.scene, &evidence, &node.1, (step_m, Look::Whole))?;
        Some((evidence, found))
    }

    /// The posterior of a node of which this is known, in a box.
    fn posterior(
        &self,
        scene: &AntennaScene,
        evidence: &PatternEvidence,
        within: &SearchBox,
        (step_m, look): (f64, Look),
    ) -> Option<CellPosterior> {
        let of_step = |width_m: f64| {
            let angle = 0.5 * width_m / (SEEN_FROM * scene.reach_m);
            self.blurred(scene, Blur::of_angle(angle))
        };
        places::find(&of_step, evidence, within, step_m, look)
    }
}

impl SectorSurvey<'_> {
    /// What the log says of a node in a box, for laws by which nodes are heard over so many metres at most.
    fn evidence(&self, (node, within): &(NodeId, SearchBox), reach_m: f64) -> PatternEvidence {
        PatternEvidence::of(self.log, *node, within, reach_m, &self.scene.columns, self.scene.surveyed)
    }

    fn step_m(&self) -> f64 {
        self.scene.reach_m / STEPS_PER_REACH
    }

    /// Elementary operations of finding the places of so many nodes, at most. A report takes one for each of its sectors.
    pub(super) fn operations(&self, nodes: f64) -> f64 {
        let sectors = self.log.sector_reports().count() as f64 / self.log.receptions().len().max(1) as f64;
        nodes * places::most_evaluations(self.scene.heights) * self.log.stops().len() as f64 * sectors.max(1.0)
    }

    /// The work of a fit to these nodes.
    fn work(&self, nodes: &[(NodeId, SearchBox)], name: &'static str) -> Work {
        let some = nodes.len().min(FIRST_NODES) as f64;
        let turns = if self.log.has_sector_snrs() { f64::from(TURN_STEPS + 2) * some } else { 0.0 };
        let each = f64::from(ROUNDS) * (nodes.len() as f64 + turns);
        Work { name, unit: "round", steps: ROUNDS.into(), operations: self.operations(FIRST_LAWS * some + each) }
    }

    /// Some nodes in their boxes, for laws by which nodes are heard over so many metres at most.
    fn in_boxes(&self, nodes: &[(NodeId, SearchBox)], reach_m: f64) -> Vec<NodeInBox> {
        nodes.iter().map(|node| NodeInBox { evidence: self.evidence(node, reach_m), within: node.1 }).collect()
    }

    /// The logarithm of the probability of what the log says of each of some nodes, over all its places.
    fn ln_evidence(&self, likelihoods: &Likelihoods, in_boxes: &mut [NodeInBox], look: Look) -> Vec<f64> {
        let of_node = |NodeInBox { evidence, within }: &mut NodeInBox| {
            let found = likelihoods.posterior(self.scene, evidence, within, (2.0 * self.step_m(), look));
            found.map_or(0.0, |found| found.ln_evidence)
        };
        in_boxes.par_iter_mut().map(of_node).collect()
    }

    /// A law to begin with, for a margin at 1 m (dB).
    fn guess(&self, margin_db: f64) -> PatternLaw {
        PatternLaw::guess(margin_db, self.scene.least_link_db, self.scene.map.sectors())
    }

    /// A law that shares the names of `guess`, with how likely it makes what the log says of some nodes.
    fn tried(&self, guess: &Likelihoods, law: PatternLaw, in_boxes: &mut [NodeInBox], look: Look) -> FirstLaw {
        let of_nodes = self.ln_evidence(&guess.of_other(law.clone(), &self.scene.map), in_boxes, look);
        FirstLaw { law, value: of_nodes.iter().sum(), of_nodes }
    }

    /// The likeliest of some laws that share the names of `guess`. A rough look says which few are worth a whole one.
    fn likeliest(
        &self,
        guess: &Likelihoods,
        laws: impl Iterator<Item = PatternLaw>,
        in_boxes: &mut [NodeInBox],
    ) -> FirstLaw {
        let mut rough: Vec<FirstLaw> = laws.map(|law| self.tried(guess, law, in_boxes, Look::Rough)).collect();
        rough.sort_by(|one, other| other.value.total_cmp(&one.value));
        rough.truncate(WHOLE_LOOKS);
        let whole = rough.into_iter().map(|first| self.tried(guess, first.law, in_boxes, Look::Whole));
        whole.reduce(FirstLaw::or_likelier).expect("there is a law")
    }

    /// The law to begin with: the margin and the yaw under which some nodes are the likeliest.
    fn first(&self, nodes: &[(NodeId, SearchBox)], watch: &dyn Watch) -> Result<PatternLaw, MapError> {
        let usual_db = 20.0 * libm::log10(self.scene.reach_m) - self.scene.map.usual_dbi();
        let widest_db = MARGINS_DB.into_iter().fold(0.0, f64::max);
        let guess = Likelihoods::new(self.guess(usual_db + widest_db), &self.scene.map, WaysOfLaw::Straight);
        let margins = MARGINS_DB.map(|off_db| self.guess(usual_db + off_db));
        let best = self.likeliest(&guess, margins.into_iter(), &mut self.in_boxes(nodes, guess.reach_m));
        watch.check()?;
        let mut in_boxes = self.in_boxes(nodes, guess.of_other(best.law.clone(), &self.scene.map).reach_m);
        // Once more with the stops that all turns are judged by.
        let best = self.tried(&guess, best.law, &mut in_boxes, Look::Whole);
        let of_yaw = |yaw_rad: f64| PatternLaw { yaw_rad, ..best.law.clone() };
        let yaws = (1..YAWS).map(|at| {
            let turn_rad = TAU * f64::from(at) / f64::from(YAWS);
            of_yaw(if turn_rad > PI { turn_rad - TAU } else { turn_rad })
        });
        let mut turned = best.clone().or_likelier(self.likeliest(&guess, yaws, &mut in_boxes));
        watch.check()?;
        // Smaller and smaller turns from the best one.
        let mut half_rad = PI / f64::from(YAWS);
        while half_rad > 0.02 {
            for yaw_rad in [-half_rad, half_rad].map(|turn_rad| turned.law.yaw_rad + turn_rad) {
                turned = turned.or_likelier(self.tried(&guess, of_yaw(yaw_rad), &mut in_boxes, Look::Whole));
            }
            half_rad *= 0.5;
        }
        watch.check()?;
        Ok(if turned.agreed_beyond(&best) > TURNED { turned.law } else { best.law })
    }

    /// The yaw of a law under which some nodes are the likeliest, over all their places. Reports of all sectors hold places so
    /// fast at the yaw of the round before that the antenna would not turn without them.
    fn likeliest_yaw(&self, law: &PatternLaw, ways: WaysOfLaw, nodes: &[(NodeId, SearchBox)]) -> f64 {
        let likelihoods = Likelihoods::new(law.clone(), &self.scene.map, ways);
        let mut in_boxes = self.in_boxes(nodes, likelihoods.reach_m);
        let turned = |yaw_rad: f64| {
            self.tried(&likelihoods, PatternLaw { yaw_rad, ..law.clone() }, &mut in_boxes, Look::Whole).value
        };
        highest(turned, [law.yaw_rad - TURN_RAD, law.yaw_rad + TURN_RAD], TURN_STEPS)
    }

    /// The law of the log, estimated from these of its nodes: expectation maximisation over their places.
    pub(super) fn fit(
        &self,
        nodes: &[(NodeId, SearchBox)],
        name: &'static str,
        watch: &dyn Watch,
    ) -> Result<FoundPattern, MapError> {
        watch.begin(self.work(nodes, name));
        let mut law = self.first(&few(nodes, FIRST_NODES), watch)?;
        let mut found = FoundPattern {
            law: law.clone(),
            ripple_sigma_db: 1.0,
            rounds: 0,
            is_settled: false,
            nodes: nodes.len(),
            namings: 0,
        };
        let is_turned = law.yaw_rad != 0.0;
        let settled_db = if self.log.has_sector_snrs() { SETTLED_OF_REPORTS_DB } else { SETTLED_DB };
        let mut ways = WaysOfLaw::Straight;
        while found.rounds < ROUNDS && !found.is_settled {
            let likelihoods = Likelihoods::new(law.clone(), &self.scene.map, ways);
            let each: Vec<_> = nodes.par_iter().map(|node| likelihoods.places(self, node, self.step_m())).collect();
            watch.check()?;
            let (mut trials, mut namings) = (Trials::default(), Vec::new());
            let finest = likelihoods.blurred(self.scene, Blur::NONE);
            for (evidence, places) in each.iter().flatten() {
                let sample = places.sample(SAMPLE);
                let whole_weight = 1.0 / sample.len().max(1) as f64;
                let likeliest = places.refined(&finest, evidence);
                for listener in &evidence.listeners {
                    for &place in &sample {
                        let Prospect { decades, gain_db, level_db, open } = finest.prospect(listener, place);
                        trials.packets.push(PacketTrial {
                            gain_db,
                            decades,
                            received: f64::from(listener.received),
                            sent: f64::from(listener.received + listener.missed),
                            weight: whole_weight,
                        });
                        if matches!(listener.heard, SectorsHeard::Nothing) {
                            continue;
                        }
                        let weight = whole_weight * open;
                        trials.levels.extend(level_db.map(|level_db| LevelTrial { level_db, decades, weight }));
                        let (stop, robot, heard) = (listener.stop, listener.pose, &listener.heard);
                        if matches!(heard, SectorsHeard::Named(..)) {
                            namings.push(Naming { place, stop, robot, heard, whole_weight, weight, level_db: 0.0 });
                        }
                    }
                    // A report tells the antenna more than a place that stands for many: its noise would be that of the places.
                    if let SectorsHeard::Reported(_) = &listener.heard {
                        let Prospect { level_db, open, .. } = finest.prospect(listener, likeliest);
                        let (stop, robot, heard) = (listener.stop, listener.pose, &listener.heard);
                        namings.push(Naming {
                            place: likeliest,
                            stop,
                            robot,
                            heard,
                            whole_weight: 1.0,
                            weight: open,
                            level_db: level_db.unwrap_or(0.0),
                        });
                    }
                }
            }
            let before = law.clone();
            hearing::improve(&mut law, &trials, &likelihoods.tables.normal);
            // With reports, places hold the turn: it is sought over all places below.
            let is_by_names = is_turned && !self.log.has_sector_snrs();
            let turn = if is_by_names { TurnOfRound::Improved } else { TurnOfRound::Kept };
            let scenery = Scenery { map: &self.scene.map, ways: likelihoods.known_ways(self.scene) };
            naming::improve(&mut law, scenery, &namings, turn, &mut found.ripple_sigma_db);
            if is_turned && self.log.has_sector_snrs() {
                law.yaw_rad = self.likeliest_yaw(&law, ways, &few(nodes, TURN_NODES));
            }
            found.rounds += 1;
            let is_named = |naming: &&Naming<'_>| matches!(naming.heard, SectorsHeard::Named(..));
            let named = namings.iter().filter(is_named).count();
            found.namings = namings.len() - named + named / SAMPLE;
            found.is_settled = law.change_db(&before) < settled_db;
            if self.scene.ways.is_some()
                && ways == WaysOfLaw::Straight
                && (found.is_settled || found.rounds >= OPEN_ROUNDS)
            {
                // What comes by known ways is no addition any more.
                law.reports = ReportLaw::guess();
                (ways, found.is_settled) = (WaysOfLaw::Known, false);
            }
            watch.advance(1);
        }
        found.law = law;
        Ok(found)
    }
}
