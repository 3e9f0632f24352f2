//! What a log leaves open of the places of its nodes, and what a stop at a new place would tell.
//!
//! The error that is expected of a node is the root of the trace of its covariance. A stop hears nothing, some packets, or
//! packets of some strength. Each outcome has a posterior; that of the places where the node may be, weighed by the probability of
//! the outcome there. By the law of total variance the covariance that is expected after the stop is the one before less the
//! covariance of the means of these posteriors. No curve is made linear, so a node of which next to nothing is known, or that may be
//! on either side of a straight way, has the gain that it has.
//!
//! Stops that were taken change what later ones tell: the covariance that is left is smaller, and the mean from which they start
//! will have moved by what was taken.

mod law;
mod node;
mod told;
mod unheard;

use rayon::prelude::*;
use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::{Interrupted, NodeId, Watch};

use crate::learned::EstimatorFindings;
use crate::profile::ReceptionProfile;
use crate::topology_map::{CoordinateFrame, TopologyMap};
use law::StopLaw;
use node::NodeOutlook;
use unheard::UnheardNodes;

/// A node gains by a stop if its error falls by this share.
const GAIN: f64 = 0.01;

/// What a log leaves open, and what further stops would tell.
#[derive(Clone, Debug)]
pub struct Outlook {
    law: StopLaw,
    nodes: Vec<NodeOutlook>,
    unheard: Option<UnheardNodes>,
    /// Where robots listened, or will (m).
    stops: Vec<Position>,
}

/// What a stop is expected to bring.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StopGain {
    /// Fall of the errors of all nodes together (m).
    pub fall_m: f64,
    /// The errors of the nodes that the stop may hear, before it (m).
    pub in_reach_m: f64,
    /// The nodes whose errors fall by one per cent or more, by number. Those that were never heard are not among them.
    pub nodes: Vec<NodeId>,
    /// The number of nodes that were never heard and are expected to be heard at the stop.
    pub found: f64,
}

