//! The forecast of a scenario as a table.

use std::io::{self, Write};

use sextant::Forecast;
use sextant::forecast::{CostForecast, NetworkForecast, WayForecast};
use sextant_kernel::text::{counted, listed, shortened};

/// Writes a forecast, one line for each thing that follows.
pub(super) fn write(forecast: &Forecast, out: &mut impl Write) -> io::Result<()> {
    let mut lines: Vec<(String, String)> = Vec::new();
    forecast.networks.iter().for_each(|network| of_network(network, &mut lines));
    forecast.robots.iter().for_each(|way| of_way(way, &mut lines));
    if let Some(cost) = &forecast.cost {
        lines.push(("simulation".to_owned(), of_cost(cost)));
    }
    let names: Vec<_> = lines.iter().map(|(name, text)| (shortened(name), text)).collect();
    let width = names.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    for (name, text) in &names {
        writeln!(out, "  {name:width$}  {text}")?;
    }
    Ok(())
}

fn of_network(network: &NetworkForecast, lines: &mut Vec<(String, String)>) {
    let called = |what: &str| network.name.as_ref().map_or(what.to_owned(), |name| format!("{name}: {what}"));
    let range = &network.range;
    let limit = range.limit_m.map_or(String::new(), |limit_m| format!("; the hard radius is {limit_m:.1} m"));
    let text = format!(
        "half of the frames at {:.1} m, 1 % at {:.1} m, without obstacles{limit}",
        range.half_m, range.hundredth_m
    );
    lines.push((called("radio range"), text));
    if let Some(neighbours) = &network.neighbours {
        let of = if neighbours.counted < network.nodes {
            format!(", counted at {} nodes", neighbours.counted)
        } else {
            String::new()
        };
        let text = format!("{:.1} a node, {} to {}{of}", neighbours.mean, neighbours.min, neighbours.max);
        lines.push((called("neighbours"), text));
    }
    if let Some(fading) = &network.fading {
        let when = if fading.changes_in_time { "in time" } else { "from place to place" };
        let text = format!(
            "{}, {when}: one draw of ten is below {:.1} dB, one of a hundred below {:.1} dB",
            fading.law, fading.tenth_below_db, fading.hundredth_below_db
        );
        lines.push((called("fading"), text));
    }
    if let Some(share) = network.burst_share {
        lines.push((called("bursts of loss"), format!("links are bad for {:.1} % of the time", 100.0 * share)));
    }
    if let Some(load) = &network.load {
        let text = format!(
            "{:.4} Erlang at a node, at most {:.4}: frames of {:.3} ms, {:.3} a second and node",
            load.mean_erlang,
            load.max_erlang,
            1e3 * load.airtime_s,
            load.rate_per_s
        );
        lines.push((called("channel load"), text));
    }
    if let Some(why) = network.load_unknown {
        lines.push((called("channel load"), format!("not known before the run: {why}")));
    }
    if let Some(interval) = &network.interval {
        let text = format!(
            "best {:.3} s, where checks and waking take {:.1} uW; {:.1} uW with {:.3} s",
            interval.best_s,
            1e6 * interval.best_power_w,
            1e6 * interval.power_w,
            interval.interval_s
        );
        lines.push((called("wake-up interval"), text));
    }
}

fn of_way(way: &WayForecast, lines: &mut Vec<(String, String)>) {
    let estimate = match (way.cut, way.estimate) {
        (true, _) => " (only the first part of a long way)",
        (false, true) => " (an estimate: the way depends on what is heard)",
        (false, false) => "",
    };
    let text =
        format!("{:.1} m, {}, {:.1} s{estimate}", way.path_length_m, counted(way.stops, "stop"), way.duration_s);
    lines.push((format!("{}: path", way.robot), text));
    if let (Some(offered), Some(expected)) = (way.packets_offered, way.packets_expected) {
        let text =
            format!("{offered:.2} sent by each node, {expected:.1} received of all nodes if none are lost to others");
        lines.push((format!("{}: packets a stop", way.robot), text));
    }
    if !way.out_of_reach.is_empty() {
        let text = format!("{} at less than 1 % at each stop", counted(way.out_of_reach.len(), "node"));
        lines.push((format!("{}: out of reach", way.robot), text));
    }
}

fn of_cost(cost: &CostForecast) -> String {
    let without = match &*cost.without {
        [] => String::new(),
        without => format!(" (without {})", listed(without)),
    };
    let events = match cost.events.zip(cost.cpu_s) {
        Some((events, cpu_s)) => format!(", {events:.0} events, {cpu_s:.1} s on one core, without maps"),
        None => String::new(),
    };
    format!("{:.1} s, about {:.0} frames{without}{events}", cost.sim_time_s, cost.frames)
}
