//! A table in memory: what a data frame has.

use std::borrow::Cow;
use std::collections::BTreeMap;

use crate::error::log_part::RowAddress;
use crate::error::robot_log_error::RobotLogError;
use crate::time::instant;

/// A table in memory with columns by name. It means the same as a CSV file with these columns, and is checked alike; errors
/// name the table and the row, counted from 0.
///
/// ```
/// use sextant_logs::{MemoryColumn, MemoryTable};
///
/// let columns = vec![
///     ("node".to_owned(), MemoryColumn::texts([Some("lamp"), Some("door"), Some("lamp")])),
///     ("stop".to_owned(), MemoryColumn::whole(vec![0, 0, 1])),
///     ("rssi_dbm".to_owned(), MemoryColumn::floats(vec![-70.5, f64::NAN, -64.0])),
/// ];
/// let table = MemoryTable::new("receptions", columns)?;
/// assert_eq!(table.rows(), 3);
/// # Ok::<(), sextant_logs::RobotLogError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct MemoryTable<'a> {
    name: String,
    columns: Vec<(String, MemoryColumn<'a>)>,
    rows: usize,
}

/// A column of a table in memory.
#[derive(Clone, Debug, PartialEq)]
pub enum MemoryColumn<'a> {
    /// Numbers; NaN is an empty cell. A number without a fraction is a whole number too, and the name `7` if it is 7.
    Floats(Cow<'a, [f64]>),
    /// Whole numbers.
    Whole {
        /// The numbers.
        values: Cow<'a, [i64]>,
        /// Which cells are empty, if any may be.
        empty: Option<Vec<bool>>,
    },
    /// Texts, each of them once, with a place in this list for each cell.
    Names {
        /// The place of the text of each cell; [`MemoryColumn::NO_NAME`] is an empty cell.
        codes: Cow<'a, [u32]>,
        /// The texts.
        names: Vec<String>,
    },
    /// Times: nanoseconds since 1970; [`MemoryColumn::NO_INSTANT`] is an empty cell.
    Instants(Cow<'a, [i64]>),
    /// Values of a type that means nothing in a log: neither numbers nor names. A cell that is needed is an error that says
    /// the type.
    Other {
        /// The type, in words.
        kind: String,
        /// Which cells are empty.
        empty: Vec<bool>,
    },
}

impl<'a> MemoryTable<'a> {
    /// The table `name` with these columns, each with its name.
    ///
    /// # Errors
    /// If the columns have not the same length, or a cell has the place of a text that is not there.
    pub fn new(name: impl Into<String>, columns: Vec<(String, MemoryColumn<'a>)>) -> Result<Self, RobotLogError> {
        let name = name.into();
        let rows = columns.first().map_or(0, |(_, column)| column.len());
        let at = |row| RowAddress::Table { name: name.clone(), row };
        for (of, column) in &columns {
            if column.len() != rows {
                let (first, found) = (&columns[0].0, column.len());
                let problem = format!("column `{of}` has {found} cells, but `{first}` has {rows}");
                return Err(RobotLogError::Row { at: at(None), problem });
            }
            if let MemoryColumn::Whole { empty: Some(empty), .. } = column
                && empty.len() != rows
            {
                let found = empty.len();
                let problem = format!("column `{of}` has {rows} cells, but says of {found} whether they are empty");
                return Err(RobotLogError::Row { at: at(None), problem });
            }
            if let Some((row, code)) = column.unknown_code() {
                let allowed = format!("the place of one of {} texts, from 0", column.names());
                let found = format!("place {code}");
                return Err(RobotLogError::Cell { at: at(Some(row)), column: of.clone(), found, allowed });
            }
        }
        Ok(Self { name, columns, rows })
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The number of its rows.
    #[must_use]
    pub const fn rows(&self) -> usize {
        self.rows
    }

    /// The names of its columns.
    pub fn column_names(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(|(name, _)| name.as_str())
    }

    /// The cell of a column in a row.
    pub(crate) fn cell(&self, column: usize, row: usize) -> Cell<'_> {
        self.columns[column].1.cell(row)
    }

    /// A number that stands for the text of the cell; see [`MemoryColumn::token`].
    pub(crate) fn token(&self, column: usize, row: usize) -> Option<u64> {
        self.columns[column].1.token(row)
    }
}

impl<'a> MemoryColumn<'a> {
    /// The place of the text of an empty cell.
    pub const NO_NAME: u32 = u32::MAX;

    /// The time of an empty cell.
    pub const NO_INSTANT: i64 = i64::MIN;

    /// Numbers; NaN is an empty cell.
    pub fn floats(values: impl Into<Cow<'a, [f64]>>) -> Self {
        Self::Floats(values.into())
    }

    /// Whole numbers, without empty cells.
    pub fn whole(values: impl Into<Cow<'a, [i64]>>) -> Self {
        Self::Whole { values: values.into(), empty: None }
    }

    /// Times: nanoseconds since 1970.
    pub fn instants(values: impl Into<Cow<'a, [i64]>>) -> Self {
        Self::Instants(values.into())
    }

    /// The text of each cell, or `None` of an empty one.
    ///
    /// # Panics
    /// If there are 2^32 - 1 different texts or more.
    pub fn texts<T: AsRef<str>>(cells: impl IntoIterator<Item = Option<T>>) -> Self {
        let mut names: Vec<String> = Vec::new();
        let mut places: BTreeMap<String, u32> = BTreeMap::new();
        let mut code = |text: &str| {
            places.get(text).copied().unwrap_or_else(|| {
                let code = u32::try_from(names.len()).ok().filter(|&code| code != Self::NO_NAME);
                let code = code.expect("fewer than 2^32 - 1 texts");
                names.push(text.to_owned());
                places.insert(text.to_owned(), code);
                code
            })
        };
        let codes: Vec<u32> =
            cells.into_iter().map(|cell| cell.map_or(Self::NO_NAME, |text| code(text.as_ref()))).collect();
        Self::Names { codes: codes.into(), names }
    }

    /// The number of its cells.
    fn len(&self) -> usize {
        match self {
            Self::Floats(values) => values.len(),
            Self::Whole { values, .. } | Self::Instants(values) => values.len(),
            Self::Names { codes, .. } => codes.len(),
            Self::Other { empty, .. } => empty.len(),
        }
    }

    /// The number of texts.
    fn names(&self) -> usize {
        if let Self::Names { names, .. } = self { names.len() } else { 0 }
    }

    /// The first row with the place of a text that is not there.
    fn unknown_code(&self) -> Option<(usize, u32)> {
        let Self::Names { codes, names } = self else { return None };
        let is_unknown = |code: u32| code != Self::NO_NAME && code as usize >= names.len();
        let row = codes.iter().position(|&code| is_unknown(code))?;
        Some((row, codes[row]))
    }

    fn cell(&self, row: usize) -> Cell<'_> {
        match self {
            Self::Floats(values) if values[row].is_nan() => Cell::Empty,
            Self::Floats(values) => Cell::Float(values[row]),
            Self::Whole { empty: Some(empty), .. } if empty[row] => Cell::Empty,
            Self::Whole { values, .. } => Cell::Whole(values[row]),
            Self::Names { codes, .. } if codes[row] == Self::NO_NAME => Cell::Empty,
            Self::Names { codes, names } => Cell::Text(&names[codes[row] as usize]),
            Self::Instants(values) if values[row] == Self::NO_INSTANT => Cell::Empty,
            Self::Instants(values) => Cell::Instant(values[row]),
            Self::Other { empty, .. } if empty[row] => Cell::Empty,
            Self::Other { kind, .. } => Cell::Other(kind),
        }
    }

    /// A number that stands for the text of the cell: cells of the column with equal numbers have equal texts. `None` if
    /// there is no such number.
    fn token(&self, row: usize) -> Option<u64> {
        match (self, self.cell(row)) {
            (_, Cell::Empty) => None,
            (Self::Names { codes, .. }, _) => Some(codes[row].into()),
            (_, Cell::Whole(value)) => u64::try_from(value).ok(),
            (_, Cell::Float(value)) => whole(value),
            (_, Cell::Text(_) | Cell::Instant(_) | Cell::Other(_)) => None,
        }
    }
}

/// What a cell holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Cell<'a> {
    Empty,
    /// A text, with the spaces around it.
    Text(&'a str),
    /// A number, not NaN.
    Float(f64),
    Whole(i64),
    /// Nanoseconds since 1970.
    Instant(i64),
    /// A value of this type, which is neither a number nor a name.
    Other(&'a str),
}

impl<'a> Cell<'a> {
    /// What a CSV file has for it.
    pub(crate) fn text(self) -> Cow<'a, str> {
        match self {
            Self::Empty => "".into(),
            Self::Text(text) | Self::Other(text) => text.into(),
            Self::Float(value) => value.to_string().into(),
            Self::Whole(value) => value.to_string().into(),
            Self::Instant(nanos) => instant::format_date(nanos).into(),
        }
    }
}

/// The number as a whole one, if it has no fraction and is so small that all whole numbers up to it are numbers of this type.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the number is in the range of the type")]
pub(crate) fn whole(value: f64) -> Option<u64> {
    /// 2^53.
    const LARGEST: f64 = 9_007_199_254_740_992.0;
    let is_whole = value.is_sign_positive() && value <= LARGEST && value.fract() == 0.0;
    is_whole.then_some(value as u64)
}
