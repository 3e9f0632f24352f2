//! What the shell of a DWM1001 (Decawave, Qorvo) prints of a tag, each line after the time at which it came.
//!
//! The commands `lec` and `les` of its firmware PANS print a line for each place that the tag worked out: the distances to the anchors
//! that it used, with their places, which are not used here.
//!
//! ```text
//! 12.35 DIST,2,AN0,022E,7.94,8.03,0.00,3.44,AN1,9280,7.95,0.00,0.00,5.68,POS,6.95,5.37,-1.97,52
//! 12.45 022E[7.94,8.03,0.00]=3.38 9280[7.95,0.00,0.00]=5.49 le_us=3082 est[6.97,5.17,-1.77,53]
//! ```

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use sextant_kernel::SimTime;
use sextant_kernel::text::shortened;

use crate::csv::lines::LinesOf;
use crate::csv::memory_table::{MemoryColumn, MemoryTable};
use crate::error::robot_log_error::RobotLogError;
use crate::time::instant;
use crate::time::time_zone::TimeZone;

/// The distances of one line: the name of an anchor, and metres.
type Distances<'a> = Vec<(&'a str, f64)>;

/// Whether a text file begins with such lines: the first line that has something like distances to anchors is one.
pub(crate) fn is_output(path: &Path) -> bool {
    const LONGEST: u64 = 1 << 14;
    let mut octets = Vec::new();
    let read = File::open(path).and_then(|file| file.take(LONGEST).read_to_end(&mut octets));
    let text = String::from_utf8_lossy(&octets);
    read.is_ok() && text.lines().any(|line| start(line).is_some())
}

/// Reads the file `path` as the table `t_s,node,range_m`. Times are seconds, or dates as RFC 3339 writes them, in `zone` if they do not
/// say theirs. Other lines than those of distances are not used.
///
/// # Errors
/// If a line has no time, or its distances are not whole.
pub(crate) fn read(path: &Path, zone: Option<TimeZone>) -> Result<MemoryTable<'static>, RobotLogError> {
    let unreadable = |why: std::io::Error| RobotLogError::read(path, why);
    let input = BufReader::new(LinesOf::new(File::open(path).map_err(unreadable)?));
    let (mut times, mut nodes, mut ranges) = (Vec::new(), Vec::new(), Vec::new());
    for (line, text) in (1..).zip(input.lines()) {
        let text = text.map_err(unreadable)?;
        let Some(at) = start(&text) else { continue };
        let wrong = |column: usize, found: &str, allowed: &str| {
            let problem = format!("column {column}: found `{}`; allowed: {allowed}", shortened(found));
            RobotLogError::line(path, line, problem)
        };
        let (before, rest) = text.split_at(at);
        let written = before.trim().trim_end_matches([',', ';']).trim_end().trim_matches(['[', ']']);
        let time = instant::parse(written).or_else(|| instant::parse_date(written, zone));
        let time = time.ok_or_else(|| {
            wrong(
                1,
                written,
                "the time at which the line came, before its distances: seconds, or a date with its zone",
            )
        })?;
        let distances = if rest.starts_with("DIST") { of_lec(rest) } else { of_les(rest) };
        let distances = distances.map_err(|(off, found)| {
            wrong(
                at + off + 1,
                found,
                "an anchor and its distance in metres: AN0,ID,X,Y,Z,DISTANCE or ID[X,Y,Z]=DISTANCE",
            )
        })?;
        for (node, range_m) in distances {
            times.push(nanos(time));
            nodes.push(node.to_owned());
            ranges.push(range_m);
        }
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let columns = vec![
        ("t_s".to_owned(), MemoryColumn::Instants(times.into())),
        ("node".to_owned(), MemoryColumn::texts(nodes.iter().map(|node| Some(node.as_str())))),
        ("range_m".to_owned(), MemoryColumn::Floats(ranges.into())),
    ];
    MemoryTable::new(name, columns)
}

fn nanos(time: SimTime) -> i64 {
    i64::try_from(time.as_nanos()).unwrap_or(i64::MAX)
}

/// Where the distances of a line begin; `None` if it has none.
fn start(line: &str) -> Option<usize> {
    if let Some(at) = line.find("DIST,") {
        return Some(at);
    }
    // An anchor of `les` is four digits of base 16, right before its place.
    let bracket = line.match_indices('[').map(|(at, _)| at).find(|&at| {
        at >= 4
            && line.is_char_boundary(at - 4)
            && line[at - 4..at].bytes().all(|octet| octet.is_ascii_hexdigit())
            && line[at..].contains("]=")
    })?;
    Some(bracket - 4)
}

