//! The links of a layout over which packets can go.

use sextant_kernel::{SettingError, StationId};
use sextant_sim::{LinkBudgets, NetworkId, Setup};

/// The usable links among the stations of a setup as it stands at the start, by what `sextant explain-link` says of each: with
/// the shadowing of the link, or over all draws if each packet has its own; without fading in time and without lost messages; or
/// as measured at first.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct UsableLinks {
    /// The links from each station: to whom, and expected transmissions.
    from: Vec<Vec<(StationId, f64)>>,
}

impl UsableLinks {
    /// The links of `setup` over which at least the share `usable_prr` of frames arrives in each direction. Robots are no part
    /// of them.
    ///
    /// # Errors
    /// Those of [`LinkBudgets::new`].
    pub(super) fn new(setup: &Setup, usable_prr: f64) -> Result<Self, SettingError> {
        let mut budgets = LinkBudgets::new(setup)?;
        let network = NetworkId::default();
        let (nodes, robots) = (setup.world.nodes.len(), setup.robots.len());
        let stations: Vec<StationId> =
            (0..nodes).chain(nodes + robots..nodes + robots + setup.sinks.len()).map(StationId::from_index).collect();
        let mut from = vec![Vec::new(); nodes + robots + setup.sinks.len()];
        for (i, &a) in stations.iter().enumerate() {
            for &b in &stations[i + 1..] {
                let mut share = |from, to| budgets.share_at_least(network, from, to, usable_prr);
                let Some(there) = share(a, b) else { continue };
                let Some(back) = share(b, a) else { continue };
                let etx = 1.0 / (there * back);
                from[a.index()].push((b, etx));
                from[b.index()].push((a, etx));
            }
        }
        Ok(Self { from })
    }

    /// No links among so many stations.
    #[cfg(test)]
    pub(super) fn none(stations: usize) -> Self {
        Self { from: vec![Vec::new(); stations] }
    }

    /// Number of stations.
    #[must_use]
    pub(super) fn stations(&self) -> usize {
        self.from.len()
    }

    /// Expected transmissions over a usable link.
    pub(super) fn etx(&self, from: StationId, to: StationId) -> Option<f64> {
        self.of(from).find(|&(other, _)| other == to).map(|(_, etx)| etx)
    }

    /// The links of a station: to whom, and expected transmissions.
    ///
    /// # Panics
    /// If there is no such station.
    pub(super) fn of(&self, station: StationId) -> impl Iterator<Item = (StationId, f64)> {
        self.from[station.index()].iter().copied()
    }
}
