//! The energy that a map costs the nodes, by the message count of the thesis.

use sextant_mac::MessageEnergy;
use sextant_mapper::{Comparator, KnowledgeKind, Mapper};
use sextant_sim::{Discovered, Survey};

use super::discovery::Discoveries;
use crate::scenario::Scenario;

/// Energy of the messages that `mapper` needs from the nodes (J; thesis, eq. 3.17 to 3.19). `None` for algorithms
/// without a formula in the thesis. Time samples are the stops. The anchors and neighbours that a node hears are means
/// over the nodes.
pub(super) fn message_energy_j(
    scenario: &Scenario,
    mapper: &Mapper,
    survey: &Survey,
    discoveries: &Discoveries,
) -> Option<f64> {
    let network = scenario.network();
    let radio = network.link.technology.ieee802154()?.radio;
    let octets = network.traffic.mpdu_octets();
    let packet = MessageEnergy::of_packet(&network.link.radio_states, radio.tx_power(), radio.phy(), octets);
    let (nodes, anchors) = (count(scenario.world().nodes.len()), scenario.anchors().len());
    let mean = |round: &Discovered, nodes: f64| count(round.log.links().len()) / nodes;
    match mapper {
        Mapper::Comparator(Comparator::Tpm(tpm)) => {
            let neighbours = mean(discoveries.neighbours.as_ref()?, nodes);
            Some(packet.tpm_j(nodes, count(tpm.landmark_count(anchors)?), 1.0, neighbours))
        }
        Mapper::Comparator(
            Comparator::TriangleCentroid(_) | Comparator::Centroid(_) | Comparator::WeightedCentroid(_),
        ) => {
            let beacons = discoveries.beacons.as_ref()?;
            let is_anchor = |node| scenario.anchors().iter().any(|anchor| anchor.node == node);
            let heard = beacons.log.links().iter().filter(|link| !is_anchor(link.listener)).count();
            let others = (nodes - count(anchors)).max(1.0);
            Some(packet.rssi_j(nodes, count(anchors), count(heard) / others))
        }
        Mapper::Comparator(_) => None,
        _ if mapper.uses().contains(&KnowledgeKind::RobotReceptions) => {
            Some(packet.ml_tm_j(nodes, count(survey.log.stops().len())))
        }
        _ => None,
    }
}

fn count(count: usize) -> f64 {
    count as f64
}
