//! The law of links, estimated from the log itself.

use rayon::prelude::*;
use sextant_channel::Position;
use sextant_kernel::{Interrupted, Watch};

use super::hearing::Hearing;
use super::law::{Law, PARAMETERS};
use super::likelihood::MarginSums;
use super::links::PlaceLinks;
use super::outages::{NodeAndPlace, Outages};
use super::posterior::{ExpectedMargins, HeardLinks, PriorGrid, log_evidence};
use super::window::LinkWindow;

/// The law is estimated from at most so many nodes, at most so many of their links, and on so many vertices, in the plane
/// and in space.
const NODES: usize = 28;
const LINKS: usize = 90;
const VERTICES: [f64; 2] = [320.0, 640.0];
/// Lengths of the steps of the search for the law, and most rounds with each.
const STEPS: [f64; 3] = [1.0, 0.5, 0.25];
const ROUNDS: [u32; 3] = [8, 6, 6];
/// A step back from one that lost so many times what a step off the best value costs would gain nothing, by a parabola twice.
const SURELY: f64 = 1.5;
/// The evidence must grow by this much for each node, or the search has ended.
const GAIN: f64 = 1e-2;
/// How much more evidence a law of fewer parameters must have to be believed (nats).
const SIMPLER: f64 = 5.0;

/// The laws among which one is sought.
#[derive(Clone, Copy, Debug)]
enum LawFamily {
    /// Laws of real links: nodes have offsets, slopes and directions of their own, and places share shadowing. A margin has so
    /// many decibels, if the log has strengths.
    Real { fading_db: Option<f64> },
    /// Nodes have nothing of their own.
    AlikeNodes,
    /// Laws of textbooks: nodes have nothing of their own, and the shadowing of each link is independent.
    Independent,
}

impl LawFamily {
    /// The numbers of the parameters that are free.
    fn parameters(self) -> &'static [usize] {
        match self {
            Self::Real { .. } => &[0, 1, 2, 3, 4, 5, 6, 7],
            Self::AlikeNodes => &[0, 1, 2, 4],
            Self::Independent => &[0, 1, 2],
        }
    }

    fn log_prior(self, law: &Law) -> f64 {
        match self {
            Self::Real { fading_db } => law.log_prior(fading_db),
            Self::AlikeNodes | Self::Independent => 0.0,
        }
    }
}

/// The law that was found, and whether it settled.
#[derive(Clone, Debug)]
pub(super) struct FoundLaw {
    /// The law of highest evidence.
    pub(super) law: Law,
    /// The law by which nodes are placed: that one, or one between it and usual links.
    pub(super) placing: Law,
    pub(super) outages: Outages,
    pub(super) rounds: u32,
    pub(super) settled: bool,
    /// Where the law places the nodes that it was estimated from (m).
    pub(super) places: Vec<Position>,
}

/// A node that the law is estimated from.
struct NodeSample<'a> {
    evidence: HeardLinks<'a>,
    grid: PriorGrid,
}

/// The number of the margin among the parameters of a law, and lengths of the steps of the search for it alone.
const MARGIN: usize = 0;
const LEVELS: [f64; 4] = [4.0, 2.0, 1.0, 0.5];
/// Links are at least so long (m).
const LEAST_LINK_M: f64 = 1e-3;

/// Number of steps of the work that [`find`] tells.
pub(super) const WORK: u64 = 2;

