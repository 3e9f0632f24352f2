//! Some of a numbered list.

use std::fmt;
use std::str::FromStr;

/// The numbers from `start` to `end` - 1 of a list that is numbered from 0, such as the work list of a plan: `A..B`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct NumberRange {
    /// The first number.
    pub start: usize,
    /// The number after the last one.
    pub end: usize,
}

impl NumberRange {
    /// How many there are.
    #[must_use]
    pub fn len(self) -> usize {
        self.end - self.start
    }

    /// Whether there is none; a range that was read has some.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.end <= self.start
    }

    /// Whether a number is in it.
    #[must_use]
    pub fn has(self, number: usize) -> bool {
        (self.start..self.end).contains(&number)
    }

    /// Joins neighbouring numbers, which are in order.
    pub fn joined(numbers: impl IntoIterator<Item = usize>) -> Vec<Self> {
        let mut ranges: Vec<Self> = Vec::new();
        for number in numbers {
            match ranges.last_mut() {
                Some(last) if last.end == number => last.end += 1,
                _ => ranges.push(Self { start: number, end: number + 1 }),
            }
        }
        ranges
    }
}

impl fmt::Display for NumberRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}..{}", self.start, self.end)
    }
}

impl FromStr for NumberRange {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let expected = "expected A..B with A < B, for example 0..100 for the first hundred";
        let (start, end) = text.split_once("..").ok_or(expected)?;
        let (Ok(start), Ok(end)) = (start.trim().parse(), end.trim().parse()) else { return Err(expected) };
        if start < end { Ok(Self { start, end }) } else { Err(expected) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_is_written_as_it_is_read() {
        let range: NumberRange = "3..12".parse().unwrap();
        assert_eq!((range.len(), range.to_string().as_str()), (9, "3..12"));
        for text in ["", "3", "3-4", "4..4", "5..4", "-1..2", "a..b"] {
            assert!(text.parse::<NumberRange>().is_err(), "{text}");
        }
    }

    #[test]
    fn neighbours_are_joined() {
        let ranges = NumberRange::joined([0, 1, 2, 5, 7, 8]);
        assert_eq!(ranges.iter().map(ToString::to_string).collect::<Vec<_>>(), ["0..3", "5..6", "7..9"]);
        assert_eq!(NumberRange::joined([]), []);
    }
}