/// A distance (m).
fn distance(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|distance: &f64| distance.is_finite())
}

/// `DIST,COUNT,AN0,ID,X,Y,Z,DISTANCE,AN1,..[,POS,..]`: or where it is wrong, and what was found there.
fn of_lec(text: &str) -> Result<Distances<'_>, (usize, &str)> {
    let mut at = 0;
    let mut cells = text.split(',').map(|cell| {
        let here = at;
        at += cell.len() + 1;
        (here, cell)
    });
    let mut next = || cells.next().unwrap_or((text.len(), ""));
    next();
    let (off, cell) = next();
    let count: usize = cell.trim().parse().map_err(|_| (off, cell))?;
    let mut found = Vec::new();
    for number in 0..count {
        let (off, cell) = next();
        if cell.trim() != format!("AN{number}") {
            return Err((off, cell));
        }
        let (off, node) = next();
        if node.trim().is_empty() {
            return Err((off, node));
        }
        for _ in 0..3 {
            let (off, cell) = next();
            distance(cell).ok_or((off, cell))?;
        }
        let (off, cell) = next();
        found.push((node.trim(), distance(cell).ok_or((off, cell))?));
    }
    Ok(found)
}

/// `ID[X,Y,Z]=DISTANCE ID[X,Y,Z]=DISTANCE .. le_us=TIME est[X,Y,Z,Q]`: or where it is wrong, and what was found there.
fn of_les(text: &str) -> Result<Distances<'_>, (usize, &str)> {
    let mut found = Vec::new();
    let mut at = 0;
    for word in text.split(' ') {
        let off = at;
        at += word.len() + 1;
        let word = word.trim();
        if word.is_empty() || word.starts_with("le_us") || word.starts_with("est[") {
            continue;
        }
        let anchor = word.split_once('[').and_then(|(node, rest)| Some((node, rest.split_once("]=")?)));
        let (node, (_, metres)) = anchor.filter(|(node, _)| !node.is_empty()).ok_or((off, word))?;
        found.push((node, distance(metres).ok_or((off, word))?));
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use sextant_channel::Position;

    use crate::test_kit::folder_of;
    use crate::{ReadOptions, read_tag_readings};

    const LEC: &str = "DIST,2,AN0,022E,7.94,8.03,0.00,3.44,AN1,9280,7.95,0.00,0.00,5.68,POS,6.95,5.37,-1.97,52";
    const LES: &str = "022E[7.94,8.03,0.00]=3.38 9280[7.95,0.00,0.00]=5.49 le_us=3082 est[6.97,5.17,-1.77,53]";

    fn readings(text: &str) -> Result<Vec<(usize, f64, sextant_mapper::TagValue)>, String> {
        let folder = folder_of([("tag.txt", text)]);
        let known = ["022E", "9280"].map(|name| (name.to_owned(), Position::ORIGIN)).into_iter().collect();
        let read = read_tag_readings(folder.path(), &known, &ReadOptions::default());
        let read = read.map_err(|why| why.to_string())?;
        let of = |reading: &sextant_mapper::TagReading| (reading.receiver, reading.time.as_secs_f64(), reading.value);
        Ok(read.tags["tag"].iter().map(of).collect())
    }

    #[test]
    fn both_forms_are_read_with_their_times() {
        use sextant_mapper::TagValue::Range;
        let text = format!("dwm> lec\n12.5 {LEC}\n[2026-11-28T15:00:00.25Z] {LES}\n\n13.5,DIST,0\n");
        let date_s = 1_795_878_000.25;
        assert_eq!(
            readings(&text).unwrap(),
            [(0, 12.5, Range(3.44)), (1, 12.5, Range(5.68)), (0, date_s, Range(3.38)), (1, date_s, Range(5.49))]
        );
    }

    #[test]
    fn a_line_without_a_time_or_a_distance_is_named_with_its_column() {
        let refused = |text: &str| readings(text).unwrap_err();
        let why = refused(&format!("1 {LEC}\n{LEC}\n"));
        assert!(
            why.contains("tag.txt") && why.contains('2') && why.contains("the time at which the line came"),
            "{why}"
        );
        let why = refused("1 DIST,1,AN0,022E,7.94,8.03,0.00,far\n");
        assert!(why.contains("column 34: found `far`"), "{why}");
        let why = refused("1 DIST,2,AN0,022E,7.94,8.03,0.00,3.4\n");
        assert!(why.contains("column 37: found ``"), "{why}");
        let why = refused("1 022E[1,2,3]=4.0 9280[1,2,3]4\n");
        assert!(why.contains("column 19: found `9280[1,2,3]4`"), "{why}");
    }
}
