//! The numbers of a run as a whole.

use super::number::{Number, Unit, count, numbers};
use crate::summary::{EnergySummary, GatheringSummary, RoundSummary, SimulationSummary, Summary};

fn simulation(run: &Summary, read: fn(&SimulationSummary) -> u64) -> Option<f64> {
    run.simulation.as_ref().map(|simulation| count(read(simulation)))
}

fn gathering<T>(run: &Summary, read: fn(&GatheringSummary) -> Option<T>) -> Option<T> {
    run.gathering.as_ref().and_then(read)
}

fn packets(run: &Summary, read: fn(&GatheringSummary) -> Option<u64>) -> Option<f64> {
    gathering(run, read).map(count)
}

fn energy(run: &Summary) -> Option<EnergySummary> {
    gathering(run, |gathering| gathering.energy_j)
}

fn neighbours(run: &Summary) -> Option<&RoundSummary> {
    run.discovery.as_ref()?.neighbours.as_ref()
}

fn anchors(run: &Summary) -> Option<&RoundSummary> {
    run.discovery.as_ref()?.anchors.as_ref()
}

numbers! { Summary {
    NODES "nodes" Count |run| simulation(run, |simulation| simulation.nodes as u64);
    OBSTACLES "obstacles" Count |run| simulation(run, |simulation| simulation.obstacles as u64);
    STOPS "stops" Count |run| packets(run, |gathering| Some(gathering.stops as u64));
    PATH_LENGTH_M "path_length_m" Metre |run| gathering(run, |gathering| gathering.path_length_m);
    DURATION_S "duration_s" Second |run| gathering(run, |gathering| gathering.duration_s);
    PACKETS_OFFERED "packets_offered" Count |run| packets(run, |gathering| gathering.packets_offered);
    PACKETS_SENT "packets_sent" Count |run| packets(run, |gathering| gathering.packets_sent);
    PACKETS_RECEIVED "packets_received" Count |run| packets(run, |gathering| gathering.packets_received);
    LOST_COLLISION "lost_collision" Count |run| packets(run, |gathering| gathering.lost_collision);
    LOST_CHANNEL_ACCESS "lost_channel_access" Count |run| packets(run, |gathering| gathering.lost_channel_access);
    LOST_SIGNAL "lost_signal" Count |run| packets(run, |gathering| gathering.lost_signal);
    ENERGY_TX_J "energy_j.tx" Joule |run| energy(run).map(|energy| energy.tx);
    ENERGY_RX_J "energy_j.rx" Joule |run| energy(run).map(|energy| energy.rx);
    ENERGY_IDLE_J "energy_j.idle" Joule |run| energy(run).map(|energy| energy.idle);
    EVENTS "events" Count |run| simulation(run, |simulation| simulation.events);
    NEIGHBOURS_TX_J "discovery.neighbours.energy_j.tx" Joule |run| neighbours(run).map(|round| round.energy_j.tx);
    NEIGHBOURS_RX_J "discovery.neighbours.energy_j.rx" Joule |run| neighbours(run).map(|round| round.energy_j.rx);
    ANCHORS_TX_J "discovery.anchors.energy_j.tx" Joule |run| anchors(run).map(|round| round.energy_j.tx);
    ANCHORS_RX_J "discovery.anchors.energy_j.rx" Joule |run| anchors(run).map(|round| round.energy_j.rx);
}}
