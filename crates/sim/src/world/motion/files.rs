//! Files of ways: our own columns, ns-2 setdest, BonnMotion, and the positions of Cooja.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use sextant_channel::Position;
use sextant_kernel::text::{of_cell, shortened};
use sextant_kernel::{Files, SettingError};

use super::track::Track;
use crate::csv_rows::{cell_fault, line_of, row_fault};

/// The ways of nodes in a file, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct MotionFileConfig {
    /// The file; its path is relative to the scenario's folder.
    pub file: PathBuf,
    /// Its format.
    #[serde(default)]
    pub format: MotionFormat,
}

/// The format of a file of ways.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum MotionFormat {
    /// A table with the columns `t_s`, `node`, `x_m`, `y_m` and, optionally, `z_m`: straight ways between the rows of a node.
    #[default]
    Csv,
    /// Commands of ns-2: `$node_(0) set X_ 3.0` and `$ns_ at 2.0 "$node_(0) setdest 9.0 4.0 1.5"`. Node i is the i-th of the entry.
    Setdest,
    /// BonnMotion: a line `t x y t x y ..` for each node, the first line for the first node of the entry.
    Bonnmotion,
    /// The positions of Cooja: `index t x y`. The nodes jump. Index i is the i-th node of the entry.
    Positions,
}

/// The rows of each node, by its place in the entry.
type Rows = Vec<Vec<(f64, Position)>>;

/// A mistake in a line: what was found, and what is allowed.
type Mistake = (usize, String, String);

impl MotionFileConfig {
    /// The ways of the nodes of these `names`.
    pub(super) fn read(&self, names: &[&str], files: &Files) -> Result<Vec<Track>, SettingError> {
        let path = files.path(&self.file);
        let text = files.read_text(&self.file).map_err(|error| {
            SettingError::new("file", format!("`{}`: {error}", path.display()), "a text file that can be read")
        })?;
        self.parse(&text, names).map_err(|error| files.discreet(&self.file, error))
    }

    fn parse(&self, text: &str, names: &[&str]) -> Result<Vec<Track>, SettingError> {
        let file = self.file.display();
        let rows = match self.format {
            MotionFormat::Csv => csv_rows(text, names),
            MotionFormat::Setdest => setdest_rows(text, names.len()),
            MotionFormat::Bonnmotion => bonnmotion_rows(text, names.len()),
            MotionFormat::Positions => position_rows(text, names.len()),
        };
        let refuse = |(line, found, allowed): Mistake| {
            SettingError::new("file", format!("`{file}`, line {line}: {found}"), allowed)
        };
        let track = |(name, rows): (&&str, Vec<(f64, Position)>)| {
            let of = |found: String| format!("`{file}`, node `{name}`: {found}");
            if rows.is_empty() {
                return Err(SettingError::new("file", of("no place".to_owned()), "a way for each node of the entry"));
            }
            Track::new(&rows).map_err(|(found, allowed)| SettingError::new("file", of(found), allowed))
        };
        names.iter().zip(rows.map_err(refuse)?).map(track).collect()
    }
}

/// One row of our table.
#[derive(Deserialize)]
struct CsvRow {
    t_s: f64,
    node: String,
    x_m: f64,
    y_m: f64,
    #[serde(default)]
    z_m: Option<f64>,
}

const COLUMNS: &str = "a header `t_s,node,x_m,y_m` or `t_s,node,x_m,y_m,z_m`, and rows below";

