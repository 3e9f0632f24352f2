//! A CSV file: what separates its cells, whether it has a header, whether blanks stand around its cells.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use csv::StringRecord;
use sextant_kernel::FileForm;

use super::blanks::{self, Blanks};
use super::lines::LinesOf;
use crate::error::robot_log_error::RobotLogError;
use crate::time::instant;
use crate::time::time_zone::TimeZone;

/// How a file is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct CsvStyle {
    /// Octets before the first line of cells: a byte order mark, and a line `sep=;`.
    pub(crate) skipped: u64,
    /// Whether a comma in a number is its decimal mark, because another character separates cells.
    pub(crate) decimal_comma: bool,
    /// Whether blanks stand around cells, which are not part of them.
    pub(crate) has_blanks: bool,
}

/// An open file.
pub(crate) struct CsvFile {
    pub(crate) style: CsvStyle,
    /// The names of its columns: of a file without a header `#1`, `#2`, ..
    pub(crate) names: Vec<String>,
    reader: csv::Reader<Box<dyn Read>>,
    /// The first row, if it was taken for the header and is none.
    first: Option<StringRecord>,
}

/// Whether the first line of a file has the names of its columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Heading {
    Named,
    /// Columns are known by their numbers.
    Numbered,
}

const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

impl CsvFile {
    /// Opens the file `path`.
    ///
    /// # Errors
    /// If it cannot be read, or is no text. An error of the first line is passed on as it is.
    pub(crate) fn open(path: &Path, heading: Heading) -> Result<Result<Self, csv::Error>, RobotLogError> {
        let file = File::open(path).map_err(|why| RobotLogError::read(path, why))?;
        let mut input = BufReader::with_capacity(1 << 16, LinesOf::new(file));
        let start = input.fill_buf().map_err(|why| RobotLogError::read(path, why))?;
        if let Some(form) = FileForm::of(start) {
            return Err(RobotLogError::Foreign { path: path.to_owned(), told: form.told(path) });
        }
        let mark = if start.starts_with(BYTE_ORDER_MARK) { BYTE_ORDER_MARK.len() } else { 0 };
        let stated = stated_separator(&start[mark..]);
        let skipped = mark + stated.map_or(0, |(_, length)| length);
        let text = &start[skipped..];
        let delimiter = stated.map_or_else(|| delimiter(text), |(separator, _)| separator);
        let has_blanks = delimiter == blanks::SEPARATOR || has_blanks(text, delimiter);
        let style = CsvStyle { skipped: skipped as u64, decimal_comma: delimiter != b',', has_blanks };
        input.consume(skipped);
        let input: Box<dyn Read> =
            if delimiter == blanks::SEPARATOR { Box::new(Blanks::new(input)) } else { Box::new(input) };
        let mut reader = csv::ReaderBuilder::new().delimiter(delimiter).from_reader(input);
        let header = match reader.headers() {
            Ok(header) => header.clone(),
            Err(why) => return Ok(Err(why)),
        };
        Ok(Ok(match heading {
            Heading::Named => {
                Self { style, names: header.iter().map(|name| name.trim().to_owned()).collect(), reader, first: None }
            }
            Heading::Numbered => {
                let names = (1..=header.len()).map(|number| format!("#{number}")).collect();
                Self { style, names, reader, first: Some(header) }
            }
        }))
    }

    /// Reads the next row. Returns whether there is one.
    pub(crate) fn read(&mut self, row: &mut StringRecord) -> Result<bool, csv::Error> {
        if let Some(first) = self.first.take() {
            *row = first;
            return Ok(true);
        }
        self.reader.read_record(row)
    }

    /// The first line, if it has values and no names: it is no header.
    pub(crate) fn values_for_names(&self) -> Option<String> {
        let is_value =
            |name: &&String| name.parse::<f64>().is_ok() || instant::parse_date(name, Some(TimeZone::UTC)).is_some();
        let values = self.names.iter().filter(is_value).count();
        (values > 0 && 2 * values >= self.names.len()).then(|| self.names.join(","))
    }
}

/// The character between the cells as a first line `sep=;` states it, as spreadsheets write it, and the octets of that line.
fn stated_separator(text: &[u8]) -> Option<(u8, usize)> {
    let length = text.iter().position(|&octet| octet == b'\n')? + 1;
    match text[..length].trim_ascii_end() {
        [b's' | b'S', b'e' | b'E', b'p' | b'P', b'=', separator @ (b',' | b';')] => Some((*separator, length)),
        b"sep=" if text[4] == b'\t' => Some((b'\t', length)),
        _ => None,
    }
}

/// The character between the cells: the one of `,`, `;` and tab that the header has most often outside of quotes. If it has
/// none of them, but several words, these are the cells.
fn delimiter(text: &[u8]) -> u8 {
    let mut counts = [(b',', 0), (b';', 0), (b'\t', 0)];
    let mut quoted = false;
    for &octet in first_line(text) {
        match octet {
            b'"' => quoted = !quoted,
            _ if quoted => {}
            _ => counts.iter_mut().filter(|(character, _)| *character == octet).for_each(|(_, count)| *count += 1),
        }
    }
    // Of equal counts the first.
    let most = counts.into_iter().rev().max_by_key(|&(_, count)| count);
    match most {
        Some((character, 1..)) => character,
        _ if blanks::has_words(&String::from_utf8_lossy(first_line(text))) => blanks::SEPARATOR,
        _ => b',',
    }
}

/// Whether a blank stands beside a separator in one of the first two lines, outside of quotes.
fn has_blanks(text: &[u8], delimiter: u8) -> bool {
    let mut quoted = false;
    let lines = text.split(|&octet| octet == b'\n').filter(|line| !line.trim_ascii().is_empty());
    lines.take(2).any(|line| {
        line.windows(2).any(|pair| {
            quoted ^= pair[0] == b'"';
            !quoted && (pair == [delimiter, b' '] || pair == [b' ', delimiter])
        })
    })
}

/// The first line that is not empty; a line break in quotes belongs to it.
fn first_line(text: &[u8]) -> &[u8] {
    let start = text.iter().position(|octet| !matches!(octet, b'\r' | b'\n')).unwrap_or(text.len());
    let mut quoted = false;
    let end = text[start..].iter().position(|&octet| {
        quoted ^= octet == b'"';
        !quoted && matches!(octet, b'\r' | b'\n')
    });
    &text[start..end.map_or(text.len(), |end| start + end)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_first_line_may_state_the_separator() {
        assert_eq!(stated_separator(b"sep=;\r\nx;y\n"), Some((b';', 7)));
        assert_eq!(stated_separator(b"SEP=,\nx,y\n"), Some((b',', 6)));
        assert_eq!(stated_separator(b"sep=\t\nx\ty\n"), Some((b'\t', 6)));
        for text in ["sep=;", "sep=x\n", "sep\n", "step;x_m\n", "sep=;1\n"] {
            assert_eq!(stated_separator(text.as_bytes()), None, "{text:?}");
        }
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("stops.csv");
        std::fs::write(&file, "sep=;\nstop;x_m\nA;0,5\n").unwrap();
        let mut csv = CsvFile::open(&file, Heading::Named).unwrap().unwrap();
        let mut row = StringRecord::new();
        assert!(csv.style.decimal_comma && csv.read(&mut row).unwrap());
        assert_eq!((csv.names.join("|").as_str(), row), ("stop|x_m", StringRecord::from(vec!["A", "0,5"])));
    }
}
