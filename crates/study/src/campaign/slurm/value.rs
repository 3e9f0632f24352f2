//! Values that go to the programs of Slurm, each in its grammar.

use std::borrow::Borrow;
use std::fmt;
use std::marker::PhantomData;
use std::str::FromStr;

use serde::{Serialize, Serializer};
use sextant_kernel::SettingError;

/// The number of a job.
pub type JobId = Value<Job>;
/// The time limit of a task.
pub type TimeLimit = Value<Time>;
/// The name of a partition or an account, or several.
pub type SlurmName = Value<Name>;
/// The memory of a task.
pub type Memory = Value<Size>;

/// A text of the grammar `G`. None ends a line, is a flag, or means something else to a shell.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Value<G> {
    text: String,
    grammar: PhantomData<G>,
}

/// Which texts are allowed.
pub trait Grammar {
    /// The texts, in words.
    const ALLOWED: &'static str;

    /// Whether a text is one of them.
    fn has(text: &str) -> bool;
}

/// Digits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Job {}

/// Times as `sbatch --time` takes them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Time {}

/// Names of partitions and accounts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Name {}

/// Sizes as `sbatch --mem` takes them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Size {}

/// Longest text of a name.
const LONGEST_NAME: usize = 200;

fn is_number(text: &str) -> bool {
    (1..=18).contains(&text.len()) && text.bytes().all(|octet| octet.is_ascii_digit())
}

impl Grammar for Job {
    const ALLOWED: &'static str = "the number of a job: digits";

    fn has(text: &str) -> bool {
        is_number(text)
    }
}

impl Grammar for Time {
    const ALLOWED: &'static str = "minutes, minutes:seconds, hours:minutes:seconds, days-hours, days-hours:minutes, \
                                   days-hours:minutes:seconds, or UNLIMITED";

    fn has(text: &str) -> bool {
        if ["UNLIMITED", "INFINITE"].iter().any(|word| text.eq_ignore_ascii_case(word)) {
            return true;
        }
        let clock = match text.split_once('-') {
            Some((days, clock)) if is_number(days) => clock,
            Some(_) => return false,
            None => text,
        };
        let parts: Vec<&str> = clock.split(':').collect();
        parts.len() <= 3 && parts.iter().all(|part| is_number(part))
    }
}

impl Grammar for Name {
    const ALLOWED: &'static str =
        "letters, digits, `_`, `.`, `+`, `@` and, not in front, `-`; commas between several names";

    fn has(text: &str) -> bool {
        let is_letter = |c: char| c.is_ascii_alphanumeric() || "_.+@-".contains(c);
        let is_name = |name: &str| !name.is_empty() && !name.starts_with('-') && name.chars().all(is_letter);
        text.len() <= LONGEST_NAME && text.split(',').all(is_name)
    }
}

impl Grammar for Size {
    const ALLOWED: &'static str = "a whole number with K, M, G or T, for example 4G; without a letter, megabytes";

    fn has(text: &str) -> bool {
        let digits = text.strip_suffix(['B', 'b']).filter(|rest| rest.ends_with(|c: char| c.is_ascii_alphabetic()));
        let digits = digits.unwrap_or(text);
        is_number(digits.strip_suffix(['K', 'M', 'G', 'T', 'k', 'm', 'g', 't']).unwrap_or(digits))
    }
}

impl<G: Grammar> Value<G> {
    /// The value in `text`, which stands under `key`.
    ///
    /// # Errors
    /// If it is none.
    pub(super) fn of(key: &str, text: &str) -> Result<Self, SettingError> {
        text.parse().map_err(|_| SettingError::new(key, found(text), G::ALLOWED))
    }
}

/// A text that was found where another one is allowed: characters that end a line are shown.
pub(super) fn found(text: &str) -> String {
    format!("`{}`", text.escape_debug())
}

impl<G: Grammar> FromStr for Value<G> {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if G::has(text) {
            Ok(Self { text: text.to_owned(), grammar: PhantomData })
        } else {
            Err(format!("allowed: {}", G::ALLOWED))
        }
    }
}

impl<G> fmt::Debug for Value<G> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(&self.text, f)
    }
}

impl<G> fmt::Display for Value<G> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl<G> AsRef<str> for Value<G> {
    fn as_ref(&self) -> &str {
        &self.text
    }
}

impl<G> Borrow<str> for Value<G> {
    fn borrow(&self) -> &str {
        &self.text
    }
}

impl<G> Serialize for Value<G> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check<G: Grammar>(good: &[&str], bad: &[&str]) {
        for text in good {
            assert_eq!(text.parse::<Value<G>>().unwrap().to_string(), *text);
        }
        for text in bad.iter().chain(&[
            "",
            " ",
            "\n",
            "1\nid",
            "1\r",
            "1\u{2028}",
            "--user=me",
            "-1",
            "$(id)",
            "`id`",
            "1 2",
            "1;2",
            "1'",
        ]) {
            assert!(text.parse::<Value<G>>().is_err(), "{text:?}");
        }
    }

    #[test]
    fn values_are_in_the_grammar_of_slurm() {
        check::<Job>(&["1", "4711"], &["12_3", "+1", "0x1", "12,13", "१"]);
        check::<Time>(
            &["30", "30:00", "1:00:00", "2-0", "2-12:30", "1-00:00:01", "UNLIMITED", "infinite"],
            &["1:2:3:4", "1-2-3", "1h", "-", "1-", ":"],
        );
        check::<Name>(
            &["long", "long,short", "def-prof_1.a+b", "me@x"],
            &["a,", ",a", "a,-b", "a=b", "#a", "ä", "a/b"],
        );
        check::<Size>(&["0", "4G", "500m", "2TB"], &["4X", "G", "1.5G", "4GG", "4B"]);
    }
}
