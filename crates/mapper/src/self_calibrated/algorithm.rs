//! The self-calibrated map.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::SettingError;

use super::absorption::AbsorptionMap;
use super::beliefs::{Beliefs, Progress};
use super::counts::Counts;
use super::model::{CalibratedCurve, Model, Sums};
use super::posterior::{Belief, Heights, Obstacles, Surroundings};
use super::settings::{ObstacleKnowledge, SelfCalibratedConfig, Settings};
use super::shadows::Shadows;
use super::start::Start;
use super::tomography::Tomography;
use crate::{Estimate, EstimateKind, TopologyMap};

/// Grid steps over the range that the log shows, if no step is set.
const STEPS_PER_RANGE: f64 = 60.0;
/// The first stage has steps of this share of the range, at most.
const COARSEST: f64 = 0.12;
/// Rounds of the first stage before the stops may differ.
const EQUAL_ROUNDS: u32 = 2;
/// A stage that is not the last ends when a round moves the nodes by less than this share of its step on average.
const SETTLED: f64 = 0.05;
/// The last one, if no tolerance is set.
const TOLERANCE: f64 = 0.02;
/// Rounds of a stage that is not the last, at most.
const STAGE_ROUNDS: u32 = 5;
/// Width of a cell in steps of the last stage.
const CELL_STEPS: f64 = 2.0;
/// Rounds of tomography the first time, and each time after.
const FIRST_IMPROVEMENT: usize = 40;
const IMPROVEMENT: usize = 15;

/// The self-calibrated map.
#[derive(Clone, Debug, PartialEq)]
pub struct SelfCalibrated {
    settings: Settings,
}

/// A self-calibrated map with all that was estimated beside it.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// The map, with a covariance of each node.
    pub map: TopologyMap,
    /// How likely a packet is received over a clear link at a stop of average efficiency; `None` if nothing was heard.
    pub curve: Option<CalibratedCurve>,
    /// Efficiency of each stop: the share of the packets that it receives of those that reach it.
    pub efficiency: Vec<f64>,
    /// What stands in the way; `None` if it was not asked for, or explains nothing.
    pub obstacles: Option<AbsorptionMap>,
    /// Rounds of positions, curve and obstacles.
    pub rounds: u32,
    /// Whether the last round moved the nodes by less than the tolerance on average. A log too poor to tell a curve
    /// is mapped with a guess, and converges at once.
    pub converged: bool,
}

/// A map in the making.
struct Round<'a> {
    counts: &'a Counts<'a>,
    beliefs: Beliefs,
    model: Model,
    sums: Sums,
    heights: Heights,
    tomography: Option<Tomography>,
    shadows: Shadows,
    /// Whether the absorption found is used.
    is_obstructed: bool,
    rounds: u32,
    vertices: u64,
}

impl SelfCalibrated {
    /// The algorithm's name in tables and topics.
    pub const NAME: &'static str = "self-calibrated";

    /// The map of the nodes in `log`, computed on the current rayon pool; the same bits for any number of threads.
    /// Nodes that were never heard are not placed.
    #[must_use]
    pub fn map(&self, log: &ReceptionLog) -> TopologyMap {
        self.calibrate(log).map
    }

    /// The map with all that was estimated beside it. About 30 rounds, each linear in the nodes and in the stops in
    /// range of a node.
    #[must_use]
    pub fn calibrate(&self, log: &ReceptionLog) -> Calibration {
        let mut map = TopologyMap {
            algorithm: Self::NAME,
            estimates: vec![None; log.node_count()],
            grid_step_m: self.settings.grid_step_m,
            vertices_evaluated: 0,
        };
        let Some(start) = Start::of(log) else {
            let efficiency = vec![1.0; log.stops().len()];
            return Calibration { map, curve: None, efficiency, obstacles: None, rounds: 0, converged: true };
        };
        let step_m = self.settings.grid_step_m.unwrap_or(start.range_m / STEPS_PER_RANGE);
        let counts = Counts::new(log, start.range_m);
        let (round, converged) = self.run(&counts, &start, step_m);
        for belief in &round.beliefs.nodes {
            let position = match self.settings.estimate {
                EstimateKind::Argmax => belief.mode,
                EstimateKind::PosteriorMean => belief.mean,
            };
            map.estimates[belief.node.index()] = Some(Estimate {
                position,
                log_likelihood: belief.highest,
                ties: 1,
                covariance: Some(belief.covariance),
                infeasible: false,
            });
        }
        map.grid_step_m = Some(step_m);
        map.vertices_evaluated = round.vertices;
        Calibration {
            map,
            curve: Some(round.model.curve()),
            efficiency: round.model.efficiencies().to_vec(),
            obstacles: round.tomography.filter(|_| round.is_obstructed).map(|tomography| tomography.map),
            rounds: round.rounds,
            converged,
        }
    }

