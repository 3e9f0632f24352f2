//! The law of a log, with the places of its nodes integrated out.

use std::f64::consts::{PI, TAU};

use rayon::prelude::*;
use sextant_channel::ReceptionLog;
use sextant_kernel::{NodeId, Watch, Work};

use super::evidence::{Evidence, Heard, Likelihood};
use super::gain_map::{GainMap, Names};
use super::hearing::{self, Trial};
use super::law::PatternLaw;
use super::naming::{self, Naming};
use super::places::{self, Places};
use crate::MapError;
use crate::log_facts::search_box::SearchBox;
use crate::numerics::normal::Normal;

/// How much rougher likelihoods are than the finest one (dB).
const BLURS_DB: [f64; 3] = [3.0, 1.0, 0.0];
/// The law is estimated from at most so many nodes, and begun with so many.
const NODES: usize = 72;
const FIRST_NODES: usize = 20;
/// Places that stand for the posterior of a node.
const SAMPLE: usize = 12;
/// Most rounds.
const ROUNDS: u32 = 40;
/// The law has settled if nothing changes by more than this in a round (dB, degrees).
const SETTLED_DB: f64 = 0.1;
/// Margins that are tried at first, from the usual one (dB), and so many yaws.
const MARGINS_DB: [f64; 7] = [0.0, -4.0, 4.0, -8.0, 8.0, -12.0, 12.0];
const YAWS: u32 = 24;
/// An antenna is turned from what the log says only if this makes the log likelier by so much (logarithm).
const TURNED: f64 = 10.0;
/// Steps of the grid over the reach, while the law is estimated.
const STEPS_PER_REACH: f64 = 40.0;

/// A log, its antenna, and where its nodes are searched for.
pub(super) struct Survey<'a> {
    pub(super) log: &'a ReceptionLog,
    pub(super) map: &'a GainMap,
    /// The place of each sector among the gains, by its identity.
    pub(super) columns: &'a [Option<usize>],
    /// How far nodes are heard, as the log says without a model (m).
    pub(super) reach_m: f64,
}

/// The law that was found.
#[derive(Clone, Debug)]
pub(super) struct Found {
    pub(super) law: PatternLaw,
    pub(super) ripple_sigma_db: f64,
    pub(super) rounds: u32,
    pub(super) is_settled: bool,
    pub(super) nodes: usize,
    /// Receptions with sectors from which noise, ripple and yaw were estimated.
    pub(super) namings: usize,
}

/// The likelihoods of a law, from the roughest to the finest.
pub(super) struct Likelihoods {
    law: PatternLaw,
    names: [Names; 3],
    normal: Normal,
    reach_m: f64,
}

impl Likelihoods {
    pub(super) fn new(law: PatternLaw, map: &GainMap) -> Self {
        let names = BLURS_DB.map(|blur_db| map.names(&law, blur_db));
        let ripple = law.ripple_db.iter().copied().fold(0.0, f64::max);
        let reach_m = law.reach_m(map.greatest_dbi() + ripple);
        Self { law, names, normal: Normal::new(), reach_m }
    }

    /// The posterior of a node in a box, with its evidence.
    pub(super) fn places(
        &self,
        survey: &Survey<'_>,
        (node, within): &(NodeId, SearchBox),
        step_m: f64,
    ) -> Option<(Evidence, Places)> {
        let evidence = Evidence::of(survey.log, *node, within, self.reach_m, survey.columns);
        let each =
            [0, 1, 2].map(|at| Likelihood::new(&self.law, survey.map, (&self.names[at], BLURS_DB[at]), &self.normal));
        let found = places::find(&each, &evidence, within, step_m)?;
        Some((evidence, found))
    }
}

