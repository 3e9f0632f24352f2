//! The energy that a map costs the nodes, by the message count of the thesis.

use sextant_kernel::NodeId;
use sextant_mac::MessageEnergy;
use sextant_mapper::{KnowledgeKind, Landmarks, Mapper, Messages};
use sextant_scenario::{MapJob, Scenario};
use sextant_sim::{Antennas, Discovered, NetworkId, Survey};

use super::discovery::Discoveries;

/// Energy of the messages that `map` needs from the nodes, in all its networks (J; thesis, eq. 3.17 to 3.19 and, with
/// sector sweeps, chapter 4). `None` for algorithms without a formula in the thesis. Time samples are the stops. The
/// anchors and neighbours that a node hears, and the sweeps that it answers, are means over the nodes.
pub(super) fn message_energy_j(
    scenario: &Scenario,
    map: &MapJob,
    survey: &Survey,
    discoveries: &Discoveries,
) -> Option<f64> {
    let networks = scenario.networks_of(map);
    let in_network = |&network: &NetworkId| match scenario.networks()[network.index()].technology.antennas() {
        None => packets_j(scenario, network, &map.mapper, survey, discoveries),
        Some(antennas) => sweeps_j(scenario, network, antennas, &map.mapper, survey),
    };
    networks.iter().map(in_network).sum()
}

/// The energy of answers to sector sweeps.
fn sweeps_j(
    scenario: &Scenario,
    id: NetworkId,
    antennas: &Antennas,
    mapper: &Mapper,
    survey: &Survey,
) -> Option<f64> {
    if !mapper.uses().contains(&KnowledgeKind::RobotReceptions) {
        return None;
    }
    let network = &scenario.networks()[id.index()];
    let frame = MessageEnergy::of_ssw_frame(&network.radio_states, network.technology.tx_power());
    let members = (0..scenario.world().nodes.len()).map(NodeId::from_index).filter(|&node| network.has(node));
    let answers = members.clone().map(|node| survey.networks[id.index()].packets[node.index()].offered);
    let (nodes, answers) = (count(members.count()), answers.sum::<u64>() as f64);
    let sweeps_heard = if nodes > 0.0 { answers / nodes } else { 0.0 };
    Some(frame.mmtm_j(nodes, sweeps_heard, f64::from(antennas.nodes().sector_count())))
}

/// The energy of packets, in a network without sector sweeps.
fn packets_j(
    scenario: &Scenario,
    id: NetworkId,
    mapper: &Mapper,
    survey: &Survey,
    discoveries: &Discoveries,
) -> Option<f64> {
    let network = &scenario.networks()[id.index()];
    let octets = network.traffic.mpdu_octets();
    let packet = network.technology.frame_energy(&network.radio_states, octets.into())?;
    let log = network.name.as_deref().and_then(|name| survey.logs.named(name));
    let stops = log.unwrap_or(survey.log()).stops().len();
    let members = (0..scenario.world().nodes.len()).filter(|&node| network.has(NodeId::from_index(node)));
    let (nodes, anchors) = (count(members.count()), scenario.anchors().len());
    let mean = |round: &Discovered, nodes: f64| count(round.log.links().len()) / nodes;
    match mapper.messages() {
        Messages::Floods(landmarks) => {
            let neighbours = mean(discoveries.neighbours.as_ref()?, nodes);
            let landmarks = match landmarks {
                Landmarks::Count(landmarks) => landmarks,
                Landmarks::Anchors => anchors,
                Landmarks::Sought => return None,
            };
            Some(packet.tpm_j(nodes, count(landmarks), 1.0, neighbours))
        }
        Messages::Beacons => {
            let beacons = discoveries.beacons.as_ref()?;
            let is_anchor = |node| scenario.anchors().iter().any(|anchor| anchor.node == node);
            let heard = beacons.log.links().iter().filter(|link| !is_anchor(link.listener)).count();
            let others = (nodes - count(anchors)).max(1.0);
            Some(packet.rssi_j(nodes, count(anchors), count(heard) / others))
        }
        Messages::Survey => Some(packet.ml_tm_j(nodes, count(stops))),
        Messages::Unknown => None,
    }
}

fn count(count: usize) -> f64 {
    count as f64
}
