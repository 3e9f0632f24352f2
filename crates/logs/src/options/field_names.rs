//! How a user's files name columns and fields: `node=src,rssi_dbm=rssi`.

use std::fmt;

use sextant_kernel::text::choices;

use crate::error::log_part::LogPart;

/// The names of columns or fields in a file, by what they mean.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FieldNames {
    /// The flag that gave them, or would.
    flag: Option<&'static str>,
    pairs: Vec<(&'static str, String)>,
}

/// What a list of packets, or of receptions, can hold.
const OF_PACKETS: [&str; 18] = [
    "node", "receiver", "stop", "t_s", "t_ms", "t_us", "t_ns", "rssi_dbm", "snr_db", "sector", "robot", "received",
    "sent", "range_m", "range_cm", "range_mm", "range_ft", "range_ns",
];

/// What a list of ranges can hold.
const OF_RANGES: [&str; 12] = [
    "node", "stop", "robot", "range_m", "range_cm", "range_mm", "range_ft", "range_ns", "t_s", "t_ms", "t_us", "t_ns",
];

/// What a list of places can hold.
const OF_PLACES: [&str; 15] = [
    "stop",
    "t_s",
    "t_ms",
    "t_us",
    "t_ns",
    "x_m",
    "y_m",
    "z_m",
    "lat",
    "lon",
    "alt_m",
    "robot",
    "sent",
    "heading_rad",
    "heading_deg",
];

/// What a list of true positions can hold.
const OF_TRUTH: [&str; 7] = ["node", "x_m", "y_m", "z_m", "lat", "lon", "alt_m"];

impl FieldNames {
    /// The names of the user for what packets have, or none.
    pub(crate) fn of_packets(given: Option<&Self>) -> Self {
        given.cloned().unwrap_or(Self { flag: Some(PACKET_FIELDS), pairs: Vec::new() })
    }

    /// The names of the user for what ranges have, or none.
    pub(crate) fn of_ranges(given: Option<&Self>) -> Self {
        given.cloned().unwrap_or(Self { flag: Some(RANGE_FIELDS), pairs: Vec::new() })
    }

    /// Reads the value of option `range_fields`.
    ///
    /// # Errors
    /// If a key is unknown or given twice, or a name is missing.
    pub fn parse_ranges(text: &str) -> Result<Self, String> {
        Self::parse(text, RANGE_FIELDS, &OF_RANGES)
    }

    /// The names of the user for what places have, or none.
    pub(crate) fn of_places(given: Option<&Self>) -> Self {
        given.cloned().unwrap_or(Self { flag: Some(PATH_FIELDS), pairs: Vec::new() })
    }

    /// Reads the value of option `packet_fields`.
    ///
    /// # Errors
    /// If a key is unknown or given twice, or a name is missing.
    pub fn parse_packets(text: &str) -> Result<Self, String> {
        Self::parse(text, PACKET_FIELDS, &OF_PACKETS)
    }

    /// The names of the user for what the table of true positions has, or none.
    pub(crate) fn of_truth(given: Option<&Self>) -> Self {
        given.cloned().unwrap_or(Self { flag: Some(TRUTH_FIELDS), pairs: Vec::new() })
    }

    /// Reads the value of option `truth_fields`.
    ///
    /// # Errors
    /// If a key is unknown or given twice, or a name is missing.
    pub fn parse_truth(text: &str) -> Result<Self, String> {
        Self::parse(text, TRUTH_FIELDS, &OF_TRUTH)
    }

    /// Reads the value of option `path_fields`.
    ///
    /// # Errors
    /// If a key is unknown or given twice, or a name is missing.
    pub fn parse_places(text: &str) -> Result<Self, String> {
        Self::parse(text, PATH_FIELDS, &OF_PLACES)
    }

