//! The columns of a table by their names: which columns are known, which are ignored.

use std::collections::BTreeSet;

use sextant_kernel::text::choices;

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
                given.hint(missing, "NAME")
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
        self.given.hint(key, "NAME")
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

    /// The names of the columns that are ignored, if any has one.
    pub(crate) fn ignored_names(&self) -> Option<String> {
        let names: Vec<String> = self
            .ignored
            .iter()
            .map(|&at| &self.written[at])
            .filter(|name| !name.is_empty())
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

/// The name among `absent` that `name` was probably meant to be: it differs in at most two letters (one, if either name has
/// fewer than four), or `name` is its beginning.
fn nearest<'a>(name: &str, absent: &[&'a str]) -> Option<&'a str> {
    let name = name.to_lowercase();
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
