//! The columns of a table by their names: which columns are known, which are ignored.

use std::collections::BTreeSet;

use sextant_kernel::text::{choices, shortened};

use crate::error::log_part::LogPart;
use crate::options::field_names::FieldNames;
use crate::time::instant;

/// The columns of a file.
#[derive(Clone, Default)]
pub(crate) struct Header {
    /// What each column is: its name, or the known name that the user gives it.
    columns: Vec<String>,
    /// The names as written.
    written: Vec<String>,
    /// The names of the user.
    given: FieldNames,
    ignored: Vec<usize>,
}

/// The columns that a file may have.
#[derive(Clone, Copy)]
pub(crate) struct KnownColumns<'a> {
    pub(crate) required: &'a [&'static str],
    pub(crate) optional: &'a [&'static str],
    /// The names of the user for them.
    pub(crate) names: &'a FieldNames,
    /// Whether the columns that are not known are ignored, or are read too.
    pub(crate) others: Others,
}

/// What columns with names that are not known are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Others {
    Ignored,
    /// They are read too.
    Read,
    /// The user names those that are read, so none is misspelt.
    Named,
}

impl Header {
    /// Checks the names of the columns of `part`. A name that is not known is ignored, unless it looks like a known column that is
    /// absent: a misspelt `sent` would silently count as absent.
    pub(crate) fn new<'n>(
        names: impl Iterator<Item = &'n str>,
        known: KnownColumns<'_>,
        part: &LogPart,
    ) -> Result<Self, String> {
        let written: Vec<String> = names.map(|name| name.trim().to_owned()).collect();
        let KnownColumns { required, optional, names: given, others } = known;
        let known = [required, optional].concat();
        let columns = given.rename(&written, &known, part)?;
        let has = |name: &str| columns.iter().any(|column| column == name);
        let has_time = instant::COLUMNS.into_iter().any(has);
        // A file has one of the columns of times.
        let is_absent = |name: &&str| !(has(name) || has_time && instant::COLUMNS.contains(name));
        let absent: Vec<&str> = known.iter().copied().filter(is_absent).collect();
        // Of the columns of times, `t_s` is the one that is meant by a name that is nearly right.
        let is_likely = |name: &&str| *name == "t_s" || !instant::COLUMNS.contains(name);
        let likely: Vec<&str> = absent.iter().copied().filter(is_likely).collect();
        let mut ignored = Vec::new();
        let mut seen = BTreeSet::new();
        for (at, name) in columns.iter().enumerate() {
            let is_known = known.contains(&name.as_str());
            if !is_known {
                let asked = written[at].as_str();
                if let Some((meant, unit, remedy)) = in_other_unit(name, &likely) {
                    return Err(format!(
                        "column `{asked}` is in {unit}, and places need metres; {remedy} and name it `{meant}`"
                    ));
                }
                let (near, more) = match others {
                    Others::Ignored => (nearest(name, &likely), ""),
                    Others::Read => {
                        (look_alike(name, &likely), ", or name the columns of nodes with option `node_columns`")
                    }
                    Others::Named => (None, ""),
                };
                if let Some(near) = near {
                    let hint = given.hint(near, asked) + more;
                    let known = known.join(", ");
                    return Err(format!(
                        "unknown column `{asked}`; did you mean `{near}`? Otherwise rename or remove it{hint}; known \
                         columns: {known}"
                    ));
                }
                ignored.push(at);
            }
            let is_new = seen.insert(name);
            if (is_known || others != Others::Ignored && !name.is_empty()) && !is_new {
                return Err(format!("column `{name}` appears twice"));
            }
        }
        if let Some(missing) = required.iter().find(|name| absent.contains(name)) {
            return Err(format!(
                "column `{missing}` is missing; {} the columns: {}{}",
                must_have(part),
                required.join(","),
                given.hint(missing, "NAME") + &hint_of_values(&written)
            ));
        }
        Ok(Self { columns, written, given: given.clone(), ignored })
    }

    /// The name of the column `known` as the file has it.
    pub(crate) fn written<'a>(&'a self, known: &'a str) -> &'a str {
        self.find(known).map_or(known, |at| &self.written[at])
    }

    /// How the user can say that a column with another name is the known one `key`.
    pub(crate) fn hint(&self, key: &str) -> String {
        self.given.hint(key, "NAME") + &hint_of_values(&self.written)
    }

    /// The names as written.
    pub(crate) fn all_written(&self) -> &[String] {
        &self.written
    }

    /// The indices of the columns that are not known.
    pub(crate) fn unknown(&self) -> impl Iterator<Item = usize> {
        self.ignored.iter().copied()
    }

    /// The index of the column `name`.
    pub(crate) fn find(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column == name)
    }

    /// The names of the columns that are ignored, without those that are `understood` elsewhere; `None` if there are none.
    pub(crate) fn ignored_names(&self, understood: &[&str]) -> Option<String> {
        let names: Vec<String> = self
            .ignored
            .iter()
            .map(|&at| &self.written[at])
            .filter(|name| !name.is_empty() && !understood.contains(&name.as_str()))
            .map(|name| format!("`{name}`"))
            .collect();
        (!names.is_empty()).then(|| choices(&names))
    }
}

/// What a part of a log must do about columns that are missing.
pub(crate) const fn must_have(part: &LogPart) -> &'static str {
    match part {
        LogPart::File(_) => "the first line must name",
        LogPart::Table(_) => "the table must have",
    }
}

