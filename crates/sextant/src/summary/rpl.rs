//! A tree of RPL, and packets in fragments, as a summary and as lines of a table.

use serde::Serialize;

/// What a tree of RPL took. Messages are counted when they are given to the MAC, on each hop.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RplSummary {
    /// The objective function: `of0` or `mrhof`.
    pub objective: &'static str,
    /// Who knows ways down: `non_storing`, `storing` or `none`.
    pub mode: &'static str,
    /// DIOs to all.
    pub dio: u64,
    /// DIOs that were left out because others had said the same.
    pub dio_left_out: u64,
    /// DIOs to one neighbour: probes of links, and answers to packets with a wrong rank.
    pub unicast_dio: u64,
    /// DISs.
    pub dis: u64,
    /// DAOs.
    pub dao: u64,
    /// Answers to DAOs.
    pub dao_ack: u64,
    /// Frames with DAOs and their answers on air, retries included.
    pub dao_transmissions: u64,
    /// DAOs and their answers that found a queue full, or were given up on a hop.
    pub dao_lost: u64,
    /// Packets that came from a station with a rank that does not fit, each time.
    pub rank_errors: u64,
    /// Packets that were dropped for that.
    pub rank_error_drops: u64,
    /// DAOs that found a table of ways full.
    pub full_tables: u64,
    /// How often a node forgot its neighbours, because no answer to its DAOs came.
    pub local_repairs: u64,
    /// Time at which the roots had learned ways to all nodes (s), warm-up included. Absent if they never had, or nobody knows ways
    /// down.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub routes_known_s: Option<f64>,
    /// Most ways down that a station keeps at the end.
    pub most_routes: usize,
    /// Nodes whose parent died, and whether they had a way to a sink again. Absent if no node with children died.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub healing: Option<HealingSummary>,
}

/// How a tree healed after deaths of nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct HealingSummary {
    /// Nodes whose parent died.
    pub orphans: u64,
    /// Those whose parents led over living nodes to a sink again.
    pub healed: u64,
    /// Mean time from the death to that (s). Absent if none had one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_s: Option<f64>,
    /// The longest one (s).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_s: Option<f64>,
}

/// Packets in fragments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct FragmentsSummary {
    /// Frames with fragments that were given to the MAC, on all hops.
    pub fragments: u64,
    /// Packets that a station could not put together: a fragment was lost, or there was no room.
    pub reassembly_failures: u64,
}

impl RplSummary {
    /// Its lines in a table: name, value, and what it is.
    pub(super) fn rows(&self) -> Vec<(&'static str, String, &'static str)> {
        let seconds = |s: Option<f64>| s.map_or_else(|| "-".to_owned(), |s| format!("{s:.1} s"));
        let mut rows = vec![
            ("DIO", self.dio.to_string(), "to all"),
            ("DIO to one", self.unicast_dio.to_string(), "probes, and answers to wrong ranks"),
            ("DIS", self.dis.to_string(), ""),
            ("DAO", self.dao.to_string(), "on all hops"),
            ("DAO-ACK", self.dao_ack.to_string(), "on all hops"),
            ("rank errors", self.rank_errors.to_string(), "packets from a station that is not farther away"),
            ("full tables", self.full_tables.to_string(), "DAOs that found no room"),
            ("local repairs", self.local_repairs.to_string(), "after DAOs without an answer"),
            ("ways to all nodes", seconds(self.routes_known_s), "time until the roots had learned them"),
            ("most ways in a station", self.most_routes.to_string(), "at the end"),
        ];
        if let Some(healing) = &self.healing {
            let healed = format!("{} of {}", healing.healed, healing.orphans);
            rows.push(("orphans with a way again", healed, "nodes whose parent died"));
            rows.push(("time to a way again", seconds(healing.mean_s), "mean"));
        }
        rows
    }
}

impl FragmentsSummary {
    /// Its lines in a table.
    pub(super) fn rows(self) -> [(&'static str, String, &'static str); 2] {
        [
            ("fragments", self.fragments.to_string(), "frames on all hops, without retries"),
            ("packets not put together", self.reassembly_failures.to_string(), "a fragment was lost, or no room"),
        ]
    }
}
