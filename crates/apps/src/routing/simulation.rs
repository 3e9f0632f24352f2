//! A simulation in which packets go over several hops.

use std::collections::BTreeSet;
use std::sync::Arc;

use sextant_kernel::{NodeId, SettingError, SimTime, StationId};
use sextant_sim::{
    Applications, FrameId, KnownTree, LeftOut, LeftPacket, ReadySimulation, Setup, Simulation, TrafficPlan,
    TreeTraffic,
};

use super::record::{Context, RoutingRecord};
use super::router::Router;
use super::rpl::RplStation;
use super::settings::{Plan, Routing, roots};
use super::source::Source;
use super::way::Way;

/// How often the frame of a station was sent that its link kept.
fn transmissions(kept: &[LeftPacket], station: StationId, frame: FrameId) -> u32 {
    let found = kept.iter().find(|left| left.station == station && left.frame == frame);
    found.map_or(0, |left| left.transmissions)
}

impl Routing {
    /// The simulation of `setup` with the traffic of its first network, ready to run.
    ///
    /// # Errors
    /// Those of [`Simulation::with`] and [`Simulation::with_region`].
    pub fn simulation(
        &self,
        mut setup: Setup,
        left_out: LeftOut,
    ) -> Result<ReadySimulation<'static, RoutingRecord>, SettingError> {
        let silent = TrafficPlan::silent(setup.world.nodes.len());
        let Some(network) = setup.networks.first_mut() else {
            return Err(SettingError::missing_table("radio"));
        };
        let traffic = std::mem::replace(&mut network.traffic, silent);
        if let Plan::Fixed(tree) = &self.plan {
            let traffic = if self.to.is_sink() { TreeTraffic::Up } else { TreeTraffic::UpAndDown };
            network.technology.know_tree(&KnownTree { parents: tree.parents().to_vec(), traffic });
        }
        let routing = Arc::new(self.clone());
        let roots = roots(&setup);
        let counted_from = SimTime::ZERO + left_out.warm_up;
        let router =
            |station, source| Router::new(Arc::clone(&routing), self.way(station, &roots), source, counted_from);
        let source = |node| {
            traffic.of(node).filter(|traffic| !traffic.is_silent()).map(|traffic| Source::new(traffic.clone()))
        };
        let nodes = (0..setup.world.nodes.len())
            .map(StationId::from_index)
            .map(|station| router(station, source(NodeId(station.0))))
            .collect();
        let sinks = roots.iter().map(|&root| router(root, None)).collect();
        let mut context =
            Context { roots: roots.clone(), counted_from, to: self.to, dead: vec![false; setup.world.nodes.len()] };
        let applications = Applications { nodes, robots: Vec::new(), sinks };
        let simulation = Simulation::with(setup, applications)?.without(left_out)?;
        let links = Arc::clone(&self.links);
        Ok(simulation.ready_with_survey(move |survey, own| {
            for death in &survey.deaths {
                context.dead[death.node.index()] = true;
            }
            let kept = survey.networks.first().map_or(&[][..], |network| &network.left);
            let left = (own.nodes.into_iter().chain(own.sinks).enumerate())
                .map(|(number, router)| {
                    router.into_record(|frame| transmissions(kept, StationId::from_index(number), frame))
                })
                .collect();
            RoutingRecord::of(left, &links, &context)
        }))
    }

    /// The hops that the packets of some nodes take, each from a station to the next one, or to any if that is not known before the
    /// start.
    #[must_use]
    pub fn hops(
        &self,
        origins: impl Iterator<Item = StationId>,
        sinks: &[StationId],
    ) -> BTreeSet<(StationId, Option<StationId>)> {
        let mut hops = BTreeSet::new();
        let goes_down = !self.to.is_sink();
        for origin in origins {
            let Plan::Fixed(tree) = &self.plan else {
                hops.insert((origin, None));
                hops.extend(sinks.iter().filter(|_| goes_down).map(|&sink| (sink, None)));
                continue;
            };
            let mut at = origin;
            while let Some(parent) = tree.parent(at) {
                let is_new = hops.insert((at, Some(parent)));
                if goes_down {
                    hops.insert((parent, Some(at)));
                }
                if !is_new {
                    break;
                }
                at = parent;
            }
        }
        hops
    }

    /// How a station finds the next one.
    fn way(&self, station: StationId, roots: &[StationId]) -> Way {
        match &self.plan {
            Plan::Fixed(_) if roots.contains(&station) => Way::FixedRoot,
            Plan::Fixed(tree) => Way::Fixed(tree.parent(station)),
            Plan::Built { trickle, .. } if roots.contains(&station) => Way::root(station, trickle.clone()),
            Plan::Built { trickle, hysteresis_etx } => Way::node(station, trickle.clone(), *hysteresis_etx),
            Plan::Rpl(plan) if roots.contains(&station) => Way::Rpl(Box::new(RplStation::root(station, plan))),
            Plan::Rpl(plan) => Way::Rpl(Box::new(RplStation::node(station, plan))),
        }
    }
}
