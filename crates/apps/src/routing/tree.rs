//! Trees whose roots are the sinks.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};
use std::path::Path;

use serde::Deserialize;
use sextant_kernel::text::{of_cell, shortened};
use sextant_kernel::{Files, SettingError, StationId};
use sextant_sim::csv_rows::{cell_fault, line_of, row_fault};
use sextant_sim::layout::PlacedNode;

use super::config::TreeMetric;
use super::links::UsableLinks;

/// A tree, or several: the parent of each station, where it has one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Tree {
    parents: Vec<Option<StationId>>,
}

/// One row of a tree in a file.
#[derive(Deserialize)]
struct TreeRow {
    node: String,
    parent: String,
}

const COLUMNS: &str = "the columns `node` and `parent`";

/// What is known of a station while the shortest ways are worked out, in the order in which stations are settled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Reached {
    /// Hops, or expected transmissions, whose order is that of their bits because they are positive.
    first: u64,
    /// The other one of both.
    second: u64,
    station: StationId,
    parent: Option<StationId>,
}

impl Tree {
    /// A tree with these parents, by station.
    #[must_use]
    pub(crate) fn of(parents: Vec<Option<StationId>>) -> Self {
        Self { parents }
    }

    /// The shortest ways to the nearest of `roots` (Dijkstra, Numerische Mathematik 1, 1959). Of ways that are as short, the one
    /// by the station with the lower number counts.
    #[must_use]
    pub(crate) fn shortest(links: &UsableLinks, roots: &[StationId], metric: TreeMetric) -> Self {
        let mut parents = vec![None; links.stations()];
        let mut settled = vec![false; links.stations()];
        let at_root = |&station: &StationId| Reverse(Reached { first: 0, second: 0, station, parent: None });
        let mut open: BinaryHeap<_> = roots.iter().map(at_root).collect();
        while let Some(Reverse(Reached { first, second, station, parent })) = open.pop() {
            if std::mem::replace(&mut settled[station.index()], true) {
                continue;
            }
            parents[station.index()] = parent;
            for (next, etx) in links.of(station).filter(|(next, _)| !settled[next.index()]) {
                let (first, second) = match metric {
                    TreeMetric::Hops => (first + 1, (f64::from_bits(second) + etx).to_bits()),
                    TreeMetric::Etx => ((f64::from_bits(first) + etx).to_bits(), second + 1),
                };
                open.push(Reverse(Reached { first, second, station: next, parent: Some(station) }));
            }
        }
        Self { parents }
    }

    /// The tree of a CSV file with the columns `node` and `parent`, for nodes and sinks with these names. Robots, of which there
    /// are `robots`, are no part of it.
    ///
    /// # Errors
    /// If it cannot be read, names a station that there is not, leaves out a node or has it twice, or goes round in a circle. The
    /// key is `file`.
    pub(crate) fn read(
        file: &Path,
        nodes: &[PlacedNode],
        robots: usize,
        sinks: &[&str],
        files: &Files,
    ) -> Result<Self, SettingError> {
        let text = files.read_text(file).map_err(|error| {
            SettingError::new(
                "file",
                format!("`{}`: {error}", files.path(file).display()),
                "a text file that can be read",
            )
        })?;
        Self::parse(&text, &file.display().to_string(), nodes, robots, sinks)
            .map_err(|error| files.discreet(file, error))
    }

