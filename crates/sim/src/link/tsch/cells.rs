//! The cells of a schedule of one's own: rows of a scenario and of a file, checked but for the names of sinks.

use std::path::Path;

use sextant_kernel::text::of_cell;
use sextant_kernel::{Files, SettingError};
use sextant_mac::tsch::{CellConfig, CellOptions, OwnScheduleConfig};

use crate::csv_rows::{line_of, row_fault};

/// The columns of a file.
const COLUMNS: [&str; 5] = ["node", "peer", "timeslot", "channel_offset", "options"];

/// A cell, whose names are not stations yet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct NamedCell {
    /// Where it is written: the key below the schedule.
    pub(super) key: String,
    /// For errors: the line, if it is in a file.
    pub(super) place: Option<String>,
    pub(super) node: String,
    pub(super) peer: String,
    pub(super) timeslot: u16,
    pub(super) channel_offset: u16,
    pub(super) options: CellOptions,
}

impl NamedCell {
    /// An error in one of its values.
    pub(super) fn refuse(&self, column: &str, found: &str, allowed: &str) -> SettingError {
        match &self.place {
            None => SettingError::new(format!("{}.{column}", self.key), found, allowed),
            Some(place) => SettingError::new(&self.key, format!("{place}: {column} {found}"), allowed),
        }
    }
}

/// The cells of a schedule, with those of its file. The keys of errors are below `own`.
pub(super) fn read(own: &OwnScheduleConfig, files: &Files) -> Result<Vec<NamedCell>, SettingError> {
    let mut cells = Vec::new();
    for (i, cell) in own.cells.iter().enumerate() {
        cells.push(checked(cell, own.slotframe, format!("cells[{i}]"), None)?);
    }
    if let Some(file) = &own.file {
        let path = files.path(file);
        let text = files.read_text(file).map_err(|error| {
            let found = format!("`{}`: {error}", path.display());
            SettingError::new("file", found, "a CSV file that can be read")
        })?;
        parse(&text, file, own.slotframe, &mut cells).map_err(|error| files.discreet(file, error))?;
    }
    Ok(cells)
}

fn checked(cell: &CellConfig, slotframe: u16, key: String, place: Option<String>) -> Result<NamedCell, SettingError> {
    let CellConfig { node, peer, timeslot, channel_offset, options } = cell;
    let (timeslot, channel_offset) = (*timeslot, *channel_offset);
    let (node, peer) = (node.clone(), peer.clone());
    let mut cell = NamedCell { key, place, node, peer, timeslot, channel_offset, options: CellOptions::default() };
    if timeslot >= slotframe {
        let allowed = format!("0 to {}, below `slotframe`", slotframe - 1);
        return Err(cell.refuse("timeslot", &timeslot.to_string(), &allowed));
    }
    for word in options.split_whitespace() {
        cell.options = cell.options.and(match word {
            "transmit" => CellOptions::TRANSMIT,
            "receive" => CellOptions::RECEIVE,
            "shared" => CellOptions::SHARED,
            "timekeeping" => CellOptions::TIMEKEEPING,
            _ => {
                let allowed = "`transmit`, `receive`, `shared` and `timekeeping`, separated by blanks";
                return Err(cell.refuse("options", &format!("`{word}`"), allowed));
            }
        });
    }
    if !cell.options.has(CellOptions::TRANSMIT) && !cell.options.has(CellOptions::RECEIVE) {
        return Err(cell.refuse("options", &format!("`{options}`"), "at least `transmit` or `receive`"));
    }
    Ok(cell)
}

fn parse(text: &str, file: &Path, slotframe: u16, cells: &mut Vec<NamedCell>) -> Result<(), SettingError> {
    let line_at = |line: u64| format!("`{}`, line {line}", file.display());
    let refuse = |line: u64, what: String, allowed: &str| {
        SettingError::new("file", format!("{}: {what}", line_at(line)), allowed)
    };
    let columns = "the columns `node`, `peer`, `timeslot`, `channel_offset` and `options`";
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
    let header = reader.headers().map_err(|error| refuse(1, error.to_string(), columns))?.clone();
    if header.iter().ne(COLUMNS) {
        return Err(refuse(1, "other columns".to_owned(), columns));
    }
    let before = cells.len();
    for record in reader.records() {
        let record = record.map_err(|error| refuse(line_of(text, error.position()), row_fault(&error), columns))?;
        let line = line_of(text, record.position());
        let cell = |column: usize| record.get(column).unwrap_or_default();
        let number = |column: usize| {
            let found = cell(column);
            let refuse = |_| refuse(line, format!("{} `{found}`", COLUMNS[column]), "0 to 65535");
            found.parse::<u16>().map_err(refuse)
        };
        let row = CellConfig {
            node: of_cell(cell(0)).to_owned(),
            peer: of_cell(cell(1)).to_owned(),
            timeslot: number(2)?,
            channel_offset: number(3)?,
            options: cell(4).to_owned(),
        };
        cells.push(checked(&row, slotframe, "file".to_owned(), Some(line_at(line)))?);
    }
    if cells.len() == before {
        return Err(SettingError::new(
            "file",
            format!("`{}`, without any rows", file.display()),
            "at least one cell",
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<Vec<NamedCell>, String> {
        let mut cells = Vec::new();
        parse(text, Path::new("cells.csv"), 10, &mut cells).map_err(|error| error.found().to_owned())?;
        Ok(cells)
    }

    const HEADER: &str = "node,peer,timeslot,channel_offset,options\n";

    #[test]
    fn a_row_of_a_file_is_a_cell() {
        let cells = parsed(&format!("{HEADER}# a comment\n a, *, 3, 1, transmit shared\n")).unwrap();
        let [cell] = &cells[..] else { panic!("{cells:?}") };
        assert_eq!((&*cell.node, &*cell.peer, cell.timeslot, cell.channel_offset), ("a", "*", 3, 1));
        assert_eq!(cell.options, CellOptions::TRANSMIT.and(CellOptions::SHARED));
    }

    #[test]
    fn an_error_names_its_line() {
        let found = |rows: &str| parsed(&format!("{HEADER}{rows}")).unwrap_err();
        assert_eq!(found("a,b,x,0,transmit\n"), "`cells.csv`, line 2: timeslot `x`");
        assert_eq!(found("a,b,10,0,transmit\n"), "`cells.csv`, line 2: timeslot 10");
        assert_eq!(found("a,b,1,0,transmit\na,b,1,0,send\n"), "`cells.csv`, line 3: options `send`");
        assert_eq!(found("a,b,1,0,shared\n"), "`cells.csv`, line 2: options `shared`");
        assert_eq!(found("a,b\n"), "`cells.csv`, line 2: 2 cells for 5 columns");
        assert_eq!(found(""), "`cells.csv`, without any rows");
        assert_eq!(parsed("node,peer\n").unwrap_err(), "`cells.csv`, line 1: other columns");
    }
}