/// Rows of nodes that are not in the entry are left out.
fn csv_rows(text: &str, names: &[&str]) -> Result<Rows, Mistake> {
    let mistake = |line: u64, found: String| (usize::try_from(line).unwrap_or(usize::MAX), found, COLUMNS.to_owned());
    let places: BTreeMap<&str, usize> = names.iter().enumerate().map(|(i, &name)| (name, i)).collect();
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
    let header = reader.headers().map_err(|error| mistake(1, error.to_string()))?.clone();
    for column in ["t_s", "node", "x_m", "y_m"] {
        if !header.iter().any(|it| it == column) {
            return Err(mistake(1, format!("no column `{column}`")));
        }
    }
    let mut rows = vec![Vec::new(); names.len()];
    for record in reader.records() {
        let record = record.map_err(|error| mistake(line_of(text, error.position()), row_fault(&error)))?;
        let line = line_of(text, record.position());
        let row: CsvRow =
            record.deserialize(Some(&header)).map_err(|error| mistake(line, cell_fault(&error, &header, &record)))?;
        if let Some(&node) = places.get(of_cell(&row.node)) {
            rows[node].push((row.t_s, Position::new(row.x_m, row.y_m, row.z_m.unwrap_or(0.0))));
        }
    }
    Ok(rows)
}

/// The lines that are neither empty nor comments, with their numbers from 1.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let numbered = text.lines().enumerate().map(|(i, line)| (i + 1, line.trim()));
    numbered.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
}

/// The numbers of a line.
fn numbers(line: usize, words: &str) -> Result<Vec<f64>, Mistake> {
    let number = |word: &str| {
        let parsed = word.parse().ok().filter(|number: &f64| number.is_finite());
        parsed.ok_or_else(|| (line, format!("`{}`", shortened(word)), "a finite number".to_owned()))
    };
    words.split_whitespace().map(number).collect()
}

fn bonnmotion_rows(text: &str, nodes: usize) -> Result<Rows, Mistake> {
    let mut rows = Vec::new();
    for (line, words) in lines(text).take(nodes) {
        let numbers = numbers(line, words)?;
        if numbers.len() % 3 != 0 {
            let found = format!("{} numbers", numbers.len());
            return Err((line, found, "a time and two coordinates, again and again: `t x y t x y ..`".to_owned()));
        }
        rows.push(numbers.chunks_exact(3).map(|row| (row[0], Position::new(row[1], row[2], 0.0))).collect());
    }
    rows.resize(nodes, Vec::new());
    Ok(rows)
}

fn position_rows(text: &str, nodes: usize) -> Result<Rows, Mistake> {
    let mut rows: Rows = vec![Vec::new(); nodes];
    for (line, words) in lines(text) {
        let numbers = numbers(line, words)?;
        let [index, t_s, x_m, y_m] = numbers[..] else {
            return Err((line, format!("{} numbers", numbers.len()), "`index t x y`".to_owned()));
        };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates, and is compared")]
        let node = index as usize;
        if (node as f64 - index).abs() > 0.0 {
            return Err((line, format!("the index {index}"), "a whole number from 0".to_owned()));
        }
        if let Some(rows) = rows.get_mut(node) {
            // A jump: until then it stands where it was.
            if let Some(&(_, before)) = rows.last() {
                rows.push((t_s, before));
            }
            rows.push((t_s, Position::new(x_m, y_m, 0.0)));
        }
    }
    Ok(rows)
}

const COMMANDS: &str = "`$node_(0) set X_ 3.0` (Y_ and Z_ too), or `$ns_ at 2.0 \"$node_(0) setdest 9.0 4.0 1.5\"`";

/// A node of ns-2 on its way.
#[derive(Clone)]
struct Ns2Node {
    rows: Vec<(f64, Position)>,
    /// Where it goes and when it arrives, if it moves.
    to: Option<(f64, Position)>,
}

impl Ns2Node {
    /// Where it is at a time that is not before its last row.
    fn at(&self, t_s: f64) -> Position {
        let &(from_s, from) = self.rows.last().expect("a node has a place");
        match self.to {
            Some((to_s, to)) if t_s >= to_s => to,
            Some((to_s, to)) if to_s > from_s => from + (to - from) * ((t_s - from_s) / (to_s - from_s)),
            Some(_) | None => from,
        }
    }

    /// Ends its way at a time: it has arrived, or changes its mind.
    fn stop(&mut self, t_s: f64) {
        let here = self.at(t_s);
        if let Some((to_s, to)) = self.to.take() {
            self.rows.push((to_s.min(t_s), if t_s >= to_s { to } else { here }));
        }
        self.rows.push((t_s, here));
    }
}

