//! Tables printed in columns.

use std::io::{self, Write};

/// How the texts of a column are aligned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    /// To the left.
    Left,
    /// To the right.
    Right,
}

/// The widest column (characters). A longer text, which only others write, moves the columns after it in its row.
const WIDEST: usize = 200;

/// Writes `rows` in columns as wide as their longest text, with two spaces between columns.
///
/// # Errors
/// If `out` cannot be written.
pub fn columns(rows: &[Vec<String>], align: &[Align], out: &mut impl Write) -> io::Result<()> {
    let width = |column: usize| {
        rows.iter().filter_map(|row| row.get(column)).map(|text| text.chars().count()).max().unwrap_or(0).min(WIDEST)
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
    fn a_very_long_text_is_written_too() {
        let long = "n".repeat(70_000);
        let rows = [vec![long.clone(), "1".to_owned()], vec!["a".to_owned(), "2".to_owned()]];
        let mut out = Vec::new();
        columns(&rows, &[Align::Left, Align::Right], &mut out).unwrap();
        assert_eq!(String::from_utf8(out).unwrap(), format!("{long}  1\n{:<200}  2\n", "a"));
    }
}
