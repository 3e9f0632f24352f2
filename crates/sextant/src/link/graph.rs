//! The graph of a network: who hears whom, and how well.

use serde::Serialize;
use sextant_sim::{LinkBudgets, NetworkId};

use super::LinkError;
use super::stations::Stations;
use crate::Scenario;

/// A link from one station to another one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GraphEdge {
    /// Who sends.
    pub from: String,
    /// Who receives.
    pub to: String,
    /// Their distance (m).
    pub distance_m: f64,
    /// Power at the receiver (dBm); without shadowing if each packet has its own.
    pub received_dbm: f64,
    /// Probability that a frame of the sender is received, if nobody else sends: over all draws of shadowing, fading and bursts
    /// if these change from frame to frame or in time.
    pub probability: f64,
}

/// The links between the nodes and sinks of a scenario, and its robots at their start, in both directions: those over which a frame is
/// received with a probability of at least `least`. The network is the first one, if none is named.
///
/// # Errors
/// If `least` is not from 0 to 1, there is no such network, or the networks do not fit together.
pub fn graph(scenario: &Scenario, network: Option<&str>, least: f64) -> Result<Vec<GraphEdge>, LinkError> {
    if !(0.0..=1.0).contains(&least) {
        return Err(LinkError::Probability(least));
    }
    let stations = Stations::of(scenario);
    let setup = stations.setup();
    let mut budgets = LinkBudgets::new(setup)?;
    let network = super::named_network(scenario, network)?.unwrap_or(NetworkId(0));
    let law = *budgets.law(network);
    // A draw that holds for good is that of the link; of others, all draws count.
    let is_drawn_anew = law.shadowing().is_per_packet()
        || law.fading().is_some_and(|fading| fading.changes_in_time())
        || law.bursts().is_some();
    let ends: Vec<_> = stations.ends().into_iter().filter(|end| budgets.is_in(network, end.station)).collect();
    let mut edges = Vec::new();
    for from in &ends {
        for to in ends.iter().filter(|to| to.station != from.station) {
            let Some(budget) = budgets.between(network, from.station, to.station) else { continue };
            let reception = budget.reception;
            let probability =
                if is_drawn_anew { reception.probability_over_shadowing } else { reception.probability };
            if probability >= least {
                edges.push(GraphEdge {
                    from: from.name.clone(),
                    to: to.name.clone(),
                    distance_m: from.place.distance_m(to.place),
                    received_dbm: budget.power.0,
                    probability,
                });
            }
        }
    }
    Ok(edges)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::explain_link;

    #[test]
    fn edges_are_the_links_that_are_explained() {
        let text = sextant_scenario::template::Template::named("survey").unwrap().scenario().unwrap().text;
        let scenario = Scenario::parse(text).unwrap();
        let edges = graph(&scenario, None, 0.5).unwrap();
        assert!(edges.len() > 40 && edges.iter().all(|edge| edge.probability >= 0.5), "{}", edges.len());
        for edge in edges.iter().step_by(17) {
            let link = explain_link(&scenario, &edge.from, &edge.to, None).unwrap();
            let [forth, _] = link.directions.unwrap();
            assert_eq!(forth.received_dbm, Some(edge.received_dbm));
            assert!((link.distance_m - edge.distance_m).abs() < 1e-12);
            assert!(edges.iter().any(|back| back.from == edge.to && back.to == edge.from));
        }
        assert!(graph(&scenario, None, 0.0).unwrap().len() > edges.len());
        assert!(graph(&scenario, Some("none"), 0.5).is_err());
    }
}