/// The law of highest evidence, with the places of nodes integrated out (type II maximum likelihood): no place has to be
/// known for it. Outages are estimated with it. Where the log has strengths, the law by which nodes are placed is shrunk toward
/// that of usual links, so that the log has `own_share` in it. The search begins at the `first` law, if one is known: it is near.
pub(super) fn find(
    links: &PlaceLinks,
    window: &LinkWindow<'_>,
    is_spatial: bool,
    hearing: &Hearing,
    (first, own_share): (Option<Law>, f64),
    watch: &dyn Watch,
) -> Result<FoundLaw, Interrupted> {
    let thinned = thinned(links);
    let usual = Outages::start(links, hearing.receiver.is_some());
    let mut samples = samples(&thinned, window, is_spatial, (hearing, &usual));
    let fading_db = hearing.receiver.map(|receiver| receiver.fading_db);
    let family = LawFamily::Real { fading_db };
    let start = start(&thinned, &samples);
    let law = first.map_or(start, |first| first.at(start.distance_m));
    let scales: [&[usize]; 2] = if first.is_some() { [&[1], &[1, 2]] } else { [&[0, 1], &[0, 1, 2]] };
    let mut found = FoundLaw { law, placing: law, outages: usual, rounds: 0, settled: false, places: Vec::new() };
    for (pass, scales) in scales.into_iter().enumerate() {
        climb(&samples, &mut found, family, scales, watch)?;
        let law = found.law;
        let told: Vec<(Position, (ExpectedMargins, Vec<NodeAndPlace>))> = samples
            .par_iter()
            .map(|NodeSample { evidence, grid }| {
                let posterior = evidence.posterior(&law, grid, &mut Vec::new());
                let expected = evidence.expected(&law, grid, &posterior, &thinned);
                let pairs = evidence.pairs(&expected, hearing);
                (posterior.mean, (expected, pairs))
            })
            .collect();
        let (places, told): (Vec<_>, Vec<_>) = told.into_iter().unzip();
        found.places = places;
        let all: Vec<NodeAndPlace> = told.iter().flat_map(|(_, pairs)| pairs).copied().collect();
        found.outages = found.outages.estimated(&all);
        let outages = &found.outages;
        samples.par_iter_mut().zip(told).for_each(|(NodeSample { evidence, grid }, (expected, pairs))| {
            evidence.set_outages(outages, &pairs);
            evidence.refine(&law, expected, &thinned, hearing);
            if pass == 0 {
                let posterior = evidence.posterior(&law, grid, &mut Vec::new());
                *grid = evidence.mixed_grid(window, grid, &posterior, VERTICES[usize::from(is_spatial)]);
            }
        });
        watch.advance(1);
    }
    if let Some(simple) = simple_law(&samples, &found, watch)? {
        return Ok(simple);
    }
    found.placing = match fading_db {
        Some(fading_db) if own_share < 1.0 => {
            let shrunk = found.law.shrunk(own_share, fading_db, median_link_m(&thinned));
            levelled(&samples, shrunk, family)
        }
        _ => found.law,
    };
    Ok(found)
}

/// Logarithm of the highest evidence of a law if nodes are in `window`. The search begins at the `first` law, if one is known.
/// Evidences of several windows compare, because links are weighed as they are before any place is known.
pub(super) fn log_evidence_in(
    links: &PlaceLinks,
    window: &LinkWindow<'_>,
    is_spatial: bool,
    hearing: &Hearing,
    first: Option<Law>,
    watch: &dyn Watch,
) -> Result<f64, Interrupted> {
    let thinned = thinned(links);
    let outages = Outages::start(links, hearing.receiver.is_some());
    let samples = samples(&thinned, window, is_spatial, (hearing, &outages));
    let start = start(&thinned, &samples);
    let law = first.map_or(start, |first| first.at(start.distance_m));
    let family = LawFamily::Real { fading_db: hearing.receiver.map(|receiver| receiver.fading_db) };
    let mut found = FoundLaw { law, placing: law, outages, rounds: 0, settled: false, places: Vec::new() };
    climb(&samples, &mut found, family, &[0, 1], watch)
}