    /// From coarse to fine. Returns whether the last stage has converged.
    fn run<'a>(&self, counts: &'a Counts<'a>, start: &Start, step_m: f64) -> (Round<'a>, bool) {
        let heights = heights(counts.log, self.settings.z_range_m);
        let model = Model::new(start.range_m, counts.log.stops().len());
        let place = |position: Position| Position { z_m: heights.clamp(position.z_m), ..position };
        let belief = |&(node, middle)| {
            let mean = place(middle);
            Belief { node, mean, mode: mean, highest: f64::NEG_INFINITY, covariance: [[0.0; 3]; 3] }
        };
        let nodes: Vec<Belief> = start.nodes.iter().map(belief).collect();
        let mut round = Round {
            counts,
            beliefs: Beliefs::new(nodes, model.clear.len()),
            sums: model.sums(),
            model,
            heights,
            tomography: None,
            shadows: Shadows::default(),
            is_obstructed: false,
            rounds: 0,
            vertices: 0,
        };
        let doublings = (libm::log2(COARSEST * start.range_m / step_m)).floor().clamp(0.0, 30.0);
        let coarsest_m = step_m * libm::exp2(doublings);
        let tolerance_m = self.settings.tolerance_m.unwrap_or(TOLERANCE * step_m);
        self.stage(&mut round, coarsest_m, SETTLED * coarsest_m, start.is_rich);
        if !start.is_rich {
            let mut step = coarsest_m;
            while step > 1.5 * step_m {
                step *= 0.5;
                self.stage(&mut round, step, f64::INFINITY, false);
            }
            return (round, true);
        }
        if self.settings.obstacles != ObstacleKnowledge::None {
            let cell_m = start.range_m * super::tomography::knob("CELL", 0.05);
            let nodes = &round.beliefs.nodes;
            let slack_m = coarsest_m;
            round.tomography = Some(Tomography::new(counts.log, nodes, cell_m, slack_m, self.settings.obstacles));
        }
        let mut stage_step_m = if doublings > 0.0 { 0.5 * coarsest_m } else { coarsest_m };
        while stage_step_m > 1.5 * step_m {
            self.stage(&mut round, stage_step_m, SETTLED * stage_step_m, true);
            stage_step_m *= 0.5;
        }
        let converged = self.stage(&mut round, step_m, tolerance_m, true);
        (round, converged)
    }

    /// Rounds at one grid step until they move the nodes by less than `tolerance_m` on average. Returns whether they
    /// do.
    fn stage(&self, round: &mut Round<'_>, step_m: f64, tolerance_m: f64, fits: bool) -> bool {
        let first = round.rounds;
        let is_last = round.tomography.is_some() && step_m < 1.0; let _ = is_last;
        round.look_for_obstacles();
        while round.rounds < self.settings.max_rounds {
            if round.rounds > first && round.rounds < first + super::tomography::knob("FZ", 100.0) as u32 { round.improve_obstacles(IMPROVEMENT); }
            let progress = round.refine(step_m);
            if std::env::var("DBG").is_ok() { println!("step {step_m:.3} round {} shift {:.4} obs {}", round.rounds, progress.shift_m, round.is_obstructed); }
            if fits {
                round.fit(round.rounds > EQUAL_ROUNDS);
            }
            if progress.shift_m < tolerance_m {
                return true;
            }
        }
        false
    }
}

impl Round<'_> {
    fn refine(&mut self, step_m: f64) -> Progress {
        let map = self.tomography.as_ref().filter(|_| self.is_obstructed).map(|tomography| &tomography.map);
        if let Some(map) = map {
            self.shadows.trace(map, self.counts.log.stops(), self.model.range_m());
        }
        let surroundings = Surroundings {
            counts: self.counts,
            model: &self.model,
            obstacles: map.map(|map| Obstacles { map, shadows: &self.shadows }),
            heights: self.heights,
            step_m,
        };
        let progress = self.beliefs.refine(&surroundings, &mut self.sums);
        self.rounds += 1;
        self.vertices += progress.vertices;
        progress
    }

    fn fit(&mut self, stops_differ: bool) {
        if !stops_differ {
            self.sums.stops.fill([0.0; 2]);
        }
        self.model.fit(&self.sums);
    }

    /// Takes obstacles into account if they explain the log.
    fn look_for_obstacles(&mut self) {
        let Some(tomography) = &mut self.tomography else { return };
        tomography.draw(self.counts, &self.beliefs.nodes, &self.model);
        if !self.is_obstructed {
            self.is_obstructed = tomography.is_warranted(&self.model, FIRST_IMPROVEMENT);
        }
        if self.is_obstructed {
            tomography.improve(&self.model, FIRST_IMPROVEMENT);
        }
    }

    fn improve_obstacles(&mut self, rounds: usize) {
        if let Some(tomography) = self.tomography.as_mut().filter(|_| self.is_obstructed) {
            tomography.draw(self.counts, &self.beliefs.nodes, &self.model);
            tomography.improve(&self.model, rounds);
        }
    }
}

impl TryFrom<SelfCalibratedConfig> for SelfCalibrated {
    type Error = SettingError;

    fn try_from(config: SelfCalibratedConfig) -> Result<Self, SettingError> {
        Settings::try_from(config).map(|settings| Self { settings })
    }
}

/// The heights at which nodes may be.
fn heights(log: &ReceptionLog, z_range_m: Option<[f64; 2]>) -> Heights {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for stop in log.stops() {
        low = low.min(stop.position.z_m);
        high = high.max(stop.position.z_m);
    }
    match z_range_m {
        Some([low, high]) if low < high => Heights::Between(low, high),
        Some([level, _]) => Heights::Level(level),
        None if low < high => Heights::Between(f64::NEG_INFINITY, f64::INFINITY),
        None => Heights::Level(low),
    }
}
