//! Packets that go over several hops as a printed table.

use std::io::{self, Write};

use super::battery::days;
use super::mac::DelaySummary;
use super::mac_table::{milliseconds, share};
use super::routing::{DepthSummary, RoutingSummary};
use super::rpl::RplSummary;
use crate::columns::{Align, columns};

/// Writes what became of packets over several hops, and of the nodes by depth.
pub(super) fn write(routing: &RoutingSummary, out: &mut impl Write) -> io::Result<()> {
    let whither = match routing.to {
        None => "packets to a sink",
        Some("nodes") => "packets to nodes",
        Some(_) => "packets to a sink, which answers",
    };
    match &routing.rpl {
        None => writeln!(out, "end to end: {whither}, tree `{}`", routing.tree)?,
        Some(rpl) => writeln!(out, "end to end: {whither}, tree `rpl` (`{}`, `{}`)", rpl.objective, rpl.mode)?,
    }
    columns(&rows(routing), &[Align::Left, Align::Right, Align::Left], out)?;
    writeln!(out)?;
    let header = ["depth", "nodes", "offered", "delivered", "delivery", "mean delay", "energy of a node", "sending"];
    let mut lines = vec![header.map(str::to_owned).to_vec()];
    lines.extend(routing.by_depth.iter().map(line));
    if routing.by_depth.iter().any(|nodes| nodes.with_way.is_some()) {
        lines[0].insert(2, "with a way".to_owned());
        for (line, nodes) in lines[1..].iter_mut().zip(&routing.by_depth) {
            line.insert(2, nodes.with_way.unwrap_or(nodes.nodes).to_string());
        }
    }
    if routing.by_depth.iter().any(|nodes| nodes.depleted.is_some()) {
        lines[0].extend(["empty batteries", "first lifetime"].map(str::to_owned));
        for (line, nodes) in lines[1..].iter_mut().zip(&routing.by_depth) {
            line.push(nodes.depleted.map_or_else(|| "-".to_owned(), |dead| dead.to_string()));
            line.push(
                nodes.lifetime_d.map_or_else(|| "-".to_owned(), |lifetime| format!("{} d", days(lifetime.min))),
            );
        }
    }
    if routing.by_depth.iter().any(|nodes| nodes.counted_nodes.is_some()) {
        lines[0].push("lived after the warm-up".to_owned());
        for (line, nodes) in lines[1..].iter_mut().zip(&routing.by_depth) {
            line.push(nodes.counted_nodes.unwrap_or(nodes.nodes).to_string());
        }
    }
    let align = vec![Align::Right; lines[0].len()];
    columns(&lines, &align, out)?;
    writeln!(out)
}

fn decimals(number: Option<f64>) -> String {
    number.map_or_else(|| "-".to_owned(), |number| format!("{number:.3}"))
}

fn rows(routing: &RoutingSummary) -> Vec<Vec<String>> {
    let delay = |read: fn(&DelaySummary) -> f64| milliseconds(routing.delay_s.as_ref().map(read));
    let rows: [(&str, String, &str); 21] = [
        ("packets offered", routing.offered.to_string(), ""),
        ("packets delivered", routing.delivered.to_string(), ""),
        ("delivery", share(routing.delivery), "delivered, of those offered and not pending"),
        ("delay, mean", delay(|delay| delay.mean), "from offer to arrival"),
        ("delay, p50", delay(|delay| delay.p50), ""),
        ("delay, p99", delay(|delay| delay.p99), ""),
        ("hops, mean", decimals(routing.hops.map(|hops| hops.mean)), ""),
        ("hops, most", routing.hops.map_or_else(|| "-".to_owned(), |hops| hops.max.to_string()), ""),
        ("stretch", decimals(routing.stretch), "hops, over those of the shortest way of usable links"),
        ("transmissions", decimals(routing.transmissions_per_delivery), "on all hops, for each packet delivered"),
        ("duplicates", routing.duplicates.to_string(), "copies that were dropped"),
        ("loops", routing.loops.to_string(), "times that a packet came again after more hops"),
        ("packets lost", routing.lost.to_string(), "on the way"),
        ("lost to a full queue", routing.queue_drops.to_string(), ""),
        ("given up on a hop", routing.given_up.to_string(), "after all tries"),
        ("too many hops", routing.hop_limit_drops.to_string(), ""),
        ("beacons", routing.beacons.to_string(), ""),
        ("changes of parents", routing.parent_changes.to_string(), "after the first one of each node"),
        ("nodes without a way", routing.without_way.to_string(), "living at the end, dead ones not counted"),
        ("depth", routing.depth.to_string(), "most hops at the end, of nodes that live and have a way"),
        ("pending", routing.pending.to_string(), "in queues at the end"),
    ];
    let mut rows = rows.to_vec();
    if routing.died > 0 {
        rows.push(("lost in dead nodes", routing.died.to_string(), "they waited in queues"));
    }
    if let Some(no_route) = routing.no_route {
        rows.push(("no way down", no_route.to_string(), "dropped by a sink"));
    }
    if let Some(answers) = &routing.answers {
        let hops = answers.hops.map(|hops| hops.mean);
        let mean_s = answers.delay_s.as_ref().map(|delay| delay.mean);
        rows.push(("answers", answers.offered.to_string(), ""));
        rows.push(("answers, delivery", share(answers.delivery), "delivered, of those offered and not pending"));
        rows.push(("answers, mean delay", milliseconds(mean_s), "from the sink to the node"));
        rows.push(("answers, mean hops", decimals(hops), ""));
    }
    rows.extend(routing.fragments.iter().flat_map(|fragments| fragments.rows()));
    rows.extend(routing.rpl.iter().flat_map(RplSummary::rows));
    rows.into_iter().map(|(name, value, note)| vec![name.to_owned(), value, note.to_owned()]).collect()
}

fn line(nodes: &DepthSummary) -> Vec<String> {
    vec![
        nodes.depth.map_or_else(|| "none".to_owned(), |depth| depth.to_string()),
        nodes.nodes.to_string(),
        nodes.offered.to_string(),
        nodes.delivered.to_string(),
        share(nodes.delivery),
        milliseconds(nodes.delay_s),
        format!("{:.3} J", nodes.energy_j),
        format!("{:.3} J", nodes.energy_tx_j),
    ]
}
