//! The ways down from a root: what it learned of the parents of nodes, and the routes that it makes of that.

use std::collections::BTreeMap;

use sextant_kernel::{SimTime, StationId};

use super::HOP_LIMIT;

/// What a root knows of the parents of nodes. Packets that reach it tell the parent of their origin, as nodes tell the root of
/// RPL without tables in nodes (RFC 6550, 9.7); the root writes the whole way into each packet that goes down.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SourceRoutes {
    parents: BTreeMap<StationId, (StationId, SimTime)>,
}

impl SourceRoutes {
    /// A packet told that `node` has this parent.
    pub fn learn(&mut self, node: StationId, parent: StationId) {
        self.learn_until(node, parent, SimTime::MAX);
    }

    /// The same, up to then.
    pub fn learn_until(&mut self, node: StationId, parent: StationId, until: SimTime) {
        self.parents.insert(node, (parent, until));
    }

    /// `node` has no parent any more.
    pub fn forget(&mut self, node: StationId) {
        self.parents.remove(&node);
    }

    /// Forgets what was told up to `now` only.
    pub fn expire(&mut self, now: SimTime) {
        self.parents.retain(|_, &mut (_, until)| now < until);
    }

    /// The stations whose parents are known.
    pub fn stations(&self) -> impl Iterator<Item = StationId> {
        self.parents.keys().copied()
    }

    /// The stations on the way from `root` down to `target`, which is the last one. `None` if a parent on the way is not known, or
    /// what is known leads round in a circle or to another root.
    #[must_use]
    pub fn route(&self, root: StationId, target: StationId) -> Option<Vec<StationId>> {
        let mut route = vec![target];
        let mut at = target;
        loop {
            let &(parent, _) = self.parents.get(&at)?;
            if parent == root {
                break;
            }
            at = parent;
            route.push(at);
            if route.len() > usize::from(HOP_LIMIT) {
                return None;
            }
        }
        route.reverse();
        Some(route)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_route_follows_the_parents_that_were_told_last() {
        let s = StationId;
        let mut routes = SourceRoutes::default();
        assert_eq!(routes.route(s(9), s(1)), None);
        routes.learn(s(1), s(2));
        assert_eq!(routes.route(s(9), s(1)), None, "the parent of 2 is not known");
        routes.learn(s(2), s(9));
        assert_eq!((routes.route(s(9), s(1)), routes.route(s(9), s(2))), (Some(vec![s(2), s(1)]), Some(vec![s(2)])));
        assert_eq!(routes.route(s(8), s(1)), None, "that is the way from another root");
        routes.learn(s(1), s(9));
        assert_eq!(routes.route(s(9), s(1)), Some(vec![s(1)]));
        // What was told at different times may go round.
        routes.learn(s(1), s(2));
        routes.learn(s(2), s(1));
        assert_eq!(routes.route(s(9), s(1)), None);
    }

    #[test]
    fn what_was_told_for_a_time_is_forgotten_after_it() {
        let s = StationId;
        let mut routes = SourceRoutes::default();
        routes.learn(s(1), s(9));
        routes.learn_until(s(2), s(1), SimTime::from_secs(60));
        routes.expire(SimTime::from_secs(59));
        assert_eq!(routes.route(s(9), s(2)), Some(vec![s(1), s(2)]));
        routes.expire(SimTime::from_secs(60));
        assert_eq!((routes.route(s(9), s(2)), routes.stations().count()), (None, 1));
        routes.forget(s(1));
        assert_eq!(routes.route(s(9), s(1)), None);
    }
}
