//! What is odd in a log.

use std::fmt;

use serde::Serialize;

/// Something odd in a log: what, what it costs, and what corrects it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// Which check found it, for example `clock-offset`.
    pub check: &'static str,
    /// What is odd, with the numbers of the log.
    pub odd: String,
    /// What it costs: what of the map is wrong or lost.
    pub cost: String,
    /// The flag or the action that corrects it.
    pub remedy: String,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}. {}. {}", self.odd, capital(&self.cost), capital(&self.remedy))
    }
}

/// The text with a capital first letter.
fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_finding_reads_as_three_sentences() {
        let finding = Finding {
            check: "speed",
            odd: "the robot is fast".to_owned(),
            cost: "places are scaled".to_owned(),
            remedy: "option `x` slows it".to_owned(),
        };
        assert_eq!(finding.to_string(), "the robot is fast. Places are scaled. Option `x` slows it");
    }
}
