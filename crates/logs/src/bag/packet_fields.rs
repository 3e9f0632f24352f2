//! The fields of the messages of packets.

use std::fmt;

use super::field_path::FieldPath;
use crate::error::robot_log_error::RobotLogError;
use crate::options::field_names::FieldNames;
use crate::options::form_options::FormOptions;
use crate::ranges::units::{OTHER_COLUMNS, RANGES};

/// The fields of the messages of packets.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PacketFields {
    /// Who is mapped: the sender, or the receiver if roles are turned.
    pub(super) node: FieldPath,
    /// The sender, if roles are turned.
    pub(super) sender: Option<FieldPath>,
    pub(super) rssi_dbm: Option<FieldPath>,
    pub(super) snr_db: Option<FieldPath>,
    pub(super) sector: Option<FieldPath>,
    /// A measured distance, and a metre in its unit.
    pub(super) range: Option<(RangeUnit, FieldPath)>,
    pub(super) time: Option<(TimeUnit, FieldPath)>,
}

/// The key of a field with a range, and a metre in its unit.
pub(super) type RangeUnit = (&'static str, f64);

/// The unit of a field with a time, if it is a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TimeUnit {
    Seconds,
    Milliseconds,
    Microseconds,
    Nanoseconds,
}

impl TimeUnit {
    const ALL: [Self; 4] = [Self::Seconds, Self::Milliseconds, Self::Microseconds, Self::Nanoseconds];

    /// The key of a time in this unit.
    pub(super) const fn key(self) -> &'static str {
        match self {
            Self::Seconds => "t_s",
            Self::Milliseconds => "t_ms",
            Self::Microseconds => "t_us",
            Self::Nanoseconds => "t_ns",
        }
    }

    /// Its length (ns).
    pub(super) const fn nanoseconds(self) -> i64 {
        match self {
            Self::Seconds => 1_000_000_000,
            Self::Milliseconds => 1_000_000,
            Self::Microseconds => 1000,
            Self::Nanoseconds => 1,
        }
    }
}

impl PacketFields {
    /// The fields that the user names; `None` if there are none.
    ///
    /// # Errors
    /// If the node is missing, a key is for CSV files only, or a name is not the path of a field.
    pub(super) fn of(form: &FormOptions) -> Result<Option<Self>, RobotLogError> {
        let Some(names) = &form.packet_fields else {
            if form.reciprocal {
                let problem =
                    "with option `reciprocal`, give `packet_fields=receiver=PATH[,node=PATH][,rssi_dbm=PATH]`";
                return Err(refused(problem));
            }
            return Ok(None);
        };
        Self::read(names, form.reciprocal)
            .map(Some)
            .map_err(|problem| refused(format!("option `packet_fields`: {problem}")))
    }

    /// The fields of ranges that the user names; `None` if there are none.
    ///
    /// # Errors
    /// If the node or the range is missing, a key is for CSV files only, or a name is not the path of a field.
    pub(super) fn of_ranges(form: &FormOptions) -> Result<Option<Self>, RobotLogError> {
        let Some(names) = &form.range_fields else { return Ok(None) };
        let refused = |problem: String| refused(format!("option `range_fields`: {problem}"));
        let fields = Self::read(names, false).map_err(refused)?;
        if fields.range.is_none() {
            return Err(refused(format!("`range_m` (or {OTHER_COLUMNS}) is missing; it is required")));
        }
        Ok(Some(fields))
    }

