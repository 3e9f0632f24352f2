//! The law of links, estimated from the log itself.

use rayon::prelude::*;
use sextant_channel::Position;
use sextant_kernel::{Interrupted, Watch};

use super::law::{Law, PARAMETERS};
use super::links::Links;
use super::margin::Receiver;
use super::posterior::{Evidence, Grid};
use super::window::Window;

/// The law is estimated from at most so many nodes, at most so many of their links, and on so many vertices, in the plane
/// and in space.
const NODES: usize = 28;
const LINKS: usize = 90;
const VERTICES: [f64; 2] = [320.0, 640.0];
/// Lengths of the steps of the search for the law, and most rounds with each.
const STEPS: [f64; 3] = [1.0, 0.5, 0.25];
const ROUNDS: [u32; 3] = [8, 6, 6];
/// The evidence must grow by this much for each node, or the search has ended.
const GAIN: f64 = 1e-2;

/// The law that was found, and whether it settled.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    pub(super) law: Law,
    pub(super) rounds: u32,
    pub(super) settled: bool,
}

/// A node that the law is estimated from.
struct Sample<'a> {
    evidence: Evidence<'a>,
    grid: Grid,
}

/// Number of steps of the work that [`find`] tells.
pub(super) const WORK: u64 = 2;

/// The law of highest evidence, with the places of nodes integrated out (type II maximum likelihood): no place has to be
/// known for it.
pub(super) fn find(
    links: &Links,
    window: &Window<'_>,
    is_spatial: bool,
    receiver: Option<&Receiver>,
    watch: &dyn Watch,
) -> Result<Found, Interrupted> {
    let thinned = thinned(links);
    let mut samples: Vec<Sample<'_>> = thinned
        .nodes
        .par_iter()
        .map(|node| {
            let evidence = Evidence::new(node, &thinned, window, receiver);
            let grid = evidence.grid(window, VERTICES[usize::from(is_spatial)]);
            Sample { evidence, grid }
        })
        .collect();
    let mut found = Found { law: start(&thinned, &samples), rounds: 0, settled: false };
    for pass in 0..WORK {
        found = climb(&samples, found, if pass == 0 { &[0, 1] } else { &[0, 1, 2] }, watch)?;
        let law = found.law;
        samples.par_iter_mut().for_each(|sample| {
            let posterior = sample.evidence.posterior(&law, &sample.grid, &mut Vec::new());
            sample.evidence.refine(&law, &sample.grid, &posterior, &thinned, receiver);
        });
        watch.advance(1);
    }
    Ok(found)
}

/// A few of the nodes and, of those, every other link or fewer, if there are many.
fn thinned(links: &Links) -> Links {
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
    Links { places: links.places.clone(), nodes, reach_m: links.reach_m }
}

/// A law that fits the centroids of the places weighted by the sixth power of what they received.
fn start(links: &Links, samples: &[Sample<'_>]) -> Law {
    let mut points: Vec<(f64, f64, f64)> = Vec::new();
    for sample in samples {
        let node = sample.evidence.node();
        let weight = |received: u32, sent: u32| (f64::from(received) / f64::from(sent)).powi(6);
        let place = |place: usize| links.places[place];
        let total: f64 = node.links.iter().map(|link| weight(link.received, link.sent)).sum();
        if total <= 0.0 {
            continue;
        }
        let sum = node
            .links
            .iter()
            .fold(Position::ORIGIN, |sum, link| sum + place(link.place) * (weight(link.received, link.sent) / total));
        for (link, site) in node.links.iter().zip(&sample.evidence.sites) {
            let distance_m = place(link.place).distance_m(sum).max(0.05 * links.reach_m);
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
        margin: y.clamp(-6.0, 8.0),
        distance_m,
        slope,
        shadowing: 1.0,
        shared: 0.5,
        correlation_m: distance_m,
        offset: 0.4,
        direction: 0.3,
    }
}

/// Moves one parameter after the other as long as the evidence grows.
fn climb(samples: &[Sample<'_>], from: Found, scales: &[usize], watch: &dyn Watch) -> Result<Found, Interrupted> {
    let mut found = from;
    let mut best = score(samples, &found.law);
    let least = GAIN * samples.len() as f64;
    found.settled = false;
    for &scale in scales {
        let step = STEPS[scale];
        // Where a parameter moved last time, it goes on in that direction first.
        let mut directions = [1.0; PARAMETERS];
        for _ in 0..ROUNDS[scale] {
            let before = best;
            for (number, direction) in directions.iter_mut().enumerate() {
                for sign in [*direction, -*direction] {
                    watch.check()?;
                    let Some(law) = found.law.moved(number, sign * step) else { continue };
                    let score = score(samples, &law);
                    if score > best {
                        (best, found.law, *direction) = (score, law, sign);
                        break;
                    }
                }
            }
            found.rounds += 1;
            found.settled = best - before < least;
            if found.settled {
                break;
            }
        }
    }
    Ok(found)
}

/// Logarithm of the evidence of all samples and of the prior density of the law.
fn score(samples: &[Sample<'_>], law: &Law) -> f64 {
    let evidences: Vec<f64> = samples
        .par_iter()
        .map_init(Vec::new, |scratch, sample| sample.evidence.posterior(law, &sample.grid, scratch).evidence)
        .collect();
    evidences.iter().sum::<f64>() + samples.len() as f64 * 0.5 * law.log_prior()
}
