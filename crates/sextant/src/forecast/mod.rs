//! What follows from a scenario before it runs: ranges, neighbours, channel load, paths, cost; and what is likely a mistake.
//!
//! Ranges and probabilities are worked out from the law of the channel and the rules of the receivers, without other
//! frames. The way of a robot whose path is planned is known; that of a robot that decides on the way is driven once,
//! as if it heard each node as often as is to be expected, and is marked as an estimate.

mod changes;
mod cost;
mod curve;
mod futile;
mod idle_mac;
mod idle_obstacles;
mod interference;
mod interval;
mod late_deaths;
mod network;
mod warning;
mod way;

use serde::Serialize;
use sextant_sim::Robot;

pub use cost::CostForecast;
pub use interval::IntervalForecast;
pub use network::{FadingForecast, LoadForecast, NeighbourForecast, NetworkForecast, RangeForecast};
use sextant_scenario::Scenario;
pub use warning::{Warning, warnings};
pub use way::WayForecast;

use interval::Hops;
use network::Reach;
use way::{Way, is_planned};

/// What follows from a scenario before it runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Forecast {
    /// The networks, in their order.
    pub networks: Vec<NetworkForecast>,
    /// The robots that survey, in their order.
    pub robots: Vec<WayForecast>,
    /// What the simulation costs; absent if how long it takes cannot be told.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cost: Option<CostForecast>,
}

impl Forecast {
    /// The forecast for `scenario`.
    #[must_use]
    pub fn of(scenario: &Scenario) -> Self {
        let setup = scenario.setup();
        let reaches = Reach::all(&setup);
        let hops = if scenario.routing().is_some() { Hops::Several } else { Hops::One };
        let of_network = |reach: &Reach<'_>| {
            let forecast = reach.forecast();
            let unknown = if hops == Hops::Several {
                Some("nodes send packets of others on, and stations tell each other of the tree")
            } else if reach.network.technology.sleeping().is_some() {
                Some("frames that wake receivers are on air, too")
            } else if reach.network.technology.has_slots() {
                Some("stations change the channel from slot to slot")
            } else {
                None
            };
            NetworkForecast {
                interval: IntervalForecast::of(reach.network, reach.rate_per_s(), hops),
                load: forecast.load.filter(|_| unknown.is_none()),
                load_unknown: unknown.filter(|_| forecast.load.is_some()),
                ..forecast
            }
        };
        let networks: Vec<_> = reaches.iter().map(of_network).collect();
        let planned = |robot: &Robot| is_planned(scenario, robot);
        let ways: Vec<_> =
            setup.robots.iter().filter_map(|robot| Way::driven(robot, planned(robot), &reaches)).collect();
        let robots: Vec<_> = ways.iter().map(Way::forecast).collect();
        let cost = CostForecast::of(scenario, &setup, &reaches, &ways);
        Self { networks, robots, cost }
    }
}