/// The law of highest evidence among those of fewer parameters, if one of independent links has surely more than the law that was
/// `found`. Real links have what it lacks, and their logs refute it; where it holds, it places nodes better.
fn simple_law(
    samples: &[NodeSample<'_>],
    found: &FoundLaw,
    watch: &dyn Watch,
) -> Result<Option<FoundLaw>, Interrupted> {
    // These families have no prior, so that the score of a law is its evidence.
    let of_family = |family: LawFamily, law: Law| {
        let mut simple = FoundLaw { law, ..found.clone() };
        let evidence = climb(samples, &mut simple, family, &[0, 1, 2], watch)?;
        simple.placing = simple.law;
        Ok::<_, Interrupted>((evidence, simple))
    };
    let alike = found.law.of_alike_nodes();
    let (most, independent) = of_family(LawFamily::Independent, Law { shared: 0.0, ..alike })?;
    let sums = sums(samples, |NodeSample { evidence, grid }, _| evidence.sums(&found.law, grid));
    if most < score(samples, &sums, &found.law, LawFamily::Independent) + SIMPLER {
        return Ok(None);
    }
    let (evidence, alike) = of_family(LawFamily::AlikeNodes, alike)?;
    Ok(Some(if evidence > most { alike } else { independent }))
}

/// The nodes of `thinned` links, with where they can be.
fn samples<'a>(
    thinned: &'a PlaceLinks,
    window: &LinkWindow<'_>,
    is_spatial: bool,
    heard: (&Hearing, &Outages),
) -> Vec<NodeSample<'a>> {
    let of_node = |node| {
        let evidence = HeardLinks::new(node, thinned, window, heard, true);
        let grid = evidence.grid(window, VERTICES[usize::from(is_spatial)]);
        NodeSample { evidence, grid }
    };
    thinned.nodes.par_iter().map(of_node).collect()
}

/// The median distance from a node's middle to the places that heard it (m).
fn median_link_m(links: &PlaceLinks) -> f64 {
    let mut lengths_m: Vec<f64> = Vec::new();
    for node in &links.nodes {
        let middle = node.middle(&links.places);
        let heard = node.links.iter().filter(|link| link.received > 0);
        lengths_m.extend(heard.map(|link| links.places[link.place].distance_m(middle)));
    }
    lengths_m.sort_by(f64::total_cmp);
    lengths_m.get(lengths_m.len() / 2).copied().unwrap_or(1.0).max(LEAST_LINK_M)
}

