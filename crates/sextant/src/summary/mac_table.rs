//! The traffic of nodes to sinks as a printed table.

use std::io::{self, Write};

use super::mac::{MacSummary, NamedTraffic, SleepSummary, SlotSummary, TrafficSummary};
use crate::columns::{Align, columns};

/// Nodes that are printed one by one.
const PRINTED_NODES: usize = 10;

/// Writes the traffic of one network.
pub(super) fn write(mac: &MacSummary, out: &mut impl Write) -> io::Result<()> {
    if let Some(network) = &mac.network {
        writeln!(out, "network {network}")?;
    }
    columns(&rows(mac), &[Align::Left, Align::Right, Align::Left], out)?;
    writeln!(out)?;
    let several_sinks = mac.sinks.len() > 1;
    for sink in mac.sinks.iter().filter(|_| several_sinks) {
        writeln!(out, "{}: {} frames received", sink.name, sink.received)?;
    }
    let mut named: Vec<_> = mac.groups.iter().map(named).collect();
    if mac.nodes.len() <= PRINTED_NODES {
        named.extend(mac.nodes.iter().map(self::named));
    }
    named.extend(mac.sinks.iter().filter_map(|sink| Some((&*sink.name, sink.sent.as_ref()?))));
    if !named.is_empty() {
        let header = ["", "offered", "delivered", "PRR", "bit/s", "mean delay", "p99", "retries", "energy"];
        let mut lines = vec![header.map(str::to_owned).to_vec()];
        lines.extend(named.into_iter().map(|(name, traffic)| line(name, traffic)));
        let mut align = vec![Align::Right; lines[0].len()];
        align[0] = Align::Left;
        columns(&lines, &align, out)?;
        writeln!(out)?;
    }
    if mac.nodes.len() > PRINTED_NODES {
        writeln!(out, "each of the {} nodes: in the summary, `mac.nodes`\n", mac.nodes.len())?;
    }
    Ok(())
}

fn named(traffic: &NamedTraffic) -> (&str, &TrafficSummary) {
    (&traffic.name, &traffic.traffic)
}

pub(super) fn share(share: Option<f64>) -> String {
    share.map_or_else(|| "-".to_owned(), |share| format!("{:.2} %", 100.0 * share))
}

pub(super) fn milliseconds(seconds: Option<f64>) -> String {
    seconds.map_or_else(|| "-".to_owned(), |seconds| format!("{:.3} ms", 1e3 * seconds))
}

fn rows(mac: &MacSummary) -> Vec<Vec<String>> {
    let all = &mac.all;
    let delay = |read: fn(&super::mac::DelaySummary) -> f64| milliseconds(all.delay_s.as_ref().map(read));
    let energy = all.energy_j.tx + all.energy_j.rx + all.energy_j.idle;
    let unheard = &all.not_listened_by;
    let rows: [(&str, String, &str); 24] = [
        ("counted time", format!("{:.3}", mac.duration_s), "s, after the warm-up"),
        ("packets offered", all.offered.to_string(), ""),
        ("packets delivered", all.delivered.to_string(), ""),
        ("PRR", share(all.prr), "delivered, of those offered and not pending"),
        ("delivered of sent", share(all.delivered_of_sent), ""),
        ("throughput", format!("{:.0}", all.throughput_bit_per_s), "bit/s of payload"),
        ("delay, mean", delay(|delay| delay.mean), "from offer to reception"),
        ("delay, p50", delay(|delay| delay.p50), ""),
        ("delay, p90", delay(|delay| delay.p90), ""),
        ("delay, p99", delay(|delay| delay.p99), ""),
        ("transmissions", all.transmissions.to_string(), ""),
        ("retries", all.retries.to_string(), ""),
        ("backoffs", all.backoffs.to_string(), ""),
        ("no acknowledgement", all.no_acknowledgement.to_string(), "packets"),
        ("lost to collisions", all.lost_collision.to_string(), ""),
        ("lost to a busy channel", all.lost_channel_access.to_string(), ""),
        ("lost to a full queue", all.lost_queue.to_string(), ""),
        ("lost to a weak signal", all.lost_signal.to_string(), ""),
        ("out of range", all.out_of_range.to_string(), ""),
        ("receiver transmitting", unheard.transmitting.to_string(), "lost, because it sent something itself"),
        ("receiver asleep", unheard.asleep.to_string(), "lost"),
        ("receiver off", unheard.off.to_string(), "lost"),
        ("pending", all.pending.to_string(), ""),
        ("energy of the nodes", format!("{energy:.3}"), "J"),
    ];
    let died = Some(all.died).filter(|&packets| packets > 0);
    let died = died.map(|packets| ("lost in dead nodes", packets.to_string(), "they waited in their node"));
    let rows = rows.into_iter().chain(died).map(owned);
    rows.chain(mac.slots.iter().flat_map(|slots| slot_rows(slots, mac.nodes.len())))
        .chain(mac.sleep.iter().flat_map(sleep_rows))
        .collect()
}

