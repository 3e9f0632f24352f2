//! Why a station hears another one, or not: the power between the two, item by item.

mod changes;
mod graph;
mod rays;
mod report;
mod stations;
mod table;

use sextant_channel::Position;
use sextant_kernel::{SettingError, StationId};
use sextant_sim::{LinkBudgets, NetworkId};

pub use changes::{BurstsReport, FadingReport, MeasuredReport};
pub use graph::{GraphEdge, graph};
pub use rays::{RayReport, rays_csv};
pub use report::{Direction, LinkEnd, LinkReport, LossOfObstacle, PathReport, ReceptionReport, ShadowingReport};

use crate::Scenario;
use stations::Stations;

/// Why a link cannot be explained.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LinkError {
    /// There is no such station.
    #[error("there is no station `{name}` in the scenario{near}; allowed: the name of a node, a robot or a sink, or a place `x,y` or `x,y,z` in metres", near = suggestion(.near))]
    UnknownStation {
        /// The name.
        name: String,
        /// Names of stations that are similar.
        near: Vec<String>,
    },
    /// A place has too many numbers, or one that is not finite.
    #[error("`{0}` is not a place; allowed: two or three finite numbers, `x,y` or `x,y,z` in metres")]
    Place(String),
    /// There is no such network.
    #[error("there is no network `{name}`; allowed: {allowed}")]
    UnknownNetwork {
        /// The name.
        name: String,
        /// The networks of the scenario, in words.
        allowed: String,
    },
    /// A station is not in the network.
    #[error("`{station}` is not in the network{network}", network = named(.network))]
    NotInNetwork {
        /// The station.
        station: String,
        /// The network, if it has a name.
        network: Option<String>,
    },
    /// The two are one station.
    #[error("`{0}` is named twice; a link has two different ends")]
    SameStation(String),
    /// The two are in one place.
    #[error("`{a}` and `{b}` are in the same place, ({x_m}, {y_m}, {z_m}) m; a link has a length above 0", x_m = .place.x_m, y_m = .place.y_m, z_m = .place.z_m)]
    SamePlace {
        /// One end.
        a: String,
        /// The other end.
        b: String,
        /// Where both are.
        place: Position,
    },
    /// A probability that is none.
    #[error("`{0}` is not a probability; allowed: 0 to 1")]
    Probability(f64),
    /// The networks do not fit together.
    #[error(transparent)]
    Setting(#[from] SettingError),
}

fn suggestion(near: &[String]) -> String {
    match near {
        [] => String::new(),
        names => format!(
            "; did you mean {}?",
            names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(" or ")
        ),
    }
}

fn named(network: &Option<String>) -> String {
    network.as_ref().map(|name| format!(" `{name}`")).unwrap_or_default()
}

/// Explains the link between `a` and `b`: names of nodes, robots and sinks, or places `x,y` or `x,y,z` (m), where a sink is
/// assumed. Robots are at their start. The network is the first one that both are in, if none is named.
///
/// All powers are those of the simulator: [`LinkBudgets`] asks the air of the simulation.
///
/// # Errors
/// If there is no such station or network, a station is not in it, or both ends are in one place.
pub fn explain_link(scenario: &Scenario, a: &str, b: &str, network: Option<&str>) -> Result<LinkReport, LinkError> {
    let mut stations = Stations::of(scenario);
    let (a, b) = (stations.find(a)?, stations.find(b)?);
    if a.station == b.station {
        return Err(LinkError::SameStation(a.name));
    }
    if a.place.distance_m(b.place) <= 0.0 {
        return Err(LinkError::SamePlace { a: a.name, b: b.name, place: a.place });
    }
    let mut budgets = LinkBudgets::new(stations.setup())?;
    let network = choose(scenario, &budgets, network, &a, &b)?;
    let law = *budgets.law(network);
    let forth = budgets.between(network, a.station, b.station);
    let back = budgets.between(network, b.station, a.station);
    let correlation = match law.shadowing() {
        shadowing if shadowing.is_per_packet() => "per_packet",
        shadowing if shadowing.is_spatial() => "spatial",
        _ => "per_link",
    };
    let budget = forth.zip(back);
    let draw_db = budget.as_ref().and_then(|(forth, _)| forth.shadowing).map(|gain| gain.0);
    let shadowing = ShadowingReport { sigma_db: law.shadowing().sigma_db(), correlation, draw_db };
    let obstacles = budgets.obstacles();
    let rays = budget.as_ref().map(|(forth, _)| rays::rays_of(&forth.path));
    let (rays, field_gain_db) = rays.map_or((None, None), |(rays, field_gain_db)| (Some(rays), field_gain_db));
    Ok(LinkReport {
        rays,
        field_gain_db,
        scenario: scenario.name().to_owned(),
        seed: scenario.seed().0,
        network: scenario.networks()[network.index()].name.clone(),
        distance_m: a.place.distance_m(b.place),
        max_range_m: Some(law.max_range_m()).filter(|range_m| range_m.is_finite()),
        path: budget.as_ref().map(|(forth, _)| PathReport::new(&law, &forth.path, forth.tx_power, obstacles)),
        shadowing,
        fading: FadingReport::of(&law, budget.as_ref().map(|(forth, _)| forth)),
        bursts: BurstsReport::of(&law),
        message_loss: Some(stations.setup().faults.message_loss()).filter(|&share| share > 0.0),
        directions: budget
            .map(|(forth, back)| [Direction::new(&a.name, &b.name, &forth), Direction::new(&b.name, &a.name, &back)]),
        ends: [a.into(), b.into()],
    })
}

/// The network of this name, or the first one that both ends are in.
fn choose(
    scenario: &Scenario,
    budgets: &LinkBudgets,
    name: Option<&str>,
    a: &stations::End,
    b: &stations::End,
) -> Result<NetworkId, LinkError> {
    let is_in = |network: NetworkId, station: StationId| budgets.is_in(network, station);
    let chosen = named_network(scenario, name)?.unwrap_or_else(|| {
        let mut networks = (0..=u8::MAX).map(NetworkId).zip(scenario.networks()).map(|(id, _)| id);
        networks.find(|&id| is_in(id, a.station) && is_in(id, b.station)).unwrap_or_default()
    });
    match [a, b].into_iter().find(|end| !is_in(chosen, end.station)) {
        None => Ok(chosen),
        Some(end) => {
            let network = scenario.networks()[chosen.index()].name.clone();
            Err(LinkError::NotInNetwork { station: end.name.clone(), network })
        }
    }
}

/// The network of this name; `None` without a name.
fn named_network(scenario: &Scenario, name: Option<&str>) -> Result<Option<NetworkId>, LinkError> {
    let Some(name) = name else { return Ok(None) };
    let networks = || (0..=u8::MAX).map(NetworkId).zip(scenario.networks());
    let found = networks().find(|(_, network)| network.name.as_deref() == Some(name));
    let found = found.ok_or_else(|| {
        let names: Vec<_> =
            networks().filter_map(|(_, network)| Some(format!("`{}`", network.name.as_ref()?))).collect();
        let allowed = if names.is_empty() { "no name: there is one network".to_owned() } else { names.join(", ") };
        LinkError::UnknownNetwork { name: name.to_owned(), allowed }
    })?;
    Ok(Some(found.0))
}

#[cfg(test)]
mod tests;
