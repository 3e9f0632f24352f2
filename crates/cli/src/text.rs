//! Printed text: counts with nouns, lists of names, and tables in columns.

use std::io::{self, Write};

/// `1 node`, `2 nodes`.
pub(crate) fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// Of a list of names, at most this many are printed.
const MOST_NAMES: usize = 10;

/// `a, b, c`, or the first of many names and the number of the others: `a, b, .. and 3 more`.
pub(crate) fn listed<T: AsRef<str>>(names: &[T]) -> String {
    let shown: Vec<&str> = names.iter().take(MOST_NAMES).map(AsRef::as_ref).collect();
    let more = names.len() - shown.len();
    shown.join(", ") + &if more > 0 { format!(" and {more} more") } else { String::new() }
}

/// How the texts of a column are aligned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Align {
    Left,
    Right,
}

/// Writes `rows` in columns as wide as their longest text, with two spaces between columns.
pub(crate) fn columns(rows: &[Vec<String>], align: &[Align], out: &mut impl Write) -> io::Result<()> {
    let width = |column: usize| {
        rows.iter().filter_map(|row| row.get(column)).map(|text| text.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<_> = (0..align.len()).map(width).collect();
    for row in rows {
        let mut line = String::new();
        for ((text, width), align) in row.iter().zip(&widths).zip(align) {
            match align {
                Align::Left => line += &format!("{text:<width$}  "),
                Align::Right => line += &format!("{text:>width$}  "),
            }
        }
        writeln!(out, "{}", line.trim_end())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_is_as_wide_as_its_longest_text() {
        let rows = [["node", "error"], ["a", "0.5"], ["beacon", "12"]].map(|row| row.map(str::to_owned).to_vec());
        let mut out = Vec::new();
        columns(&rows, &[Align::Left, Align::Right], &mut out).unwrap();
        assert_eq!(String::from_utf8(out).unwrap(), "node    error\na         0.5\nbeacon     12\n");
    }

    #[test]
    fn of_many_names_the_first_are_listed() {
        let names: Vec<String> = (0..13).map(|i| format!("n{i}")).collect();
        assert_eq!(listed(&names), "n0, n1, n2, n3, n4, n5, n6, n7, n8, n9 and 3 more");
        assert_eq!((listed(&names[..2]), listed(&names[..0])), ("n0, n1".to_owned(), String::new()));
    }

    #[test]
    fn a_count_of_one_is_singular() {
        assert_eq!([counted(0, "node"), counted(1, "node"), counted(2, "node")], ["0 nodes", "1 node", "2 nodes"]);
    }
}
