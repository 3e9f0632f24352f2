//! Routing, checked: its settings and its tree.

use std::sync::Arc;
use std::time::Duration;

use sextant_kernel::{Files, NodeId, SettingError, SimTime, StationId};
use sextant_mac::routing::{MAX_STATIONS, Trickle};
use sextant_sim::{Applications, LeftOut, ReadySimulation, Setup, Simulation, TrafficPlan};

use super::config::{CollectionConfig, RoutingConfig, TreeConfig};
use super::links::UsableLinks;
use super::record::{Context, RoutingRecord};
use super::router::{Router, Way};
use super::source::Source;
use super::tree::Tree;

/// Routing in the first network of a setup, checked.
#[derive(Clone, Debug)]
pub struct Routing {
    pub(super) queue_packets: usize,
    pub(super) resends: u8,
    plan: Plan,
    links: Arc<UsableLinks>,
}

/// Where the tree comes from.
#[derive(Clone, Debug)]
enum Plan {
    Fixed(Arc<Tree>),
    Built { trickle: Trickle, hysteresis_etx: f64 },
}

impl Routing {
    /// Routing among the stations of `setup`, as `config` says; a file is among `files`.
    ///
    /// # Errors
    /// If a number is out of range, or the tree does not reach each node, or there are too many stations.
    pub fn new(config: &RoutingConfig, setup: &Setup, files: &Files) -> Result<Self, SettingError> {
        let &RoutingConfig { ref tree, queue_packets, resends, usable_prr } = config;
        if !(1..=1000).contains(&queue_packets) {
            return Err(SettingError::new("queue_packets", queue_packets, "1 to 1000"));
        }
        if !(usable_prr > 0.0 && usable_prr <= 1.0) {
            return Err(SettingError::new("usable_prr", usable_prr, "above 0, to 1"));
        }
        let stations = setup.world.nodes.len() + setup.robots.len() + setup.sinks.len();
        if stations > MAX_STATIONS {
            let allowed = format!("at most {MAX_STATIONS}, whose numbers have 16 bits in packets");
            return Err(SettingError::new("", format!("set for {stations} stations"), allowed));
        }
        let links = Arc::new(UsableLinks::new(setup, usable_prr)?);
        let plan = match tree {
            TreeConfig::Given(given) => {
                let sinks: Vec<&str> = setup.sinks.iter().map(|sink| sink.name.as_str()).collect();
                let tree = Tree::read(&given.file, &setup.world.nodes, setup.robots.len(), &sinks, files);
                Plan::Fixed(Arc::new(tree.map_err(|error| error.within("tree.given"))?))
            }
            TreeConfig::Shortest(shortest) => {
                Plan::Fixed(Arc::new(Tree::shortest(&links, &roots(setup), shortest.metric)))
            }
            TreeConfig::Collection(collection) => {
                let trickle = trickle(collection).map_err(|error| error.within("tree.collection"))?;
                Plan::Built { trickle, hysteresis_etx: collection.hysteresis_etx }
            }
        };
        Ok(Self { queue_packets: queue_packets.into(), resends, plan, links })
    }

    /// The tree, if it is fixed.
    #[must_use]
    pub fn tree(&self) -> Option<&Tree> {
        match &self.plan {
            Plan::Fixed(tree) => Some(tree),
            Plan::Built { .. } => None,
        }
    }

    /// The usable links of the layout.
    #[must_use]
    pub fn links(&self) -> &UsableLinks {
        &self.links
    }

    /// The least size of a frame of the traffic: a header of the MAC and one of a packet (octets).
    pub const LEAST_MPDU_OCTETS: u8 = 11 + 9;

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
        let mut dead = vec![false; setup.world.nodes.len()];
        let end = setup.duration.map(|duration| SimTime::ZERO + duration);
        for death in setup.faults.deaths().iter().filter(|death| end.is_none_or(|end| death.time <= end)) {
            dead[death.node.index()] = true;
        }
        let context = Context { roots: roots.clone(), counted_from, dead };
        let applications = Applications { nodes, robots: Vec::new(), sinks };
        let simulation = Simulation::with(setup, applications)?.without(left_out)?;
        let links = Arc::clone(&self.links);
        Ok(simulation.ready(move |own| RoutingRecord::of(own.nodes, own.sinks, &links, &context)))
    }

    /// How a station finds the next one.
    fn way(&self, station: StationId, roots: &[StationId]) -> Way {
        match &self.plan {
            Plan::Fixed(_) if roots.contains(&station) => Way::FixedRoot,
            Plan::Fixed(tree) => Way::Fixed(tree.parent(station)),
            Plan::Built { trickle, .. } if roots.contains(&station) => Way::root(station, trickle.clone()),
            Plan::Built { trickle, hysteresis_etx } => Way::node(station, trickle.clone(), *hysteresis_etx),
        }
    }
}

/// The sinks of a setup.
fn roots(setup: &Setup) -> Vec<StationId> {
    let first = setup.world.nodes.len() + setup.robots.len();
    (first..first + setup.sinks.len()).map(StationId::from_index).collect()
}

fn trickle(config: &CollectionConfig) -> Result<Trickle, SettingError> {
    let shortest_s = SettingError::in_range("beacon_min_s", config.beacon_min_s, 0.01, 1e5)?;
    let longest_s = SettingError::in_range("beacon_max_s", config.beacon_max_s, shortest_s, 1e6)?;
    SettingError::in_range("hysteresis_etx", config.hysteresis_etx, 0.0, 100.0)?;
    Ok(Trickle::new(Duration::from_secs_f64(shortest_s), Duration::from_secs_f64(longest_s)))
}