impl Survey<'_> {
    fn step_m(&self) -> f64 {
        self.reach_m / STEPS_PER_REACH
    }

    /// The logarithm of the probability of what the log says of some nodes, over all their places.
    fn ln_evidence(&self, law: PatternLaw, nodes: &[(NodeId, SearchBox)]) -> f64 {
        let likelihoods = Likelihoods::new(law, self.map);
        let of_node = |node: &(NodeId, SearchBox)| {
            likelihoods.places(self, node, 2.0 * self.step_m()).map_or(0.0, |(_, found)| found.ln_evidence)
        };
        nodes.par_iter().map(of_node).collect::<Vec<f64>>().iter().sum()
    }

    /// The law to begin with: the margin and the yaw under which some nodes are the likeliest.
    fn first(&self, nodes: &[(NodeId, SearchBox)], watch: &dyn Watch) -> Result<PatternLaw, MapError> {
        let usual_db = 20.0 * libm::log10(self.reach_m) - self.map.usual_dbi();
        let mut best = (PatternLaw::guess(usual_db, self.map.sectors()), f64::NEG_INFINITY);
        for off_db in MARGINS_DB {
            watch.check()?;
            let law = PatternLaw::guess(usual_db + off_db, self.map.sectors());
            let value = self.ln_evidence(law.clone(), nodes);
            if value > best.1 {
                best = (law, value);
            }
        }
        let mut turned = best.clone();
        for at in 1..YAWS {
            watch.check()?;
            let turn_rad = TAU * f64::from(at) / f64::from(YAWS);
            let yaw_rad = if turn_rad > PI { turn_rad - TAU } else { turn_rad };
            let law = PatternLaw { yaw_rad, ..best.0.clone() };
            let value = self.ln_evidence(law.clone(), nodes);
            if value > turned.1 {
                turned = (law, value);
            }
        }
        // Smaller and smaller turns from the best one.
        let mut half_rad = PI / f64::from(YAWS);
        while half_rad > 0.02 {
            for yaw_rad in [turned.0.yaw_rad - half_rad, turned.0.yaw_rad + half_rad] {
                watch.check()?;
                let law = PatternLaw { yaw_rad, ..best.0.clone() };
                let value = self.ln_evidence(law.clone(), nodes);
                if value > turned.1 {
                    turned = (law, value);
                }
            }
            half_rad *= 0.5;
        }
        Ok(if turned.1 > best.1 + TURNED { turned.0 } else { best.0 })
    }

    /// The law of the log, estimated from some of its `heard` nodes: expectation maximisation over their places.
    pub(super) fn fit(
        &self,
        heard: &[(NodeId, SearchBox)],
        name: &'static str,
        watch: &dyn Watch,
    ) -> Result<Found, MapError> {
        watch.begin(Work { name, unit: "round", steps: u64::from(ROUNDS), operations: 0.0 });
        let thinned = |most: usize| -> Vec<(NodeId, SearchBox)> {
            heard.iter().copied().step_by(heard.len().div_ceil(most).max(1)).collect()
        };
        let mut law = self.first(&thinned(FIRST_NODES), watch)?;
        let nodes = thinned(NODES);
        let normal = Normal::new();
        let mut found = Found {
            law: law.clone(),
            ripple_sigma_db: 1.0,
            rounds: 0,
            is_settled: false,
            nodes: nodes.len(),
            namings: 0,
        };
        while found.rounds < ROUNDS && !found.is_settled {
            let likelihoods = Likelihoods::new(law.clone(), self.map);
            let each: Vec<_> = nodes.par_iter().map(|node| likelihoods.places(self, node, self.step_m())).collect();
            watch.check()?;
            let (mut trials, mut namings) = (Vec::new(), Vec::new());
            let finest = Likelihood::new(&law, self.map, (&likelihoods.names[2], 0.0), &normal);
            for (evidence, places) in each.iter().flatten() {
                let sample = places.sample(SAMPLE);
                let weight = 1.0 / sample.len().max(1) as f64;
                for listener in &evidence.listeners {
                    for &place in &sample {
                        let sight = finest.sight(place, listener.place);
                        trials.push(Trial {
                            gain_db: finest.names.top_dbi(sight.cell),
                            distance_m: sight.distance_m,
                            received: f64::from(listener.received),
                            sent: f64::from(listener.received + listener.missed),
                            weight,
                        });
                        if !matches!(listener.heard, Heard::Nothing) {
                            namings.push(Naming { place, stop: listener.place, heard: &listener.heard, weight });
                        }
                    }
                }
            }
            let before = law.clone();
            hearing::improve(&mut law, &trials, &normal);
            naming::improve(&mut law, self.map, &namings, &mut found.ripple_sigma_db);
            found.rounds += 1;
            found.namings = namings.len() / SAMPLE;
            found.is_settled = law.change_db(&before) < SETTLED_DB;
            watch.advance(1);
        }
        found.law = law;
        Ok(found)
    }
}
