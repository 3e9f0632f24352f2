//! The ways down from a root: what it learned of the parents of nodes, and the routes that it makes of that.

use std::collections::BTreeMap;

use sextant_kernel::StationId;

use super::HOP_LIMIT;

/// What a root knows of the parents of nodes. Packets that reach it tell the parent of their origin, as nodes tell the root of
/// RPL without tables in nodes (RFC 6550, 9.7); the root writes the whole way into each packet that goes down.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SourceRoutes {
    parents: BTreeMap<StationId, StationId>,
}

impl SourceRoutes {
    /// A packet told that `node` has this parent.
    pub fn learn(&mut self, node: StationId, parent: StationId) {
        self.parents.insert(node, parent);
    }

    /// The stations on the way from `root` down to `target`, which is the last one. `None` if a parent on the way is not known, or
    /// what is known leads round in a circle or to another root.
    #[must_use]
    pub fn route(&self, root: StationId, target: StationId) -> Option<Vec<StationId>> {
        let mut route = vec![target];
        let mut at = target;
        while *self.parents.get(&at)? != root {
            at = self.parents[&at];
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
}
