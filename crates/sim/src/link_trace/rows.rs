//! The rows of files of measured links: our own columns, and the format K7.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use csv::StringRecord;
use sextant_channel::{Dbm, TracedLink};
use sextant_kernel::text::{listed, of_cell, shortened};
use sextant_kernel::{SettingError, SimTime};

use super::{TraceEnd, TraceRow, TraceStations};
use crate::csv_rows::{line_of, row_fault};

/// Latest time of a row (s).
const LATEST_S: f64 = 1e8;

const OWN: &str = "the columns `t_s`, `from`, `to`, optionally `channel`, and `prr` (0 to 1), `rssi_dbm` or both; or \
                   those of K7: `datetime`, `src`, `dst`, `channel`, `mean_rssi`, `pdr`, `tx_count`";

/// The columns of a file.
#[derive(Clone, Copy)]
struct Columns {
    /// Whether times are dates: in K7.
    is_dated: bool,
    time: usize,
    from: usize,
    to: usize,
    channel: Option<usize>,
    strength: Option<usize>,
    share: Option<usize>,
}

/// The names of the columns of time, sender, receiver, strength and share, in our format and in K7.
const NAMES: [[&str; 5]; 2] =
    [["t_s", "from", "to", "rssi_dbm", "prr"], ["datetime", "src", "dst", "mean_rssi", "pdr"]];

impl Columns {
    fn of(header: &StringRecord) -> Result<Self, String> {
        let find = |name: &str| header.iter().position(|column| column == name);
        let is_dated = find("datetime").is_some();
        let [time, from, to, strength, share] = NAMES[usize::from(is_dated)];
        let known = |column: &str| {
            [time, from, to, strength, share, "channel"].contains(&column) || column == "tx_count" && is_dated
        };
        if let Some(column) = header.iter().find(|column| !known(column)) {
            return Err(format!("column `{}`", shortened(column)));
        }
        let needed = |name: &str| find(name).ok_or_else(|| format!("no column `{name}`"));
        let columns = Self {
            is_dated,
            time: needed(time)?,
            from: needed(from)?,
            to: needed(to)?,
            channel: find("channel"),
            strength: find(strength),
            share: find(share),
        };
        match (columns.strength, columns.share) {
            (None, None) => Err(format!("neither a column `{share}` nor `{strength}`")),
            _ => Ok(columns),
        }
    }
}