/// Ends of the names of places in other units than metres, the units, and what makes metres of them.
const OTHER_UNITS: [(&str, &str, &str); 6] = [
    ("_mm", "millimetres", "divide it by 1000"),
    ("_cm", "centimetres", "divide it by 100"),
    ("_ft", "feet", "multiply it by 0.3048"),
    ("_feet", "feet", "multiply it by 0.3048"),
    ("_in", "inches", "multiply it by 0.0254"),
    ("_km", "kilometres", "multiply it by 1000"),
];

/// The column of places among `absent` that `name` is in another unit, with that unit and what makes metres of it.
fn in_other_unit<'a>(name: &str, absent: &[&'a str]) -> Option<(&'a str, &'static str, &'static str)> {
    let name = name.to_lowercase();
    OTHER_UNITS.iter().find_map(|(end, unit, remedy)| {
        let axis = name.strip_suffix(end).filter(|axis| ["x", "y", "z", "alt"].contains(axis))?;
        let meant = absent.iter().copied().find(|known| known.strip_suffix("_m") == Some(axis))?;
        Some((meant, *unit, *remedy))
    })
}

/// Names that programs give to strengths.
const STRENGTHS: [&str; 6] = ["signal", "signal_strength", "rss", "level", "power_dbm", "dbm"];

/// The name among `absent` that `name` was probably meant to be: it differs in at most two letters (one, if either name has
/// fewer than four), `name` is its beginning, or programs give it to strengths.
fn nearest<'a>(name: &str, absent: &[&'a str]) -> Option<&'a str> {
    let name = name.to_lowercase();
    if STRENGTHS.contains(&name.as_str()) && absent.contains(&"rssi_dbm") {
        return Some("rssi_dbm");
    }
    let distance = |candidate: &&str| strsim::damerau_levenshtein(&name, candidate);
    let is_near = |candidate: &&str| {
        let allowed = if name.len().min(candidate.len()) < 4 { 1 } else { 2 };
        !name.is_empty() && (distance(candidate) <= allowed || candidate.starts_with(name.as_str()))
    };
    absent.iter().copied().filter(is_near).min_by_key(distance)
}

/// Names that programs give to places and times, and the columns that they are here.
const LOOK_ALIKES: [(&str, &str); 12] = [
    ("x", "x_m"),
    ("y", "y_m"),
    ("z", "z_m"),
    ("latitude", "lat"),
    ("longitude", "lon"),
    ("lng", "lon"),
    ("altitude", "alt_m"),
    ("alt", "alt_m"),
    ("ele", "alt_m"),
    ("t", "t_s"),
    ("time", "t_s"),
    ("timestamp", "t_s"),
];

/// The name among `absent` that the column of a node, which may have any name, was probably meant to be: it is one that
/// programs give to it, or differs in one letter of at least three.
fn look_alike<'a>(name: &str, absent: &[&'a str]) -> Option<&'a str> {
    let name = name.to_lowercase();
    let meant = LOOK_ALIKES.iter().find(|(other, _)| *other == name).map(|(_, meant)| *meant);
    let is_near = |candidate: &&str| {
        meant == Some(*candidate) || name.len() >= 3 && strsim::damerau_levenshtein(&name, candidate) <= 1
    };
    absent.iter().copied().find(is_near)
}

/// What to tell of a first line that holds values and no names: it has digits and no letters.
fn hint_of_values(written: &[String]) -> String {
    let has = |of: fn(char) -> bool| written.iter().any(|cell| cell.contains(of));
    if has(char::is_alphabetic) || !has(|letter| letter.is_ascii_digit()) {
        return String::new();
    }
    let line = shortened(&written.join(",")).into_owned();
    format!("; the first line, `{line}`, holds values and no names: write the names of the columns above it")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The problem of a header with these columns.
    fn problem(columns: &str, required: &[&'static str], optional: &[&'static str], others: Others) -> String {
        let names = FieldNames::of_places(None);
        let known = KnownColumns { required, optional, names: &names, others };
        let found = Header::new(columns.split(','), known, &LogPart::File("stops.csv".into()));
        found.map_or_else(|problem| problem, |_| String::new())
    }

    #[test]
    fn places_in_other_units_are_refused_without_a_hint_that_reads_them_as_metres() {
        const PLACES: [&str; 5] = ["x_m", "y_m", "z_m", "lat", "lon"];
        for (columns, told) in [
            (
                "stop,x_mm,y_mm",
                "column `x_mm` is in millimetres, and places need metres; divide it by 1000 and name it `x_m`",
            ),
            (
                "stop,X_cm,Y_cm",
                "column `X_cm` is in centimetres, and places need metres; divide it by 100 and name it `x_m`",
            ),
            (
                "stop,x_m,y_ft",
                "column `y_ft` is in feet, and places need metres; multiply it by 0.3048 and name it `y_m`",
            ),
            ("stop,x_m,x_mm,y_m", ""),
        ] {
            assert_eq!(problem(columns, &["stop"], &PLACES, Others::Ignored), told);
            assert_eq!(problem(columns, &["stop"], &PLACES, Others::Read), told);
        }
    }

    #[test]
    fn usual_names_of_strengths_are_asked_about() {
        for name in STRENGTHS {
            let found = problem(&format!("t_s,node,{name}"), &["node"], &["t_s", "rssi_dbm"], Others::Ignored);
            assert!(found.contains(&format!("`{name}`; did you mean `rssi_dbm`?")), "{found}");
        }
        assert_eq!(problem("t_s,node,rssi_dbm,level", &["node"], &["t_s", "rssi_dbm"], Others::Ignored), "");
    }
}