/// Why it cannot be said what further stops would tell.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OutlookError {
    /// There are no stops.
    #[error("the log has no stops: nobody listened")]
    NoStops,
    /// No node was heard.
    #[error("no node was heard: where nodes may be is not known, and a first survey has to find them")]
    NotHeard,
    /// The map has no covariances.
    #[error("`{algorithm}` gives places without their covariance: what is not known of a node is not known either")]
    NoCovariance {
        /// The algorithm.
        algorithm: &'static str,
    },
    /// Nothing says over which distances packets arrive.
    #[error("`{algorithm}` does not tell over which distances packets arrive")]
    NoLaw {
        /// The algorithm.
        algorithm: &'static str,
    },
    /// The places are not those of the stops.
    #[error("`{algorithm}` gives places in a frame of their own, which is not that of the stops")]
    Relative {
        /// The algorithm.
        algorithm: &'static str,
    },
    /// The work was ended.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl Outlook {
    /// The outlook of `log`, of which `map` was made, and `learned` with it. A packet arrives over a distance as the estimator
    /// learned, or as `profile` says. Nodes of the log that were never heard may be at each of `open` places, at which they would not
    /// have been heard.
    ///
    /// # Errors
    /// If the log or the map lacks what is needed.
    pub fn of(
        log: &ReceptionLog,
        map: &TopologyMap,
        learned: Option<&EstimatorFindings>,
        profile: Option<&ReceptionProfile>,
        open: &[Position],
    ) -> Result<Self, OutlookError> {
        let algorithm = map.algorithm;
        if log.stops().is_empty() {
            return Err(OutlookError::NoStops);
        }
        if map.mapped() == 0 {
            return Err(OutlookError::NotHeard);
        }
        if let CoordinateFrame::Relative(_) = map.frame {
            return Err(OutlookError::Relative { algorithm });
        }
        let nodes = map.estimates.iter().enumerate();
        let nodes: Vec<NodeOutlook> = nodes
            .filter_map(|(node, estimate)| {
                let estimate = estimate.as_ref()?;
                Some(NodeOutlook::new(NodeId::from_index(node), estimate.position, estimate.covariance?))
            })
            .collect();
        if nodes.is_empty() {
            return Err(OutlookError::NoCovariance { algorithm });
        }
        let curves = learned.map(|learned| learned.curves()).unwrap_or_default();
        let law = match (curves.first(), profile) {
            (Some(curve), _) => StopLaw::of(log, map, learned, &*curve.probability),
            (None, Some(profile)) => StopLaw::of(log, map, learned, &|distance_m| profile.probability(distance_m)),
            (None, None) => None,
        };
        let law = law.ok_or(OutlookError::NoLaw { algorithm })?;
        let stops: Vec<Position> = log.stops().iter().map(|stop| stop.position).collect();
        let unheard = UnheardNodes::new(map.unmapped(), open, &stops, &law);
        Ok(Self { law, nodes, unheard, stops })
    }

    /// Beyond this distance next to nothing is heard (m).
    #[must_use]
    pub fn reach_m(&self) -> f64 {
        self.law.reach_m()
    }

    /// Number of nodes that the errors are those of.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.nodes.len() + self.unheard.as_ref().map_or(0, UnheardNodes::count)
    }

    /// Number of them that were never heard.
    #[must_use]
    pub fn unheard_count(&self) -> usize {
        self.unheard.as_ref().map_or(0, UnheardNodes::count)
    }

    /// Whether stops tell the strength of what they hear.
    #[must_use]
    pub fn has_strengths(&self) -> bool {
        self.law.strengths.is_some()
    }

    /// The error that is expected of a node, on average over the nodes (m): root mean squares.
    #[must_use]
    pub fn mean_error_m(&self) -> f64 {
        let unheard_m = self.unheard.as_ref().map_or(0.0, UnheardNodes::errors_m);
        (self.nodes.iter().map(NodeOutlook::error_m).sum::<f64>() + unheard_m) / self.node_count() as f64
    }

    /// What a stop at `place` would bring.
    #[must_use]
    pub fn gain(&self, place: Position) -> StopGain {
        let share = self.new_share(place);
        let mut gain = StopGain::default();
        for node in &self.nodes {
            let Some(fall) = node.fall(&self.law, place) else { continue };
            let (before_m, after_m) = (node.error_m(), node.error_after_m(&(fall * share)));
            gain.fall_m += before_m - after_m;
            gain.in_reach_m += before_m;
            if before_m - after_m >= GAIN * before_m {
                gain.nodes.push(node.node());
            }
        }
        if let Some(of) = self.unheard.as_ref().and_then(|unheard| unheard.gain(&self.law, place)) {
            gain.fall_m += of.fall_m;
            gain.in_reach_m += of.in_reach_m;
            gain.found = of.found;
        }
        gain
    }

    /// What a stop at each of `places` would bring. The result is bit-identical for any number of threads.
    ///
    /// # Errors
    /// If `watch` ends the work.
    pub fn gains(&self, places: &[Position], watch: &dyn Watch) -> Result<Vec<StopGain>, Interrupted> {
        places
            .par_iter()
            .map(|&place| {
                watch.check()?;
                let gain = self.gain(place);
                watch.advance(1);
                Ok(gain)
            })
            .collect()
    }

    /// Takes the stop at `place`: what it is expected to tell is known from now on.
    pub fn take(&mut self, place: Position) {
        let share = self.new_share(place);
        let law = &self.law;
        self.nodes.par_iter_mut().for_each(|node| {
            if let Some(fall) = node.fall(law, place) {
                node.take(&(fall * share));
            }
        });
        if let Some(unheard) = &mut self.unheard {
            unheard.take(law, place);
        }
        self.stops.push(place);
    }

    fn new_share(&self, place: Position) -> f64 {
        let nearest_m = self.stops.iter().map(|stop| stop.distance_m(place)).fold(f64::INFINITY, f64::min);
        self.law.new_share(nearest_m)
    }
}

#[cfg(test)]
mod tests;
