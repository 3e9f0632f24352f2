//! The frames of several robots, found from their maps.

use sextant_kernel::{NodeId, Seed};

use super::frame_change::FrameChange;
use super::frame_covariance::FrameCovariance;
use super::joint::{self, FrameAgreement};
use super::pair::{PairFit, PairState};
use super::settings::StitchRules;
use super::shared::OwnMap;
use super::tree;

/// A robot is left out if fewer nodes agree with the maps of the others.
const LEAST_AGREEING: usize = 3;

/// The frames of robots, as changes into that of the first one.
#[derive(Clone, Debug, PartialEq)]
pub struct Frames {
    /// How the frame of each robot becomes that of the first one; `None` for a robot whose frame the maps do not tell.
    pub changes: Vec<Option<FrameChange>>,
    /// What each pair of maps tells.
    pub pairs: Vec<PairFit>,
    /// How uncertain the changes are; `None` if the maps do not tell it.
    pub covariance: Option<FrameCovariance>,
    /// How the map of each robot agrees with those of the others.
    pub(super) agreements: Vec<FrameAgreement>,
}

/// How the frame of each robot becomes that of the first one, from `maps` in these frames. `seed` is that of random pairs of
/// nodes that are tried. The same maps give the same frames.
#[must_use]
pub fn stitch(maps: &[OwnMap], rules: &StitchRules, seed: Seed) -> Frames {
    let pairs: Vec<PairFit> = (0..maps.len())
        .flat_map(|a| (a + 1..maps.len()).map(move |b| [a, b]))
        .map(|robots| PairFit::of(robots, robots.map(|robot| &maps[robot]), rules, seed))
        .collect();
    let mut known = pairs.clone();
    loop {
        let start = tree::frames(maps.len(), &known);
        let graph = joint::refined(maps, start, rules.lengths);
        let agreements = graph.agreements();
        let disagrees = |robot: &usize| {
            *robot > 0 && graph.frames[*robot].is_some() && agreements[*robot].agreeing < LEAST_AGREEING
        };
        let Some(robot) = (0..maps.len()).filter(disagrees).min_by_key(|&robot| agreements[robot].agreeing) else {
            let covariance = FrameCovariance::of(&graph);
            return Frames { changes: graph.frames, pairs, covariance, agreements };
        };
        known.retain(|pair| !pair.robots.contains(&robot));
    }
}

impl Frames {
    /// The share of what `maps` tell of the place of a node that each robot with a frame tells, by their variances; none if
    /// the node is on no map.
    #[must_use]
    pub fn shares(&self, maps: &[OwnMap], node: NodeId) -> Vec<(usize, f64)> {
        let weight = |(robot, map): (usize, &OwnMap)| {
            self.changes[robot]?;
            let at = map.nodes.binary_search_by_key(&node, |placed| placed.node).ok()?;
            Some((robot, 1.0 / map.nodes[at].variance))
        };
        as_shares(maps.iter().enumerate().filter_map(weight).collect())
    }

    /// How far the frame of a robot may move the nodes on its own `map` (m), as the root of the mean square, seen from above.
    /// A map that claims no covariances tells none: what all its places have in common is not in its residuals.
    pub(super) fn deviation_m(&self, robot: usize, map: &OwnMap) -> Option<f64> {
        let has_claims = map.nodes.iter().all(|node| node.covariance.is_some());
        let covariance = self.covariance.as_ref().filter(|_| has_claims)?;
        let change = self.changes[robot]?;
        let moved = |place| {
            let of_place = covariance.of_place(change.apply(place), &[(robot, 1.0)]);
            of_place[0][0] + of_place[1][1]
        };
        let squares: f64 = map.nodes.iter().map(|node| moved(node.place)).sum();
        Some((squares / map.nodes.len().max(1) as f64).sqrt())
    }

    /// The robots in groups that fit together by their pairs: first those with a frame, then the others.
    pub(super) fn groups(&self) -> Vec<Vec<usize>> {
        let count = self.changes.len();
        let mut groups: Vec<Vec<usize>> = vec![(0..count).filter(|&robot| self.changes[robot].is_some()).collect()];
        let fits = |a: usize, b: usize| {
            let is_fitted = |pair: &PairFit| matches!(pair.state, PairState::Fitted { .. });
            self.pairs.iter().any(|pair| (pair.robots == [a, b] || pair.robots == [b, a]) && is_fitted(pair))
        };
        let mut left: Vec<usize> = (0..count).filter(|&robot| self.changes[robot].is_none()).collect();
        while !left.is_empty() {
            let mut group = vec![left.remove(0)];
            while let Some(at) = left.iter().position(|&robot| group.iter().any(|&of| fits(of, robot))) {
                group.push(left.remove(at));
            }
            group.sort_unstable();
            groups.push(group);
        }
        groups
    }
}

/// Weights as shares of their sum.
pub(super) fn as_shares(mut weights: Vec<(usize, f64)>) -> Vec<(usize, f64)> {
    let total: f64 = weights.iter().map(|(_, weight)| weight).sum();
    weights.iter_mut().for_each(|(_, weight)| *weight /= total);
    weights
}