/// The rows of a network whose stations sleep between checks of the channel.
fn sleep_rows(sleep: &SleepSummary) -> Vec<Vec<String>> {
    let row = |name: &str, value: String, note: &str| vec![name.to_owned(), value, note.to_owned()];
    let mut rows = vec![row("duty cycle", percent_or_none(sleep.duty_cycle), &of_a_node(sleep.counted_nodes))];
    if let (Some(share), Some(node)) = (sleep.worst_duty_cycle, &sleep.worst_node) {
        rows.push(row("duty cycle, worst", percent(share), &format!("of `{node}`")));
    }
    rows.extend(sleep.sink_duty_cycle.map(|share| row("duty cycle, sinks", percent(share), "")));
    rows.push(row("checks", sleep.checks.to_string(), "of the channel, by all nodes"));
    let strobes = sleep.strobes_per_packet.map_or_else(|| "-".to_owned(), |strobes| format!("{strobes:.1}"));
    rows.push(row("strobes per packet", strobes, "to wake the receiver"));
    rows.extend(
        sleep.mean_power_w.map(|power_w| row("mean power", format!("{:.1}", 1e6 * power_w), "uW, of a node")),
    );
    rows.push(row("energy asleep", format!("{:.3}", sleep.asleep_j), "J"));
    rows
}

/// The rows of a network with slots.
fn slot_rows(slots: &SlotSummary, nodes: usize) -> Vec<Vec<String>> {
    let note = of_a_node(slots.counted_nodes);
    let mut rows = vec![("duty cycle", percent_or_none(slots.duty_cycle), &*note)];
    rows.extend(slots.sink_duty_cycle.map(|share| ("duty cycle, sinks", percent(share), "")));
    for (name, count, note) in [
        ("slots, idle listening", slots.idle_listen, "of all nodes"),
        ("slots, acknowledged", slots.transmit_acknowledged, "sent to one station"),
        ("slots, unacknowledged", slots.transmit_unacknowledged, "sent to one station"),
        ("slots, sent to all", slots.transmit, "enhanced beacons included"),
        ("slots, acknowledging", slots.receive_acknowledge, "received and acknowledged"),
        ("slots, receiving", slots.receive, "received and not acknowledged"),
        ("network lost", slots.lost, "times"),
    ] {
        rows.push((name, count.to_string(), note));
    }
    let of_slots =
        |current_a: f64| ("mean current", format!("{:.1}", 1e6 * current_a), "uA, by published charges of slots");
    rows.extend(slots.mean_current_a.map(of_slots));
    rows.push(("nodes in the network", slots.joined.to_string(), "at the end"));
    if let Some(cells) = &slots.negotiated {
        rows.push(("negotiated cells", format!("{:.3}", cells.mean_cells), "of a node, on average"));
        let at_end = cells.cells.map(|cells| format!("{cells:.3}"));
        rows.extend(at_end.map(|cells| ("negotiated cells, end", cells, "of a node in the network, on average")));
        rows.push(("6P transactions", cells.transactions.to_string(), "of all nodes"));
        rows.push(("6P failures", cells.failures.to_string(), "transactions without success"));
        rows.push(("relocations", cells.relocations.to_string(), "cells that delivered too little"));
    }
    let joined = slots.joined_by_scan.map(|joined| format!("s, on average, of {joined} of {nodes} that scanned"));
    let join_s = slots.join_s.map(|join_s| format!("{join_s:.3}"));
    rows.extend(join_s.zip(joined.as_deref()).map(|(join_s, note)| ("joined after", join_s, note)));
    rows.into_iter().map(owned).collect()
}

fn percent(share: f64) -> String {
    format!("{:.3} %", 100.0 * share)
}

fn percent_or_none(share: Option<f64>) -> String {
    share.map_or_else(|| "-".to_owned(), percent)
}

/// Of what a mean is, where only some nodes lived after the warm-up.
fn of_a_node(counted: Option<usize>) -> String {
    counted
        .map_or_else(|| "of a node".to_owned(), |nodes| format!("of a node, of {nodes} that lived after the warm-up"))
}

fn owned((name, value, note): (&str, String, &str)) -> Vec<String> {
    vec![name.to_owned(), value, note.to_owned()]
}

fn line(name: &str, traffic: &TrafficSummary) -> Vec<String> {
    let energy = traffic.energy_j.tx + traffic.energy_j.rx + traffic.energy_j.idle;
    vec![
        name.to_owned(),
        traffic.offered.to_string(),
        traffic.delivered.to_string(),
        share(traffic.prr),
        format!("{:.0}", traffic.throughput_bit_per_s),
        milliseconds(traffic.delay_s.map(|delay| delay.mean)),
        milliseconds(traffic.delay_s.map(|delay| delay.p99)),
        traffic.retries.to_string(),
        format!("{energy:.3} J"),
    ]
}