    fn parse(
        text: &str,
        file: &str,
        nodes: &[PlacedNode],
        robots: usize,
        sinks: &[&str],
    ) -> Result<Self, SettingError> {
        let numbered = |(i, name): (usize, &str)| (name.to_owned(), StationId::from_index(i));
        let of_nodes: BTreeMap<String, StationId> =
            nodes.iter().map(|node| node.name.as_str()).enumerate().map(numbered).collect();
        let first_sink = nodes.len() + robots;
        let of_sinks: BTreeMap<String, StationId> =
            sinks.iter().enumerate().map(|(i, name)| numbered((first_sink + i, name))).collect();
        let mut parents = vec![None; first_sink + sinks.len()];
        let refuse = |line: u64, what: String, allowed: &str| {
            SettingError::new("file", format!("`{file}`, line {line}: {what}"), allowed)
        };
        let mut reader =
            csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
        let header = reader.headers().map_err(|error| refuse(1, error.to_string(), COLUMNS))?.clone();
        let line_of_header = line_of(text, header.position());
        if let Some(column) = header.iter().find(|column| !matches!(*column, "node" | "parent")) {
            return Err(refuse(line_of_header, format!("column `{}`", shortened(column)), COLUMNS));
        }
        if let Some(column) = ["node", "parent"].into_iter().find(|&column| !header.iter().any(|it| it == column)) {
            return Err(refuse(line_of_header, format!("no column `{column}`"), COLUMNS));
        }
        for record in reader.records() {
            let record =
                record.map_err(|error| refuse(line_of(text, error.position()), row_fault(&error), COLUMNS))?;
            let line = line_of(text, record.position());
            let row: TreeRow = record
                .deserialize(Some(&header))
                .map_err(|error| refuse(line, cell_fault(&error, &header, &record), COLUMNS))?;
            let (node, parent) = (of_cell(&row.node), of_cell(&row.parent));
            let unknown = |name: &str, allowed: &str| refuse(line, format!("`{}`", shortened(name)), allowed);
            let &child = of_nodes.get(node).ok_or_else(|| unknown(node, "the name of a node"))?;
            let above = of_nodes.get(parent).or_else(|| of_sinks.get(parent));
            let &above = above.ok_or_else(|| unknown(parent, "the name of a node or a sink"))?;
            if parents[child.index()].replace(above).is_some() {
                return Err(refuse(line, format!("`{}` again", shortened(node)), "one row for each node"));
            }
        }
        let tree = Self { parents };
        for (i, node) in nodes.iter().enumerate() {
            let found = match tree.depth(StationId::from_index(i), |station| station.index() >= first_sink) {
                Some(_) => continue,
                None if tree.parents[i].is_none() => format!("`{file}` without a row for `{}`", node.name),
                None => format!("`{file}`, in which no way leads from `{}` to a sink", node.name),
            };
            return Err(SettingError::new("file", found, "a row for each node, along which all reach a sink"));
        }
        Ok(tree)
    }

    /// The parent of each station, where it has one.
    #[must_use]
    pub(crate) fn parents(&self) -> &[Option<StationId>] {
        &self.parents
    }

    /// The parent of a station.
    #[must_use]
    pub(crate) fn parent(&self, station: StationId) -> Option<StationId> {
        self.parents.get(station.index()).copied().flatten()
    }

    /// Hops from a station to one that is a root; `None` if its way ends elsewhere, or goes round in a circle.
    #[must_use]
    pub(crate) fn depth(&self, station: StationId, is_root: impl Fn(StationId) -> bool) -> Option<u32> {
        let mut at = station;
        for hops in 0..=u32::try_from(self.parents.len()).ok()? {
            if is_root(at) {
                return Some(hops);
            }
            at = self.parent(at)?;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use sextant_channel::Position;

    use super::*;

    fn nodes(names: &[&str]) -> Vec<PlacedNode> {
        let node = |name: &&str| PlacedNode { name: (*name).to_owned(), position: Position::ORIGIN };
        names.iter().map(node).collect()
    }

    #[test]
    fn a_file_has_the_parent_of_each_node() {
        let nodes = nodes(&["a", "b"]);
        let parse =
            |text: &str| Tree::parse(text, "t.csv", &nodes, 1, &["sink"]).map_err(|error| error.found().to_owned());
        let tree = parse("# a comment\nnode,parent\na,sink\n\nb , a\n").unwrap();
        assert_eq!(tree.parents, [Some(StationId(3)), Some(StationId(0)), None, None]);
        let depth = |node| tree.depth(StationId(node), |station| station == StationId(3));
        assert_eq!((depth(0), depth(1), depth(3), depth(2)), (Some(1), Some(2), Some(0), None));
        // The columns may be in the other order, and names may be quoted.
        assert_eq!(parse("parent,node\nsink,a\na,\"b\"\n").unwrap(), tree);
        for (text, found) in [
            ("", "`t.csv`, line 1: no column `node`"),
            ("a,b\n", "`t.csv`, line 1: column `a`"),
            ("# a comment\n\nnode\na\n", "`t.csv`, line 3: no column `parent`"),
            ("node,parent\nx,sink\n", "`t.csv`, line 2: `x`"),
            ("node,parent\na,x\n", "`t.csv`, line 2: `x`"),
            ("node,parent\na,sink,3\n", "`t.csv`, line 2: 3 cells for 2 columns"),
            ("node,parent\n\n# a comment\na\n", "`t.csv`, line 4: 1 cells for 2 columns"),
            ("node,parent\na,sink\na,b\n", "`t.csv`, line 3: `a` again"),
            ("node,parent\na,sink\n", "`t.csv` without a row for `b`"),
            ("node,parent\na,b\nb,a\n", "`t.csv`, in which no way leads from `a` to a sink"),
        ] {
            assert_eq!(parse(text).unwrap_err(), found);
        }
    }
}
