//! Paths of settings in a scenario: `world.obstacles[2].shape.box.size_m`.

use std::fmt;
use std::ops::Range;

/// One step of a path, into a table or an array.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum PathStep {
    /// Into a table, by key. A key of digits may also be an index: `robots.0`.
    Key(String),
    /// Into an array, by index from 0.
    Index(usize),
}

impl PathStep {
    /// The step as a key of a table, if it can be one.
    pub(crate) fn key(&self) -> Option<&str> {
        match self {
            Self::Key(key) => Some(key),
            Self::Index(_) => None,
        }
    }

    /// The step as an index into an array, if it can be one.
    pub(crate) fn index(&self) -> Option<usize> {
        match self {
            Self::Key(key) => key.parse().ok(),
            Self::Index(index) => Some(*index),
        }
    }
}

/// The steps from the top of a scenario to a setting. It is printed as users write it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct KeyPath(pub(crate) Vec<PathStep>);

/// An error in a key path: the bytes, and the message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct PathError {
    pub(crate) span: Range<usize>,
    pub(crate) message: &'static str,
}

/// The most steps of a path. Scenarios are less deep, and work on them goes down step by step.
pub(crate) const MOST_STEPS: usize = 64;

/// What is said of a path with more.
pub(crate) const TOO_DEEP: &str = "a path has at most 64 keys";

impl KeyPath {
    /// Parses `a.b[2].c`, `a.b.2.c` or `a."odd key".c`.
    pub(crate) fn parse(text: &str) -> Result<Self, PathError> {
        Ok(Self(Self::parse_spanned(text)?.into_iter().map(|(step, _)| step).collect()))
    }

    /// Parses a path into its steps and the bytes of each step.
    pub(crate) fn parse_spanned(text: &str) -> Result<Vec<(PathStep, Range<usize>)>, PathError> {
        let mut steps = Vec::new();
        let mut at = 0;
        loop {
            let rest = &text[at..];
            let fail = |length: usize, message| Err(PathError { span: at..at + length, message });
            if steps.len() == MOST_STEPS {
                return fail(rest.len(), TOO_DEEP);
            }
            if rest.starts_with('[') && !steps.is_empty() {
                let Some(close) = rest.find(']') else {
                    return fail(rest.len(), "`[` without `]`");
                };
                let Ok(index) = rest[1..close].trim().parse() else {
                    return fail(close + 1, "an index must be a whole number, 0 or above");
                };
                steps.push((PathStep::Index(index), at..at + close + 1));
                at += close + 1;
            } else if let Some(quoted) = rest.strip_prefix('"') {
                let Some(length) = quoted.find('"') else {
                    return fail(rest.len(), "the closing quote is missing");
                };
                steps.push((PathStep::Key(quoted[..length].to_owned()), at..at + length + 2));
                at += length + 2;
            } else {
                let length = rest.find(['.', '[']).unwrap_or(rest.len());
                let key = rest[..length].trim();
                if key.is_empty() {
                    return fail(length.max(usize::from(!rest.is_empty())), "a key is missing here");
                }
                steps.push((PathStep::Key(key.to_owned()), at..at + length));
                at += length;
            }
            match text[at..].chars().next() {
                None => return Ok(steps),
                Some('[') => {}
                Some('.') => at += 1,
                Some(other) => {
                    let span = at..at + other.len_utf8();
                    return Err(PathError { span, message: "expected `.` between keys" });
                }
            }
        }
    }

    /// Whether it is `other`, or a path to something in it.
    pub(crate) fn is_within(&self, other: &Self) -> bool {
        let same = |(step, other): (&PathStep, &PathStep)| {
            step == other || step.index().is_some_and(|i| other.index() == Some(i))
        };
        self.0.len() >= other.0.len() && self.0.iter().zip(&other.0).all(same)
    }

    /// Whether it is another setting of the same table as `other`.
    pub(crate) fn is_beside(&self, other: &Self) -> bool {
        let table = |path: &Self| path.0.split_last().map(|(_, table)| Self(table.to_vec()));
        table(self) == table(other) && self != other
    }

    /// The path with one more step.
    pub(crate) fn child(&self, step: PathStep) -> Self {
        let mut steps = self.0.clone();
        steps.push(step);
        Self(steps)
    }
}

impl fmt::Display for KeyPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, step) in self.0.iter().enumerate() {
            match step {
                PathStep::Index(index) => write!(f, "[{index}]")?,
                PathStep::Key(key) => {
                    let dot = if i > 0 { "." } else { "" };
                    let bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
                    if !key.is_empty() && key.chars().all(bare) {
                        write!(f, "{dot}{key}")?;
                    } else {
                        write!(f, "{dot}\"{key}\"")?;
                    }
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_printed_as_written() {
        for text in ["seed", "world.obstacles[2].shape.box.size_m", "a.\"odd key\".c[0][1]"] {
            assert_eq!(KeyPath::parse(text).unwrap().to_string(), text);
        }
        assert_eq!(KeyPath::parse("robots.0.speed").unwrap().0[1].index(), Some(0));
    }

    #[test]
    fn each_step_knows_its_bytes() {
        let text = "a.bc[10].d";
        let spans: Vec<_> = KeyPath::parse_spanned(text).unwrap().into_iter().map(|(_, span)| &text[span]).collect();
        assert_eq!(spans, ["a", "bc", "[10]", "d"]);
    }

    #[test]
    fn errors_in_paths_have_the_right_place() {
        for (text, span) in [("", 0..0), (".a", 0..1), ("a..b", 2..3), ("a.", 2..2), ("a[x]", 1..4), ("a[1", 1..3)] {
            assert_eq!(KeyPath::parse(text).unwrap_err().span, span, "{text}");
        }
        assert_eq!(KeyPath::parse("a[0]b").unwrap_err().span, 4..5);
        let deep = |steps: usize| KeyPath::parse(&vec!["a"; steps].join("."));
        assert!(deep(MOST_STEPS).is_ok());
        assert_eq!(deep(100_000).unwrap_err().message, TOO_DEEP);
    }
}