fn setdest_rows(text: &str, nodes: usize) -> Result<Rows, Mistake> {
    let start = Ns2Node { rows: vec![(0.0, Position::ORIGIN)], to: None };
    let mut all = vec![start; nodes];
    let mut named = vec![false; nodes];
    // Commands count in the order of their times, whatever their order in the file.
    let mut commands: Vec<(f64, usize, &str)> = Vec::new();
    for (line, words) in lines(text) {
        let wrong = || (line, format!("`{}`", shortened(words)), COMMANDS.to_owned());
        match words.strip_prefix("$ns_ at ") {
            Some(rest) => {
                let (time, command) = rest.split_once('"').ok_or_else(wrong)?;
                let t_s: f64 = time.trim().parse().map_err(|_| wrong())?;
                commands.push((t_s, line, command.trim_end().strip_suffix('"').ok_or_else(wrong)?));
            }
            None => commands.push((0.0, line, words)),
        }
    }
    commands.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (t_s, line, command) in commands {
        let wrong = || (line, format!("`{}`", shortened(command)), COMMANDS.to_owned());
        // What is said of the god of ns-2 is about hops, not about places.
        if command.starts_with("$god_") {
            continue;
        }
        let rest = command.strip_prefix("$node_(").ok_or_else(wrong)?;
        let (index, words) = rest.split_once(')').ok_or_else(wrong)?;
        let index: usize = index.parse().map_err(|_| wrong())?;
        let Some(node) = all.get_mut(index) else { continue };
        named[index] = true;
        let words: Vec<&str> = words.split_whitespace().collect();
        let number = |word: &str| word.parse::<f64>().ok().filter(|number| number.is_finite()).ok_or_else(wrong);
        match words[..] {
            ["set", axis @ ("X_" | "Y_" | "Z_"), value] => {
                node.stop(t_s);
                // A jump: until then it stood, or moved, where it was.
                let mut place = node.at(t_s);
                let value = number(value)?;
                match axis {
                    "X_" => place.x_m = value,
                    "Y_" => place.y_m = value,
                    _ => place.z_m = value,
                }
                node.rows.push((t_s, place));
            }
            ["setdest", x, y, speed] => {
                node.stop(t_s);
                let from = node.at(t_s);
                let to = Position::new(number(x)?, number(y)?, from.z_m);
                let speed = number(speed)?;
                if speed > 0.0 {
                    node.to = Some((t_s + from.distance_m(to) / speed, to));
                }
            }
            _ => return Err(wrong()),
        }
    }
    let rows = |(mut node, is_named): (Ns2Node, bool)| {
        if let Some(last) = node.to.take() {
            node.rows.push(last);
        }
        if is_named { node.rows } else { Vec::new() }
    };
    Ok(all.into_iter().zip(named).map(rows).collect())
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use sextant_kernel::SimTime;

    use super::*;

    fn parsed(format: MotionFormat, text: &str, names: &[&str]) -> Result<Vec<Track>, String> {
        let config = MotionFileConfig { file: "ways".into(), format };
        config.parse(text, names).map_err(|error| error.found().to_owned())
    }

    /// Where a node is at a time, by its legs.
    fn at(track: &Track, t_s: f64) -> [f64; 2] {
        let time = SimTime::ZERO + Duration::from_secs_f64(t_s);
        let (mut place, mut i) = (track.start(), 0);
        while let Some(leg) = track.leg(i).filter(|leg| leg.start <= time) {
            (place, i) = (leg.at(time), i + 1);
        }
        if track.leg(i).is_none() && (i == 0 || track.leg(i - 1).is_some_and(|leg| leg.end <= time)) {
            place = track.end();
        }
        [place.x_m, place.y_m]
    }

    #[test]
    fn the_same_way_in_three_formats_is_the_same() {
        let csv = "t_s,node,x_m,y_m\n0,tag,1,2\n2,tag,1,2\n6,tag,9,2\n6,other,0,0\n10,tag,9,8\n";
        let bonnmotion = "0 1 2 2 1 2 6 9 2 10 9 8\n0 0 0\n";
        let setdest = "# a comment\n$node_(0) set X_ 1.0\n$node_(0) set Y_ 2.0\n$node_(0) set Z_ 0.0\n\
                       $ns_ at 6.0 \"$node_(0) setdest 9.0 8.0 1.5\"\n$ns_ at 2.0 \"$node_(0) setdest 9.0 2.0 2.0\"\n\
                       $god_ set-dist 0 1 2\n";
        let all =
            [(MotionFormat::Csv, csv), (MotionFormat::Bonnmotion, bonnmotion), (MotionFormat::Setdest, setdest)];
        for (format, text) in all {
            let tracks = parsed(format, text, &["tag"]).unwrap();
            for (t_s, expected) in [
                (0.0, [1.0, 2.0]),
                (1.9, [1.0, 2.0]),
                (3.0, [3.0, 2.0]),
                (6.0, [9.0, 2.0]),
                (8.0, [9.0, 5.0]),
                (99.0, [9.0, 8.0]),
            ] {
                let found = at(&tracks[0], t_s);
                assert!(
                    (found[0] - expected[0]).abs() + (found[1] - expected[1]).abs() < 1e-9,
                    "{format:?} {t_s}: {found:?}"
                );
            }
        }
    }

    #[test]
    fn nodes_of_cooja_jump_and_those_of_ns_2_change_their_minds() {
        let jumps =
            parsed(MotionFormat::Positions, "# index t x y\n0 0 1 1\n1 0 5 5\n0 4 2 1\n", &["a", "b"]).unwrap();
        assert_eq!(
            [at(&jumps[0], 3.9), at(&jumps[0], 4.0), at(&jumps[1], 9.0)],
            [[1.0, 1.0], [2.0, 1.0], [5.0, 5.0]]
        );
        let text = "$node_(0) set X_ 0\n$ns_ at 0 \"$node_(0) setdest 10 0 1\"\n$ns_ at 4 \"$node_(0) setdest 4 3 1\"\n\
                    $ns_ at 20 \"$node_(0) set X_ 50\"\n$ns_ at 30 \"$node_(0) setdest 0 0 0\"\n";
        let tracks = parsed(MotionFormat::Setdest, text, &["a"]).unwrap();
        let found = [3.0, 5.0, 7.0, 19.0, 20.0, 99.0].map(|t_s| at(&tracks[0], t_s));
        assert_eq!(found, [[3.0, 0.0], [4.0, 1.0], [4.0, 3.0], [4.0, 3.0], [50.0, 3.0], [50.0, 3.0]]);
    }

    #[test]
    fn mistakes_name_their_line_or_their_node() {
        let found = |format, text: &str| parsed(format, text, &["a"]).unwrap_err();
        assert_eq!(found(MotionFormat::Csv, "t_s,node,x_m,y_m\n0,b,1,1\n"), "`ways`, node `a`: no place");
        assert_eq!(found(MotionFormat::Csv, "t_s,node,x_m\n"), "`ways`, line 1: no column `y_m`");
        assert_eq!(
            found(MotionFormat::Csv, "t_s,node,x_m,y_m\n0,a,1,one\n"),
            "`ways`, line 2: `one` in the column `y_m`"
        );
        assert_eq!(found(MotionFormat::Bonnmotion, "0 1 2 3\n"), "`ways`, line 1: 4 numbers");
        assert_eq!(found(MotionFormat::Bonnmotion, "0 1 2 3 4 x\n"), "`ways`, line 1: `x`");
        assert_eq!(found(MotionFormat::Positions, "0 0 1\n"), "`ways`, line 1: 3 numbers");
        assert_eq!(found(MotionFormat::Setdest, "$node_(0) goes home\n"), "`ways`, line 1: `$node_(0) goes home`");
    }
}