    fn parse(text: &str, flag: &'static str, keys: &[&'static str]) -> Result<Self, String> {
        let mut pairs: Vec<(&'static str, String)> = Vec::new();
        for part in text.split(',') {
            let (key, name) = part.split_once('=').unwrap_or((part, ""));
            let (key, name) = (key.trim(), name.trim());
            if name.is_empty() {
                return Err(format!("found `{part}`; allowed: KEY=NAME, joined by commas"));
            }
            let known = keys.iter().find(|known| **known == key);
            let key = known.ok_or_else(|| format!("unknown key `{key}`; allowed: {}", keys.join(", ")))?;
            if pairs.iter().any(|(other, _)| other == key) {
                return Err(format!("`{key}` is given twice"));
            }
            if let Some((other, _)) = pairs.iter().find(|(_, other)| other == name) {
                return Err(format!("`{name}` is both `{other}` and `{key}`"));
            }
            pairs.push((key, name.to_owned()));
        }
        Ok(Self { flag: Some(flag), pairs })
    }

    /// The name of `key`, if the user gave one.
    pub(crate) fn name(&self, key: &str) -> Option<&str> {
        self.pairs.iter().find(|(known, _)| *known == key).map(|(_, name)| name.as_str())
    }

    /// Whether the user gives this name to a column.
    pub(crate) fn gives(&self, name: &str) -> bool {
        self.pairs.iter().any(|(_, given)| given == name)
    }

    /// Whether some column is named by its number, `#2`: the file has no header.
    pub(crate) fn has_numbers(&self) -> bool {
        self.pairs.iter().any(|(_, name)| is_number(name))
    }

    /// How to name the columns of a file without a header, for an error; nothing if there is no option for it. `wanted` are
    /// columns that the file may have.
    pub(crate) fn numbers_hint(&self, wanted: &[&'static str]) -> String {
        let Some(flag) = self.flag else { return "; allowed: a first line with the names of the columns".to_owned() };
        let shown = ["stop", "node", "t_s", "x_m", "y_m", "rssi_dbm"].into_iter().filter(|key| wanted.contains(key));
        let pairs: Vec<String> = shown.enumerate().map(|(at, key)| format!("{key}=#{}", at + 1)).collect();
        format!(
            "; if the file has no header, name its columns by their numbers: `{flag}={}`, for example",
            pairs.join(",")
        )
    }

    /// The keys for which the user gave names.
    pub(crate) fn keys(&self) -> impl Iterator<Item = &'static str> {
        self.pairs.iter().map(|(key, _)| *key)
    }

    /// What the columns `written` are: the known names that the user gives them, or their own. A column with the known name
    /// that the user gives to another one is none: it has no name.
    pub(crate) fn rename(
        &self,
        written: &[String],
        known: &[&'static str],
        part: &LogPart,
    ) -> Result<Vec<String>, String> {
        let flag = self.flag.unwrap_or_default();
        let own = |name: &String| if self.name(name).is_some() { String::new() } else { name.clone() };
        let mut columns: Vec<String> = written.iter().map(own).collect();
        for (key, name) in &self.pairs {
            if !known.contains(key) {
                return Err(format!(
                    "option `{flag}` has `{key}={name}`, but this {} has no `{key}`; allowed: {}",
                    part.noun(),
                    known.join(", ")
                ));
            }
            let at = written.iter().position(|column| column == name).ok_or_else(|| {
                format!(
                    "option `{flag}` has `{key}={name}`, but there is no column `{name}`; the columns are: {}",
                    choices(written)
                )
            })?;
            columns[at] = (*key).to_owned();
        }
        Ok(columns)
    }

    /// How to say that the column `written` is the known one `key`, for an error.
    pub(crate) fn hint(&self, key: &str, written: &str) -> String {
        self.flag.map_or_else(String::new, |flag| format!(", or give `{flag}={key}={written}`"))
    }
}

impl fmt::Display for FieldNames {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, (key, name)) in self.pairs.iter().enumerate() {
            write!(f, "{}{key}={name}", if index == 0 { "" } else { "," })?;
        }
        Ok(())
    }
}

/// Whether a name is that of a column by its number: `#2`.
fn is_number(name: &str) -> bool {
    let digits = name.strip_prefix('#').unwrap_or_default();
    !digits.is_empty() && digits.bytes().all(|octet| octet.is_ascii_digit())
}

/// The flag that names what packets have.
const PACKET_FIELDS: &str = "packet_fields";
/// The flag that names what ranges have.
const RANGE_FIELDS: &str = "range_fields";
/// The flag that names what true positions have.
const TRUTH_FIELDS: &str = "truth_fields";
/// The flag that names what places have.
const PATH_FIELDS: &str = "path_fields";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_written_as_they_are_read() {
        let text = "node=beacons[].id,rssi_dbm=beacons[].rssi,t_ms=#time [ms]";
        assert_eq!(FieldNames::parse_packets(text).unwrap().to_string(), text);
        for (text, problem) in [
            ("node=a,node=b", "`node` is given twice"),
            ("node=a,rssi=b", "unknown key `rssi`; allowed: node, receiver"),
            ("node=a,t_s=a", "`a` is both `node` and `t_s`"),
            ("src", "found `src`; allowed: KEY=NAME"),
            ("node=", "found `node=`; allowed: KEY=NAME"),
        ] {
            let found = FieldNames::parse_packets(text).unwrap_err();
            assert!(found.starts_with(problem), "{found}");
        }
    }

    #[test]
    fn a_column_gives_way_to_the_one_that_the_user_names() {
        let names = FieldNames::parse_places("t_s=time").unwrap();
        let file = LogPart::File("path.csv".into());
        let written = ["t_s", "time", "x_m"].map(str::to_owned);
        assert_eq!(names.rename(&written, &["t_s", "x_m"], &file).unwrap(), ["", "t_s", "x_m"]);
        let problem = names.rename(&written[..1], &["t_s", "x_m"], &file).unwrap_err();
        assert_eq!(
            problem,
            "option `path_fields` has `t_s=time`, but there is no column `time`; the columns are: t_s"
        );
        let problem = names.rename(&written, &["x_m"], &file).unwrap_err();
        assert_eq!(problem, "option `path_fields` has `t_s=time`, but this file has no `t_s`; allowed: x_m");
    }
}
