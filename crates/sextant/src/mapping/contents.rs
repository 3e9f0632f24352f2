//! What is inside the log of a robot, and what is odd in it.

use std::fmt;

use serde::Serialize;
use sextant_channel::{ReceptionLog, SectorTable};
use sextant_kernel::NodeId;

use super::notes;
use crate::summary::LogCounts;
use sextant_kernel::text::counted;
use sextant_logs::RobotLog;
use sextant_logs::doctor::Finding;

/// The contents of the log of a robot.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Contents {
    /// Nodes that the log names.
    pub nodes: usize,
    /// Nodes of which at least one packet was received.
    pub heard: usize,
    /// Robots that listened.
    pub robots: usize,
    /// Places where robots listened.
    pub stops: usize,
    /// Length of the paths through the stops (m).
    pub path_length_m: f64,
    /// Time from the first stop to the last (s). Absent if the log has no times.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub duration_s: Option<f64>,
    /// Packets received.
    pub packets_received: u64,
    /// Packets that were sent while a robot listened, as far as the log has pairs of a node and a stop.
    pub packets_sent: u64,
    /// Pairs of a node and a stop with a signal strength.
    pub strengths: usize,
    /// The weakest and the strongest of them (dBm). Absent without strengths.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strengths_dbm: Option<[f64; 2]>,
    /// The antenna sectors. Absent if the log has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sectors: Option<SectorContents>,
    /// How it was read.
    pub notes: Vec<String>,
    /// What is odd, what it costs, and what corrects it.
    pub findings: Vec<Finding>,
}

/// What a log has of the sectors of the robot's antenna.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SectorContents {
    /// Their identities: `0 to 7, 9`. Absent if their directions are unknown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub identities: Option<String>,
    /// Whether the gains of the antenna are known.
    pub gains: bool,
    /// Whether the antenna turns with the robot: stops have headings.
    pub turning: bool,
    /// Pairs of a node and a stop with the best sector.
    pub best: usize,
    /// Pairs of a node, a stop and a sector with a signal-to-noise ratio.
    pub snrs: usize,
}

impl SectorContents {
    fn of(log: &ReceptionLog) -> Option<Self> {
        let table = log.sectors();
        let best = log.receptions().iter().filter(|row| row.received > 0 && row.sector.is_some()).count();
        let snrs = log.sector_reports().count();
        (table.is_some() || best > 0 || snrs > 0).then(|| Self {
            identities: table.map(SectorTable::identities),
            gains: table.is_some_and(|table| table.gains().is_some()),
            turning: log.has_headings(),
            best,
            snrs,
        })
    }
}

impl fmt::Display for SectorContents {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let gains = if self.gains { "with" } else { "without" };
        let turns = if self.turning { ", which turns with the robot" } else { "" };
        match &self.identities {
            Some(identities) => write!(f, "{identities}, {gains} the gains of the antenna{turns}")?,
            None => write!(f, "of unknown directions")?,
        }
        write!(f, "; {} with the best one, {}", counted(self.best, "pair"), counted(self.snrs, "SNR"))
    }
}

impl Contents {
    /// The contents of a log.
    #[must_use]
    pub fn of(read: &RobotLog) -> Self {
        let log = &read.log;
        let nodes = (0..log.node_count()).map(NodeId::from_index);
        let receptions = || log.receptions();
        let receptions = receptions();
        let strengths = receptions.iter().filter(|row| row.received > 0).filter_map(|row| row.rssi_dbm);
        let range = strengths.clone().fold(None, |range: Option<[f64; 2]>, level| {
            let [low, high] = range.unwrap_or([level, level]);
            Some([low.min(level), high.max(level)])
        });
        let times = log.stops().iter().map(|stop| stop.time);
        let span =
            times.clone().min().zip(times.max()).map(|(first, last)| last.saturating_since(first).as_secs_f64());
        Self {
            nodes: log.node_count(),
            heard: nodes.filter(|&node| log.of(node).iter().any(|row| row.received > 0)).count(),
            robots: log.robot_count(),
            stops: log.stops().len(),
            // Adding 0 makes the -0 of a sum of nothing a 0.
            path_length_m: log.drives().map(|drive| drive.length_m()).sum::<f64>() + 0.0,
            duration_s: span.filter(|span_s| *span_s > 0.0),
            packets_received: receptions.iter().map(|row| u64::from(row.received)).sum(),
            packets_sent: receptions.iter().map(|row| u64::from(row.sent)).sum(),
            strengths: strengths.count(),
            strengths_dbm: range,
            sectors: SectorContents::of(log),
            notes: (read.notes.iter().cloned())
                .chain(read.odometry.as_deref().map(notes::of_odometry))
                .chain(notes::of_log(log, &LogCounts::of(log)))
                .collect(),
            findings: read.findings.clone(),
        }
    }
}

impl fmt::Display for Contents {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "nodes      {} named, {} heard", self.nodes, self.heard)?;
        let duration = self.duration_s.map_or_else(String::new, |span_s| format!(" in {span_s:.1} s"));
        let robots = if self.robots > 1 { format!(" of {} robots", self.robots) } else { String::new() };
        writeln!(
            f,
            "stops      {}{robots}, {:.1} m from the first to the last{duration}",
            self.stops, self.path_length_m
        )?;
        writeln!(
            f,
            "packets    {} received of {} in the pairs that are listed",
            self.packets_received, self.packets_sent
        )?;
        match self.strengths_dbm {
            Some([low, high]) => {
                writeln!(f, "strengths  {} from {low:.1} to {high:.1} dBm", counted(self.strengths, "pair"))?
            }
            None => writeln!(f, "strengths  none")?,
        }
        if let Some(sectors) = &self.sectors {
            writeln!(f, "sectors    {sectors}")?;
        }
        for note in &self.notes {
            writeln!(f, "note: {note}")?;
        }
        for finding in &self.findings {
            writeln!(f, "odd: {}\n  costs: {}\n  do: {}", finding.odd, finding.cost, finding.remedy)?;
        }
        if self.findings.is_empty() {
            writeln!(f, "nothing odd was found")?;
        }
        Ok(())
    }
}
