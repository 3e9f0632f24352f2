//! What the cells of a wide table say of nodes that were not heard, and which columns are nodes.

use std::str::FromStr;

/// What a cell holds if the node was not heard: `100`, `empty`, or a word.
#[derive(Clone, Debug, PartialEq)]
pub enum Missing {
    /// Nothing, or NaN.
    Empty,
    /// A number.
    Level(f64),
    /// Another word.
    Word(String),
}

impl Missing {
    /// Whether the text of a cell says that the node was not heard. `number` is the same as a number is written in a program.
    pub(crate) fn is(&self, text: &str, number: &str) -> bool {
        match self {
            Self::Empty => is_empty(text),
            #[expect(clippy::float_cmp, reason = "the same decimal as written in the flag")]
            Self::Level(level) => number.parse::<f64>().is_ok_and(|number| number == *level),
            Self::Word(word) => text.eq_ignore_ascii_case(word),
        }
    }
}

/// Whether a cell holds nothing: programs write NaN for that, too.
pub(crate) fn is_empty(text: &str) -> bool {
    text.is_empty() || text.eq_ignore_ascii_case("nan")
}

impl FromStr for Missing {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        Ok(match text.parse::<f64>() {
            _ if text.eq_ignore_ascii_case("empty") || text.eq_ignore_ascii_case("nan") => Self::Empty,
            _ if text.is_empty() => return Err("expected a number (100), a word, or `empty`".to_owned()),
            Ok(level) if level.is_finite() => Self::Level(level),
            _ => Self::Word(text.to_owned()),
        })
    }
}

/// The names of some columns: one, or a pattern in which `*` stands for any text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColumnPattern(String);

impl ColumnPattern {
    /// Whether a column with this name is meant.
    pub(crate) fn holds(&self, name: &str) -> bool {
        let mut parts = self.0.split('*');
        let first = parts.next().unwrap_or_default();
        let Some(mut rest) = name.strip_prefix(first) else { return false };
        let mut parts: Vec<&str> = parts.collect();
        let Some(last) = parts.pop() else { return rest.is_empty() };
        for part in parts {
            let Some(at) = rest.find(part) else { return false };
            rest = &rest[at + part.len()..];
        }
        rest.ends_with(last)
    }
}

impl FromStr for ColumnPattern {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        if text.is_empty() {
            Err("expected the name of a column, or a pattern as AP*".to_owned())
        } else {
            Ok(Self(text.to_owned()))
        }
    }
}

impl std::fmt::Display for ColumnPattern {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_star_stands_for_any_text() {
        for (pattern, name, expected) in [
            ("WAP*", "WAP001", true),
            ("WAP*", "FLOOR", false),
            ("*:*:01", "aa:bb:01", true),
            ("*:*:01", "aa:bb:02", false),
            ("lamp", "lamp", true),
            ("lamp", "lamps", false),
            ("a*a", "a", false),
            ("*", "", true),
        ] {
            assert_eq!(pattern.parse::<ColumnPattern>().unwrap().holds(name), expected, "{pattern} {name}");
        }
    }

    #[test]
    fn a_value_for_not_heard_is_a_number_a_word_or_nothing() {
        let is = |missing: &str, cell: &str| missing.parse::<Missing>().unwrap().is(cell, cell);
        assert!(is("100", "100.0") && is("-200", "-200") && !is("100", "-100") && !is("100", ""));
        assert!(is("empty", "") && is("empty", "NaN") && is("nan", "") && !is("empty", "0"));
        assert!(is("none", "None") && !is("none", ""));
    }
}