/// The law with the margin of highest evidence.
fn levelled(samples: &[NodeSample<'_>], mut law: Law, family: LawFamily) -> Law {
    let sums = sums(samples, |NodeSample { evidence, grid }, _| evidence.sums(&law, grid));
    let mut best = score(samples, &sums, &law, family);
    for step in LEVELS {
        for sign in [1.0, -1.0] {
            while let Some(moved) = law.moved(MARGIN, sign * step) {
                let score = score(samples, &sums, &moved, family);
                if score <= best {
                    break;
                }
                (best, law) = (score, moved);
            }
        }
    }
    law
}

/// A few of the nodes and, of those, every other link or fewer, if there are many.
fn thinned(links: &PlaceLinks) -> PlaceLinks {
    let every = links.nodes.len().div_ceil(NODES).max(1);
    // Nodes that were heard at few places say little.
    let mut nodes: Vec<_> = links.nodes.iter().step_by(every).cloned().collect();
    for node in &mut nodes {
        let kept = node.links.len().div_ceil(LINKS).max(1);
        let mut number = node.heard.node.index();
        node.links.retain(|_| {
            number += 1;
            number % kept == 0
        });
    }
    PlaceLinks { places: links.places.clone(), nodes, reach_m: links.reach_m }
}

/// A law that fits the centroids of the places weighted by the sixth power of what they received, or by strength.
fn start(links: &PlaceLinks, samples: &[NodeSample<'_>]) -> Law {
    let mut points: Vec<(f64, f64, f64)> = Vec::new();
    for sample in samples {
        let node = sample.evidence.node();
        let middle = node.middle(&links.places);
        for (link, site) in node.links.iter().zip(&sample.evidence.sites) {
            let distance_m = links.places[link.place].distance_m(middle).max(0.05 * links.reach_m);
            points.push((libm::log(distance_m), site.margin, 1.0 / (1.0 + site.variance)));
        }
    }
    let weight: f64 = points.iter().map(|&(_, _, weight)| weight).sum::<f64>().max(1e-9);
    let x = points.iter().map(|&(x, _, weight)| x * weight).sum::<f64>() / weight;
    let y = points.iter().map(|&(_, y, weight)| y * weight).sum::<f64>() / weight;
    let xx = points.iter().map(|&(at, _, weight)| (at - x) * (at - x) * weight).sum::<f64>();
    let xy = points.iter().map(|&(at, up, weight)| (at - x) * (up - y) * weight).sum::<f64>();
    let slope = if xx > 1e-9 { (-xy / xx).clamp(0.8, 6.0) } else { 1.7 };
    let distance_m = if points.is_empty() { 1.0 } else { libm::exp(x) };
    Law {
        margin: y.clamp(-6.0, 30.0),
        distance_m,
        slope,
        shadowing: 1.0,
        shared: 0.5,
        correlation_m: distance_m,
        offset: 0.4,
        direction: 0.3,
        slope_spread: 0.1,
    }
}

/// Moves one parameter after the other as long as the evidence grows. Returns the score of the law that it found.
fn climb(
    samples: &[NodeSample<'_>],
    found: &mut FoundLaw,
    family: LawFamily,
    scales: &[usize],
    watch: &dyn Watch,
) -> Result<f64, Interrupted> {
    let mut sums = sums(samples, |NodeSample { evidence, grid }, _| evidence.sums(&found.law, grid));
    let mut best = score(samples, &sums, &found.law, family);
    let least = GAIN * samples.len() as f64;
    found.settled = false;
    let mut courses = [ParameterCourse::default(); PARAMETERS];
    let parameters = family.parameters();
    for &scale in scales {
        let step = STEPS[scale];
        for _ in 0..ROUNDS[scale] {
            let before = best;
            for (&number, course) in parameters.iter().zip(&mut courses) {
                let mut losses = [None; 2];
                for (trial, sign) in [course.sign(), -course.sign()].into_iter().enumerate() {
                    watch.check()?;
                    if trial == 1 && course.is_vain(losses[0], step) {
                        break;
                    }
                    let Some(law) = found.law.moved(number, sign * step) else { continue };
                    let moved = Law::is_of_covariance(number).then(|| {
                        self::sums(samples, |NodeSample { evidence, grid }, number| {
                            evidence.sums_under(&law, grid, &sums[number])
                        })
                    });
                    let score = score(samples, moved.as_ref().unwrap_or(&sums), &law, family);
                    if score > best {
                        (best, found.law) = (score, law);
                        sums = moved.unwrap_or(sums);
                        course.is_backward = sign < 0.0;
                        break;
                    }
                    losses[trial] = Some(best - score);
                }
                if let [Some(forward), Some(backward)] = losses {
                    course.take(forward, backward, step);
                }
            }
            found.rounds += 1;
            found.settled = best - before < least;
            if found.settled {
                break;
            }
        }
    }
    Ok(best)
}

/// What the search knows of a parameter.
#[derive(Clone, Copy, Default)]
struct ParameterCourse {
    /// Whether it is better moved down than up.
    is_backward: bool,
    /// What a step of 1 off the best value costs, if steps to both sides were tried in vain.
    curvature: Option<f64>,
}

impl ParameterCourse {
    /// Where a parameter moved last time, it goes on in that direction first.
    fn sign(&self) -> f64 {
        if self.is_backward { -1.0 } else { 1.0 }
    }

    /// Whether a step backward is in vain if one forward has this loss: the parabola through both falls.
    fn is_vain(&self, forward: Option<f64>, step: f64) -> bool {
        self.curvature.zip(forward).is_some_and(|(curvature, loss)| loss < SURELY * curvature * step * step)
    }

    /// Takes what a step forward and one backward lost.
    fn take(&mut self, forward: f64, backward: f64, step: f64) {
        self.curvature = Some(0.5 * (forward + backward) / (step * step));
        self.is_backward ^= backward < forward;
    }
}

/// The sums of each sample, which come from it and its number.
fn sums(samples: &[NodeSample<'_>], of: impl Fn(&NodeSample<'_>, usize) -> MarginSums + Sync) -> Vec<MarginSums> {
    samples.par_iter().enumerate().map(|(number, sample)| of(sample, number)).collect()
}

/// Logarithm of the evidence of all samples, with the `sums` of each, and of the prior density of the law.
fn score(samples: &[NodeSample<'_>], sums: &[MarginSums], law: &Law, family: LawFamily) -> f64 {
    let evidences: Vec<f64> = samples
        .par_iter()
        .zip(sums)
        .map_init(Vec::new, |scratch, (NodeSample { grid, .. }, sums)| log_evidence(law, grid, sums, scratch))
        .collect();
    evidences.iter().sum::<f64>() + samples.len() as f64 * 0.5 * family.log_prior(law)
}