/// Reads the rows of `text`, sorted by time.
pub(super) fn read(text: &str, file: &str, stations: &TraceStations<'_>) -> Result<Vec<TraceRow>, SettingError> {
    // The first line of K7 is an object that describes the site.
    let (skipped, table) = match text.split_once('\n') {
        Some((first, rest)) if first.trim_start().starts_with('{') => (1, rest),
        _ => (0, text),
    };
    let refuse = |line: u64, what: String, allowed: &str| {
        SettingError::new("file", format!("`{file}`, line {}: {what}", line + skipped), allowed)
    };
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(table.as_bytes());
    let header = reader.headers().map_err(|error| refuse(1, error.to_string(), OWN))?.clone();
    let columns = Columns::of(&header).map_err(|what| refuse(1, what, OWN))?;
    let mut ends: BTreeMap<&str, TraceEnd> = BTreeMap::new();
    ends.extend(stations.sinks.iter().enumerate().map(|(sink, &name)| (name, TraceEnd::Sink(sink))));
    ends.extend(stations.nodes.iter().enumerate().map(|(node, placed)| (&*placed.name, TraceEnd::Node(node))));
    let (mut rows, mut channels) = (Vec::new(), BTreeSet::new());
    for record in reader.records() {
        let record = record.map_err(|error| refuse(line_of(table, error.position()), row_fault(&error), OWN))?;
        let line = line_of(table, record.position());
        let cell = |column: usize| record.get(column).unwrap_or_default();
        let in_column = |column: usize| {
            let name = header.get(column).unwrap_or_default();
            format!("`{}` in the column `{name}`", shortened(cell(column)))
        };
        let mut only_on = None;
        if let Some(column) = columns.channel {
            let allowed = "the number of a radio channel";
            let channel: u8 = cell(column).parse().map_err(|_| refuse(line, in_column(column), allowed))?;
            channels.insert(channel);
            if !stations.channels.is_empty() && !stations.channels.contains(&channel) {
                continue;
            }
            only_on = Some(channel).filter(|_| stations.channels.len() > 1);
        }
        let end = |column: usize| {
            let name = of_cell(cell(column));
            ends.get(name).copied().ok_or_else(|| refuse(line, in_column(column), "the name of a node or a sink"))
        };
        let number = |column: Option<usize>| {
            let Some(column) = column.filter(|&column| !matches!(cell(column), "" | "nan" | "NaN")) else {
                return Ok(None);
            };
            let parsed: Result<f64, _> = cell(column).parse();
            let number = parsed.ok().filter(|number| number.is_finite());
            number.map(Some).ok_or_else(|| refuse(line, in_column(column), "a number, or nothing"))
        };
        let (from, to) = (end(columns.from)?, end(columns.to)?);
        if from == to {
            return Err(refuse(line, format!("`{}` twice", shortened(cell(columns.to))), "two different stations"));
        }
        let time = cell(columns.time);
        let since_s = if columns.is_dated { seconds_of_date(time) } else { time.parse().ok() };
        let allowed = if columns.is_dated { "a time like `2017-06-20 16:22:15`" } else { "0 to 1e8" };
        let since_s = since_s.filter(|t_s| columns.is_dated || (0.0..=LATEST_S).contains(t_s));
        let since_s = since_s.ok_or_else(|| refuse(line, in_column(columns.time), allowed))?;
        let (strength, share) = (number(columns.strength)?, number(columns.share)?);
        if share.is_some_and(|share| !(0.0..=1.0).contains(&share)) {
            return Err(refuse(
                line,
                in_column(columns.share.unwrap_or_default()),
                "a share from 0 to 1, not percent",
            ));
        }
        if strength.is_some_and(|dbm| !(-200.0..=50.0).contains(&dbm)) {
            return Err(refuse(line, in_column(columns.strength.unwrap_or_default()), "-200 to 50"));
        }
        if strength.is_none() && share.is_none() {
            return Err(refuse(line, "neither a strength nor a share".to_owned(), OWN));
        }
        let link = TracedLink { strength: strength.map(Dbm), share };
        rows.push((since_s, TraceRow { since: SimTime::ZERO, from, to, channel: only_on, link }));
    }
    let allowed = "at least one row of each radio channel of the network";
    if rows.is_empty() && channels.is_empty() {
        return Err(SettingError::new("file", format!("`{file}`, without any rows"), allowed));
    }
    let missing = stations.channels.iter().find(|wanted| !channels.contains(*wanted));
    if let Some(channel) = missing.filter(|_| !channels.is_empty()) {
        let others: Vec<String> = channels.iter().map(u8::to_string).collect();
        let found = format!("`{file}`, with rows of the channels {}, and none of channel {channel}", listed(&others));
        return Err(SettingError::new("file", found, allowed));
    }
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Dates count from the first row of the file that is used.
    let start_s = if columns.is_dated { rows[0].0 } else { 0.0 };
    let row = |(since_s, row): (f64, TraceRow)| {
        let since = SimTime::ZERO + Duration::from_secs_f64((since_s - start_s).min(LATEST_S));
        TraceRow { since, ..row }
    };
    Ok(rows.into_iter().map(row).collect())
}

/// Seconds since some fixed instant of `YYYY-MM-DD HH:MM:SS`, with `T` between or parts of a second if they are there.
fn seconds_of_date(text: &str) -> Option<f64> {
    let (date, time) = text.split_once([' ', 'T'])?;
    let mut date = date.splitn(3, '-').map(|part| part.parse::<i64>().ok());
    let (year, month, day) = (date.next()??, date.next()??, date.next()??);
    let mut time = time.trim_end_matches('Z').splitn(3, ':').map(|part| part.parse::<f64>().ok());
    let (hour, minute, second) = (time.next()??, time.next()??, time.next()??);
    let is_date = (1..=9999).contains(&year) && (1..=12).contains(&month) && (1..=31).contains(&day);
    let is_time = (0.0..24.0).contains(&hour) && (0.0..60.0).contains(&minute) && (0.0..61.0).contains(&second);
    if !is_date || !is_time {
        return None;
    }
    // Days of the Gregorian calendar, with years that begin in March.
    let (year, month) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    let days = 365 * year + year / 4 - year / 100 + year / 400 + (153 * month + 2) / 5 + day;
    Some(86_400.0 * days as f64 + 3600.0 * hour + 60.0 * minute + second)
}

#[cfg(test)]
mod tests {
    use sextant_channel::Position;

    use super::*;
    use crate::world::layout::PlacedNode;

    fn parsed(text: &str, channels: &[u8]) -> Result<Vec<TraceRow>, String> {
        let node = |name: &str| PlacedNode { name: name.into(), position: Position::ORIGIN };
        let nodes = [node("a"), node("b")];
        let stations = TraceStations { nodes: &nodes, sinks: &["gateway"], channels };
        read(text, "links.csv", &stations).map_err(|error| error.found().to_owned())
    }