    fn read(names: &FieldNames, is_turned: bool) -> Result<Self, String> {
        let allowed: &[&str] = &[
            "node", "receiver", "rssi_dbm", "snr_db", "sector", "range_m", "range_cm", "range_mm", "range_ft",
            "range_ns", "t_s", "t_ms", "t_us", "t_ns",
        ];
        if let Some(key) = names.keys().find(|key| !allowed.contains(key)) {
            return Err(format!("`{key}` is for CSV files; allowed for bags: {}", allowed.join(", ")));
        }
        let path = |key: &str| names.name(key).map(FieldPath::parse).transpose();
        let required = |key: &str| path(key)?.ok_or_else(|| format!("`{key}` is missing; it is required"));
        let (node, sender) = match (is_turned, path("receiver")?) {
            (false, Some(_)) => return Err("`receiver` is for option `reciprocal`".to_owned()),
            (false, None) => (required("node")?, None),
            (true, _) => (required("receiver")?, path("node")?),
        };
        let mut times = TimeUnit::ALL.into_iter().filter_map(|unit| Some((unit, path(unit.key()).transpose()?)));
        let time = times.next().map(|(unit, path)| path.map(|path| (unit, path))).transpose()?;
        if let (Some((unit, _)), Some((other, _))) = (&time, times.next()) {
            return Err(format!("both `{}` and `{}` are given; allowed: one of them", unit.key(), other.key()));
        }
        let mut ranges = RANGES.into_iter().filter_map(|unit| Some((unit, path(unit.0).transpose()?)));
        let range = ranges.next().map(|(unit, path)| path.map(|path| (unit, path))).transpose()?;
        if let (Some(((first, _), _)), Some(((other, _), _))) = (&range, ranges.next()) {
            return Err(format!("both `{first}` and `{other}` are given; allowed: one of them"));
        }
        let [rssi_dbm, snr_db, sector] = [path("rssi_dbm")?, path("snr_db")?, path("sector")?];
        Ok(Self { node, sender, rssi_dbm, snr_db, sector, range, time })
    }
}

fn refused(problem: impl Into<String>) -> RobotLogError {
    RobotLogError::Form { problem: problem.into() }
}

impl fmt::Display for PacketFields {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.sender {
            None => write!(f, "node={}", self.node)?,
            Some(sender) => write!(f, "receiver={},node={sender}", self.node)?,
        }
        let measured = [("rssi_dbm", &self.rssi_dbm), ("snr_db", &self.snr_db), ("sector", &self.sector)];
        for (key, path) in measured {
            if let Some(path) = path {
                write!(f, ",{key}={path}")?;
            }
        }
        if let Some(((key, _), path)) = &self.range {
            write!(f, ",{key}={path}")?;
        }
        match &self.time {
            Some((unit, path)) => write!(f, ",{}={path}", unit.key()),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, reciprocal: bool) -> Result<String, String> {
        let names = FieldNames::parse_packets(text)?;
        let form = FormOptions { packet_fields: Some(names), reciprocal, ..FormOptions::default() };
        let fields = PacketFields::of(&form).map_err(|error| error.to_string())?;
        Ok(fields.map(|fields| fields.to_string()).unwrap_or_default())
    }

    #[test]
    fn the_fields_of_packets_are_written_as_they_are_read() {
        for (text, reciprocal) in [
            ("node=beacons[].id,rssi_dbm=beacons[].rssi,sector=antenna,t_s=header.stamp", false),
            ("node=src,snr_db=snr,t_us=time", false),
            ("receiver=gateway,node=tag,rssi_dbm=rssi", true),
            ("node=anchor_id,rssi_dbm=rss,range_mm=range,t_s=stamp", false),
        ] {
            assert_eq!(read(text, reciprocal).as_deref(), Ok(text));
        }
        for (text, reciprocal, problem) in [
            ("rssi_dbm=rssi", false, "`node` is missing"),
            ("node=a..b", false, "`a..b` is not the path of a field"),
            ("node=a,stop=b", false, "`stop` is for CSV files"),
            ("node=a,receiver=b", false, "`receiver` is for option `reciprocal`"),
            ("node=a", true, "`receiver` is missing"),
            ("node=a,range_m=b,range_mm=c", false, "both `range_m` and `range_mm` are given"),
            ("node=a,t_s=b,t_ms=c", false, "both `t_s` and `t_ms` are given"),
        ] {
            let found = read(text, reciprocal).unwrap_err();
            assert!(found.contains(problem), "{found}");
        }
    }
}
