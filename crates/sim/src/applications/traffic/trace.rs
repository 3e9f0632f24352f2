//! Traffic from a table.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

use serde::Deserialize;
use sextant_kernel::text::of_cell;
use sextant_kernel::{Files, NodeId, SettingError, SimTime};

use crate::csv_rows::{cell_fault, line_of, row_fault};
use crate::world::layout::PlacedNode;

/// Latest time of a frame (s).
const LATEST_S: f64 = 1e8;

/// The frames of each node, in the order of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Trace {
    frames: Vec<Vec<(SimTime, u8)>>,
}

/// One row of the table.
#[derive(Deserialize)]
struct TraceRow {
    t_s: f64,
    node: String,
    mpdu_octets: u8,
}

const COLUMNS: &str =
    "a header `t_s,node,mpdu_octets`, and below it a time (s), the name of a node, and a size (octets)";

impl Trace {
    /// Frame number `count` of a node: when it is offered, and its size (octets).
    pub(super) fn frame(&self, node: NodeId, count: u64) -> Option<(SimTime, u8)> {
        self.frames.get(node.index())?.get(usize::try_from(count).ok()?).copied()
    }

    /// When each frame is due.
    pub(super) fn frames(&self) -> impl Iterator<Item = SimTime> {
        self.frames.iter().flatten().map(|&(due, _)| due)
    }

    pub(super) fn largest_octets(&self) -> u8 {
        self.frames.iter().flatten().map(|&(_, octets)| octets).max().unwrap_or(0)
    }
}

/// Reads the table `file`, whose path is among `files`.
pub(super) fn read(file: &Path, nodes: &[PlacedNode], files: &Files) -> Result<Trace, SettingError> {
    let path = files.path(file);
    let text = files.read_text(file).map_err(|error| {
        SettingError::new("file", format!("`{}`: {error}", path.display()), "a CSV file that can be read")
    })?;
    parse(&text, &file.display().to_string(), nodes).map_err(|error| files.discreet(file, error))
}

fn parse(text: &str, file: &str, nodes: &[PlacedNode]) -> Result<Trace, SettingError> {
    let refuse = |line: u64, what: String, allowed: &str| {
        SettingError::new("file", format!("`{file}`, line {line}: {what}"), allowed)
    };
    let by_name: BTreeMap<&str, usize> = nodes.iter().enumerate().map(|(i, node)| (&*node.name, i)).collect();
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
    let header = reader.headers().map_err(|error| refuse(1, error.to_string(), COLUMNS))?.clone();
    for column in ["t_s", "node", "mpdu_octets"] {
        if !header.iter().any(|it| it == column) {
            return Err(refuse(1, format!("no column `{column}`"), COLUMNS));
        }
    }
    let mut trace = Trace { frames: vec![Vec::new(); nodes.len()] };
    let (mut last_s, mut any) = (0.0, false);
    for record in reader.records() {
        let record = record.map_err(|error| refuse(line_of(text, error.position()), row_fault(&error), COLUMNS))?;
        let line = line_of(text, record.position());
        let row: TraceRow = record
            .deserialize(Some(&header))
            .map_err(|error| refuse(line, cell_fault(&error, &header, &record), COLUMNS))?;
        if !(0.0..=LATEST_S).contains(&row.t_s) {
            return Err(refuse(line, format!("t_s {}", row.t_s), "0 to 1e8"));
        }
        if row.t_s < last_s {
            let what = format!("t_s {}, after {last_s} in a line before", row.t_s);
            return Err(refuse(line, what, "times in rising order"));
        }
        let Some(&node) = by_name.get(of_cell(&row.node)) else {
            return Err(refuse(line, format!("node `{}`", row.node), "the name of a node"));
        };
        if !(11..=127).contains(&row.mpdu_octets) {
            return Err(refuse(line, format!("mpdu_octets {}", row.mpdu_octets), "11 to 127"));
        }
        last_s = row.t_s;
        any = true;
        trace.frames[node].push((SimTime::ZERO + Duration::from_secs_f64(row.t_s), row.mpdu_octets));
    }
    if !any {
        return Err(SettingError::new("file", format!("`{file}`, without any rows"), "at least one frame"));
    }
    Ok(trace)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_channel::Position;

    fn parsed(text: &str) -> Result<Trace, String> {
        let node = |name: &str| PlacedNode { name: name.into(), position: Position::ORIGIN };
        parse(text, "trace.csv", &[node("a"), node("b")]).map_err(|error| error.found().to_owned())
    }

    #[test]
    fn frames_are_kept_by_node_in_the_order_of_time() {
        let trace = parsed("t_s,node,mpdu_octets\n0.5,b,20\n0.5,a,30\n# a comment\n2,b,40\n").unwrap();
        let at = |seconds| SimTime::ZERO + Duration::from_secs_f64(seconds);
        assert_eq!(trace.frame(NodeId(1), 0), Some((at(0.5), 20)));
        assert_eq!(trace.frame(NodeId(1), 1), Some((at(2.0), 40)));
        assert_eq!(trace.frame(NodeId(1), 2), None);
        assert_eq!(trace.frame(NodeId(0), 0), Some((at(0.5), 30)));
        assert_eq!(trace.largest_octets(), 40);
    }

    #[test]
    fn an_error_names_its_line() {
        let found = |rows: &str| parsed(&format!("t_s,node,mpdu_octets\n{rows}")).unwrap_err();
        assert_eq!(found("1,a,20\n0.5,b,20\n"), "`trace.csv`, line 3: t_s 0.5, after 1 in a line before");
        assert_eq!(found("1,a,20\n\n# a comment\n2,a\n"), "`trace.csv`, line 5: 2 cells for 3 columns");
        assert_eq!(found("1,a,twenty\n"), "`trace.csv`, line 2: `twenty` in the column `mpdu_octets`");
        assert_eq!(found("1,c,20\n"), "`trace.csv`, line 2: node `c`");
        assert_eq!(found("1,a,128\n"), "`trace.csv`, line 2: mpdu_octets 128");
        assert_eq!(found("-1,a,20\n"), "`trace.csv`, line 2: t_s -1");
        assert_eq!(found("NaN,a,20\n"), "`trace.csv`, line 2: t_s NaN");
        assert_eq!(found(""), "`trace.csv`, without any rows");
        assert_eq!(parsed("t_s,node\n1,a\n").unwrap_err(), "`trace.csv`, line 1: no column `mpdu_octets`");
    }
}
