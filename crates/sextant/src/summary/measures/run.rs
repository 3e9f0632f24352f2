//! The numbers of a run as a whole.

use super::number::{Number, Unit, count, numbers};
use crate::summary::{
    DelaySummary, EnergySummary, GatheringSummary, RoundSummary, SimulationSummary, Summary, TrafficSummary,
};

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

fn mac(run: &Summary, read: fn(&TrafficSummary) -> f64) -> Option<f64> {
    run.mac.as_ref().map(|mac| read(&mac.all))
}

fn mac_share(run: &Summary, read: fn(&TrafficSummary) -> Option<f64>) -> Option<f64> {
    read(&run.mac.as_ref()?.all)
}

fn delay(run: &Summary, read: fn(&DelaySummary) -> f64) -> Option<f64> {
    run.mac.as_ref()?.all.delay_s.as_ref().map(read)
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
    MAC_OFFERED "mac.offered" Count |run| mac(run, |mac| count(mac.offered));
    MAC_SENT "mac.sent" Count |run| mac(run, |mac| count(mac.sent));
    MAC_DELIVERED "mac.delivered" Count |run| mac(run, |mac| count(mac.delivered));
    MAC_PRR "mac.prr" Share |run| mac_share(run, |mac| mac.prr);
    MAC_DELIVERED_OF_SENT "mac.delivered_of_sent" Share |run| mac_share(run, |mac| mac.delivered_of_sent);
    MAC_THROUGHPUT "mac.throughput_bit_per_s" BitPerSecond |run| mac(run, |mac| mac.throughput_bit_per_s);
    MAC_DELAY_MEAN_S "mac.delay_s.mean" Second |run| delay(run, |delay| delay.mean);
    MAC_DELAY_P50_S "mac.delay_s.p50" Second |run| delay(run, |delay| delay.p50);
    MAC_DELAY_P90_S "mac.delay_s.p90" Second |run| delay(run, |delay| delay.p90);
    MAC_DELAY_P99_S "mac.delay_s.p99" Second |run| delay(run, |delay| delay.p99);
    MAC_TRANSMISSIONS "mac.transmissions" Count |run| mac(run, |mac| count(mac.transmissions));
    MAC_RETRIES "mac.retries" Count |run| mac(run, |mac| count(mac.retries));
    MAC_BACKOFFS "mac.backoffs" Count |run| mac(run, |mac| count(mac.backoffs));
    MAC_NO_ACKNOWLEDGEMENT "mac.no_acknowledgement" Count |run| mac(run, |mac| count(mac.no_acknowledgement));
    MAC_CHANNEL_ACCESS_FAILURES "mac.channel_access_failures" Count
        |run| mac(run, |mac| count(mac.channel_access_failures));
    MAC_LOST_COLLISION "mac.lost_collision" Count |run| mac(run, |mac| count(mac.lost_collision));
    MAC_LOST_CHANNEL_ACCESS "mac.lost_channel_access" Count |run| mac(run, |mac| count(mac.lost_channel_access));
    MAC_LOST_QUEUE "mac.lost_queue" Count |run| mac(run, |mac| count(mac.lost_queue));
    MAC_LOST_SIGNAL "mac.lost_signal" Count |run| mac(run, |mac| count(mac.lost_signal));
    MAC_PENDING "mac.pending" Count |run| mac(run, |mac| count(mac.pending));
    MAC_ENERGY_TX_J "mac.energy_j.tx" Joule |run| mac(run, |mac| mac.energy_j.tx);
    MAC_ENERGY_RX_J "mac.energy_j.rx" Joule |run| mac(run, |mac| mac.energy_j.rx);
    MAC_ENERGY_IDLE_J "mac.energy_j.idle" Joule |run| mac(run, |mac| mac.energy_j.idle);
    DETECTIONS "sensing.detections" Count |run| run.sensing.map(|sensing| count(sensing.detections));
    SAMPLES "sensing.samples" Count |run| run.sensing.map(|sensing| count(sensing.samples));
    MAC_OUT_OF_RANGE "mac.out_of_range" Count |run| mac(run, |mac| count(mac.out_of_range));
    MAC_NOT_LISTENED "mac.not_listened" Count |run| mac(run, |mac| count(mac.not_listened));
    MAC_NOT_LISTENED_TRANSMITTING "mac.not_listened_by.transmitting" Count
        |run| mac(run, |mac| count(mac.not_listened_by.transmitting));
    MAC_NOT_LISTENED_ASLEEP "mac.not_listened_by.asleep" Count |run| mac(run, |mac| count(mac.not_listened_by.asleep));
    MAC_NOT_LISTENED_OFF "mac.not_listened_by.off" Count |run| mac(run, |mac| count(mac.not_listened_by.off));
    LOST_QUEUE "lost_queue" Count |run| packets(run, |gathering| gathering.lost_queue);
    OUT_OF_RANGE "out_of_range" Count |run| packets(run, |gathering| gathering.out_of_range);
    NOT_LISTENED "not_listened" Count |run| packets(run, |gathering| gathering.not_listened);
    NOT_LISTENED_TRANSMITTING "not_listened_by.transmitting" Count
        |run| packets(run, |gathering| gathering.not_listened_by.map(|by| by.transmitting));
    NOT_LISTENED_ASLEEP "not_listened_by.asleep" Count
        |run| packets(run, |gathering| gathering.not_listened_by.map(|by| by.asleep));
    NOT_LISTENED_OFF "not_listened_by.off" Count |run| packets(run, |gathering| gathering.not_listened_by.map(|by| by.off));
    PENDING "pending" Count |run| packets(run, |gathering| gathering.pending);
    ANCHORS_RX_J "discovery.anchors.energy_j.rx" Joule |run| anchors(run).map(|round| round.energy_j.rx);
}}
