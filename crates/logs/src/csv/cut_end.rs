//! A file whose last line may be cut.

use std::fs::{self, File};
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

/// So much of the end of a file is looked at (octets).
const END: u64 = 1 << 14;
/// Without so many lines before the last one, nothing is said.
const LEAST_LINES: usize = 8;

/// That the last line of a file may be cut in its last number: it has no line end, and the number has fewer decimals than those of
/// all lines before it near the end of the file.
pub(super) fn note(path: &Path) -> Option<String> {
    // A pipe is read once.
    let length = fs::metadata(path).ok().filter(fs::Metadata::is_file)?.len();
    let mut file = File::open(path).ok()?;
    file.seek(SeekFrom::Start(length.saturating_sub(END))).ok()?;
    let mut end = Vec::new();
    file.take(END).read_to_end(&mut end).ok()?;
    let line = cut_line(&end)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    Some(format!(
        "{name} ends without a line end, and the last number of `{line}` has fewer decimals than those before it: the file may be cut there"
    ))
}

/// The last line of the end of a file, if it seems to be cut.
fn cut_line(end: &[u8]) -> Option<&str> {
    let start = end.iter().rposition(|&octet| octet == b'\n')? + 1;
    let last = std::str::from_utf8(&end[start..]).ok().filter(|line| !line.trim().is_empty())?;
    let own = decimals(last.as_bytes())?;
    // The first line may be cut at its beginning, or is the header.
    let before = end[..start - 1].split(|&octet| octet == b'\n').skip(1);
    let before: Vec<usize> = before.filter_map(decimals).collect();
    (before.len() >= LEAST_LINES && before.iter().all(|&other| other > own)).then_some(last)
}

/// The decimals of the number that ends a line; `None` without one.
fn decimals(line: &[u8]) -> Option<usize> {
    let line = std::str::from_utf8(line).ok()?.trim_end();
    let cell = line.rsplit([',', ';', '\t', ' ']).next()?;
    cell.parse::<f64>().ok().or_else(|| (cell == "-").then_some(0.0))?;
    Some(cell.split_once('.').map_or(0, |(_, decimals)| decimals.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_last_number_with_fewer_decimals_than_all_others_may_be_cut() {
        let rows: String = (0..20).map(|i| format!("n,{i},-{}.{:03}\n", 60 + i, 7 * i)).collect();
        let of = |last: &str| cut_line(format!("node,stop,rssi_dbm\n{rows}{last}").as_bytes()).map(str::to_owned);
        assert_eq!(of("n,47,-7"), Some("n,47,-7".to_owned()));
        assert_eq!(of("n,47,-"), Some("n,47,-".to_owned()));
        assert_eq!(of("n,47,-74.5"), Some("n,47,-74.5".to_owned()));
        for whole in ["", "n,47,-7\n", "n,47,-74.507", "n,47,yes"] {
            assert_eq!(of(whole), None, "{whole}");
        }
        // Where one number more has as few, nothing is odd.
        assert_eq!(of("n,46,-70\nn,47,-7"), None);
        assert_eq!(cut_line(b"n,1,-7.25\nn,2,-7"), None);
    }
}