    fn at(seconds: f64) -> SimTime {
        SimTime::ZERO + Duration::from_secs_f64(seconds)
    }

    #[test]
    fn rows_are_sorted_by_time_and_may_have_a_share_or_a_strength() {
        let text = "t_s,from,to,prr,rssi_dbm\n20,a,gateway,0.5,\n0,gateway,a,,-81.5\n# later\n10,a,b,1,-60\n";
        let rows = parsed(text, &[15]).unwrap();
        let link = |strength: Option<f64>, share| TracedLink { strength: strength.map(Dbm), share };
        let row = |t_s, from, to, link| TraceRow { since: at(t_s), from, to, channel: None, link };
        let (a, b, gateway) = (TraceEnd::Node(0), TraceEnd::Node(1), TraceEnd::Sink(0));
        assert_eq!(rows[0], row(0.0, gateway, a, link(Some(-81.5), None)));
        assert_eq!(rows[1], row(10.0, a, b, link(Some(-60.0), Some(1.0))));
        assert_eq!(rows[2], row(20.0, a, gateway, link(None, Some(0.5))));
    }

    #[test]
    fn a_file_of_k7_counts_from_its_first_row_and_has_its_channels_chosen() {
        let text = "{\"location\": \"somewhere\", \"node_count\": 2}\n\
                    datetime,src,dst,channel,mean_rssi,pdr,tx_count\n\
                    2017-12-31 23:59:58,a,b,11,-71.5,0.93,100\n\
                    2018-01-01 00:00:03.5,a,b,11,-72,0.4,100\n\
                    2018-01-01 00:00:01,b,a,20,,0,100\n";
        let rows = parsed(text, &[11]).unwrap();
        assert_eq!(rows.iter().map(|row| row.since).collect::<Vec<_>>(), [at(0.0), at(5.5)]);
        assert_eq!(rows[1].link, TracedLink { strength: Some(Dbm(-72.0)), share: Some(0.4) });
        assert_eq!(rows[0].channel, None);
        assert_eq!(parsed(text, &[]).unwrap().len(), 3);
        let hopping = parsed(text, &[20, 11]).unwrap();
        assert_eq!(hopping.iter().map(|row| row.channel).collect::<Vec<_>>(), [Some(11), Some(20), Some(11)]);
        assert!(parsed(text, &[20, 11, 12]).unwrap_err().ends_with("and none of channel 12"));
        assert_eq!(
            parsed(text, &[26]).unwrap_err(),
            "`links.csv`, with rows of the channels 11, 20, and none of channel 26"
        );
        assert_eq!(
            parsed(&text.replace("0.4", "93"), &[11]).unwrap_err(),
            "`links.csv`, line 4: `93` in the column `pdr`"
        );
        assert_eq!(
            parsed(&text.replace("2018-01-01 00:00:03.5", "1.1.2018"), &[11]).unwrap_err(),
            "`links.csv`, line 4: `1.1.2018` in the column `datetime`"
        );
        // A leap year.
        let between =
            seconds_of_date("2024-03-01 00:00:00").unwrap() - seconds_of_date("2024-02-28T00:00:00Z").unwrap();
        assert!((between - 2.0 * 86_400.0).abs() < 1e-6);
    }

    #[test]
    fn an_error_names_its_line() {
        let found = |rows: &str| parsed(&format!("t_s,from,to,prr\n{rows}"), &[]).unwrap_err();
        assert_eq!(found("0,a,c,1\n"), "`links.csv`, line 2: `c` in the column `to`");
        assert_eq!(found("0,a,a,1\n"), "`links.csv`, line 2: `a` twice");
        assert_eq!(found("0,a,b,1.5\n"), "`links.csv`, line 2: `1.5` in the column `prr`");
        assert_eq!(found("-1,a,b,1\n"), "`links.csv`, line 2: `-1` in the column `t_s`");
        assert_eq!(found("0,a,b,\n"), "`links.csv`, line 2: neither a strength nor a share");
        assert_eq!(found(""), "`links.csv`, without any rows");
        assert_eq!(
            parsed("t_s,from,to\n", &[]).unwrap_err(),
            "`links.csv`, line 1: neither a column `prr` nor `rssi_dbm`"
        );
        assert_eq!(parsed("t_s,from,to,pdr\n", &[]).unwrap_err(), "`links.csv`, line 1: column `pdr`");
    }
}
