//! The batteries of the nodes: how long they last, and which are empty.

use std::io::{self, Write};

use serde::Serialize;

use crate::columns::{Align, columns};

/// The batteries of the nodes.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct BatterySummary {
    /// How long nodes last, from a full battery: extrapolated from the mean power since the warm-up, or measured for nodes that
    /// died in the run. Absent if no node has a load.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lifetime_d: Option<LifetimeSummary>,
    /// Nodes whose battery is empty at the end.
    pub depleted: usize,
    /// When the first battery was empty (s). Absent if none was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_death_s: Option<f64>,
    /// When the batteries of half of the nodes, rounded up, were empty (s). Absent if fewer were.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub half_death_s: Option<f64>,
    /// The nodes.
    pub nodes: Vec<BatteryNodeSummary>,
}

/// Lifetimes of nodes (d).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct LifetimeSummary {
    /// Of the node that lasts shortest: until the first one is empty (d).
    pub min: f64,
    /// Median over the nodes (d). Absent if half of them have no load: it is longer than any number.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub median: Option<f64>,
    /// Of the node that lasts longest (d). Absent if one has no load.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max: Option<f64>,
    /// Nodes without a load, which last for ever. Absent if there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub endless: Option<usize>,
}

/// The battery of a node.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct BatteryNodeSummary {
    /// Name of the node.
    pub name: String,
    /// Capacity (J).
    pub capacity_j: f64,
    /// What is left at the end (J).
    pub left_j: f64,
    /// Mean power of radios and load since the warm-up, as long as it lived (W).
    pub mean_power_w: f64,
    /// How long it lasts from full with this power, or how long it lasted (d). Absent without a load.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lifetime_d: Option<f64>,
    /// When it was empty (s). Absent if it was not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub depleted_s: Option<f64>,
}

/// Days with as many digits as help.
pub(super) fn days(days: f64) -> String {
    if days < 0.1 { format!("{days:.6}") } else { format!("{days:.2}") }
}

/// Writes the batteries as a table.
pub(super) fn write(battery: &BatterySummary, out: &mut impl Write) -> io::Result<()> {
    let mut rows = Vec::new();
    let mut row = |name: &str, value: String, note: &str| rows.push(vec![name.to_owned(), value, note.to_owned()]);
    if let Some(lifetime) = battery.lifetime_d {
        let note = match battery.depleted {
            0 => "d, extrapolated from the mean power of this run",
            count if count == battery.nodes.len() => "d",
            _ => "d, extrapolated for nodes that live",
        };
        row("battery lifetime, first", days(lifetime.min), note);
        row("battery lifetime, median", lifetime.median.map_or_else(|| "-".to_owned(), days), note);
        if let Some(endless) = lifetime.endless {
            row("without a load", endless.to_string(), "nodes that last for ever");
        }
    }
    row("batteries empty", battery.depleted.to_string(), &format!("of {}", battery.nodes.len()));
    if let Some(first_s) = battery.first_death_s {
        row("first battery empty", format!("{first_s:.3}"), "s");
    }
    if let Some(half_s) = battery.half_death_s {
        row("half of them empty", format!("{half_s:.3}"), "s");
    }
    columns(&rows, &[Align::Left, Align::Right, Align::Left], out)?;
    writeln!(out)
}
